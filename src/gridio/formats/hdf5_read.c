/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/hdf5_read.h"
#include "gridio/common/array_place.h"
#include "gridio/common/raster.h"
#include "gridio/formats/hdf5.h"
#include "sandbox/reader_process.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/** It may lie behind a block of another program: MATLAB's is 512 bytes. */
bool vxm_hdf5_sniff(const vxm_input *input) {
  static const char magic[8] = "\x89HDF\r\n\x1a\n";
  for (size_t at = 0; at <= 4096 && input->size > at + sizeof magic; at = at == 0 ? 512 : 2 * at)
    if (memcmp(input->data + at, magic, sizeof magic) == 0)
      return true;
  return false;
}

/** A file on its way in. */
typedef struct receipt {
  vxm_voxel_sink sink;
  const vxm_input *input;
  bool wants_space; /**< and no values */
  vxm_about about;
  vxm_warnings warnings;
  int axis[3]; /**< of the grid, for each of the file */
  bool has_odd_axes;
  vxm_space space;
  vxm_field *field;
  size_t filled; /**< bytes of its values, in the order of the file */
} receipt;

/* ---- What the file says ---- */

static bool equals(const char *text, size_t size, const char *word) {
  return size == strlen(word) && memcmp(text, word, size) == 0;
}

static void take_label(vxm_about *about, vxm_context *context, const char *key, size_t key_size,
                       const char *value, size_t size) {
  char count[24] = "", name[VXM_SINK_TEXT_MAX / 1024];
  size_t digits = key_size - strlen(VXM_HDF5_LABEL);
  if (digits >= sizeof count || size >= sizeof name || about->table.count >= VXM_LABELS_MAX)
    return;
  memcpy(count, key + strlen(VXM_HDF5_LABEL), digits);
  memcpy(name, value, size);
  name[size] = '\0';
  about->starved |= !vxm_label_table_add(&about->table, context, name, strtoll(count, NULL, 10));
}

static vxm_status take_text(void *payload, const char *key, size_t key_size, const char *value,
                            size_t value_size, vxm_error *error) {
  receipt *r = payload;
  char word[32] = "";
  (void)error;
  memcpy(word, value, value_size < sizeof word ? value_size : sizeof word - 1);
  if (equals(key, key_size, "kind"))
    vxm_about_name(&r->about, word);
  else if (equals(key, key_size, "axes"))
    r->has_odd_axes = !vxm_axes_parse(r->axis, value, value_size);
  else if (key_size > strlen(VXM_HDF5_LABEL) && memcmp(key, VXM_HDF5_LABEL, strlen(VXM_HDF5_LABEL)) == 0)
    take_label(&r->about, r->input->context, key, key_size, value, value_size);
  return VXM_OK;
}

static void warn_array(receipt *r, const vxm_sink_array *array) {
  if (array->fits > 1)
    vxm_warn(&r->warnings, "of its %" PRIu32 " datasets that could be voxels \"voxels\" is read",
             array->fits);
  if (r->has_odd_axes)
    vxm_axes_warn(&r->warnings);
  vxm_place_warn(&r->warnings, array->known_place);
}

/** Values are not touched before they arrive, so that a short file cannot take much memory. */
static vxm_status take_array(void *payload, const vxm_sink_array *array, vxm_error *error) {
  receipt *r = payload;
  for (int a = 0; a < 3; a++) {
    r->space.dims[r->axis[a]] = array->shape[a];
    r->space.origin[a] = array->known_place & VXM_PLACE_ORIGIN ? array->place[a] : 0;
    r->space.voxel_size[a] = array->known_place & VXM_PLACE_SIZE ? array->place[3 + a] : 1;
  }
  vxm_status status = vxm_space_check_file(&r->space, r->input, 0, error);
  if (status != VXM_OK)
    return status;
  warn_array(r, array);
  r->sink.is_full = r->wants_space;
  if (r->wants_space)
    return VXM_OK;
  vxm_scalar scalar = array->is_color ? VXM_UINT8 : (vxm_scalar)array->scalar;
  return vxm_field_make_zeros(&r->field, r->input->context, &r->space,
                              array->is_color ? VXM_FIELD_COLORS : VXM_FIELD_NUMBERS, scalar, error);
}

/* ---- The values ---- */

/** Where a value of the file goes, counted in values, if the axes are not those of the grid. */
static size_t find_place(const receipt *r, size_t index) {
  const int64_t *n = r->space.dims, step[3] = {n[1] * n[2], n[2], 1};
  int64_t at = 0, rest = (int64_t)index;
  for (int a = 2; a >= 0; a--) {
    at += rest % n[r->axis[a]] * step[r->axis[a]];
    rest /= n[r->axis[a]];
  }
  return (size_t)at;
}

static bool is_straight(const receipt *r) {
  return r->axis[0] == 0 && r->axis[1] == 1 && r->axis[2] == 2;
}

static vxm_status take_values(void *payload, const void *values, size_t size, vxm_error *error) {
  receipt *r = payload;
  const unsigned char *from = values;
  const size_t voxel = r->field ? vxm_field_voxel_bytes(r->field) : 1;
  if (!r->field || size > vxm_field_count(r->field) * voxel - r->filled)
    return vxm_fail_byte(error, r->input, 0, "more values came from it than it has");
  if (is_straight(r)) {
    memcpy(r->field->values + r->filled, from, size);
    r->filled += size;
    return VXM_OK;
  }
  for (size_t b = 0; b < size;) {
    size_t in = r->filled % voxel, part = voxel - in < size - b ? voxel - in : size - b;
    memcpy(r->field->values + find_place(r, r->filled / voxel) * voxel + in, from + b, part);
    r->filled += part;
    b += part;
  }
  return VXM_OK;
}

/* ---- A file ---- */

/** Reads the file; of the receipt nothing but the space and warnings holds after a failure. */
static vxm_status receive(receipt *r, vxm_error *error) {
  const vxm_input *input = r->input;
  const vxm_reader_request request = {
      .data = input->data, .size = input->size, .name = input->name, .hint = "h5"};
  memcpy(r->axis, (const int[3]){0, 1, 2}, sizeof r->axis);
  r->sink = (vxm_voxel_sink){
      .text = take_text, .array = take_array, .values = take_values, .payload = r, .is_full = false};
  if (!vxm_hdf5_sniff(input))
    return vxm_fail_byte(error, input, 0, "not an HDF5 file: its signature is not there");
  vxm_status status =
      vxm_reader_process_grid(&r->sink, &r->warnings, input->context, &vxm_hdf5_need, &request, error);
  if (status == VXM_OK && r->field &&
      r->filled != vxm_field_count(r->field) * vxm_field_voxel_bytes(r->field))
    status = vxm_fail_byte(error, input, 0, "fewer values came from it than it has");
  if (status == VXM_OK)
    status = vxm_progress(input->context, "reading", 1, error);
  if (status == VXM_OK)
    return VXM_OK;
  vxm_field_destroy(r->field);
  vxm_about_destroy(&r->about);
  return status;
}

vxm_status vxm_hdf5_read_field(vxm_field **out, const vxm_input *input, vxm_error *error) {
  receipt r = {.input = input};
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = receive(&r, &local);
  if (status != VXM_OK) {
    vxm_error_pass(error, &local);
    return status;
  }
  if (r.about.kind == VXM_FIELD_LABELS && r.about.table.count == 0)
    vxm_sidecar_take_labels(&r.about, r.space.dims, input);
  if (r.about.table.count > 0 && !r.about.is_declared) {
    r.about.is_declared = true;
    r.about.kind = VXM_FIELD_LABELS;
  }
  vxm_field_describe(r.field, &r.about);
  r.field->warnings = r.warnings;
  return vxm_field_hand_over(out, r.field, VXM_OK, error);
}

vxm_status vxm_hdf5_read(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  if (rule != VXM_BITS_NONE)
    return vxm_raster_bits_of_file(out, vxm_hdf5_read_field, input, rule, error);
  receipt r = {.input = input, .wants_space = true};
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = receive(&r, &local);
  if (status == VXM_OK) {
    vxm_about_destroy(&r.about);
    status = vxm_grid_create(out, input->context, &r.space, &local);
  }
  if (status == VXM_OK)
    (*out)->warnings = r.warnings;
  else
    vxm_error_pass(error, &local);
  return status;
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** .npy: an array [x][y][z] of numpy. It holds no transform: that goes into a JSON file beside it. */
#include "base/endian.h"
#include "gridio/common/byte_rows.h"
#include "gridio/common/format.h"
#include "gridio/common/scalar_type.h"
#include "gridio/common/sidecar.h"
#include "gridio/common/values_writer.h"
#include "gridio/formats/npy_header.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static const vxm_sidecar_text description = {"voxmend npy", "z fastest, then y, then x", NULL};

/* ---- Reading ---- */

/** C order: z fastest and x slowest, through planes. */
static vxm_status read_c_order(vxm_grid *grid, const unsigned char *data, vxm_scalar_type element,
                               atomic_uint *seen, vxm_error *error) {
  vxm_bit_transpose planes;
  vxm_status status =
      vxm_bit_transpose_create(&planes, grid->context, &grid->space, (vxm_layout)VXM_PLANE_Z_FAST, error);
  if (status != VXM_OK)
    return status;
  for (size_t w = 0; status == VXM_OK && w < grid->row_words; w++) {
    size_t count = vxm_bit_transpose_in(grid, w);
    vxm_scalar_types_to_planes(&planes, count, data, element, seen);
    data += count * planes.rows * planes.length * element.size;
    vxm_bit_transpose_scatter(&planes, grid, w);
    status = vxm_progress(grid->context, "reading", (double)(w + 1) / (double)grid->row_words, error);
  }
  vxm_bit_transpose_destroy(&planes);
  return status;
}

/** The transform from the JSON, and what it says of the values, if there is one and it is of this array. */
static vxm_status find_space(vxm_space *space, vxm_about *about, const vxm_npy_header *h,
                             const vxm_input *input, vxm_warnings *warnings, vxm_error *error) {
  const char *format = h->channels == 4 ? "voxmend colors" : description.format;
  for (int a = 0; a < 3; a++) {
    space->origin[a] = 0;
    space->voxel_size[a] = 1;
  }
  bool is_file = input->mapping || strcmp(input->name, "<stdin>") != 0;
  if (!is_file || !vxm_sidecar_exists(input->name)) {
    vxm_warn(warnings, "no .json beside the array: origin 0 0 0 and voxel size 1 are taken");
    return VXM_OK;
  }
  vxm_space beside;
  vxm_about found = {.is_declared = false};
  vxm_error why = VXM_ERROR_INIT;
  vxm_status status = vxm_sidecar_read(&beside, &found, input->context, input->name, format, &why);
  if (vxm_is_memory(status)) {
    vxm_about_destroy(&found);
    return vxm_fail(error, status, "%s", why.text);
  }
  if (status != VXM_OK)
    vxm_warn(warnings, "origin 0 0 0 and voxel size 1 are taken: %s", why.text);
  else if (memcmp(beside.dims, space->dims, sizeof space->dims) != 0)
    vxm_warn(warnings, "origin 0 0 0 and voxel size 1 are taken: the .json beside the array has other dims");
  else {
    *space = beside;
    *about = found;
    return VXM_OK;
  }
  vxm_about_destroy(&found);
  return VXM_OK;
}

static vxm_status check_length(const vxm_npy_header *h, const vxm_space *space, const vxm_input *input,
                               vxm_warnings *warnings, vxm_error *error) {
  size_t size = h->size * (size_t)h->channels;
  uint64_t voxels = vxm_space_voxels(space), there = input->size - h->data;
  if (there / size < voxels)
    return vxm_fail_byte(error, input, input->size,
                         "the file is cut short: it has %" PRIu64 " of %" PRIu64 " elements", there / size,
                         voxels);
  if (there > voxels * size)
    vxm_warn(warnings, "%" PRIu64 " bytes behind the array are ignored", there - voxels * size);
  return VXM_OK;
}

/** All that stands before the values. */
typedef struct front {
  vxm_npy_header header;
  vxm_space space;
  vxm_about about;
  vxm_warnings warnings;
} front;

static vxm_status read_front(front *f, const vxm_input *input, vxm_error *error) {
  *f = (front){.warnings.count = 0};
  vxm_npy_header *h = &f->header;
  vxm_status status = vxm_npy_header_read(h, input, error);
  if (status != VXM_OK)
    return status;
  memcpy(f->space.dims, h->shape, sizeof f->space.dims);
  status = find_space(&f->space, &f->about, h, input, &f->warnings, error);
  if (status == VXM_OK)
    status = vxm_space_check_file(&f->space, input, h->shape_offset, error);
  return status == VXM_OK ? check_length(h, &f->space, input, &f->warnings, error) : status;
}

static const char *type_of(const vxm_npy_header *h) {
  return h->channels == 4 ? "colors" : vxm_scalar_name(vxm_scalar_of(h->kind, h->size));
}

static vxm_status read_bits(vxm_grid **out, const front *f, const vxm_input *input, vxm_bits_rule rule,
                            vxm_error *error) {
  const vxm_npy_header *h = &f->header;
  const unsigned char *data = input->data + h->data;
  vxm_scalar_type element = vxm_scalar_type_of(h->kind, h->size, h->big_endian);
  atomic_uint seen = 0;
  if (rule != VXM_BITS_NONE && (h->channels == 4 || !vxm_scalar_type_may_be_bits(element, rule) ||
                                !vxm_about_may_be_bits(&f->about, rule)))
    return vxm_fail_numbers(error, input->name, type_of(h));
  vxm_grid *grid;
  vxm_status status = vxm_grid_create(&grid, input->context, &f->space, error);
  if (status == VXM_OK && rule != VXM_BITS_NONE)
    status = (h->fortran ? vxm_scalar_types_to_grid : read_c_order)(grid, data, element, &seen, error);
  if (status == VXM_OK && !vxm_seen_bits(seen, element, rule))
    status = vxm_fail_numbers(error, input->name, type_of(h));
  if (status != VXM_OK) {
    vxm_grid_destroy(grid);
    return status;
  }
  grid->warnings = f->warnings;
  *out = grid;
  return VXM_OK;
}

static vxm_status read_npy(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  front f;
  vxm_status status = read_front(&f, input, error);
  if (status == VXM_OK)
    status = read_bits(out, &f, input, rule, error);
  vxm_about_destroy(&f.about);
  return status;
}

static vxm_status read_field(vxm_field **out, const vxm_input *input, vxm_error *error) {
  front f;
  vxm_field *field = NULL;
  vxm_status status = read_front(&f, input, error);
  const vxm_npy_header *h = &f.header;
  if (status == VXM_OK)
    status = vxm_field_make(&field, input->context, &f.space,
                            h->channels == 4 ? VXM_FIELD_COLORS : VXM_FIELD_NUMBERS,
                            vxm_scalar_of(h->kind, h->size), error);
  if (status != VXM_OK) {
    vxm_about_destroy(&f.about);
    return status;
  }
  bool is_swapped = h->size > 1 && h->big_endian != (vxm_le64(1) != 1);
  if (h->fortran)
    vxm_field_put_slices(field, input->data + h->data, 0, f.space.dims[2], is_swapped);
  else
    vxm_field_put_all(field, input->data + h->data, is_swapped);
  vxm_field_describe(field, &f.about);
  field->warnings = f.warnings;
  return vxm_field_hand_over(out, field, vxm_progress(input->context, "reading", 1, error), error);
}

/* ---- Writing ---- */

static size_t state_bytes(const vxm_space *space) {
  return vxm_byte_rows_bytes(space, (vxm_layout)VXM_PLANE_Z_FAST);
}

static vxm_status begin(vxm_grid_writer *writer, vxm_error *error) {
  (void)error;
  vxm_npy_header_write(writer->output, "|b1", false, writer->space.dims);
  return VXM_OK;
}

static const vxm_grid_writer_kind writer_kind = {
    .layout = VXM_PLANE_Z_FAST,
    .sidecar = &description,
    .state_bytes = state_bytes,
    .begin = begin,
    .put = vxm_byte_rows_put,
    .file_bytes = vxm_space_voxels,
};

/* ---- Writing numbers: as they lie, little-endian ---- */

static const vxm_sidecar_text color_description = {"voxmend colors", "z fastest, then y, then x", NULL};

static vxm_status begin_values(vxm_values_writer *w, vxm_error *error) {
  (void)error;
  char type[8];
  size_t size = vxm_scalar_bytes(w->values.scalar);
  snprintf(type, sizeof type, "%c%c%zu", size == 1 ? '|' : '<', vxm_scalar_name(w->values.scalar)[0], size);
  if (w->values.channels == 4)
    vxm_npy_header_write_bytes(w->output, w->space.dims, 4);
  else
    vxm_npy_header_write(w->output, type, false, w->space.dims);
  return VXM_OK;
}

static const vxm_values_writer_kind values_kind = {
    .layout = VXM_PLANE_Z_FAST,
    .holds = VXM_HOLDS_NUMBERS | VXM_HOLDS_LABELS | VXM_HOLDS_COLORS,
    .sidecar = &description,
    .color_sidecar = &color_description,
    .has_sidecar = true,
    .file_bytes = vxm_values_plain_bytes,
    .begin = begin_values,
};

const vxm_grid_format vxm_format_npy = {
    .name = "npy",
    .holds = VXM_HOLDS_ALL,
    .sniff = vxm_npy_sniff,
    .read = read_npy,
    .read_field = read_field,
    .writer = &writer_kind,
    .values = &values_kind,
};

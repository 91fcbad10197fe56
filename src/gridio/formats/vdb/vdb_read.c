/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/vdb/vdb_read.h"
#include "gridio/common/sink_receipt.h"
#include "gridio/formats/vdb/vdb.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/** The number 0x56444220, in 8 bytes. */
static const unsigned char magic[8] = {' ', 'B', 'D', 'V', 0, 0, 0, 0};

bool vxm_vdb_sniff(const vxm_input *input) {
  return input->size >= sizeof magic && memcmp(input->data, magic, sizeof magic) == 0;
}

/** A file on its way in. */
typedef struct receipt {
  vxm_sink_receipt voxels; /**< first: it is what the sink is called with */
  bool wants_numbers;
  vxm_about about;
  vxm_scalar scalar; /**< of the numbers before they became floats */
} receipt;

/* ---- What the file says ---- */

static bool equals(const char *text, size_t size, const char *word) {
  return size == strlen(word) && memcmp(text, word, size) == 0;
}

/** Texts that OpenVDB itself writes, or that are told in another way. */
static bool is_own(const char *key, size_t size) {
  static const char *const own[] = {"class",       "name",          "creator",       "value_type",
                                    "vector_type", "file_bbox_max", "file_bbox_min", "file_compression"};
  for (size_t n = 0; n < sizeof own / sizeof own[0]; n++)
    if (equals(key, size, own[n]))
      return true;
  return false;
}

static void declare(vxm_about *about, vxm_field_kind kind) {
  about->is_declared = true;
  about->kind = kind;
}

/** What a text says of the values. What voxmend says counts more than the class. */
static vxm_status take_text(void *payload, const char *key, size_t key_size, const char *value,
                            size_t value_size, vxm_error *error) {
  (void)error;
  receipt *r = payload;
  char word[64] = "";
  vxm_field_kind kind;
  memcpy(word, value, value_size < sizeof word ? value_size : sizeof word - 1);
  if (equals(key, key_size, "class") && !r->about.is_declared && equals(value, value_size, "level set"))
    declare(&r->about, VXM_FIELD_DISTANCE);
  else if (equals(key, key_size, "class") && !r->about.is_declared && equals(value, value_size, "fog volume"))
    declare(&r->about, VXM_FIELD_COVERAGE);
  else if (equals(key, key_size, "voxmend_values") && vxm_field_kind_find(&kind, word) &&
           kind != VXM_FIELD_NUMBERS)
    declare(&r->about, kind);
  else if (equals(key, key_size, "voxmend_scalar"))
    vxm_scalar_find(&r->scalar, word);
  else if (!is_own(key, key_size))
    vxm_metadata_add(&r->about.pairs, r->voxels.input->context, key, key_size, value, value_size);
  return VXM_OK;
}

/** The name by which voxmend calls unsigned distances says what they are; other names are carried along. */
static void take_name(receipt *r) {
  const char *name = r->voxels.grid.name;
  vxm_field_kind kind = r->about.kind;
  if (!r->about.is_declared && strcmp(name, vxm_field_kind_name(VXM_FIELD_DISTANCE)) == 0)
    declare(&r->about, VXM_FIELD_DISTANCE);
  else if (*name && strcmp(name, vxm_field_kind_name(kind)) != 0)
    vxm_metadata_add(&r->about.pairs, r->voxels.input->context, VXM_VDB_NAME_KEY, strlen(VXM_VDB_NAME_KEY),
                     name, strlen(name));
}

/** Floats are bits only if all of them are 0 or 1, and nothing says that they are something else. */
static vxm_status take_grid(void *payload, const vxm_sink_grid *grid, vxm_error *error) {
  receipt *r = payload;
  r->voxels.grid = *grid;
  for (int a = 0; a < 3; a++)
    if (!(grid->voxel_size[a] > 0) || !isfinite(grid->voxel_size[a]) || !isfinite(grid->first[a]))
      return vxm_fail_byte(error, r->voxels.input, grid->at, "the place or size of its voxels is no number");
  take_name(r);
  if (grid->grids > 1)
    vxm_warn(&r->voxels.warnings, "of its %" PRIu32 " grids \"%s\" is read", grid->grids, grid->name);
  if (grid->is_numbers && r->voxels.wants_octree)
    return VXM_ERROR_NUMBERS; /* read in another way */
  bool is_refused = grid->is_numbers && !r->wants_numbers && r->voxels.rule != VXM_BITS_NONE &&
                    (r->voxels.rule != VXM_BITS_ANY || !vxm_about_may_be_bits(&r->about, r->voxels.rule));
  return is_refused ? vxm_fail_numbers(error, r->voxels.input->name, vxm_scalar_name(r->scalar)) : VXM_OK;
}

/* ---- The space ---- */

/** The space that voxmend has written, unless later programs have made other voxels, or moved the grid: then
 * its origin is another. */
static bool find_written_space(vxm_space *out, const vxm_sink_grid *grid, const vxm_sink_extent *extent) {
  *out = grid->space;
  for (int a = 0; a < 3; a++) {
    if (!grid->has_space || grid->space.voxel_size[a] != grid->voxel_size[a])
      return false;
    if (!extent->is_empty && (extent->low[a] < 0 || extent->high[a] >= grid->space.dims[a]))
      return false;
    if (out->origin[a] + grid->voxel_size[a] / 2 != grid->first[a])
      out->origin[a] = grid->first[a] - grid->voxel_size[a] / 2;
  }
  return true;
}

static vxm_status find_space(vxm_space *space, receipt *r, const vxm_sink_extent *extent, vxm_error *error) {
  const vxm_sink_grid *grid = &r->voxels.grid;
  if (!find_written_space(space, grid, extent)) {
    if (extent->is_empty)
      return vxm_fail_byte(error, r->voxels.input, grid->at,
                           "no voxel of the grid \"%s\" is active, so it has no size", grid->name);
    vxm_sink_take_box(space, &r->voxels, extent);
    for (int a = 0; a < 3; a++)
      space->origin[a] = grid->first[a] + ((double)extent->low[a] - 0.5) * grid->voxel_size[a];
  }
  return vxm_space_check_file(space, r->voxels.input, (size_t)grid->at, error);
}

static vxm_status make_field(receipt *r, const vxm_space *space, float background, vxm_error *error) {
  vxm_field **field = &r->voxels.filling.field;
  vxm_status status =
      vxm_field_make(field, r->voxels.input->context, space, VXM_FIELD_NUMBERS, VXM_FLOAT32, error);
  if (status != VXM_OK)
    return status;
  float *values = (float *)(void *)(*field)->values;
  for (size_t v = 0, count = vxm_field_count(*field); v < count; v++)
    values[v] = background;
  return VXM_OK;
}

static vxm_status take_extent(void *payload, const vxm_sink_extent *extent, vxm_error *error) {
  receipt *r = payload;
  vxm_space space;
  vxm_status status = find_space(&space, r, extent, error);
  if (status != VXM_OK)
    return status;
  r->voxels.sink.is_full = !r->wants_numbers && r->voxels.rule == VXM_BITS_NONE; /* the space was all */
  if (r->voxels.grid.is_numbers && !r->voxels.sink.is_full)
    return make_field(r, &space, extent->background, error);
  return vxm_sink_begin_bits(&r->voxels, &space, error);
}

/* ---- A file ---- */

static vxm_status receive(receipt *r, vxm_error *error) {
  r->scalar = VXM_FLOAT32;
  r->voxels.sink = (vxm_voxel_sink){.text = take_text, .grid = take_grid, .extent = take_extent};
  if (!vxm_vdb_sniff(r->voxels.input))
    return vxm_fail_byte(error, r->voxels.input, 0, "not a vdb file: it does not begin with \" BDV\"");
  return vxm_sink_receive(&r->voxels, &vxm_vdb_need, "vdb", error);
}

/* ---- Bits and numbers ---- */

/** Makes the field of the receipt what the file says of it. */
static vxm_status describe(vxm_field **out, receipt *r, vxm_error *error) {
  vxm_field *field = r->voxels.filling.field;
  vxm_sidecar_take_labels(&r->about, field->space.dims, r->voxels.input);
  vxm_field_describe(field, &r->about);
  field->warnings = r->voxels.warnings;
  return vxm_field_hand_over(out, field, vxm_field_narrow(field, r->scalar, error), error);
}

static vxm_status finish_bits(vxm_grid **out, receipt *r, vxm_error *error) {
  if (r->voxels.filling.grid) {
    *out = r->voxels.filling.grid;
    (*out)->warnings = r->voxels.warnings;
    return VXM_OK;
  }
  vxm_field *field;
  vxm_status status = describe(&field, r, error);
  if (status == VXM_OK)
    status = vxm_field_to_bits(out, field, r->voxels.input->name, error);
  vxm_field_destroy(field);
  return status;
}

vxm_status vxm_vdb_read(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  receipt r = {.voxels = {.input = input, .rule = rule}};
  vxm_status status = receive(&r, error);
  if (status == VXM_OK)
    status = finish_bits(out, &r, error);
  vxm_about_destroy(&r.about);
  return status;
}

/** Bits as the numbers 0 and 1. */
static vxm_status count_bits(vxm_field **out, const vxm_grid *grid, vxm_error *error) {
  vxm_status status = vxm_field_make(out, grid->context, &grid->space, VXM_FIELD_NUMBERS, VXM_UINT8, error);
  if (status == VXM_OK)
    vxm_field_put_grid(*out, grid);
  return status;
}

vxm_status vxm_vdb_read_field(vxm_field **out, const vxm_input *input, vxm_error *error) {
  receipt r = {.voxels.input = input, .wants_numbers = true};
  vxm_status status = receive(&r, error);
  if (status == VXM_OK)
    status = r.voxels.filling.grid ? count_bits(out, r.voxels.filling.grid, error) : describe(out, &r, error);
  vxm_grid_destroy(r.voxels.filling.grid);
  vxm_about_destroy(&r.about);
  return status;
}

vxm_status vxm_vdb_read_sparse(vxm_sparse **out, const vxm_input *input, vxm_error *error) {
  receipt r = {.voxels = {.input = input, .wants_octree = true}};
  *out = NULL;
  vxm_status status = receive(&r, error);
  if (status == VXM_OK)
    status = vxm_sink_end_octree(out, &r.voxels, error);
  vxm_about_destroy(&r.about);
  return status;
}

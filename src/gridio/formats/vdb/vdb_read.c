/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/vdb/vdb_read.h"
#include "gridio/common/format.h"
#include "gridio/common/sink_fill.h"
#include "gridio/formats/vdb/vdb.h"
#include "sandbox/reader_process.h"

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
  vxm_voxel_sink sink;
  const vxm_input *input;
  bool wants_numbers, wants_octree;
  vxm_bits_rule rule; /**< where bits are wanted */
  vxm_sink_grid grid;
  vxm_about about;
  vxm_scalar scalar; /**< of the numbers before they became floats */
  vxm_warnings warnings;
  vxm_sink_filling filling;
  vxm_octree_pieces pieces; /**< of an octree */
  vxm_error fault;          /**< of these */
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
    vxm_metadata_add(&r->about.pairs, r->input->context, key, key_size, value, value_size);
  return VXM_OK;
}

/** The name by which voxmend calls unsigned distances says what they are; other names are carried along. */
static void take_name(receipt *r) {
  const char *name = r->grid.name;
  vxm_field_kind kind = r->about.kind;
  if (!r->about.is_declared && strcmp(name, vxm_field_kind_name(VXM_FIELD_DISTANCE)) == 0)
    declare(&r->about, VXM_FIELD_DISTANCE);
  else if (*name && strcmp(name, vxm_field_kind_name(kind)) != 0)
    vxm_metadata_add(&r->about.pairs, r->input->context, VXM_VDB_NAME_KEY, strlen(VXM_VDB_NAME_KEY), name,
                     strlen(name));
}

/** Floats are bits only if all of them are 0 or 1, and nothing says that they are something else. */
static vxm_status take_grid(void *payload, const vxm_sink_grid *grid, vxm_error *error) {
  receipt *r = payload;
  r->grid = *grid;
  for (int a = 0; a < 3; a++)
    if (!(grid->voxel_size[a] > 0) || !isfinite(grid->voxel_size[a]) || !isfinite(grid->first[a]))
      return vxm_fail_byte(error, r->input, grid->at, "the place or size of its voxels is no number");
  take_name(r);
  if (grid->grids > 1)
    vxm_warn(&r->warnings, "of its %" PRIu32 " grids \"%s\" is read", grid->grids, grid->name);
  if (grid->is_numbers && r->wants_octree)
    return VXM_ERROR_NUMBERS; /* read in another way */
  bool is_refused = grid->is_numbers && !r->wants_numbers && r->rule != VXM_BITS_NONE &&
                    (r->rule != VXM_BITS_ANY || !vxm_about_may_be_bits(&r->about, r->rule));
  return is_refused ? vxm_fail_numbers(error, r->input->name, vxm_scalar_name(r->scalar)) : VXM_OK;
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
  const vxm_sink_grid *grid = &r->grid;
  if (!find_written_space(space, grid, extent)) {
    if (extent->is_empty)
      return vxm_fail_byte(error, r->input, grid->at,
                           "no voxel of the grid \"%s\" is active, so it has no size", grid->name);
    for (int a = 0; a < 3; a++) {
      r->filling.low[a] = extent->low[a];
      space->dims[a] = extent->high[a] - extent->low[a] + 1;
      space->voxel_size[a] = grid->voxel_size[a];
      space->origin[a] = grid->first[a] + ((double)extent->low[a] - 0.5) * grid->voxel_size[a];
    }
  }
  return vxm_space_check_file(space, r->input, (size_t)grid->at, error);
}

static vxm_status make_field(receipt *r, const vxm_space *space, float background, vxm_error *error) {
  vxm_field **field = &r->filling.field;
  vxm_status status = vxm_field_make(field, r->input->context, space, VXM_FIELD_NUMBERS, VXM_FLOAT32, error);
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
  r->sink.is_full = !r->wants_numbers && r->rule == VXM_BITS_NONE; /* the space was all */
  if (r->grid.is_numbers && !r->sink.is_full)
    return make_field(r, &space, extent->background, error);
  if (r->wants_octree) {
    r->pieces = (vxm_octree_pieces){.context = r->input->context, .space = space, .error = &r->fault};
    r->filling.pieces = &r->pieces;
    return VXM_OK;
  }
  return vxm_grid_create(&r->filling.grid, r->input->context, &space, error);
}

/* ---- The voxels ---- */

static void take_bits(void *payload, const int64_t at[3], const uint64_t bits[VXM_SINK_SIDE]) {
  vxm_sink_fill_bits(&((receipt *)payload)->filling, at, bits);
}

static void take_numbers(void *payload, const int64_t at[3], const float numbers[VXM_SINK_VOXELS]) {
  vxm_sink_fill_numbers(&((receipt *)payload)->filling, at, numbers);
}

static void take_cube(void *payload, const int64_t at[3], int64_t side, float number) {
  vxm_sink_fill_cube(&((receipt *)payload)->filling, at, side, number);
}

/** Reads the file into r->filling, which holds nothing after a failure. */
static vxm_status receive(receipt *r, vxm_error *error) {
  const vxm_input *input = r->input;
  const vxm_reader_request request = {
      .data = input->data, .size = input->size, .name = input->name, .hint = "vdb"};
  r->scalar = VXM_FLOAT32;
  r->sink = (vxm_voxel_sink){take_text, take_grid, take_extent, take_bits, take_numbers,
                             take_cube, r,         NULL,        NULL,      false};
  if (!vxm_vdb_sniff(input))
    return vxm_fail_byte(error, input, 0, "not a vdb file: it does not begin with \" BDV\"");
  vxm_status status =
      vxm_reader_process_grid(&r->sink, &r->warnings, input->context, &vxm_vdb_need, &request, error);
  if (status == VXM_OK)
    status = vxm_progress(input->context, "reading", 1, error);
  if (status != VXM_OK) {
    vxm_grid_destroy(r->filling.grid);
    vxm_field_destroy(r->filling.field);
    vxm_free(input->context, r->pieces.list);
    r->filling = (vxm_sink_filling){.grid = NULL};
  }
  return status;
}

/* ---- Bits and numbers ---- */

/** Makes the field of the receipt what the file says of it. */
static vxm_status describe(vxm_field **out, receipt *r, vxm_error *error) {
  vxm_field *field = r->filling.field;
  vxm_sidecar_take_labels(&r->about, field->space.dims, r->input);
  vxm_field_describe(field, &r->about);
  field->warnings = r->warnings;
  return vxm_field_hand_over(out, field, vxm_field_narrow(field, r->scalar, error), error);
}

static vxm_status finish_bits(vxm_grid **out, receipt *r, vxm_error *error) {
  if (r->filling.grid) {
    *out = r->filling.grid;
    (*out)->warnings = r->warnings;
    return VXM_OK;
  }
  vxm_field *field;
  vxm_status status = describe(&field, r, error);
  if (status == VXM_OK)
    status = vxm_field_to_bits(out, field, r->input->name, error);
  vxm_field_destroy(field);
  return status;
}

vxm_status vxm_vdb_read(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  receipt r = {.input = input, .rule = rule};
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = receive(&r, &local);
  if (status == VXM_OK)
    status = finish_bits(out, &r, &local);
  vxm_about_destroy(&r.about);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
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
  receipt r = {.input = input, .wants_numbers = true};
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = receive(&r, &local);
  if (status == VXM_OK)
    status = r.filling.grid ? count_bits(out, r.filling.grid, &local) : describe(out, &r, &local);
  vxm_grid_destroy(r.filling.grid);
  vxm_about_destroy(&r.about);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_vdb_read_sparse(vxm_sparse **out, const vxm_input *input, vxm_error *error) {
  receipt r = {.input = input, .wants_octree = true, .fault = VXM_ERROR_INIT};
  vxm_error local = VXM_ERROR_INIT;
  *out = NULL;
  vxm_status status = receive(&r, &local);
  if (status == VXM_OK) {
    status = vxm_octree_pieces_end(out, &r.pieces);
    local = r.fault;
  }
  if (status == VXM_OK)
    (*out)->warnings = r.warnings;
  vxm_about_destroy(&r.about);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

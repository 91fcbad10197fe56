/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/vdb_read.h"
#include "gridio/common/format.h"
#include "gridio/formats/vdb_tree.h"

#include <string.h>

/* ---- Bits ---- */

typedef struct filling {
  vxm_grid *grid;
  int64_t low[3]; /**< index of voxel (0,0,0) of the grid */
} filling;

/** Sets those of 8 voxels from x on that the grid has. */
static void or_byte(const filling *f, int64_t x, int64_t y, int64_t z, uint64_t byte) {
  const int64_t *dims = f->grid->space.dims;
  if (byte == 0 || y < 0 || z < 0 || y >= dims[1] || z >= dims[2] || x <= -8 || x >= dims[0])
    return;
  if (x < 0) {
    byte >>= -x;
    x = 0;
  }
  if (dims[0] - x < 8)
    byte &= vxm_low_bits((unsigned)(dims[0] - x));
  uint64_t *row = vxm_grid_row(f->grid, y, z);
  unsigned shift = (unsigned)(x % 64);
  row[x / 64] |= byte << shift;
  if (shift > 56 && byte >> (64 - shift))
    row[x / 64 + 1] |= byte >> (64 - shift);
}

static void put_block(const int64_t at[3], const uint64_t bits[8], void *payload) {
  const filling *f = payload;
  for (unsigned y = 0; y < 8; y++) {
    uint64_t plane = 0;
    for (unsigned x = 0; x < 8; x++)
      plane |= (bits[x] >> 8 * y & 0xff) << 8 * x;
    plane = vxm_transpose8(plane);
    for (unsigned z = 0; z < 8; z++)
      or_byte(f, at[0] - f->low[0], at[1] - f->low[1] + y, at[2] - f->low[2] + z, plane >> 8 * z & 0xff);
  }
}

static void put_cube(const int64_t at[3], int64_t side, void *payload) {
  const filling *f = payload;
  int64_t begin[3], end[3];
  for (int a = 0; a < 3; a++) {
    begin[a] = vxm_max(at[a] - f->low[a], 0);
    end[a] = vxm_min(at[a] - f->low[a] + side, f->grid->space.dims[a]);
  }
  for (int64_t z = begin[2]; z < end[2]; z++)
    for (int64_t y = begin[1]; y < end[1]; y++)
      vxm_row_set_span(vxm_grid_row(f->grid, y, z), begin[0], end[0]);
}

/* ---- Numbers ---- */

typedef struct numbering {
  vxm_field *field;
  int64_t low[3];
} numbering;

/** The part of a cube that the field has, counted from its first voxel; false if there is none. */
static bool clip(const numbering *n, const int64_t at[3], int64_t side, int64_t begin[3], int64_t end[3]) {
  for (int a = 0; a < 3; a++) {
    begin[a] = vxm_max(at[a] - n->low[a], 0);
    end[a] = vxm_min(at[a] - n->low[a] + side, n->field->space.dims[a]);
    if (begin[a] >= end[a])
      return false;
  }
  return true;
}

static float *place_of(const numbering *n, int64_t x, int64_t y, int64_t z) {
  const int64_t *dims = n->field->space.dims;
  return (float *)n->field->values + (size_t)((x * dims[1] + y) * dims[2] + z);
}

static void put_numbers(const int64_t at[3], const float numbers[512], void *payload) {
  const numbering *n = payload;
  int64_t begin[3], end[3];
  if (!clip(n, at, 8, begin, end))
    return;
  for (int64_t x = begin[0]; x < end[0]; x++)
    for (int64_t y = begin[1]; y < end[1]; y++) {
      int64_t dx = x + n->low[0] - at[0], dy = y + n->low[1] - at[1], dz = begin[2] + n->low[2] - at[2];
      memcpy(place_of(n, x, y, begin[2]), numbers + (dx * 8 + dy) * 8 + dz,
             (size_t)(end[2] - begin[2]) * sizeof *numbers);
    }
}

static void put_number(const int64_t at[3], int64_t side, float number, void *payload) {
  const numbering *n = payload;
  int64_t begin[3], end[3];
  if (!clip(n, at, side, begin, end))
    return;
  for (int64_t x = begin[0]; x < end[0]; x++)
    for (int64_t y = begin[1]; y < end[1]; y++) {
      float *row = place_of(n, x, y, begin[2]);
      for (int64_t z = begin[2]; z < end[2]; z++)
        *row++ = number;
    }
}

/* ---- The grid ---- */

/** The dimensions that voxmend has written, if they hold all that is active. */
static bool fits(const vxm_space *space, const vxm_vdb_extent *extent) {
  for (int a = 0; a < 3 && !extent->is_empty; a++)
    if (extent->low[a] < 0 || extent->high[a] >= space->dims[a])
      return false;
  return true;
}

static vxm_status find_space(vxm_space *space, int64_t low[3], const vxm_vdb_grid *grid,
                             const vxm_vdb_extent *extent, const vxm_input *input, vxm_error *error) {
  if (grid->has_space && fits(&grid->space, extent)) {
    *space = grid->space;
    low[0] = low[1] = low[2] = 0;
  } else if (extent->is_empty)
    return vxm_fail_byte(error, input, grid->tree, "no voxel of the grid \"%s\" is active, so it has no size",
                         grid->name);
  else
    for (int a = 0; a < 3; a++) {
      low[a] = extent->low[a];
      space->dims[a] = extent->high[a] - extent->low[a] + 1;
      space->voxel_size[a] = grid->size[a];
      space->origin[a] = grid->first[a] + ((double)low[a] - 0.5) * grid->size[a];
    }
  return vxm_space_check_file(space, input, grid->tree, error);
}

/** All that is known before the values are read. */
typedef struct front {
  vxm_vdb_grid grid;
  vxm_vdb_extent extent;
  vxm_space space;
  int64_t low[3]; /**< index of the voxel that becomes (0,0,0) */
  vxm_warnings warnings;
} front;

static vxm_status read_front(front *f, const vxm_input *input, vxm_error *error) {
  f->warnings.count = 0;
  vxm_status status = vxm_vdb_file_read(&f->grid, input, &f->warnings, error);
  if (status == VXM_OK)
    status = vxm_vdb_tree_measure(&f->extent, &f->grid, input, error);
  return status == VXM_OK ? find_space(&f->space, f->low, &f->grid, &f->extent, input, error) : status;
}

static vxm_status read_numbers(vxm_field **out, front *f, const vxm_input *input, vxm_error *error) {
  numbering n = {.low = {f->low[0], f->low[1], f->low[2]}};
  vxm_status status =
      vxm_field_make(&n.field, input->context, &f->space, VXM_FIELD_NUMBERS, VXM_FLOAT32, error);
  if (status != VXM_OK)
    return status;
  float *values = (float *)n.field->values;
  for (size_t v = 0, count = vxm_field_count(n.field); v < count; v++)
    values[v] = f->extent.background;
  const vxm_vdb_visitor visitor = {.numbers = put_numbers, .number = put_number, .payload = &n};
  status = vxm_vdb_tree_visit(&visitor, &f->grid, &f->extent, input, error);
  vxm_sidecar_take_labels(&f->grid.about, f->space.dims, input);
  vxm_field_describe(n.field, &f->grid.about);
  n.field->warnings = f->warnings;
  if (status == VXM_OK)
    status = vxm_field_narrow(n.field, f->grid.scalar, error);
  return vxm_field_hand_over(out, n.field, status, error);
}

static vxm_status read_bits(vxm_grid **out, front *f, const vxm_input *input, vxm_bits_rule rule,
                            vxm_error *error) {
  filling filled = {.low = {f->low[0], f->low[1], f->low[2]}};
  vxm_status status = vxm_grid_create(&filled.grid, input->context, &f->space, error);
  const vxm_vdb_visitor visitor = {.block = put_block, .cube = put_cube, .payload = &filled};
  if (status == VXM_OK && rule != VXM_BITS_NONE)
    status = vxm_vdb_tree_visit(&visitor, &f->grid, &f->extent, input, error);
  if (status != VXM_OK) {
    vxm_grid_destroy(filled.grid);
    return status;
  }
  filled.grid->warnings = f->warnings;
  *out = filled.grid;
  return VXM_OK;
}

/** Floats are bits only if all of them are 0 or 1, and nothing says that they are something else. */
static vxm_status read_mask(vxm_grid **out, front *f, const vxm_input *input, vxm_bits_rule rule,
                            vxm_error *error) {
  vxm_field *field = NULL;
  if (rule != VXM_BITS_ANY || !vxm_about_may_be_bits(&f->grid.about, rule))
    return vxm_fail_numbers(error, input->name, vxm_scalar_name(f->grid.scalar));
  vxm_status status = read_numbers(&field, f, input, error);
  if (status == VXM_OK)
    status = vxm_field_to_bits(out, field, input->name, error);
  vxm_field_destroy(field);
  return status;
}

vxm_status vxm_vdb_read(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  front f;
  vxm_status status = read_front(&f, input, error);
  bool is_float = f.grid.type == VXM_VDB_TYPE_FLOAT && rule != VXM_BITS_NONE;
  if (status == VXM_OK)
    status = (is_float ? read_mask : read_bits)(out, &f, input, rule, error);
  vxm_about_destroy(&f.grid.about);
  return status;
}

/** Bits as the numbers 0 and 1. */
static vxm_status read_bits_as_numbers(vxm_field **out, front *f, const vxm_input *input, vxm_error *error) {
  vxm_grid *grid;
  vxm_status status = read_bits(&grid, f, input, VXM_BITS_ANY, error);
  if (status != VXM_OK)
    return status;
  status = vxm_field_make(out, input->context, &f->space, VXM_FIELD_NUMBERS, VXM_UINT8, error);
  if (status == VXM_OK)
    vxm_field_put_grid(*out, grid);
  vxm_grid_destroy(grid);
  return status;
}

vxm_status vxm_vdb_read_field(vxm_field **out, const vxm_input *input, vxm_error *error) {
  front f;
  vxm_status status = read_front(&f, input, error);
  bool is_float = f.grid.type == VXM_VDB_TYPE_FLOAT;
  if (status == VXM_OK)
    status = (is_float ? read_numbers : read_bits_as_numbers)(out, &f, input, error);
  vxm_about_destroy(&f.grid.about);
  return status;
}

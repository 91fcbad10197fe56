/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/vdb_read.h"
#include "gridio/format.h"
#include "gridio/vdb_tree.h"

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

vxm_status vxm_vdb_read(vxm_grid **out, const vxm_input *input, vxm_error *error) {
  vxm_vdb_grid found;
  vxm_vdb_extent extent;
  vxm_space space;
  vxm_notes notes = {0};
  filling f = {.grid = NULL};
  vxm_status status = vxm_vdb_file_read(&found, input, &notes, error);
  if (status == VXM_OK)
    status = vxm_vdb_tree_measure(&extent, &found, input, error);
  if (status == VXM_OK)
    status = find_space(&space, f.low, &found, &extent, input, error);
  if (status == VXM_OK)
    status = vxm_grid_create(&f.grid, input->context, &space, error);
  const vxm_vdb_visitor visitor = {put_block, put_cube, &f};
  if (status == VXM_OK)
    status = vxm_vdb_tree_visit(&visitor, &found, &extent, input, error);
  if (status != VXM_OK) {
    vxm_grid_destroy(f.grid);
    return status;
  }
  if (found.type == VXM_VDB_TYPE_FLOAT && found.rule == VXM_VDB_BY_BACKGROUND)
    vxm_note(&notes,
             "\"%s\" is called neither a level set nor a fog volume: by its background, voxels %s are set",
             found.name, extent.is_below ? "below 0" : "above 1/2");
  f.grid->notes = notes;
  *out = f.grid;
  return VXM_OK;
}

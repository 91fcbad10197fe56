/* SPDX-License-Identifier: BSD-3-Clause */
#include "truth.h"

#include <stdlib.h>

vxm_space truth_space(vxm_context *context, const shape *body, int64_t resolution) {
  vxm_space_options fit = VXM_SPACE_OPTIONS_INIT;
  fit.resolution[0] = resolution;
  fit.pad = 1;
  vxm_mesh *mesh = mesh_of_shape(context, body);
  vxm_space space;
  vxm_error error = VXM_ERROR_INIT;
  require(vxm_space_fit(&space, mesh, &fit, &error), &error);
  vxm_mesh_destroy(mesh);
  return space;
}

/** Gives every voxel of `into` that `other` has the value. */
static void assign(vxm_grid *into, const vxm_grid *other, bool value) {
  const int64_t *dims = vxm_grid_space(into)->dims;
  for (int64_t k = 0; k < dims[2]; k++)
    for (int64_t j = 0; j < dims[1]; j++)
      for (int64_t i = 0; i < dims[0]; i++)
        if (vxm_grid_get(other, i, j, k))
          vxm_grid_set(into, i, j, k, value);
}

void truth_unite(vxm_grid *into, const vxm_grid *other) {
  assign(into, other, true);
}

void truth_subtract(vxm_grid *from, const vxm_grid *other) {
  assign(from, other, false);
}

static vxm_grid *solid_by(const vxm_mesh *mesh, const vxm_space *space, vxm_method method) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.like = space;
  options.method = method;
  options.thin = VXM_THIN_DROP;
  vxm_grid *grid;
  vxm_error error = VXM_ERROR_INIT;
  require(vxm_voxelize(&grid, NULL, mesh, &space_options, &options, &error), &error);
  return grid;
}

vxm_grid *truth_solid(vxm_context *context, const shape *body, const vxm_space *space) {
  vxm_mesh *mesh = mesh_of_shape(context, body);
  vxm_grid *grid = solid_by(mesh, space, VXM_METHOD_Z), *wound = solid_by(mesh, space, VXM_METHOD_WINDING);
  truth_unite(grid, wound);
  vxm_grid_destroy(wound);
  vxm_mesh_destroy(mesh);
  return grid;
}

/** Edge of the largest cube of set voxels whose last voxel is (i,j,k), from those of its seven predecessors.
 */
static int cube_ending_at(const int *edges, size_t voxel, const int64_t dims[3]) {
  const size_t step[3] = {1, (size_t)dims[0], (size_t)(dims[0] * dims[1])};
  int least = edges[voxel - step[0]];
  for (int corner = 2; corner < 8; corner++) {
    size_t back = 0;
    for (int a = 0; a < 3; a++)
      if (corner >> a & 1)
        back += step[a];
    if (edges[voxel - back] < least)
      least = edges[voxel - back];
  }
  return least + 1;
}

/** The largest cube of set voxels: its edge, and its last voxel. The grid's first layers are empty. */
static int largest_cube(const vxm_grid *solid, int64_t last[3]) {
  const int64_t *dims = vxm_grid_space(solid)->dims;
  int best = 0, *edges = calloc((size_t)(dims[0] * dims[1] * dims[2]), sizeof *edges);
  if (!edges)
    exit(1);
  for (int64_t k = 1; k < dims[2]; k++)
    for (int64_t j = 1; j < dims[1]; j++)
      for (int64_t i = 1; i < dims[0]; i++) {
        if (!vxm_grid_get(solid, i, j, k))
          continue;
        size_t voxel = (size_t)((k * dims[1] + j) * dims[0] + i);
        edges[voxel] = cube_ending_at(edges, voxel, dims);
        if (edges[voxel] <= best)
          continue;
        best = edges[voxel];
        last[0] = i;
        last[1] = j;
        last[2] = k;
      }
  free(edges);
  return best;
}

bool truth_room(const vxm_grid *solid, double low[3], double high[3]) {
  int64_t last[3] = {0, 0, 0};
  int edge = largest_cube(solid, last);
  const vxm_space *space = vxm_grid_space(solid);
  for (int a = 0; a < 3; a++) {
    /* Off the centres, so that no rounding decides whether a voxel is in the room. */
    high[a] = space->origin[a] + ((double)last[a] - 0.31) * space->voxel_size[a];
    low[a] = high[a] - (edge - 3) * space->voxel_size[a];
  }
  return edge >= 6;
}

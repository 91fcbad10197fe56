/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/mesh/coarse_positions.h"
#include "gridio/mesh/split_vertices.h"
#include "mesh/weld.h"
#include "repair/state/merge_rule.h"

#include <float.h>
#include <math.h>

/** Of a voxel, along the axis on which it is least. */
static double least_side(const vxm_space *space) {
  return fmin(space->voxel_size[0], fmin(space->voxel_size[1], space->voxel_size[2]));
}

/** How many vertices there are at the place of another, once their positions are rounded. */
static vxm_status count_lost(size_t *lost, vxm_soup *surface, bool single, vxm_error *error) {
  size_t count = surface->vertex_count, distinct = 0;
  for (size_t i = 0; i < 3 * count && single; i++)
    surface->positions[i] = vxm_single(surface->positions[i]);
  vxm_error local = VXM_ERROR_INIT;
  uint32_t *map = vxm_alloc(surface->context, count, sizeof *map, &local);
  vxm_status status =
      map ? vxm_weld_exact(surface->context, surface->positions, count, map, &distinct, &local) : local.code;
  vxm_free(surface->context, map);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  *lost = count - distinct;
  return status;
}

vxm_status vxm_check_coarse_positions(vxm_soup *surface, const vxm_space *space, bool single,
                                      const char *path, vxm_error *error) {
  double farthest = 0, least = least_side(space);
  for (size_t i = 0; i < 3 * surface->vertex_count; i++)
    farthest = fmax(farthest, fabs(surface->positions[i]));
  /* the step from a number to the next, at most: rounding moves each by half of it */
  double step = farthest * (single ? FLT_EPSILON : DBL_EPSILON);
  if (step * 4 < least * VXM_SPLIT_SHARE || (single && farthest > FLT_MAX))
    return VXM_OK;
  size_t lost = 1; /* where voxels are no longer than a step */
  vxm_status status = step < least ? count_lost(&lost, surface, single, error) : VXM_OK;
  if (status != VXM_OK || lost == 0)
    return status;
  return vxm_fail_at(
      error, VXM_ERROR_RANGE, (vxm_place){path, 0, -1, -1},
      "%s are too coarse for the surface of voxels of %g at %g; %smove the model to the origin",
      single ? "the 32-bit floats of stl" : "numbers", least, farthest, single ? "write ply, or " : "");
}

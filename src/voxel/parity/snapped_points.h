/* SPDX-License-Identifier: BSD-3-Clause */
/** The points of triangles, put on a lattice. */
#ifndef VXM_VOXEL_PARITY_SNAPPED_POINTS_H
#define VXM_VOXEL_PARITY_SNAPPED_POINTS_H

#include "voxel/lattice/lattice.h"
#include "voxel/lattice/vertex_transform.h"
#include "voxel/parts/triangle_set.h"

/** Narrow coordinates stay below this, so that differences of two of them fit 31 bits, and cells fit theirs.
 */
#define VXM_NARROW_MAX ((INT32_C(1) << 29) - (INT32_C(1) << 7))

/** Bits of the number of a cell along one axis. */
enum { VXM_CELL_BITS = 21 };

/**
 * Points on a lattice. The cell of a point is the number of voxel centres of the grid before it along each
 * axis, as they are moved by the perturbation: a triangle covers a column only if its corners lie in
 * different cells along both axes across the column.
 */
typedef struct vxm_snapped_points {
  vxm_context *context;
  uint64_t serial; /**< no two that hold different points have the same */
  vxm_lattice lattice;
  vxm_edge_lengths lengths[VXM_LENGTHS_SETS]; /**< of the triangles as they lie here, or more, before
                                                 `transform` */
  double transform[12];                       /**< that of vxm_snapped_points_set, else nothing */
  size_t capacity;                            /**< of `narrow` and `cells` */
  int32_t (*narrow)[4];                       /**< points by number; the fourth number is 0 */
  uint64_t *cells; /**< of each point: x from bit 0 on, y from VXM_CELL_BITS, z from twice that */
  vxm_point *wide; /**< used instead where a point lies beyond VXM_NARROW_MAX, else NULL */
} vxm_snapped_points;

/**
 * Places the points of triangles, keeping the memory of the placing before. Start from {.context = ...};
 * destroy with vxm_snapped_points_destroy.
 *
 * @param transform NULL, or a 3 x 4 matrix applied to positions first
 * @param apexes    whether cones or tetrahedra will be used: the apex of a part is the mean of the corners of
 * its triangles (Rueda et al., section 3), rounded toward zero so that it stays in their box
 * @return VXM_OK; VXM_ERROR_RANGE if a vertex that a face uses is not finite or lies too far outside the
 * grid; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_snapped_points_set(vxm_snapped_points *placed, const vxm_triangle_set *triangles,
                                  const vxm_lattice *lattice, const double transform[12], bool apexes,
                                  vxm_error *error);
/** The same for points that move first; motion->from has those before first_apex. */
vxm_status vxm_snapped_points_move(vxm_snapped_points *placed, const vxm_triangle_set *triangles,
                                   const vxm_lattice *lattice, const vxm_vertex_transform *motion,
                                   bool apexes, vxm_error *error);

/* The same in steps, where something else than the CPU places the points before first_apex: it writes
 * `narrow`, with a fourth number that is not 0 where a point does not fit. */

/** Begins a placing of points that move. @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_snapped_points_begin(vxm_snapped_points *placed, const vxm_triangle_set *triangles,
                                    const vxm_lattice *lattice, const vxm_vertex_transform *motion,
                                    vxm_error *error);
/** What a coordinate is multiplied by, less the origin of the space, to become steps. */
double vxm_snapped_points_scale(const vxm_snapped_points *placed, int axis);
/** Finds the cells; false if a point does not fit. */
bool vxm_snapped_points_take(vxm_snapped_points *placed, const vxm_triangle_set *triangles);
/** Places the apexes, behind all other points. */
void vxm_snapped_points_apexes(vxm_snapped_points *placed, const vxm_triangle_set *triangles, bool apexes);

void vxm_snapped_points_destroy(vxm_snapped_points *placed);

/** The bits of a cell that belong to an axis. */
static inline uint64_t vxm_cell_mask(int axis) {
  return ((UINT64_C(1) << VXM_CELL_BITS) - 1) << (VXM_CELL_BITS * axis);
}

static inline vxm_point vxm_snapped_points_at(const vxm_snapped_points *placed, uint32_t point) {
  if (placed->wide)
    return placed->wide[point];
  const int32_t *p = placed->narrow[point];
  return (vxm_point){{p[0], p[1], p[2]}};
}

#endif

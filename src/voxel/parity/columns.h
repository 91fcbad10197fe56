/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The columns of one voter: lines of voxel centres along an axis w, numbered by the other two axes u and v,
 * and where what a triangle flips in them lies in the slabs of a window.
 *
 * In each column that it covers, a triangle flips the first voxel whose centre lies beyond it; a prefix XOR
 * along w then leaves the voxels with an odd number of triangles before them (Schwarz & Seidel 2010, section
 * 4.1). A column belongs to exactly one of two triangles that share an edge, also when its centre lies on
 * that edge.
 */
#ifndef VXM_VOXEL_PARITY_COLUMNS_H
#define VXM_VOXEL_PARITY_COLUMNS_H

#include "grid/window.h"
#include "voxel/parity/snapped_points.h"

typedef struct vxm_columns {
  int u, v, w;              /**< axes of the voxel space; 0 = x */
  int64_t begin[3], end[3]; /**< voxels of the window along each axis */
  bool keep_before;         /**< a flip before the window counts for its first voxel; else it
                               is left out, as is one behind the window always */
  uint64_t step[3];         /**< bits from a voxel to the next one along each axis in a slab */
  int slab_axis;            /**< v or w: slabs are cut along it */
  int slab_shift;           /**< a slab is 2^slab_shift voxels thick */
  unsigned roles;           /**< triangles of these roles count, or-ed vxm_triangle_role */
  size_t triangle_begin, triangle_end;
} vxm_columns;

/** The end of the last part's triangles that can have one of the roles. */
static inline size_t vxm_roles_end(const vxm_triangle_set *triangles, size_t part, unsigned roles) {
  const vxm_part *p = &triangles->parts[part];
  return roles & VXM_ROLE_CONE ? p->end : roles & VXM_ROLE_CAP ? p->cones : p->caps;
}

#endif

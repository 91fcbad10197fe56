/* SPDX-License-Identifier: BSD-3-Clause */
/** What is united in an octree, by parity along x. */
#ifndef VXM_VOXEL_ENGINE_SPARSE_JOB_H
#define VXM_VOXEL_ENGINE_SPARSE_JOB_H

#include "voxel/parity/triangle_order.h"

#include <stdatomic.h>

typedef struct vxm_sparse_job {
  const vxm_triangle_set *triangles;
  const vxm_triangle_order *order; /**< NULL, or that of the triangles */
  const vxm_snapped_points *placed;
  size_t part_end;          /**< parts 0 to part_end - 1 */
  unsigned roles;           /**< triangles of these roles count, or-ed vxm_triangle_role */
  atomic_uchar *has_voxels; /**< per part: set to 1 if it sets a voxel */
} vxm_sparse_job;

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The union of parts, each by parity along one axis.
 *
 * Threads first put the crossings of all triangles into the bins of slabs. Then each slab is folded by one
 * thread, which alone writes its words: part after part, a prefix XOR along the axis turns what was flipped
 * into what is inside.
 */
#ifndef VXM_VOXEL_PARITY_PARITY_UNION_H
#define VXM_VOXEL_PARITY_PARITY_UNION_H

#include "voxel/parity/slabs.h"

/** Which triangles are united, and along which axis. */
typedef struct vxm_parity_union_job {
  const vxm_triangle_set *triangles;
  const vxm_snapped_points *placed;
  int axis;                    /**< of the columns; 0 = x */
  size_t part_begin, part_end; /**< these parts only */
  unsigned roles;              /**< triangles of these roles count, or-ed vxm_triangle_role */
  bool fresh;                  /**< the window's words are replaced; else voxels are added to them */
  atomic_uchar *has_voxels;    /**< per part: set to 1 if it sets a voxel; may be NULL */
  const char *phase;           /**< for progress */
} vxm_parity_union_job;

/**
 * Sets in the window every voxel inside at least one of the job's parts: those with an odd number of the
 * part's triangles before them along the axis. Exact, and the same bits for any number of threads.
 *
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_parity_union(vxm_workspace *workspace, const vxm_window *window,
                            const vxm_parity_union_job *job, vxm_error *error);

#endif

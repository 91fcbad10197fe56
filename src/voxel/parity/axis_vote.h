/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Several voters on one part at once. Its triangles are rastered along one axis only: where the parities
 * along the other two differ from that is told by the part's odd edges (voxel/parity/parity_difference.h),
 * and what the tetrahedra add by its cones. While a slab is in cache all voters are folded and combined, so
 * that only the outcome goes to memory.
 *
 * Slabs are cut across slices. Parity along slices needs to know what was open at the beginning of a slab:
 * each thread takes a run of slabs in order and carries it along, starting from the flips in all slabs
 * before.
 */
#ifndef VXM_VOXEL_PARITY_AXIS_VOTE_H
#define VXM_VOXEL_PARITY_AXIS_VOTE_H

#include "voxel/parity/slabs.h"
#include "voxel/parity/vote.h"

typedef struct vxm_axis_vote_job {
  const vxm_triangle_set *triangles;
  const vxm_snapped_points *placed;
  size_t part;
  bool tetra;    /**< ask the tetrahedra, too, as parity with cones */
  vxm_vote rule; /**< VXM_VOTE_AUTO elects what x, y and z all hold and none abstains from (odd_lines.h); what
                    two or three that do not abstain call outside is, and the rest is left to others */
  bool fresh;    /**< the window's words are replaced; else voxels are added to them */
  uint64_t *mask;  /**< NULL, or words laid out as the window's that become the contested voxels */
  uint64_t *carry; /**< a slice of words: what is open along slices at the beginning of the window; becomes
                      that at its end. Zeros for the first window */
} vxm_axis_vote_job;

/**
 * Sets in the window the voxels that win the vote, and adds up the tally. The same bits for any number of
 * threads.
 *
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_axis_vote(vxm_workspace *workspace, const vxm_window *window, const vxm_axis_vote_job *job,
                         vxm_vote_tally *tally, vxm_error *error);

#endif

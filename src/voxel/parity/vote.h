/* SPDX-License-Identifier: BSD-3-Clause */
/** Combining voters word by word. */
#ifndef VXM_VOXEL_PARITY_VOTE_H
#define VXM_VOXEL_PARITY_VOTE_H

#include "base/context.h"
#include "voxmend/voxelize.h"

/** What voters came to. */
typedef struct vxm_vote_tally {
  int64_t contested; /**< voxels on which they disagree and that were not set before */
  bool added;        /**< whether a voxel was newly set */
} vxm_vote_tally;

/**
 * Adds to `out` the voxels that win the vote. What `out` holds before is not in question.
 *
 * VXM_VOTE_MAJORITY elects what at least two of x, y and z hold (Chen & Tu, section 2.3). The tetrahedral
 * voter cannot change that: with it on the side of the axes' minority the four are at most two against two,
 * and a tie goes to the axes. VXM_VOTE_AUTO elects what x, y and z all hold, and leaves the rest to others;
 * the axes that abstain have been taken out before (voxel/parity/odd_lines.h).
 *
 * @param voters words of x, y, z and, or NULL, the tetrahedra
 * @param mask   NULL, or words that become the contested voxels
 */
void vxm_vote_count(uint64_t *out, const uint64_t *const voters[4], uint64_t *mask, size_t word_count,
                    vxm_vote rule, vxm_context *context, vxm_vote_tally *tally);

#endif

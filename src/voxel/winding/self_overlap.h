/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Closed parts that lie in themselves, as an arm that reaches into the trunk of the same body.
 *
 * There the surface is entered twice before it is left, so that parity says outside; the winding number is 2.
 */
#ifndef VXM_VOXEL_WINDING_SELF_OVERLAP_H
#define VXM_VOXEL_WINDING_SELF_OVERLAP_H

#include "voxel/parts/triangle_set.h"
#include "voxel/winding/chain.h"

typedef struct vxm_self_overlap {
  vxm_winding_chain chain; /**< faces and caps of all such parts, turned outward: closed, without a rest */
  size_t *part;            /**< their numbers */
  size_t part_count;       /**< 0 = there are none, and no chain */
  size_t hollow_count; /**< parts that seem to lie in themselves, too, but of which no chain can be made */
  size_t hollow_part;  /**< that of them which does so most */
  double hollow_share; /**< and how much of what lines run inside of it is wound twice */
  size_t
      filled_count; /**< parts with cavities that overlap each other, so that parity fills what they share */
  size_t filled_part;  /**< that of them which does so most */
  double filled_share; /**< and how much that is of what lines run inside of */
} vxm_self_overlap;

/**
 * Finds the closed and capped parts that lie in themselves.
 *
 * Lines along the shortest side of each part are followed from face to face, up to 24 x 24 of them
 * (probe_lines.h). A part counts where these lines run
 * through what is wound twice, or more often, for more than 10^-5 of what they run inside of; so one that
 * overlaps itself in a small place only may be passed over. Its faces must be wound consistently, as a repair
 * leaves them where it can: a wall of two skins that face the same way is wound twice as well, and hollow.
 * Where they are not, it is only counted if it seems to be wound twice for more than 1/500. So is a part with
 * two cavities or more that is wound against itself, as where cavities overlap, for more than that.
 *
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED; to be destroyed in any case.
 * Takes time linear in the number of triangles
 */
vxm_status vxm_self_overlap_find(vxm_self_overlap *out, const vxm_triangle_set *triangles, vxm_error *error);
void vxm_self_overlap_destroy(vxm_self_overlap *overlap);

#endif

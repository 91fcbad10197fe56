/* SPDX-License-Identifier: BSD-3-Clause */
/** Which faces each rim belongs to, also where bodies share edges. */
#ifndef VXM_MESH_RIM_OWNERS_H
#define VXM_MESH_RIM_OWNERS_H

#include "mesh/edges.h"

#define VXM_NO_OWNER UINT32_MAX

/**
 * Groups of faces that are closed but for their own rims: along each edge but one group at most has an even
 * number of sides, and along an odd edge that one owns it. Faces across an edge of two sides are in one
 * group; of several groups with an odd number of sides along an edge one is made. So bodies that share edges
 * are different groups, but for those of which rims go along the same edge.
 */
typedef struct vxm_rim_owners {
  uint32_t *of_face; /**< the group: the number of one of its faces */
  uint32_t *of_edge; /**< of odd edges: the group that owns it; of others nothing that has a meaning */
} vxm_rim_owners;

/**
 * @param[out] out freed with vxm_rim_owners_destroy, also after a failure
 * @param edges    of the same soup, without a vertex map
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_rim_owners_find(vxm_rim_owners *out, const vxm_soup *soup, const vxm_edges *edges,
                               vxm_error *error);
void vxm_rim_owners_destroy(vxm_rim_owners *owners, vxm_context *context);

#endif

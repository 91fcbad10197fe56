/* SPDX-License-Identifier: BSD-3-Clause */
/** Where groups of faces are open. */
#ifndef VXM_REPAIR_BODIES_GROUP_RIMS_H
#define VXM_REPAIR_BODIES_GROUP_RIMS_H

#include "repair/state/edge_groups.h"

/** A vertex of an edge where a group has an odd number of sides. */
typedef struct vxm_rim_vertex {
  size_t group;
  uint32_t vertex;
} vxm_rim_vertex;

typedef struct vxm_group_rims {
  const vxm_edge_groups *groups;
  vxm_rim_vertex *vertices; /**< sorted */
  size_t count;
} vxm_group_rims;

/** @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_group_rims_find(vxm_group_rims *out, const vxm_edge_groups *groups, vxm_repair_state *state,
                               vxm_error *error);
void vxm_group_rims_destroy(vxm_group_rims *rims, vxm_context *context);

bool vxm_group_is_open_at(const vxm_group_rims *rims, size_t group, uint32_t vertex);

#endif

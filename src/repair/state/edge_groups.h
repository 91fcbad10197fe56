/* SPDX-License-Identifier: BSD-3-Clause */
/** Faces that edges connect, and whether they are closed. */
#ifndef VXM_REPAIR_STATE_EDGE_GROUPS_H
#define VXM_REPAIR_STATE_EDGE_GROUPS_H

#include "mesh/disjoint_sets.h"
#include "repair/state/repair_state.h"

/** What the edges of a group tell. */
typedef struct vxm_edge_group {
  bool closed;   /**< every edge has an even number of sides */
  bool balanced; /**< along every edge as many sides run one way as the other, so that winding numbers are
                    whole and change only at faces */
  bool manifold; /**< no edge has more than two sides */
} vxm_edge_group;

/** The faces of a soup by group: those that share edges, however many faces an edge has. Faces without an
 * edge are groups of their own, and closed. */
typedef struct vxm_edge_groups {
  const uint32_t *sides; /**< per corner: its edge, of the state's edge map */
  size_t *of_face;       /**< per face: its group */
  vxm_edge_group *groups;
  size_t count;
} vxm_edge_groups;

/** @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED; the groups are to be freed
 * in any case */
vxm_status vxm_edge_groups_find(vxm_edge_groups *out, vxm_repair_state *state, vxm_error *error);
void vxm_edge_groups_destroy(vxm_edge_groups *groups, vxm_context *context);

/**
 * Lists the faces that are chosen, one group behind the other.
 *
 * @param chosen       per face: 1 or 0
 * @param[out] begin   groups->count + 1 zeros: where those of each group begin
 * @param[out] faces   room for all that are chosen
 */
void vxm_edge_groups_list(const vxm_edge_groups *groups, size_t face_count, const uint8_t *chosen,
                          size_t *begin, size_t *faces);

#endif

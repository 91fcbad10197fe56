/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * T-junctions: an edge of one face along which its neighbours have several, with vertices between that lie on
 * it. Nothing is missing there, though each of these edges is open.
 */
#ifndef VXM_REPAIR_WELD_T_JUNCTIONS_H
#define VXM_REPAIR_WELD_T_JUNCTIONS_H

#include "repair/state/repair_state.h"

/** Edges that are to be divided, each at one vertex; the halves may be among them. */
typedef struct vxm_edge_splits {
  uint64_t *keys;   /**< lower vertex << 32 | higher one; UINT64_MAX where a slot is free */
  uint32_t *middle; /**< per slot */
  size_t slots;     /**< a power of two; 0 = there are none */
  size_t count;
} vxm_edge_splits;

/**
 * Finds what closes edges: from a vertex where two open edges leave in one direction the longer one is
 * divided where the shorter ends, then what is left of it is matched with what leaves there, and so on; it
 * counts only if the end is reached with nothing left over.
 *
 * Vertices lie on an edge if they are no farther from it than what automatic welding bridges, and far nearer
 * to it than to its ends, and than it is to the corners beyond it. Time and memory are linear in the edges.
 *
 * @param[out] out freed with vxm_edge_splits_destroy, also after a failure
 * @param is_signed open are edges with more sides one way than the other, and what goes together runs
 * opposite ways, so that bodies which touch there do not get mixed up; else those with an odd number of sides
 * are, as faces may be turned against each other
 */
vxm_status vxm_t_junctions_find(vxm_edge_splits *out, vxm_repair_state *state, bool is_signed,
                                vxm_error *error);
void vxm_edge_splits_destroy(vxm_edge_splits *splits, vxm_context *context);

/** The vertex at which an edge is to be divided, or VXM_NO_VERTEX. */
uint32_t vxm_edge_split_at(const vxm_edge_splits *splits, uint32_t a, uint32_t b);

#endif

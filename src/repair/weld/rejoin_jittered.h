/* SPDX-License-Identifier: BSD-3-Clause */
/** Soups that were torn apart: each face moved by itself, much farther than rounding moves a vertex. */
#ifndef VXM_REPAIR_WELD_REJOIN_JITTERED_H
#define VXM_REPAIR_WELD_REJOIN_JITTERED_H

#include "repair/state/repair_state.h"

/**
 * Maps every vertex to the lowest one of its cluster, or to itself, so that boundary edges come together that
 * were one edge before the soup was torn.
 *
 * A soup is taken for torn if most of its edges are boundary edges and most of these have a mate: another
 * boundary edge, of a face on the other side, with both ends nearer than a third of the edge and than 3e-4 of
 * the diagonal. How far the mates of long edges are apart tells how far the soup was torn. Then pairs of
 * edges are joined, the nearest first, if at least one of the two is still open, no face loses a corner, and
 * no cluster of vertices gets wider than 5e-4 of the diagonal. All other soups stay as they are.
 *
 * @param map vertex_count elements, owned by the caller
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_rejoin_jittered(vxm_repair_state *state, uint32_t *map, vxm_error *error);

#endif

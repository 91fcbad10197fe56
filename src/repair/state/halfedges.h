/* SPDX-License-Identifier: BSD-3-Clause */
/** Which edge each side of each face runs along. */
#ifndef VXM_REPAIR_STATE_HALFEDGES_H
#define VXM_REPAIR_STATE_HALFEDGES_H

#include "repair/state/repair_state.h"

#define VXM_NO_EDGE SIZE_MAX

/**
 * For every corner the place in work->edges of the side from it to the next corner of its face, or
 * VXM_NO_EDGE where the edge map has none (vxm_edges_build). Linear time, but for vertices with many edges.
 *
 * @param[out] sides corner_count elements, freed by the caller with vxm_free; NULL after a failure
 */
vxm_status vxm_halfedges_find(size_t **sides, vxm_repair_state *state, vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Vertices whose faces do not form one fan. */
#ifndef VXM_REPAIR_STATE_VERTEX_FANS_H
#define VXM_REPAIR_STATE_VERTEX_FANS_H

#include "repair/state/repair_state.h"

/**
 * Counts for every vertex the fans about it: its faces are in one fan if edges that they share lead from each
 * to each other.
 *
 * @param[out] fans vertex_count elements, freed by the caller with vxm_free; at most 255 are counted
 */
vxm_status vxm_vertex_fans_count(uint8_t **fans, vxm_repair_state *state, vxm_error *error);

/** Whether the faces are a manifold: no edge has more than two, which run along it in opposite directions,
 * and no vertex more than one fan. */
vxm_status vxm_is_manifold(bool *out, vxm_repair_state *state, vxm_error *error);

#endif

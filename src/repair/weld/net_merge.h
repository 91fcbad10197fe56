/* SPDX-License-Identifier: BSD-3-Clause */
/** Whether merging vertices is worth while where faces are to be a manifold. */
#ifndef VXM_REPAIR_WELD_NET_MERGE_H
#define VXM_REPAIR_WELD_NET_MERGE_H

#include "repair/state/repair_state.h"

/**
 * Below the level manifold, and for what is no manifold as yet, merging always helps. In a manifold it may
 * make edges of three faces, or vertices of two fans, which separation then cuts apart again: that helps only
 * if fewer vertices are left in the end, or faces that were in the way are gone. So what separation has cut
 * apart, and lies near, is not merged again and again.
 */
vxm_status vxm_merge_helps(bool *helps, vxm_repair_state *state, const uint32_t *map, vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Polygons into triangles, where polygons will not do. */
#ifndef VXM_REPAIR_STATE_SPLIT_H
#define VXM_REPAIR_STATE_SPLIT_H

#include "repair/state/repair_state.h"

/** Splits polygons of more than three corners; with `touching` only those with a corner that comes twice. */
vxm_status vxm_split_polygons(vxm_repair_state *state, bool touching, vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** The faces as they were before a union, for another try with their vertices on a lattice. */
#ifndef VXM_REPAIR_EXACT_ON_LATTICE_H
#define VXM_REPAIR_EXACT_ON_LATTICE_H

#include "repair/state/repair_state.h"

/** What a repair had come to, so that it can go on from there again. */
typedef struct vxm_before_union {
  vxm_soup *soup;
  uint8_t *turned;
  vxm_repair_state state; /**< counts and the like; its pointers are not followed */
} vxm_before_union;

/** Takes a copy. @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_before_union_keep(vxm_before_union *out, const vxm_repair_state *state, vxm_error *error);
void vxm_before_union_destroy(vxm_before_union *kept, vxm_context *context);

/** Goes back to the copy. @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_before_union_again(vxm_repair_state *state, const vxm_before_union *kept, vxm_error *error);

/** A pass that moves the vertices to a lattice of 2^-bits of the diagonal (vxm_union_try): walls that lie
 * nearly in one plane do then, and unions have no slivers between them that come apart by less than numbers
 * tell. */
vxm_status vxm_snap_to_lattice(vxm_repair_state *state, bool *changed, vxm_error *error);

/** Whether another try may do better: faces cut through each other, or vertices could not be kept apart,
 * although all parts were united that had to be; or parts were not that have an inside. */
vxm_status vxm_union_fell_short(bool *out, const vxm_repair_state *state, vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** How the faces of patches are turned that no turning makes consistent. */
#ifndef VXM_REPAIR_CLEAN_SPANNING_TURNS_H
#define VXM_REPAIR_CLEAN_SPANNING_TURNS_H

#include "repair/state/repair_state.h"

/** Faces joined by edges that have exactly two sides. */
typedef struct vxm_joined_faces {
  const uint32_t *label;   /**< per face: its patch */
  const size_t (*pair)[2]; /**< per edge with two sides: their faces */
  const uint8_t *apart;    /**< per edge: it joins nothing */
  const uint8_t *chosen;   /**< per patch: whether its faces are to be turned */
} vxm_joined_faces;

/**
 * Turns faces so that they go together along the longest edges, and where they cannot along all of them, as
 * round a Moebius strip, not along short ones: along the edges of a longest spanning tree. Where edges are
 * equally long the one comes first that does in space, so that nothing hangs on how faces are numbered.
 *
 * @param[out] turn per face of a chosen patch: whether it runs the other way than some face of it. The others
 *                  are left alone
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_spanning_turns_find(uint8_t *turn, vxm_repair_state *state, const vxm_joined_faces *joined,
                                   vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Which faces are of sheets that end at other faces on one side, and nowhere on another. */
#ifndef VXM_REPAIR_BODIES_RIMMED_SHEETS_H
#define VXM_REPAIR_BODIES_RIMMED_SHEETS_H

#include "repair/state/edge_groups.h"

/**
 * Faces that edges with two sides connect are a patch. A patch that has edges to itself, and others with more
 * than two sides, is asked: it is a sheet if it would be one for the closing of holes (vxm_find_sheets), had
 * it all its vertices to itself.
 */
typedef struct vxm_rimmed_sheets {
  uint8_t *sheet; /**< per face; NULL if no patch was to be asked */
  size_t *joined; /**< per face: another one of its patch or of a sheet that meets it at an edge, or itself;
                     see vxm_set_of */
} vxm_rimmed_sheets;

/** @return VXM_OK, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED; the sheets
 * are to be freed in any case */
vxm_status vxm_rimmed_sheets_find(vxm_rimmed_sheets *out, vxm_repair_state *state,
                                  const vxm_edge_groups *groups, vxm_error *error);
void vxm_rimmed_sheets_destroy(vxm_rimmed_sheets *sheets, vxm_context *context);

#endif

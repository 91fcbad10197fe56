/* SPDX-License-Identifier: BSD-3-Clause */
/** The vertices of the surface around sheets, and where they are. */
#ifndef VXM_REPAIR_SHEETS_SHEET_OFFSETS_H
#define VXM_REPAIR_SHEETS_SHEET_OFFSETS_H

#include "repair/sheets/sheet_sides.h"

typedef struct vxm_sheet_offsets {
  vxm_context *context;
  uint32_t *vertex;  /**< per corner of a side: its vertex of the surface */
  double *positions; /**< per vertex, x 3 */
  uint32_t count;
} vxm_sheet_offsets;

/**
 * Gives corners of sides that see each other one vertex, at the distance to their faces, mitred by at most
 * VXM_MITRE_LIMIT times it. Where the front and the back of a rim would have the same vertex, as at the foot
 * of a flap, another edge about that vertex is cut, so that they have two. Where a triangle would be turned
 * over by that, the distance is halved at its corners until it is not, or next to nothing.
 *
 * @param distance model units
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_sheet_offsets_find(vxm_sheet_offsets *out, vxm_sheet_sides *sides, double distance,
                                  double scale, vxm_error *error);
void vxm_sheet_offsets_destroy(vxm_sheet_offsets *offsets);

#endif

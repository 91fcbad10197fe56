/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Sheets that stand alone, as the shell of a seat.
 *
 * A curved sheet turns its hollow side to what lies in its bend, and lines across the bend meet it twice, as
 * they do a body: the winding number would fill the bend up to its rim, where somebody is to sit. But a cap
 * over the whole of its rim would be as large as the sheet itself, and where nothing open lies near there is
 * nothing that it could make a body with.
 */
#ifndef VXM_VOXEL_PARTS_LONE_SHEETS_H
#define VXM_VOXEL_PARTS_LONE_SHEETS_H

#include "mesh/soup.h"

/** What is known of a component. */
typedef struct vxm_opening {
  double widest_cap; /**< the area of its largest cap; 0 = it is closed */
  bool open;         /**< caps would only cover it a second time */
  bool lone;         /**< it may be a lone sheet */
} vxm_opening;

/**
 * Of components that may be lone sheets keeps those near which nothing lies that they could make a body with:
 * no open component, and none with an opening that they could be the lid of. What counts are boxes, a little
 * grown.
 *
 * @param[in,out] openings per component
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 *
 * Where more than 4096 components have openings none is kept: comparing all of them would take long.
 */
vxm_status vxm_lone_sheets_keep(vxm_opening *openings, const vxm_soup *soup, const uint32_t *component,
                                size_t count, vxm_error *error);

#endif

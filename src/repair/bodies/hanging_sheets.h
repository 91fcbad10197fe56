/* SPDX-License-Identifier: BSD-3-Clause */
/** Sheets that hang on the edges of bodies, as fins and flags do, are cut off. */
#ifndef VXM_REPAIR_BODIES_HANGING_SHEETS_H
#define VXM_REPAIR_BODIES_HANGING_SHEETS_H

#include "repair/state/repair_state.h"

/**
 * Gives sheets that hang vertices of their own, so that the edges they hang on are what they are without
 * them: a closed body with a fin on one of its edges has an edge with three sides, and is closed again.
 *
 * Asked are sheets with a rim (repair/bodies/rimmed_sheets.h). Those that meet at an edge are cut off
 * together, if all edges where they meet other patches have an even number of sides without them: of three
 * walls that meet at an edge none hangs on the others if all are sheets. That is done where it matters: where
 * the faces that edges connect are closed without them, or are a sheet as a whole with them.
 *
 * @param[out] added vertices that there are more
 * @return VXM_OK, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 *
 * Linear time; where no edge has one side or none has more than two, it takes a look at each edge alone.
 */
vxm_status vxm_cut_hanging_sheets(vxm_repair_state *state, int64_t *added, vxm_error *error);

/** What there was before sheets were cut off for a while. */
typedef struct vxm_hung_sheets {
  uint32_t *indices; /**< NULL if none were */
  size_t vertex_count;
} vxm_hung_sheets;

/** Cuts those off without which the faces that edges connect are closed, until vxm_hang_sheets_again, which
 * is called in any case; faces are not to be changed in between. @return as above */
vxm_status vxm_take_sheets_off(vxm_hung_sheets *off, vxm_repair_state *state, vxm_error *error);
void vxm_hang_sheets_again(vxm_hung_sheets *off, vxm_repair_state *state);

#endif

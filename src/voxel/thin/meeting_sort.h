/* SPDX-License-Identifier: BSD-3-Clause */
/** Meetings in the order of their cells. */
#ifndef VXM_VOXEL_THIN_MEETING_SORT_H
#define VXM_VOXEL_THIN_MEETING_SORT_H

#include "voxel/thin/dual_elements.h"

/**
 * Sorts by the numbers of cells. Cells of the first stage that have one meeting may come first, in any order.
 *
 * @param from is overwritten
 * @param to   room for as many
 * @return which of the two has them
 */
vxm_meeting *vxm_meetings_sort(vxm_meeting *from, vxm_meeting *to, size_t count);

#endif

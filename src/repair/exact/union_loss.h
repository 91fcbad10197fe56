/* SPDX-License-Identifier: BSD-3-Clause */
/** What a union takes away of the insides of parts. */
#ifndef VXM_REPAIR_EXACT_UNION_LOSS_H
#define VXM_REPAIR_EXACT_UNION_LOSS_H

#include "mesh/soup.h"

/**
 * Counts the closed components of which more than a hundredth of what they enclosed is enclosed no more. What
 * a cavity takes from the body that it cuts through is not lost, but what goes of a body whose box lies
 * within that of the cavity is.
 *
 * @return as vxm_lost_parts_find
 */
vxm_status vxm_union_loss_find(int64_t *count, const vxm_soup *before, const vxm_soup *united,
                               vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** The passes of a repair, in their order. */
#ifndef VXM_REPAIR_PIPELINE_H
#define VXM_REPAIR_PIPELINE_H

#include "repair/state/repair_state.h"

/**
 * Runs the passes that the level and the options of `state` ask for.
 *
 * @param in what state->soup is a copy of
 * @param again a part would be lost: nothing more was done, state->lost names it, and the repair is to begin
 *              anew with that part guarded
 */
vxm_status vxm_pipeline_run(vxm_repair_state *state, const vxm_soup *in, bool *again, vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Names of several devices that work at once. */
#ifndef VXM_GPU_TEAM_NAMES_H
#define VXM_GPU_TEAM_NAMES_H

#include "gpu/team.h"

/** Whether a name stands for several devices, or for parts of one. */
bool vxm_team_is_named(const char *name);

/** Makes the engine of such a name; of one device it is that device's. @return as vxm_engine_create */
vxm_status vxm_team_make(vxm_engine **out, vxm_context *context, const char *name,
                         const vxm_engine_options *options, vxm_error *error);

#endif

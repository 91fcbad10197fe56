/* SPDX-License-Identifier: BSD-3-Clause */
/** Checks that several public functions share. */
#ifndef VXM_API_API_OPTIONS_H
#define VXM_API_API_OPTIONS_H

#include "base/error.h"
#include "voxmend/voxelize.h"

/** The caller's options or the defaults, if every choice is one of its enum. */
vxm_status vxm_choose_voxelize_options(vxm_voxelize_options *chosen, const vxm_voxelize_options *options,
                                       vxm_error *error);

#endif

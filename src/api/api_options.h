/* SPDX-License-Identifier: BSD-3-Clause */
/** Checks that several public functions share. */
#ifndef VXM_API_API_OPTIONS_H
#define VXM_API_API_OPTIONS_H

#include "base/error.h"

/** Whether the options' version is known and every choice is one of its enum. */
vxm_status vxm_check_voxelize_options(const vxm_voxelize_options *options, vxm_error *error);

#endif

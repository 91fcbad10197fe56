/* SPDX-License-Identifier: BSD-3-Clause */
/** Names of several devices that work at once. */
#ifndef VXM_GPU_MULTI_DEVICE_NAMES_H
#define VXM_GPU_MULTI_DEVICE_NAMES_H

#include "gpu/multi_device.h"

/** Whether a name stands for several devices, or for parts of one. */
bool vxm_multi_device_is_named(const char *name);

/** Makes the engine of such a name; of one device it is that device's. @return as vxm_engine_create */
vxm_status vxm_multi_device_make(vxm_engine **out, vxm_context *context, const char *name,
                                 const vxm_engine_options *options, vxm_error *error);

#endif

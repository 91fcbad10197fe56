/* SPDX-License-Identifier: BSD-3-Clause */
/** Engines by name. */
#ifndef VXM_GPU_ENGINES_H
#define VXM_GPU_ENGINES_H

#include "voxel/engine/engine.h"

/** See vxm_engine_create in voxmend.h; the options have been checked. */
vxm_status vxm_engines_make(vxm_engine **out, vxm_context *context, const char *name,
                            const vxm_engine_options *options, vxm_error *error);
/** As vxm_engines_make of a name that stands for one engine, with a context that is already held. */
vxm_status vxm_engines_make_one(vxm_engine **out, vxm_context *context, const char *name,
                                const vxm_engine_options *options, vxm_error *error);
/** OpenCL devices, and devices of EGL: those that there are, whether they work or not. */
int vxm_engines_opencl_count(void);
int vxm_engines_opengl_count(void);
/** See vxm_engines_find in voxmend.h. */
vxm_status vxm_engines_list(vxm_engine_info *out, int64_t capacity, int64_t *count, vxm_context *context,
                            vxm_error *error);

#endif

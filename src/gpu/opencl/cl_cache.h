/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Compiled programs in the user's cache folder, $XDG_CACHE_HOME/voxmend or ~/.cache/voxmend: compiling takes
 * seconds with some drivers. A file appears only when it is complete, so that two processes may write the
 * same one; what was damaged or belongs to another driver is not used. Where there is no such folder nothing
 * is kept.
 */
#ifndef VXM_GPU_OPENCL_CL_CACHE_H
#define VXM_GPU_OPENCL_CL_CACHE_H

#include "base/context.h"

/** Whose program it is: the device, its driver, the options and the source, hashed twice. */
typedef struct vxm_cl_key {
  uint64_t hash[2];
} vxm_cl_key;

void vxm_cl_key_add(vxm_cl_key *key, const char *text);

/** Loads a binary into a new block. @return NULL if there is none, or it is damaged */
unsigned char *vxm_cl_cache_load(const vxm_cl_key *key, vxm_context *context, size_t *size);
/** Stores one; what fails is no error, as it is compiled again then. */
void vxm_cl_cache_store(const vxm_cl_key *key, vxm_context *context, const unsigned char *binary,
                        size_t size);

#endif

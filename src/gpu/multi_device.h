/* SPDX-License-Identifier: BSD-3-Clause */
/** Several engines that work at once as one: each takes from what is left as much as its speed says. */
#ifndef VXM_GPU_MULTI_DEVICE_H
#define VXM_GPU_MULTI_DEVICE_H

#include "voxel/engine/engine.h"

enum { VXM_MULTI_DEVICE_MOST = 16 };

typedef struct vxm_multi_device_member {
  vxm_engine *engine; /**< in a context of its own; belongs to the group */
  double rate;        /**< pieces of work in a millisecond, lately; 0 = not known */
  bool is_lost;       /**< it has failed, and gets no more work */
  bool is_too_small;  /**< lost for this work alone, which is more than it can hold */
} vxm_multi_device_member;

typedef struct vxm_multi_device {
  vxm_engine base; /**< first, so that it is one */
  vxm_engine_ops ops;
  int count;
  vxm_multi_device_member members[VXM_MULTI_DEVICE_MOST];
} vxm_multi_device;

/** The group that an engine is; NULL if it is something else. */
vxm_multi_device *vxm_multi_device_of(vxm_engine *engine);

/**
 * Makes an engine of several, which it takes over, also after a failure. @param context as for
 * vxm_engines_make: the reference is the caller's
 */
vxm_status vxm_multi_device_create(vxm_engine **out, vxm_context *context, vxm_engine *const engines[],
                                   int count, vxm_error *error);

/** Does pieces begin..end-1 by member number `who`; those that another failed to do from the start. */
typedef vxm_status (*vxm_multi_device_fn)(vxm_engine *engine, int who, int64_t begin, int64_t end,
                                          void *payload, vxm_error *error);

/** Work to share out. */
typedef struct vxm_multi_device_work {
  int64_t begin, end;
  int64_t least; /**< so many pieces at once at least, where there are as many */
  const char *phase;
  vxm_multi_device_fn function;
  void *payload;
} vxm_multi_device_work;

/**
 * Has the members do all of it, in threads of their own; the caller reports progress. What one fails to do
 * goes to the others.
 *
 * @return VXM_OK; VXM_ERROR_CANCELLED, VXM_ERROR_MEMORY_LIMIT and VXM_ERROR_ARGUMENT as soon as one member
 *         has them; what the last member failed with
 */
vxm_status vxm_multi_device_run(vxm_multi_device *group, const vxm_multi_device_work *work, vxm_error *error);

#endif

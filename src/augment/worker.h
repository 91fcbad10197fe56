/* SPDX-License-Identifier: BSD-3-Clause */
/** What one thread makes variants with; its memory is kept from one to the next. */
#ifndef VXM_AUGMENT_WORKER_H
#define VXM_AUGMENT_WORKER_H

#include "augment/sampler_model.h"

typedef struct vxm_worker {
  vxm_context *context; /**< one reference held; NULL = not made yet */
  vxm_model_instance instance;
  vxm_engine *engine; /**< in place of the model's; NULL = that one */
  vxm_grid *grid;     /**< a variant on its way to a file; NULL before the first */
  bool streaming;     /**< what is written goes past the cache: there is so much that it would not stay */
  bool write_failed;  /**< the last variant was made, and its file could not be written */
  uint64_t *words;    /**< of a window, where what is asked for has another form */
  size_t word_capacity;
} vxm_worker;

/** @param alone whether one thread works here while others work elsewhere; else all of the context's do */
vxm_status vxm_worker_create(vxm_worker *out, vxm_context *context, bool alone, vxm_error *error);
void vxm_worker_destroy(vxm_worker *worker);

/** Voxelizes a variant into a window, which is all of a cube. @return as vxm_sampler_batch */
vxm_status vxm_worker_fill(vxm_worker *worker, const vxm_window *window, const vxm_sampler_model *subject,
                           const vxm_placement *placement, const vxm_noise *noise, vxm_error *error);

/** The same into variant `index` of voxels that stay on the engine's device. */
vxm_status vxm_worker_keep(vxm_worker *worker, vxm_device_voxels *voxels, int64_t index,
                           const vxm_sampler_model *subject, const vxm_placement *placement,
                           const vxm_noise *noise, vxm_error *error);

/** The same into memory, as [x][y][z] in C order; `coverage` as in vxm_sampler_options. */
vxm_status vxm_worker_write(vxm_worker *worker, void *out, vxm_voxel_format voxels, int64_t resolution,
                            int coverage, const vxm_sampler_model *subject, const vxm_placement *placement,
                            const vxm_noise *noise, vxm_error *error);

/** The same into a file. */
vxm_status vxm_worker_save(vxm_worker *worker, const char *path, const char *format, int64_t resolution,
                           const vxm_sampler_model *subject, const vxm_placement *placement,
                           const vxm_noise *noise, vxm_error *error);

/** The voxel space of all variants: the unit cube. */
vxm_space vxm_worker_space(int64_t resolution);

#endif

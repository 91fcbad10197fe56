/* SPDX-License-Identifier: BSD-3-Clause */
/** Variants of numbered models, made by all threads. */
#ifndef VXM_AUGMENT_SAMPLER_H
#define VXM_AUGMENT_SAMPLER_H

#include "augment/worker.h"
#include "gpu/multi_device.h"

struct vxm_sampler {
  vxm_context *context; /**< one reference held */
  vxm_pose_rules rules;
  double *rotations; /**< a copy of the list */
  vxm_noise noise;
  vxm_sampler_model *subjects; /**< in the order of their numbers */
  size_t subject_count, subject_capacity;
  vxm_worker *workers;                     /**< one for each thread, and then one for all of them together */
  vxm_worker seats[VXM_MULTI_DEVICE_MOST]; /**< one for each device, where several work at once */
};

/** See vxm_sampler_create in voxmend.h; the options have been checked. */
vxm_status vxm_sampler_make(vxm_sampler **out, vxm_context *context, const vxm_sampler_options *options,
                            vxm_error *error);
/** See vxm_sampler_put; `soup` may be NULL. */
vxm_status vxm_sampler_set(vxm_sampler *sampler, uint32_t model, const vxm_soup *soup, vxm_error *error);
/** The model of a variant; NULL after a failure. */
const vxm_sampler_model *vxm_sampler_find(const vxm_sampler *sampler, uint32_t model, vxm_error *error);
/** See vxm_sampler_grid. */
vxm_status vxm_sampler_fill(vxm_sampler *sampler, vxm_grid *grid, const vxm_variant *variant,
                            vxm_error *error);
/** See vxm_sampler_batch. */
vxm_status vxm_sampler_write(vxm_sampler *sampler, void *out, const vxm_variant *variants, size_t count,
                             vxm_voxel_format voxels, vxm_error *error);
/** See vxm_sampler_batch_device. */
vxm_status vxm_sampler_keep(vxm_device_voxels **out, vxm_sampler *sampler, const vxm_variant *variants,
                            size_t count, vxm_voxel_format format, vxm_error *error);
/** See vxm_sampler_files; `format` may be NULL. */
vxm_status vxm_sampler_save(vxm_sampler *sampler, const char *const *paths, const vxm_variant *variants,
                            size_t count, const char *format, bool *written, vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** A model of which variants are made. */
#ifndef VXM_AUGMENT_SAMPLER_MODEL_H
#define VXM_AUGMENT_SAMPLER_MODEL_H

#include "augment/noise.h"
#include "augment/pose.h"
#include "voxel/model/model_instance.h"

/** Points at the same position have the same entry of the noise, so that what is closed stays closed. */
typedef struct vxm_sampler_model {
  uint32_t number;
  vxm_model *model; /**< prepared; NULL = nothing here */
  vxm_model_extent extent;
  uint32_t *entry;        /**< of the triangles' points, below the size of the noise; NULL without noise */
  uint32_t *vertex_entry; /**< of the soup's vertices, where faces set voxels; else NULL */
} vxm_sampler_model;

/** @return as vxm_sampler_put */
vxm_status vxm_sampler_model_create(vxm_sampler_model *out, uint32_t number, const vxm_soup *soup,
                                    const vxm_voxelize_options *options, const vxm_noise *noise,
                                    vxm_error *error);
void vxm_sampler_model_destroy(vxm_sampler_model *subject);

#endif

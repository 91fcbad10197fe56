/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Random displacements: a circular buffer of vectors that is made once for a seed and read from another place
 * for each variant (Ogayar et al., section III-B).
 */
#ifndef VXM_AUGMENT_NOISE_H
#define VXM_AUGMENT_NOISE_H

#include "base/context.h"
#include "voxmend/sampler.h"

typedef struct vxm_noise {
  uint64_t serial;     /**< no two that hold other vectors have the same */
  uint32_t size;       /**< vectors; 0 = no displacement */
  double reach;        /**< the most that any coordinate is displaced */
  float (*vectors)[4]; /**< in units of the voxel space; the fourth number is 0 */
} vxm_noise;

/** @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_noise_create(vxm_noise *out, vxm_context *context, uint64_t seed, vxm_displacement kind,
                            double amount, uint32_t size, vxm_error *error);
void vxm_noise_destroy(vxm_noise *noise, vxm_context *context);
/** The most that a coordinate is displaced. */
double vxm_noise_reach(vxm_displacement kind, double amount);

#endif

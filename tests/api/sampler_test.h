/* SPDX-License-Identifier: BSD-3-Clause */
/** What the tests of samplers share. */
#ifndef SAMPLER_TEST_H
#define SAMPLER_TEST_H

#include "api_support.h"

#include <stdlib.h>

static inline vxm_context *context_of(int threads) {
  vxm_context_options limits = VXM_CONTEXT_OPTIONS_INIT;
  limits.threads = threads;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, &limits, NULL), VXM_OK);
  return context;
}

/** Everything at once. */
static inline vxm_sampler_options all_options(void) {
  vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT;
  options.resolution = 32;
  options.pad = 1;
  options.seed = UINT64_C(0x123456789abcdef0);
  options.rotation = VXM_ROTATION_ANY;
  options.scale = 0.5;
  options.displace = 0.03;
  options.mirror = 7;
  options.translate = 1;
  return options;
}

static inline vxm_sampler *sampler_of(vxm_context *context, const vxm_sampler_options *options,
                                      const vxm_mesh *mesh) {
  vxm_sampler *sampler = NULL;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_sampler_create(&sampler, context, options, &error) != VXM_OK ||
      vxm_sampler_put(sampler, 0, mesh, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return sampler;
}

/** Variants first to first + count - 1 of model 0; to be freed. */
static inline uint8_t *make(vxm_sampler *sampler, uint32_t first, size_t count, vxm_voxel_format voxels) {
  vxm_variant *variants = calloc(count, sizeof *variants);
  uint8_t *out = malloc(count * vxm_sampler_bytes(sampler, voxels));
  assert_true(variants && out);
  for (size_t i = 0; i < count; i++)
    variants[i] = (vxm_variant){0, 2, first + (uint32_t)i};
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_sampler_batch(out, sampler, variants, count, voxels, &error) != VXM_OK)
    fail_msg("%s", error.text);
  free(variants);
  return out;
}

/** FNV-1a, which other languages can easily do too. */
static inline uint64_t hash_of(const uint8_t *bytes, size_t count) {
  uint64_t hash = UINT64_C(0xcbf29ce484222325);
  for (size_t i = 0; i < count; i++)
    hash = (hash ^ bytes[i]) * UINT64_C(0x100000001b3);
  return hash;
}

#endif

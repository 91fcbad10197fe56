/* SPDX-License-Identifier: BSD-3-Clause */
#include "augment/noise.h"
#include "augment/random.h"
#include "base/threads.h"

#include <stdatomic.h>

enum { NORMAL_REACH = 3, SLICE = 1024 };

typedef struct noise_job {
  vxm_noise *noise;
  uint64_t seed;
  vxm_displacement kind;
  double amount;
} noise_job;

static void fill_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  const noise_job *job = payload;
  uint32_t begin = (uint32_t)slice * SLICE, end = begin + SLICE;
  for (uint32_t v = begin; v < end && v < job->noise->size; v++) {
    vxm_random draw = vxm_random_begin(job->seed, (const uint32_t[3]){v, 0, 0}, VXM_DRAW_NOISE);
    float *vector = job->noise->vectors[v];
    for (int a = 0; a < 3; a++) {
      bool normal = job->kind == VXM_DISPLACEMENT_NORMAL;
      vector[a] = (float)(job->amount * (normal ? vxm_random_normal(&draw) : vxm_random_signed(&draw)));
    }
    vector[3] = 0;
  }
}

double vxm_noise_reach(vxm_displacement kind, double amount) {
  return kind == VXM_DISPLACEMENT_NORMAL ? NORMAL_REACH * amount : amount;
}

vxm_status vxm_noise_create(vxm_noise *out, vxm_context *context, uint64_t seed, vxm_displacement kind,
                            double amount, uint32_t size, vxm_error *error) {
  static atomic_uint_fast64_t last_serial;
  *out = (vxm_noise){0};
  if (amount == 0)
    return VXM_OK;
  vxm_status status = VXM_OK;
  out->vectors = vxm_try_alloc(context, size, sizeof *out->vectors, &status, error);
  if (!out->vectors)
    return status;
  out->size = size;
  out->serial = atomic_fetch_add(&last_serial, 1) + 1;
  out->reach = vxm_noise_reach(kind, amount);
  noise_job job = {out, seed, kind, amount};
  vxm_parallel(context, ((size_t)size + SLICE - 1) / SLICE, fill_slice, &job);
  return VXM_OK;
}

void vxm_noise_destroy(vxm_noise *noise, vxm_context *context) {
  vxm_free(context, noise->vectors);
  *noise = (vxm_noise){0};
}

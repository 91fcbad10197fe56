/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/lattice/vertex_transform.h"
#include "base/threads.h"

#include <string.h>

enum {
  SLICE_POINTS = 8192,
  BLOCK = 256 /**< points that stay in the first-level cache */
};

/** Adds the entries of the noise to points. */
static void displace(double (*to)[3], const vxm_vertex_transform *motion, size_t begin, size_t end) {
  const uint32_t *entries = motion->entry, offset = motion->offset, size = motion->noise_size;
  const float(*noise)[4] = motion->noise;
  for (size_t i = begin; i < end; i++) {
    uint32_t entry = entries[i] + offset; /* both are below 2^31 */
    const float *v = noise[entry < size ? entry : entry - size];
    for (int a = 0; a < 3; a++)
      to[i - begin][a] += (double)v[a];
  }
}

void vxm_vertex_transform_range(double (*to)[3], const vxm_vertex_transform *motion, size_t begin,
                                size_t end) {
  const double(*from)[3] = motion->from;
  double m[12]; /* a copy that no store can change */
  memcpy(m, motion->matrix, sizeof m);
  while (begin < end) {
    size_t last = end - begin < BLOCK ? end : begin + BLOCK, count = last - begin;
    for (size_t i = 0; i < count; i++) {
      const double x = from[begin + i][0], y = from[begin + i][1], z = from[begin + i][2];
      to[i][0] = m[0] * x + m[1] * y + m[2] * z + m[3];
      to[i][1] = m[4] * x + m[5] * y + m[6] * z + m[7];
      to[i][2] = m[8] * x + m[9] * y + m[10] * z + m[11];
    }
    if (motion->entry)
      displace(to, motion, begin, last);
    to += count;
    begin = last;
  }
}

typedef struct apply_job {
  double (*to)[3];
  const vxm_vertex_transform *motion;
  size_t slices;
} apply_job;

static void apply_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  const apply_job *job = payload;
  size_t begin = vxm_slice_begin(job->motion->count, job->slices, slice);
  vxm_vertex_transform_range(job->to + begin, job->motion, begin,
                             vxm_slice_begin(job->motion->count, job->slices, slice + 1));
}

void vxm_vertex_transform_apply(vxm_context *context, double (*to)[3], const vxm_vertex_transform *motion) {
  apply_job job = {to, motion, 1 + motion->count / SLICE_POINTS};
  vxm_parallel(context, job.slices, apply_slice, &job);
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/settle.h"
#include "base/threads.h"

#include <math.h>
#include <stdatomic.h>

static const char phase[] = "computing winding numbers";

typedef struct settle_job {
  vxm_grid *out;
  const vxm_grid *asked;
  const vxm_winding *winding;
  uint8_t *confidence;
  size_t layer_count, row_count; /**< bricks along z and y */
  atomic_size_t done;
  atomic_bool stop;
  vxm_status status;
  vxm_error *error;
} settle_job;

/** The voxels of a brick that are asked about, as bits 16 z + 4 y + x. i is a multiple of 4. */
static uint64_t asked_in_brick(const settle_job *job, int64_t i, int64_t j, int64_t k) {
  const int64_t *dims = job->out->space.dims;
  uint64_t bits = 0;
  for (int row = 0; row < 16; row++) {
    int64_t y = j + row % 4, z = k + row / 4;
    if (y >= dims[1] || z >= dims[2])
      continue;
    uint64_t four = 15;
    if (job->asked)
      four = vxm_grid_row(job->asked, y, z)[i / 64] >> (i % 64) & 15;
    else if (dims[0] - i < 4)
      four = vxm_low_bits((unsigned)(dims[0] - i));
    bits |= four << (4 * row);
  }
  return bits;
}

static void decide_brick(const settle_job *job, int64_t i, int64_t j, int64_t k, uint64_t bits) {
  const int64_t *dims = job->out->space.dims;
  float value[VXM_BRICK];
  vxm_winding_brick(job->winding, i, j, k, value);
  for (; bits; bits &= bits - 1) {
    int v = __builtin_ctzll(bits);
    int64_t x = i + v % 4, y = j + v / 4 % 4, z = k + v / 16;
    if (value[v] > 0.5F)
      vxm_grid_row(job->out, y, z)[x / 64] |= UINT64_C(1) << (x % 64);
    if (job->confidence) {
      float sure = fabsf(2.0F * value[v] - 1.0F);
      job->confidence[(z * dims[1] + y) * dims[0] + x] = (uint8_t)(sure < 1.0F ? 255.0F * sure : 255.0F);
    }
  }
}

/** A row of bricks along x: its words belong to this task alone. */
static void decide_row(size_t task, int worker, void *payload) {
  settle_job *job = payload;
  if (atomic_load_explicit(&job->stop, memory_order_relaxed))
    return;
  int64_t k = 4 * (int64_t)(task / job->row_count), j = 4 * (int64_t)(task % job->row_count);
  for (int64_t i = 0; i < job->out->space.dims[0]; i += 4) {
    uint64_t bits = asked_in_brick(job, i, j, k);
    if (bits)
      decide_brick(job, i, j, k, bits);
  }
  size_t done = atomic_fetch_add_explicit(&job->done, 1, memory_order_relaxed) + 1;
  if (worker != 0 || job->status != VXM_OK)
    return; /* worker 0 is the calling thread, the only one that may report progress */
  double fraction = (double)done / (double)(job->layer_count * job->row_count);
  job->status = vxm_progress(job->out->context, phase, fraction, job->error);
  if (job->status != VXM_OK)
    atomic_store_explicit(&job->stop, true, memory_order_relaxed);
}

vxm_status vxm_settle(vxm_grid *out, const vxm_grid *asked, const vxm_winding *winding, uint8_t *confidence,
                      vxm_error *error) {
  settle_job job = {.out = out, .asked = asked, .winding = winding, .confidence = confidence, .error = error};
  job.layer_count = (size_t)(out->space.dims[2] + 3) / 4;
  atomic_init(&job.done, 0);
  atomic_init(&job.stop, false);
  job.row_count = (size_t)(out->space.dims[1] + 3) / 4;
  vxm_parallel(out->context, job.layer_count * job.row_count, decide_row, &job);
  /* Other threads may have taken the last rows: ask once more, so that no wish to stop is missed. */
  return job.status == VXM_OK ? vxm_progress(out->context, phase, 1.0, error) : job.status;
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/vote.h"
#include "base/threads.h"

#include <stdatomic.h>

typedef struct vote_job {
  uint64_t *out;
  const uint64_t *x, *y, *z, *t;
  size_t word_count, slices;
  vxm_vote rule;
  atomic_int_fast64_t contested;
} vote_job;

static void vote_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  vote_job *job = payload;
  int64_t contested = 0;
  size_t end = vxm_slice_begin(job->word_count, job->slices, slice + 1);
  for (size_t w = vxm_slice_begin(job->word_count, job->slices, slice); w < end; w++) {
    uint64_t x = job->x[w], y = job->y[w], z = job->z[w], t = job->t[w];
    uint64_t any = x | y | z | t, all = x & y & z & t;
    contested += vxm_popcount(any & ~all & ~job->out[w]);
    if (job->rule == VXM_VOTE_MAJORITY)
      job->out[w] |= (x & y) | (z & (x | y));
    else
      job->out[w] |= job->rule == VXM_VOTE_ANY ? any : all;
  }
  atomic_fetch_add_explicit(&job->contested, contested, memory_order_relaxed);
}

void vxm_vote_combine(vxm_grid *out, vxm_grid *const voters[4], vxm_vote rule, int64_t *contested) {
  vote_job job = {out->words,
                  voters[0]->words,
                  voters[1]->words,
                  voters[2]->words,
                  voters[3]->words,
                  out->word_count,
                  1 + out->word_count / 65536,
                  rule,
                  0};
  vxm_parallel(out->context, job.slices, vote_slice, &job);
  *contested = atomic_load(&job.contested);
}

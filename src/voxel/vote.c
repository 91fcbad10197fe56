/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/vote.h"
#include "base/threads.h"

#include <stdatomic.h>

enum { SLICE_WORDS = 1 << 16 };

typedef struct vote_job {
  uint64_t *out, *mask;
  const uint64_t *voters[4];
  size_t word_count, slices;
  vxm_vote rule;
  atomic_int_fast64_t contested;
} vote_job;

static void combine_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  vote_job *job = payload;
  int64_t contested = 0;
  size_t end = vxm_slice_begin(job->word_count, job->slices, slice + 1);
  for (size_t w = vxm_slice_begin(job->word_count, job->slices, slice); w < end; w++) {
    uint64_t x = job->voters[0][w], y = job->voters[1][w], z = job->voters[2][w], t = job->voters[3][w];
    uint64_t any = x | y | z | t, all = x & y & z & t;
    contested += vxm_popcount(any & ~all & ~job->out[w]);
    if (job->rule == VXM_VOTE_MAJORITY)
      job->out[w] |= (x & y) | (z & (x | y));
    else
      job->out[w] |= job->rule == VXM_VOTE_ANY ? any : all;
  }
  atomic_fetch_add_explicit(&job->contested, contested, memory_order_relaxed);
}

static void agree_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  vote_job *job = payload;
  int64_t contested = 0;
  size_t end = vxm_slice_begin(job->word_count, job->slices, slice + 1);
  for (size_t w = vxm_slice_begin(job->word_count, job->slices, slice); w < end; w++) {
    uint64_t x = job->voters[0][w], y = job->voters[1][w], z = job->voters[2][w];
    job->mask[w] = (x | y | z) & ~(x & y & z) & ~job->out[w];
    job->out[w] |= x & y & z;
    contested += vxm_popcount(job->mask[w]);
  }
  atomic_fetch_add_explicit(&job->contested, contested, memory_order_relaxed);
}

static int64_t run(vote_job *job, const vxm_grid *out, vxm_task_fn slice) {
  job->out = out->words;
  job->word_count = out->word_count;
  job->slices = 1 + out->word_count / SLICE_WORDS;
  atomic_init(&job->contested, 0);
  vxm_parallel(out->context, job->slices, slice, job);
  return atomic_load(&job->contested);
}

void vxm_vote_combine(vxm_grid *out, vxm_grid *const voters[4], vxm_vote rule, int64_t *contested) {
  vote_job job = {.rule = rule};
  for (int v = 0; v < 4; v++)
    job.voters[v] = voters[v]->words;
  *contested = run(&job, out, combine_slice);
}

void vxm_vote_agree(vxm_grid *out, vxm_grid *const voters[3], vxm_grid *contested, int64_t *count) {
  vote_job job = {.mask = contested->words};
  for (int v = 0; v < 3; v++)
    job.voters[v] = voters[v]->words;
  *count = run(&job, out, agree_slice);
}

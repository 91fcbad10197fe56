/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/vote.h"
#include "base/bits.h"
#include "base/threads.h"

#include <stdatomic.h>

enum { SLICE_WORDS = 1 << 15 };

typedef struct vote_job {
  uint64_t *out, *mask;
  const uint64_t *const *voters;
  size_t word_count, slices;
  vxm_vote rule;
  atomic_int_fast64_t contested, added;
} vote_job;

static void count_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  vote_job *job = payload;
  int64_t contested = 0, added = 0;
  const uint64_t *tetra = job->voters[3] ? job->voters[3] : job->voters[0];
  size_t end = vxm_slice_begin(job->word_count, job->slices, slice + 1);
  for (size_t w = vxm_slice_begin(job->word_count, job->slices, slice); w < end; w++) {
    uint64_t x = job->voters[0][w], y = job->voters[1][w], z = job->voters[2][w], t = tetra[w];
    uint64_t any = x | y | z | t, all = x & y & z & t, before = job->out[w];
    uint64_t elected = job->rule == VXM_VOTE_MAJORITY ? (x & y) | (z & (x | y))
                       : job->rule == VXM_VOTE_ANY    ? any
                                                      : all;
    uint64_t disagree = any & ~all & ~before;
    contested += vxm_popcount(disagree);
    added += vxm_popcount(elected & ~before);
    job->out[w] = before | elected;
    if (job->mask)
      job->mask[w] = disagree;
  }
  atomic_fetch_add_explicit(&job->contested, contested, memory_order_relaxed);
  atomic_fetch_add_explicit(&job->added, added, memory_order_relaxed);
}

void vxm_vote_count(uint64_t *out, const uint64_t *const voters[4], uint64_t *mask, size_t word_count,
                    vxm_vote rule, vxm_context *context, vxm_tally *tally) {
  vote_job job = {.out = out,
                  .mask = mask,
                  .voters = voters,
                  .word_count = word_count,
                  .slices = 1 + word_count / SLICE_WORDS,
                  .rule = rule};
  atomic_init(&job.contested, 0);
  atomic_init(&job.added, 0);
  vxm_parallel(context, job.slices, count_slice, &job);
  tally->contested += atomic_load(&job.contested);
  tally->added += atomic_load(&job.added);
}

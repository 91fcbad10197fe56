/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parity/vote.h"
#include "base/threads.h"
#include "voxel/parity/kernels.h"

enum { SLICE_WORDS = 1 << 15 };

typedef struct vote_job {
  uint64_t *out, *mask;
  const uint64_t *const *voters;
  size_t word_count, slices;
  vxm_vote rule;
  const vxm_kernels *kernels;
  atomic_int_fast64_t contested;
  atomic_bool added;
} vote_job;

static void count_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  vote_job *job = payload;
  size_t begin = vxm_slice_begin(job->word_count, job->slices, slice);
  size_t end = vxm_slice_begin(job->word_count, job->slices, slice + 1);
  const uint64_t *voters[4];
  for (int v = 0; v < 4; v++)
    voters[v] = job->voters[v] ? job->voters[v] + begin : NULL;
  uint64_t added = 0;
  int64_t contested = job->kernels->vote(job->out + begin, voters, NULL, job->mask ? job->mask + begin : NULL,
                                         end - begin, job->rule, false, false, &added);
  atomic_fetch_add_explicit(&job->contested, contested, memory_order_relaxed);
  if (added)
    atomic_store_explicit(&job->added, true, memory_order_relaxed);
}

void vxm_vote_count(uint64_t *out, const uint64_t *const voters[4], uint64_t *mask, size_t word_count,
                    vxm_vote rule, vxm_context *context, vxm_vote_tally *tally) {
  vote_job job = {.out = out,
                  .mask = mask,
                  .voters = voters,
                  .word_count = word_count,
                  .slices = 1 + word_count / SLICE_WORDS,
                  .rule = rule,
                  .kernels = vxm_kernels_get()};
  atomic_init(&job.contested, 0);
  atomic_init(&job.added, false);
  vxm_parallel(context, job.slices, count_slice, &job);
  tally->contested += atomic_load(&job.contested);
  tally->added |= atomic_load(&job.added);
}

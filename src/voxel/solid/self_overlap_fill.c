/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/solid/self_overlap_fill.h"
#include "base/threads.h"
#include "voxel/solid/outside_parts.h"

typedef struct union_job {
  const vxm_window *window, *other;
  atomic_bool added;
} union_job;

static void unite_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  union_job *job = payload;
  uint64_t *words = job->window->words + slice * job->window->slice_words;
  const uint64_t *more = job->other->words + slice * job->other->slice_words;
  size_t count = job->window->row_words * (size_t)job->window->middle_dim;
  uint64_t added = 0;
  for (size_t w = 0; w < count; w++) {
    added |= more[w] & ~words[w];
    words[w] |= more[w];
  }
  if (added)
    atomic_store_explicit(&job->added, true, memory_order_relaxed);
}

vxm_status vxm_self_overlap_place(vxm_voxel_pass *pass, int axis, vxm_error *error) {
  if (pass->overlap_placed)
    return VXM_OK;
  vxm_status status = vxm_chain_winding_place(&pass->overlap_winding, &pass->analysis->self_overlap.chain,
                                              &pass->placed, axis, pass->mirrored, error);
  pass->overlap_placed = status == VXM_OK;
  return status;
}

void vxm_self_overlap_note(vxm_voxel_pass *pass) {
  const vxm_self_overlap *overlap = &pass->analysis->self_overlap;
  for (size_t i = 0; i < overlap->part_count && pass->has_voxels; i++)
    if (!vxm_part_is_outside(pass, overlap->part[i]))
      atomic_store_explicit(&pass->has_voxels[overlap->part[i]], 1, memory_order_relaxed);
}

vxm_status vxm_self_overlap_fill(vxm_voxel_pass *pass, const vxm_window *window, vxm_error *error) {
  if (!vxm_overlaps_wanted(pass->analysis, &pass->options))
    return VXM_OK;
  vxm_chain_winding *wound = &pass->overlap_winding;
  vxm_status status = vxm_self_overlap_place(pass, window->layout.fast, error);
  if (status == VXM_OK)
    status = vxm_chain_winding_fill(wound, pass->workspace, &pass->placed, window, false, error);
  union_job job = {.window = window, .other = &wound->window};
  if (status == VXM_OK)
    status = vxm_parallel_cancellable(pass->context, (size_t)(window->end - window->begin), unite_slice, &job,
                                      error);
  if (job.added)
    vxm_self_overlap_note(pass);
  return status;
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/added_voxels.h"
#include "base/threads.h"

/** What the threads work on. */
typedef struct stage {
  const vxm_added_voxels *to;
  const vxm_thin_job *job;
  vxm_meeting_slabs *slabs;
  vxm_thin_stage now;
} stage;

/** The coordinates of a voxel side by side. */
static uint64_t pack(const int64_t voxel[3]) {
  return (uint64_t)(voxel[0] | voxel[1] << VXM_VIEW_AXIS_BITS | voxel[2] << 2 * VXM_VIEW_AXIS_BITS);
}

static void unpack(int64_t voxel[3], uint64_t packed) {
  for (int a = 0; a < 3; a++)
    voxel[a] = (int64_t)(packed >> VXM_VIEW_AXIS_BITS * a & ((UINT64_C(1) << VXM_VIEW_AXIS_BITS) - 1));
}

/** Chooses for each link, square or cube of a slab that belongs to the stage. */
static void choose(size_t number, int worker, void *payload) {
  (void)worker;
  const stage *s = payload;
  vxm_meeting_slab *slab = &s->slabs->slabs[number];
  vxm_meeting *meetings = slab->meetings;
  size_t chosen = slab->begin = slab->end, m = chosen;
  for (size_t next; m < slab->count && vxm_dual_stage(meetings[m].element) == s->now; m = next) {
    int64_t voxel[3];
    for (next = m + 1; next < slab->count && meetings[next].element == meetings[m].element; next++)
      ;
    if (vxm_dual_choose(&s->job->view, meetings + m, next - m, voxel))
      meetings[chosen++].element = pack(voxel); /* which has been looked at */
  }
  slab->chosen = chosen - slab->begin;
  slab->end = m;
}

/** Sets a voxel; returns whether it was not set before. @param alone whether no other thread does that */
static bool set_bit(const vxm_view *view, int64_t bit, bool alone) {
  const uint64_t mask = UINT64_C(1) << ((uint64_t)bit % 64);
  uint64_t *word = &view->words[(uint64_t)bit / 64], before;
  if (alone) {
    before = *word;
    *word = before | mask;
  } else
    before = __atomic_fetch_or(word, mask, __ATOMIC_RELAXED);
  return !(before & mask);
}

/** Notes a voxel that has been added; returns whether it counts. */
static bool note_added(const stage *s, const int64_t voxel[3]) {
  const vxm_thin_job *job = s->job;
  const int64_t *dims = job->placed->lattice.space.dims;
  if (voxel[job->slow] < job->counted[0] || voxel[job->slow] >= job->counted[1])
    return false; /* slices around are not right */
  if (s->to->confidence)
    s->to->confidence[(voxel[2] * dims[1] + voxel[1]) * dims[0] + voxel[0]] = 255;
  return true;
}

/** Sets what has been chosen in a slab. */
static void set_words(size_t number, int worker, void *payload) {
  (void)worker;
  const stage *s = payload;
  vxm_meeting_slab *slab = &s->slabs->slabs[number];
  const vxm_view *view = &s->job->view;
  const bool alone = s->slabs->count == 1;
  int64_t added = 0;
  for (size_t c = 0; c < slab->chosen; c++) {
    int64_t voxel[3];
    unpack(voxel, slab->meetings[slab->begin + c].element);
    if (set_bit(view, vxm_view_bit(view, voxel), alone))
      added += note_added(s, voxel);
  }
  slab->added += added;
}

/** Puts what has been chosen in a slab into a set. */
static vxm_status put_in_set(const stage *s, vxm_meeting_slab *slab, vxm_error *error) {
  const vxm_view *view = &s->job->view;
  vxm_status status = VXM_OK;
  for (size_t c = 0; c < slab->chosen && status == VXM_OK; c++) {
    int64_t voxel[3];
    unpack(voxel, slab->meetings[slab->begin + c].element);
    if (vxm_view_set(view, voxel))
      continue;
    status = vxm_voxel_set_add(s->to->set, (uint64_t)vxm_view_bit(view, voxel), error);
    slab->added += note_added(s, voxel);
    if (status == VXM_OK)
      status = vxm_check_cancelled_at(c + 1, s->slabs->context, error);
  }
  return status;
}

static vxm_status add_stage(stage *s, vxm_error *error) {
  vxm_meeting_slabs *slabs = s->slabs;
  vxm_status status = vxm_parallel_cancellable(slabs->context, slabs->count, choose, s, error);
  if (status == VXM_OK && !s->to->set)
    return vxm_parallel_cancellable(slabs->context, slabs->count, set_words, s, error);
  for (size_t i = 0; i < slabs->count && status == VXM_OK; i++)
    status = put_in_set(s, &slabs->slabs[i], error);
  return status;
}

/** The next stage that something belongs to; false if there is none. */
static bool next_stage(stage *s) {
  bool any = false;
  for (size_t i = 0; i < s->slabs->count; i++) {
    const vxm_meeting_slab *slab = &s->slabs->slabs[i];
    if (slab->end == slab->count)
      continue;
    vxm_thin_stage own = vxm_dual_stage(slab->meetings[slab->end].element);
    s->now = any && s->now < own ? s->now : own;
    any = true;
  }
  return any;
}

vxm_status vxm_add_voxels(const vxm_added_voxels *to, const vxm_thin_job *job, vxm_meeting_slabs *slabs,
                          int64_t *added, vxm_error *error) {
  stage s = {to, job, slabs, VXM_THIN_DOMINANT_LINKS};
  vxm_status status = VXM_OK;
  while (status == VXM_OK && next_stage(&s))
    status = add_stage(&s, error);
  for (size_t i = 0; i < slabs->count; i++)
    *added += slabs->slabs[i].added;
  return status;
}

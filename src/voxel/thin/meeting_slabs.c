/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/meeting_slabs.h"
#include "base/bits.h"
#include "base/threads.h"
#include "voxel/thin/meeting_sort.h"

#include <string.h>

typedef struct sorting {
  vxm_meeting_slabs *slabs;
  const vxm_meetings *found;
  int threads;     /**< that have found some */
  size_t workers;  /**< that sort */
  uint64_t lowest; /**< of the numbers of cells' voxels */
  unsigned shift;  /**< of such a number, counted from the lowest, to that of its slab */
  size_t total;
  const vxm_meetings *all; /**< of a thread that has found all; NULL = there is none */
  size_t largest;          /**< slab */
} sorting;

static uint64_t voxel_of(const vxm_meeting *m) {
  return m->element & vxm_low_bits(VXM_DUAL_VOXEL_BITS);
}

static size_t slab_number(const sorting *s, const vxm_meeting *m) {
  return (size_t)((voxel_of(m) - s->lowest) >> s->shift);
}

/** Equal ranges of cells, from the first to the last that is met. */
static void choose_ranges(sorting *s) {
  uint64_t low = UINT64_MAX, high = 0;
  for (int w = 0; w < s->threads; w++)
    for (size_t m = 0; m < s->found[w].count; m++) {
      const uint64_t voxel = voxel_of(&s->found[w].list[m]);
      low = voxel < low ? voxel : low;
      high = voxel > high ? voxel : high;
    }
  s->lowest = low;
  for (s->shift = 0; (high - low) >> s->shift >= VXM_MEETING_SLABS;)
    s->shift++;
}

static void count_list(size_t list, int worker, void *payload) {
  (void)worker;
  const sorting *s = payload;
  size_t *counts = s->slabs->starts[list];
  memset(counts, 0, sizeof *s->slabs->starts);
  for (size_t m = 0; m < s->found[list].count; m++)
    counts[slab_number(s, &s->found[list].list[m])]++;
}

/** From counts to places: slab after slab, in each the lists one after the other. */
static void place_slabs(sorting *s) {
  size_t at = 0;
  for (size_t i = 0; i < VXM_MEETING_SLABS; i++) {
    size_t begin = at;
    for (int w = 0; w < s->threads; w++) {
      size_t count = s->slabs->starts[w][i];
      s->slabs->starts[w][i] = at;
      at += count;
    }
    s->slabs->slabs[i] = (vxm_meeting_slab){.meetings = s->slabs->room + begin, .count = at - begin};
    s->largest = at - begin > s->largest ? at - begin : s->largest;
  }
  s->slabs->count = VXM_MEETING_SLABS;
}

static void distribute_list(size_t list, int worker, void *payload) {
  (void)worker;
  const sorting *s = payload;
  size_t *at = s->slabs->starts[list];
  for (size_t m = 0; m < s->found[list].count; m++) {
    const vxm_meeting *one = &s->found[list].list[m];
    s->slabs->room[at[slab_number(s, one)]++] = *one;
  }
}

static void sort_slab(size_t number, int worker, void *payload) {
  const sorting *s = payload;
  vxm_meeting_slab *slab = &s->slabs->slabs[number];
  vxm_meeting *scratch = s->slabs->scratch + (size_t)worker * s->largest;
  if (vxm_meetings_sort(slab->meetings, scratch, slab->count) == scratch && slab->count > 0)
    memcpy(slab->meetings, scratch, slab->count * sizeof *scratch);
}

/** Room for so many, and a quarter more, not to grow for each that is a little larger. */
static vxm_status make_room(vxm_context *context, vxm_meeting **room, size_t *capacity, size_t count,
                            vxm_error *error) {
  return count <= *capacity
             ? VXM_OK
             : vxm_renew(context, (void **)room, capacity, count + count / 4, sizeof **room, error);
}

/** A slab for each of some ranges of cells. */
static vxm_status sort_many(sorting *s, vxm_error *error) {
  vxm_meeting_slabs *slabs = s->slabs;
  vxm_context *context = slabs->context;
  const size_t threads = (size_t)s->threads;
  choose_ranges(s);
  vxm_status status = make_room(context, &slabs->room, &slabs->capacity, s->total, error);
  if (status == VXM_OK)
    status = vxm_renew(context, (void **)&slabs->starts, &slabs->starts_capacity, threads,
                       sizeof *slabs->starts, error);
  if (status == VXM_OK)
    status = vxm_parallel_cancellable(context, threads, count_list, s, error);
  if (status != VXM_OK)
    return status;
  place_slabs(s);
  status = make_room(context, &slabs->scratch, &slabs->scratch_capacity, s->workers * s->largest, error);
  if (status == VXM_OK)
    status = vxm_parallel_cancellable(context, threads, distribute_list, s, error);
  return status == VXM_OK ? vxm_parallel_cancellable(context, VXM_MEETING_SLABS, sort_slab, s, error)
                          : status;
}

/** All in one slab. The list of a thread that has found all stays where it is. */
static vxm_status sort_one(const sorting *s, vxm_error *error) {
  vxm_meeting_slabs *slabs = s->slabs;
  vxm_status status =
      make_room(slabs->context, &slabs->room, &slabs->capacity, s->all ? s->total : 2 * s->total, error);
  if (status != VXM_OK)
    return status;
  vxm_meeting *from = s->all ? s->all->list : slabs->room, *to = slabs->room + (s->all ? 0 : s->total);
  size_t at = 0;
  for (int w = 0; w < s->threads && !s->all; w++) {
    if (s->found[w].count > 0)
      memcpy(from + at, s->found[w].list, s->found[w].count * sizeof *from);
    at += s->found[w].count;
  }
  slabs->slabs[0] = (vxm_meeting_slab){.meetings = vxm_meetings_sort(from, to, s->total), .count = s->total};
  slabs->count = 1;
  return VXM_OK;
}

vxm_status vxm_meeting_slabs_sort(vxm_meeting_slabs *slabs, const vxm_meetings *found, int threads,
                                  vxm_error *error) {
  const int workers = vxm_context_threads(slabs->context);
  /* Fewer are sorted sooner than taken apart; one thread gains where they do not stay in the cache. */
  const size_t many = workers > 1 ? 1 << 13 : 1 << 17;
  sorting s = {.slabs = slabs, .found = found, .threads = threads, .workers = (size_t)workers};
  slabs->count = 0;
  for (int w = 0; w < threads; w++) {
    if (found[w].error.code != VXM_OK) {
      vxm_error_pass(error, &found[w].error);
      return found[w].error.code;
    }
    s.total += found[w].count;
  }
  for (int w = 0; w < threads; w++)
    s.all = found[w].count == s.total ? &found[w] : s.all;
  if (s.total == 0)
    return VXM_OK;
  return s.total < many ? sort_one(&s, error) : sort_many(&s, error);
}

void vxm_meeting_slabs_destroy(vxm_meeting_slabs *slabs) {
  vxm_free(slabs->context, slabs->room);
  vxm_free(slabs->context, slabs->scratch);
  vxm_free(slabs->context, slabs->starts);
  *slabs = (vxm_meeting_slabs){.context = slabs->context};
}

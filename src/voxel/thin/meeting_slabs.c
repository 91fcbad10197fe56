/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/meeting_slabs.h"
#include "base/bits.h"
#include "base/threads.h"
#include "voxel/thin/meeting_sort.h"

#include <string.h>

typedef struct sorting {
  vxm_meeting_slabs *slabs;
  const vxm_meetings *found;
  int threads;
  uint64_t lowest; /**< of the numbers of cells' voxels */
  unsigned shift;  /**< of such a number, counted from the lowest, to that of its slab */
  size_t total;
  vxm_meeting *other; /**< room beside that of the slabs */
} sorting;

static uint64_t voxel_of(const vxm_meeting *m) {
  return m->cell & vxm_low_bits(VXM_CELL_VOXEL_BITS);
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
static void place_slabs(const sorting *s) {
  size_t at = 0;
  for (size_t i = 0; i < VXM_MEETING_SLABS; i++) {
    size_t begin = at;
    for (int w = 0; w < s->threads; w++) {
      size_t count = s->slabs->starts[w][i];
      s->slabs->starts[w][i] = at;
      at += count;
    }
    s->slabs->slabs[i] = (vxm_meeting_slab){.meetings = s->slabs->room + begin, .count = at - begin};
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
  (void)worker;
  const sorting *s = payload;
  vxm_meeting_slab *slab = &s->slabs->slabs[number];
  slab->meetings =
      vxm_meetings_sort(slab->meetings, s->other + (slab->meetings - s->slabs->room), slab->count);
}

/** A slab for each of some ranges of cells. */
static vxm_status sort_many(sorting *s, vxm_error *error) {
  vxm_meeting_slabs *slabs = s->slabs;
  const size_t threads = (size_t)s->threads;
  choose_ranges(s);
  vxm_status status = vxm_renew(slabs->context, (void **)&slabs->starts, &slabs->starts_room, threads,
                                sizeof *slabs->starts, error);
  if (status == VXM_OK)
    status = vxm_parallel_asked(slabs->context, threads, count_list, s, error);
  if (status != VXM_OK)
    return status;
  place_slabs(s);
  status = vxm_parallel_asked(slabs->context, threads, distribute_list, s, error);
  return status == VXM_OK ? vxm_parallel_asked(slabs->context, VXM_MEETING_SLABS, sort_slab, s, error)
                          : status;
}

/** All in one slab; `all` is the list of a thread that found all, or NULL. */
static void sort_one(const sorting *s, const vxm_meetings *all) {
  vxm_meeting_slabs *slabs = s->slabs;
  size_t at = 0;
  for (int w = 0; w < s->threads && !all; w++) {
    if (s->found[w].count > 0)
      memcpy(slabs->room + at, s->found[w].list, s->found[w].count * sizeof *slabs->room);
    at += s->found[w].count;
  }
  vxm_meeting *from = all ? all->list : slabs->room, *to = all ? slabs->room : s->other;
  slabs->slabs[0] = (vxm_meeting_slab){.meetings = vxm_meetings_sort(from, to, s->total), .count = s->total};
  slabs->count = 1;
}

/** Room for all meetings once more, or twice unless one thread has found `all`. */
static vxm_status make_room(sorting *s, const vxm_meetings *all, vxm_error *error) {
  vxm_meeting_slabs *slabs = s->slabs;
  size_t room = all ? s->total : 2 * s->total;
  vxm_status status = VXM_OK;
  if (room > slabs->capacity) /* a quarter more, not to grow for each that is a little larger */
    status = vxm_renew(slabs->context, (void **)&slabs->room, &slabs->capacity, room + room / 4,
                       sizeof *slabs->room, error);
  s->other = all ? all->list : slabs->room + s->total; /* a list is free once it has been distributed */
  return status;
}

vxm_status vxm_meeting_slabs_sort(vxm_meeting_slabs *slabs, const vxm_meetings *found, int threads,
                                  vxm_error *error) {
  /* Fewer are sorted sooner than taken apart; one thread gains where they do not stay in the cache. */
  const size_t many = vxm_context_threads(slabs->context) > 1 ? 1 << 13 : 1 << 17;
  sorting s = {.slabs = slabs, .found = found, .threads = threads};
  const vxm_meetings *all = NULL;
  slabs->count = 0;
  for (int w = 0; w < threads; w++) {
    if (found[w].error.code != VXM_OK) {
      vxm_error_pass(error, &found[w].error);
      return found[w].error.code;
    }
    s.total += found[w].count;
  }
  if (s.total == 0)
    return VXM_OK;
  for (int w = 0; w < threads; w++)
    all = found[w].count == s.total ? &found[w] : all;
  vxm_status status = make_room(&s, all, error);
  if (status == VXM_OK && s.total >= many)
    return sort_many(&s, error);
  if (status == VXM_OK)
    sort_one(&s, all);
  return status;
}

void vxm_meeting_slabs_destroy(vxm_meeting_slabs *slabs) {
  vxm_free(slabs->context, slabs->room);
  vxm_free(slabs->context, slabs->starts);
  *slabs = (vxm_meeting_slabs){.context = slabs->context};
}

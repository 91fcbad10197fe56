/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/meeting_slabs.h"
#include "base/bits.h"
#include "base/threads.h"
#include "voxel/thin/meeting_sort.h"

#include <string.h>

typedef struct sorting {
  vxm_meeting_slabs *slabs;
  const vxm_meetings *found;
  unsigned shift; /**< of the number of a cell's voxel, to that of its slab */
  size_t total;
} sorting;

static size_t slab_number(const sorting *s, const vxm_meeting *m) {
  return (size_t)((m->cell & vxm_low_bits(VXM_CELL_VOXEL_BITS)) >> s->shift);
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
static void place_slabs(const sorting *s, int threads) {
  size_t at = 0;
  for (size_t i = 0; i < VXM_MEETING_SLABS; i++) {
    size_t begin = at;
    for (int w = 0; w < threads; w++) {
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
  slab->meetings = vxm_meetings_sort(slab->meetings, slab->meetings + s->total, slab->count);
}

/** A slab for each of some ranges of cells. */
static vxm_status sort_many(sorting *s, int threads, const vxm_view *view, vxm_error *error) {
  vxm_meeting_slabs *slabs = s->slabs;
  uint64_t cells = 1;
  for (int a = 0; a < 3; a++)
    cells *= (uint64_t)(view->end[a] - view->begin[a] + 2);
  for (s->shift = 0; (cells - 1) >> s->shift >= VXM_MEETING_SLABS;)
    s->shift++;
  vxm_status status = vxm_renew(slabs->context, (void **)&slabs->starts, &slabs->starts_room, (size_t)threads,
                                sizeof *slabs->starts, error);
  if (status == VXM_OK)
    status = vxm_parallel_asked(slabs->context, (size_t)threads, count_list, s, error);
  if (status != VXM_OK)
    return status;
  place_slabs(s, threads);
  status = vxm_parallel_asked(slabs->context, (size_t)threads, distribute_list, s, error);
  return status == VXM_OK ? vxm_parallel_asked(slabs->context, VXM_MEETING_SLABS, sort_slab, s, error)
                          : status;
}

/** All in one slab. The list of a thread that found all stays where it is. */
static void sort_one(vxm_meeting_slabs *slabs, const vxm_meetings *found, int threads, size_t total) {
  vxm_meeting *from = slabs->room, *to = slabs->room;
  size_t at = 0;
  for (int w = 0; w < threads; w++) {
    if (found[w].count == total)
      from = found[w].list;
    else if (found[w].count > 0)
      memcpy(slabs->room + at, found[w].list, found[w].count * sizeof *found[w].list);
    at += found[w].count;
  }
  to += from == slabs->room ? total : 0;
  slabs->slabs[0] = (vxm_meeting_slab){.meetings = vxm_meetings_sort(from, to, total), .count = total};
  slabs->count = 1;
}

vxm_status vxm_meeting_slabs_sort(vxm_meeting_slabs *slabs, vxm_meetings *found, int threads,
                                  const vxm_view *view, vxm_error *error) {
  /* Fewer are sorted sooner than taken apart; one thread gains where they do not stay in the cache. */
  const size_t many = vxm_context_threads(slabs->context) > 1 ? 1 << 13 : 1 << 17;
  sorting s = {.slabs = slabs, .found = found};
  bool is_one = false;
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
  for (int w = 0; w < threads && s.total < many; w++)
    is_one |= found[w].count == s.total;
  size_t room = is_one ? s.total : 2 * s.total;
  if (room > slabs->capacity) { /* a quarter more, not to grow for each that is a little larger */
    vxm_status status = vxm_renew(slabs->context, (void **)&slabs->room, &slabs->capacity, room + room / 4,
                                  sizeof *slabs->room, error);
    if (status != VXM_OK)
      return status;
  }
  if (s.total >= many)
    return sort_many(&s, threads, view, error);
  sort_one(slabs, found, threads, s.total);
  return VXM_OK;
}

void vxm_meeting_slabs_destroy(vxm_meeting_slabs *slabs) {
  vxm_free(slabs->context, slabs->room);
  vxm_free(slabs->context, slabs->starts);
  *slabs = (vxm_meeting_slabs){.context = slabs->context};
}

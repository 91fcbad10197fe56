/* SPDX-License-Identifier: BSD-3-Clause */
/** Meetings are sorted by stage, with those of a cell side by side, whatever the number of them and of the
 * threads that found them. */
#include "engine.h"

#include "../base/rounds.h"
#include "voxel/thin/meeting_slabs.h"
#include "voxel/thin/meeting_sort.h"

#include <stdlib.h>

/** A meeting of some link or square in a space of `side` voxels a side. */
static vxm_meeting random_meeting(vxm_rng *rng, const vxm_view *view, int64_t side, uint32_t number) {
  int kind = (int)vxm_rng_below(rng, 10);
  int64_t lowest[3];
  for (int a = 0; a < 3; a++)
    lowest[a] = (int64_t)vxm_rng_below(rng, (uint32_t)side + 1) - 1;
  vxm_meeting m = {.offset = {(int32_t)number, 0, 0}};
  if (kind < 7)
    m.element = vxm_dual_number(view, VXM_THIN_DOMINANT_LINKS, kind % 3, lowest);
  else if (kind < 9)
    m.element = vxm_dual_number(view, VXM_THIN_LINKS, kind % 3, lowest);
  else
    m.element = vxm_dual_number(view, VXM_THIN_SQUARES, VXM_DUAL_SQUARE + (int)vxm_rng_below(rng, 3), lowest);
  return m;
}

static int by_number(const void *a, const void *b) {
  const vxm_meeting *p = a, *q = b;
  return (p->offset[0] > q->offset[0]) - (p->offset[0] < q->offset[0]);
}

static int by_cell(const void *a, const void *b) {
  uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
  return (p > q) - (p < q);
}

/** Fails unless stages follow one another, and those of a cell. */
static void check_order(const vxm_meeting *meetings, size_t count) {
  uint64_t *cells = calloc(count + 1, sizeof *cells);
  size_t runs = 0;
  assert_non_null(cells);
  for (size_t m = 0; m < count; m++) {
    bool same = m > 0 && meetings[m].element == meetings[m - 1].element;
    if (m > 0)
      assert_true(vxm_dual_stage(meetings[m - 1].element) <= vxm_dual_stage(meetings[m].element));
    if (!same)
      cells[runs++] = meetings[m].element;
  }
  qsort(cells, runs, sizeof *cells, by_cell);
  for (size_t r = 1; r < runs; r++)
    assert_true(cells[r - 1] != cells[r]); /* none comes twice */
  free(cells);
}

/** Fails unless these are the meetings 0, 1, ..., in any order, as they were made. */
static void check_same(vxm_meeting *meetings, const vxm_meeting *made, size_t count) {
  qsort(meetings, count, sizeof *meetings, by_number);
  for (size_t m = 0; m < count; m++) {
    assert_int_equal(meetings[m].offset[0], made[m].offset[0]);
    assert_true(meetings[m].element == made[m].element);
  }
}

static vxm_view view_of(int64_t side) {
  vxm_view view = {.axis = {0, 1, 2}, .end = {side, side, side}};
  return view;
}

static vxm_meeting *make_meetings(vxm_rng *rng, const vxm_view *view, int64_t side, size_t count) {
  vxm_meeting *made = calloc(count + 1, sizeof *made);
  assert_non_null(made);
  for (size_t m = 0; m < count; m++)
    made[m] = random_meeting(rng, view, side, (uint32_t)m);
  return made;
}

static void test_sort(void **state) {
  (void)state;
  vxm_rng rng = {611};
  static const size_t counts[] = {0, 1, 2, 31, 33, 100, 1023, 1024, 1500, 5000, 40000};
  static const int64_t sides[] = {1, 3, 9, 40, 1000, 100000};
  for (int round = 0; round < ROUNDS(110); round++) {
    const size_t count = counts[round % 11];
    const int64_t side = sides[round % 6];
    const vxm_view view = view_of(side);
    vxm_meeting *made = make_meetings(&rng, &view, side, count), *from = calloc(count + 1, sizeof *from),
                *to = calloc(count + 1, sizeof *to);
    assert_true(from && to);
    memcpy(from, made, count * sizeof *made);
    vxm_meeting *sorted = vxm_meetings_sort(from, to, count);
    check_order(sorted, count);
    check_same(sorted, made, count);
    free(made);
    free(from);
    free(to);
  }
}

/** What threads have found, one list of theirs empty now and then: all is in one slab or another, and a cell
 * in one alone. */
static void check_slabs(vxm_context *own, int threads, size_t count, int64_t side, uint64_t seed) {
  vxm_rng rng = {seed};
  vxm_error error = VXM_ERROR_INIT;
  const vxm_view view = view_of(side);
  vxm_meeting *made = make_meetings(&rng, &view, side, count), *all = calloc(count + 1, sizeof *all);
  vxm_meetings *found = calloc((size_t)threads, sizeof *found);
  assert_true(all && found);
  bool is_one = seed % 3 == 0;
  for (int w = 0; w < threads; w++)
    found[w] = (vxm_meetings){.context = own, .list = calloc(count + 1, sizeof *all)};
  for (size_t m = 0; m < count; m++) {
    vxm_meetings *to = &found[is_one ? threads - 1 : (int)vxm_rng_below(&rng, (uint32_t)threads)];
    to->list[to->count++] = made[m];
  }
  vxm_meeting_slabs slabs = {.context = own};
  assert_int_equal(vxm_meeting_slabs_sort(&slabs, found, threads, &error), VXM_OK);
  assert_int_equal(slabs.count, count == 0                                  ? 0
                                : count < (threads > 1 ? 1 << 13 : 1 << 17) ? 1
                                                                            : VXM_MEETING_SLABS);
  size_t at = 0;
  uint64_t last = 0;
  for (size_t i = 0; i < slabs.count; i++) {
    const vxm_meeting_slab *slab = &slabs.slabs[i];
    uint64_t least = UINT64_MAX, most = 0;
    check_order(slab->meetings, slab->count);
    for (size_t m = 0; m < slab->count; m++) {
      const uint64_t voxel = slab->meetings[m].element & ((UINT64_C(1) << VXM_DUAL_VOXEL_BITS) - 1);
      least = voxel < least ? voxel : least;
      most = voxel > most ? voxel : most;
      assert_true(at < count);
      all[at++] = slab->meetings[m];
    }
    if (slab->count > 0) {
      assert_true(i == 0 || least >= last);
      last = most + 1;
    }
  }
  assert_int_equal(at, count);
  check_same(all, made, count);
  vxm_meeting_slabs_destroy(&slabs);
  for (int w = 0; w < threads; w++)
    free(found[w].list);
  free(found);
  free(all);
  free(made);
}

static void test_slabs(void **state) {
  (void)state;
  for (int threads = 1; threads <= 3; threads++) {
    vxm_context *own = context_of(threads, 0);
    uint64_t seed = 0;
    static const size_t counts[] = {0, 1, 40, 3000, (1 << 13) - 1, 1 << 13, 20000};
    for (size_t c = 0; c < sizeof counts / sizeof *counts; c++)
      for (int round = 0; round < 3; round++)
        check_slabs(own, threads, counts[c], round == 0 ? 12 : 300, seed++);
    check_slabs(own, threads, (1 << 17) + 5, 200, seed);
    vxm_context_destroy(own);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_sort),
      cmocka_unit_test(test_slabs),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}

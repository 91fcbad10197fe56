/* SPDX-License-Identifier: BSD-3-Clause */
/** Triangles in order are those there were, and the range of some slices has all that reach into these: each
 * triangle is compared with each slice. */
#include "shapes.h"

#include "voxel/parity/triangle_order.h"

#include <stdlib.h>
#include <string.h>

/** Loose triangles about the space and outside of it, most of them small. */
static vxm_soup *random_soup(vxm_rng *rng, const int64_t dims[3], size_t count) {
  vxm_soup *soup = shape_empty(context);
  for (size_t f = 0; f < count; f++) {
    int64_t size = vxm_rng_below(rng, 50) ? 30 : dims[2];
    uint32_t v[3];
    double at[3], corner[3];
    for (int a = 0; a < 3; a++)
      at[a] = (double)vxm_rng_below(rng, (uint64_t)dims[a] + 40) - 20;
    for (int k = 0; k < 3; k++) {
      for (int a = 0; a < 3; a++)
        corner[a] = at[a] + (double)vxm_rng_below(rng, (uint64_t)size * 4) / 4;
      v[k] = shape_vertex(soup, corner[0], corner[1], corner[2]);
    }
    shape_triangle(soup, v[0], v[1], v[2]);
  }
  return soup;
}

static int compare(const void *a, const void *b) {
  return memcmp(a, b, 3 * sizeof(uint32_t));
}

/** The faces of each part are the same, and all else is in its place. */
static void check_triangles(const vxm_triangle_set *want, const vxm_triangle_set *got) {
  size_t bytes = want->triangle_count * sizeof *want->corners;
  uint32_t(*a)[3] = malloc(bytes), (*b)[3] = malloc(bytes);
  assert_true(a && b);
  memcpy(a, want->corners, bytes);
  memcpy(b, got->corners, bytes);
  for (size_t p = 0; p < want->split.part_count; p++) {
    const vxm_part *part = &want->parts[p];
    qsort(a + part->begin, part->caps - part->begin, sizeof *a, compare);
    qsort(b + part->begin, part->caps - part->begin, sizeof *b, compare);
  }
  assert_memory_equal(a, b, bytes);
  free(a);
  free(b);
}

/** Whether a triangle has a point beyond the centre of slice `begin` and one before that of `end` - 1. */
static bool reaches(const vxm_snapped_points *placed, const uint32_t corner[3], int64_t begin, int64_t end) {
  const int64_t unit = placed->lattice.unit;
  bool beyond = false, before = false;
  for (int k = 0; k < 3; k++) {
    int64_t z = vxm_snapped_points_at(placed, corner[k]).at[2];
    beyond |= z >= begin * unit + unit / 2;
    before |= z <= (end - 1) * unit + unit / 2;
  }
  return beyond && before;
}

static void check_slices(const vxm_triangle_order *order, const vxm_snapped_points *placed, vxm_rng *rng) {
  const int64_t deep = placed->lattice.space.dims[2];
  for (int round = 0; round < 60; round++) {
    int64_t begin = (int64_t)vxm_rng_below(rng, (uint64_t)deep);
    int64_t end = begin + 1 + (int64_t)vxm_rng_below(rng, round % 2 ? 40 : (uint64_t)(deep - begin));
    size_t first, last;
    end = vxm_min(end, deep);
    vxm_triangle_order_slices(order, begin, end, &first, &last);
    assert_true(first <= last && last <= order->set.parts[0].caps);
    for (size_t t = order->set.parts[0].begin; t < order->set.parts[0].caps; t++)
      if (t < first || t >= last)
        assert_false(reaches(placed, order->set.corners[t], begin, end));
  }
}

/** Of the whole range of slices few triangles are left for a few of them, where no large one is there. */
static void test_ranges_are_short(void **state) {
  (void)state;
  const vxm_split_rule rule = {VXM_SPLIT_MODE_WHOLE, VXM_CAVITIES_FILL, false};
  vxm_rng rng = {41};
  vxm_soup *soup = shape_empty(context);
  for (int f = 0; f < 3000; f++) {
    double x = (double)vxm_rng_below(&rng, 2000), y = (double)vxm_rng_below(&rng, 2000),
           z = (double)vxm_rng_below(&rng, 2000);
    uint32_t v = shape_vertex(soup, x, y, z);
    shape_vertex(soup, x + 9, y, z + 4);
    shape_vertex(soup, x, y + 9, z + 9);
    shape_triangle(soup, v, v + 1, v + 2);
  }
  vxm_triangle_set triangles;
  vxm_snapped_points placed = {.context = context};
  vxm_triangle_order order;
  const vxm_space space = {{2048, 2048, 2048}, {0, 0, 0}, {1, 1, 1}};
  vxm_lattice lattice = vxm_lattice_of(&space);
  assert_int_equal(vxm_triangle_set_create(&triangles, soup, rule, NULL), VXM_OK);
  assert_int_equal(vxm_snapped_points_set(&placed, &triangles, &lattice, NULL, false, NULL), VXM_OK);
  vxm_triangle_order_make(&order, context, &triangles, &placed);
  assert_non_null(order.corners);
  size_t first, last;
  vxm_triangle_order_slices(&order, 1024, 1024 + 128, &first, &last);
  assert_true(last - first < 3000 / 6);
  vxm_triangle_order_destroy(&order);
  vxm_snapped_points_destroy(&placed);
  vxm_triangle_set_destroy(&triangles);
  vxm_soup_destroy(soup);
}

static void test_slices_have_their_triangles(void **state) {
  (void)state;
  const int64_t dims[][3] = {{100, 100, 100}, {300, 200, 4096}, {70, 9000, 1000}, {64, 64, 100000}};
  vxm_rng rng = {40};
  for (size_t d = 0; d < sizeof dims / sizeof *dims; d++)
    for (int round = 0; round < 6; round++) {
      const vxm_split_rule rule = {round % 2 ? VXM_SPLIT_MODE_WHOLE : VXM_SPLIT_MODE_GROUP, VXM_CAVITIES_FILL,
                                   false};
      vxm_soup *soup = random_soup(&rng, dims[d], 1 + vxm_rng_below(&rng, 600));
      vxm_triangle_set triangles;
      vxm_snapped_points placed = {.context = context};
      vxm_triangle_order order;
      vxm_space space = {{dims[d][0], dims[d][1], dims[d][2]}, {0, 0, 0}, {1, 1, 1}};
      vxm_lattice lattice = vxm_lattice_of(&space);
      assert_int_equal(vxm_triangle_set_create(&triangles, soup, rule, NULL), VXM_OK);
      assert_int_equal(vxm_snapped_points_set(&placed, &triangles, &lattice, NULL, true, NULL), VXM_OK);
      vxm_triangle_order_make(&order, context, &triangles, &placed);
      assert_non_null(order.corners);
      check_triangles(&triangles, &order.set);
      check_slices(&order, &placed, &rng);
      vxm_triangle_order_destroy(&order);
      vxm_snapped_points_destroy(&placed);
      vxm_triangle_set_destroy(&triangles);
      vxm_soup_destroy(soup);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_slices_have_their_triangles),
                                     cmocka_unit_test(test_ranges_are_short)};
  return cmocka_run_group_tests(tests, setup, teardown);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** Unions of hollow boxes that overlap, lie in each other and in each other's walls. */
#include "../base/rounds.h"
#include "../mesh/hollow_boxes.h"
#include "solids.h"

#include "repair_test.h"

static double cells_of(const assembly *a) {
  double cells = 0;
  int64_t at[3], side = 4 * (int64_t)a->count;
  for (at[2] = 0; at[2] < side; at[2]++)
    for (at[1] = 0; at[1] < side; at[1]++)
      for (at[0] = 0; at[0] < side; at[0]++)
        cells += is_solid(a, at);
  return cells;
}

static void check_walls(const assembly *a, uint64_t seed, vxm_rng *rng) {
  vxm_soup *soup = faces_of(context, a, false, rng), *out;
  vxm_union_report report;
  vxm_error error = VXM_ERROR_INIT;
  if (cgal->unite(&out, NULL, &report, soup, NULL, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_united(out);
  assert_int_equal(report.failed, 0);
  double volume = volume_of(out), wanted = cells_of(a);
  if (fabs(volume - wanted) > 1e-9 * wanted)
    fail_msg("seed %llu, %zu boxes: the volume is %g instead of %g", (unsigned long long)seed, a->count,
             volume, wanted);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

static void a_liner_in_a_vessel(void **state) {
  (void)state;
  vxm_rng rng = {1};
  const assembly a = liner_in_vessel();
  for (uint64_t round = 0; round < 24; round++)
    check_walls(&a, round, &rng);
}

static void nested(void **state) {
  (void)state;
  for (uint64_t seed = 1; seed <= ROUNDS(100); seed++) {
    vxm_rng rng = {seed};
    const assembly a = nested_boxes(2 + (size_t)vxm_rng_below(&rng, BODIES_MAX - 1), &rng);
    check_walls(&a, seed, &rng);
  }
}

static void overlapping(void **state) {
  (void)state;
  for (uint64_t seed = 1; seed <= ROUNDS(100); seed++) {
    vxm_rng rng = {seed};
    const assembly a = random_boxes(2 + (size_t)vxm_rng_below(&rng, 2), &rng);
    check_walls(&a, seed, &rng);
  }
}

static void voids_that_cut_through_rings(void **state) {
  (void)state;
  for (uint64_t seed = 1; seed <= ROUNDS(100); seed++) {
    vxm_rng rng = {seed};
    const assembly a = ring_in_void(&rng);
    check_walls(&a, seed, &rng);
  }
}

int main(void) {
  if (!open_cgal())
    return 77;
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_liner_in_a_vessel), cmocka_unit_test(nested),
                                     cmocka_unit_test(overlapping),
                                     cmocka_unit_test(voids_that_cut_through_rings)};
  return cmocka_run_group_tests(tests, hold_context, release_context);
}

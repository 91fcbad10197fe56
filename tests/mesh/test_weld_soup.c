/* SPDX-License-Identifier: BSD-3-Clause */
#include "soups.h"

#include "mesh/weld_soup.h"

#include <math.h>

/** Each vertex is the first of its position, by trying all before it. */
static void check(vxm_context *context, vxm_soup *soup) {
  vxm_soup *before;
  size_t merged, next = 0;
  assert_int_equal(vxm_soup_copy(&before, soup, NULL), VXM_OK);
  assert_int_equal(vxm_weld_soup(soup, &merged, NULL), VXM_OK);
  assert_ptr_equal(soup->context, context);
  uint32_t *number = malloc((before->vertex_count + 1) * sizeof *number);
  assert_non_null(number);
  for (size_t v = 0; v < before->vertex_count; v++) {
    size_t u = 0;
    while (u < v && memcmp(vxm_position(before, u), vxm_position(before, v), 3 * sizeof(double)) != 0)
      u++;
    number[v] = u < v ? number[u] : (uint32_t)next++;
    assert_memory_equal(vxm_position(soup, number[v]), vxm_position(before, v), 3 * sizeof(double));
  }
  assert_int_equal(soup->vertex_count, next);
  assert_int_equal(merged, before->vertex_count - next);
  assert_int_equal(soup->corner_count, before->corner_count);
  assert_int_equal(soup->face_count, before->face_count);
  for (size_t c = 0; c < soup->corner_count; c++)
    assert_int_equal(soup->indices[c], number[before->indices[c]]);
  free(number);
  vxm_soup_destroy(before);
}

static void equals_trying_all(void **state) {
  (void)state;
  vxm_rng rng = {3};
  vxm_context *context = context_of_threads(2);
  for (int round = 0; round < 300; round++) {
    vxm_soup *soup = random_soup(context, &rng, (size_t)vxm_rng_below(&rng, 60),
                                 (size_t)vxm_rng_below(&rng, 30), 1 + (unsigned)vxm_rng_below(&rng, 4), 5);
    check(context, soup);
    check(context, soup);      /* there is nothing left to do */
    add_vertex(soup, 1, 2, 3); /* it can still grow */
    add_vertex(soup, 1, 2, 3);
    check(context, soup);
    vxm_soup_destroy(soup);
  }
  vxm_context_destroy(context);
}

static void what_is_not_finite_stays(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(2);
  vxm_soup *soup = new_soup(context);
  for (int v = 0; v < 3; v++) {
    add_vertex(soup, 1, 1, 1);
    add_vertex(soup, 1, v == 1 ? -INFINITY : 1, 1);
  }
  size_t merged;
  assert_int_equal(vxm_weld_soup(soup, &merged, NULL), VXM_OK);
  assert_int_equal(merged, 0);
  assert_int_equal(soup->vertex_count, 6);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(equals_trying_all),
                                     cmocka_unit_test(what_is_not_finite_stays)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

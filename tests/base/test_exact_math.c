/* SPDX-License-Identifier: BSD-3-Clause */
/** Lengths and angles that are the same on every machine, against those of the C library with more bits. */
#include "base/exact_math.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/rng.h"

#include <float.h>

static double any_number(vxm_rng *rng, int most) {
  int exponent = (int)vxm_rng_below(rng, 2 * (uint64_t)most) - most;
  return ldexp(2 * vxm_rng_unit(rng) - 1, exponent);
}

static void check_near(double found, long double wanted, double units) {
  if (fabsl((long double)found - wanted) > units * DBL_EPSILON * fabsl(wanted))
    fail_msg("%a, and not %La", found, wanted);
}

static void test_lengths(void **state) {
  (void)state;
  vxm_rng rng = {17};
  for (int i = 0; i < 100000; i++) {
    int most = i % 2 ? 4 : 1020;
    double x = any_number(&rng, most), y = any_number(&rng, most), z = i % 3 ? any_number(&rng, most) : 0;
    check_near(vxm_length3(x, y, z), hypotl(hypotl((long double)x, (long double)y), (long double)z), 2);
  }
  assert_true(vxm_length3(0, 0, 0) == 0);
  assert_true(vxm_length3(3, -4, 0) == 5);
  assert_true(vxm_length3(0, 0, -DBL_MAX) == DBL_MAX);
  assert_true(vxm_length3(DBL_TRUE_MIN, 0, 0) == DBL_TRUE_MIN);
  assert_true(isinf(vxm_length3(1, -INFINITY, 0)));
  assert_true(isnan(vxm_length3(1, NAN, 0)));
  assert_true(isnan(vxm_length3(NAN, NAN, NAN)));
}

static void test_angles(void **state) {
  (void)state;
  vxm_rng rng = {18};
  for (int i = 0; i < 100000; i++) {
    int most = i % 2 ? 4 : 400;
    double sine = fabs(any_number(&rng, most)), cosine = any_number(&rng, most);
    check_near(vxm_angle(sine, cosine), atan2l((long double)sine, (long double)cosine), 16);
  }
  assert_true(vxm_angle(0, 0) == 0);
  assert_true(vxm_angle(0, 2) == 0);
  check_near(vxm_angle(0, -2), atan2l(0, -2), 1);
  check_near(vxm_angle(1e-300, -1), atan2l(0, -1), 1);
  check_near(vxm_angle(5, 0), atan2l(5, 0), 4);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_lengths), cmocka_unit_test(test_angles)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** The nearest point of a triangle, against another formula. */
#include "../base/rounds.h"
#include "label_oracle.h"

#include "voxel/closest/closest_point.h"

#include <string.h>

static void test_closest_point(void **state) {
  (void)state;
  vxm_rng rng = {34};
  for (int round = 0; round < ROUNDS(40000); round++) {
    double at[3][3], p[3], foot[3], sum = 0, size = round % 3 == 0 ? 30 : 2;
    for (int c = 0; c < 3; c++)
      for (int a = 0; a < 3; a++)
        at[c][a] = size * vxm_rng_unit(&rng);
    double share = 2 * vxm_rng_unit(&rng) - 0.5;
    for (int a = 0; a < 3 && round % 4 >= 2; a++) /* slivers, segments and points */
      at[2][a] = at[0][a] + share * (at[1][a] - at[0][a]) + (round % 4 == 2 ? 1e-6 * at[2][a] : 0);
    if (round % 50 == 0)
      memcpy(at[1], at[0], sizeof at[1]);
    if (round % 100 == 0)
      memcpy(at[2], at[0], sizeof at[2]);
    for (int a = 0; a < 3; a++)
      p[a] = 1.5 * size * vxm_rng_unit(&rng) - 0.25 * size;
    vxm_closest_triangle corners;
    vxm_closest_triangle_make(&corners, (const double(*)[3])at);
    double square = vxm_closest_point(&corners, p, foot);
    for (int a = 0; a < 3; a++)
      sum += (p[a] - foot[a]) * (p[a] - foot[a]);
    vec v[3], q = {p[0], p[1], p[2]}, f = {foot[0], foot[1], foot[2]};
    for (int c = 0; c < 3; c++)
      v[c] = (vec){at[c][0], at[c][1], at[c][2]};
    assert_true(fabs(sum - square) < 1e-12 * size * size);
    assert_true(fabs(sqrt(square) - to_triangle(q, v[0], v[1], v[2])) < 1e-7 * size);
    assert_true(to_triangle(f, v[0], v[1], v[2]) < 1e-7 * size);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_closest_point),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}

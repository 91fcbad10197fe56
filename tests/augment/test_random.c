/* SPDX-License-Identifier: BSD-3-Clause */
/** Random numbers: the published answers of Philox, and the distributions of what is made of them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "augment/random.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* ---- Words ---- */

/* From the file kat_vectors of Random123, the authors' own library. */
static void philox_gives_the_published_answers(void **state) {
  (void)state;
  static const struct {
    vxm_philox_block counter;
    uint64_t key;
    vxm_philox_block answer;
  } known[] = {
      {{{0, 0, 0, 0}}, 0, {{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}}},
      {{{UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX}},
       UINT64_MAX,
       {{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}}},
      {{{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}},
       UINT64_C(0x299f31d0a4093822),
       {{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}}},
  };
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    vxm_philox_block made = vxm_philox(known[i].counter, known[i].key);
    assert_memory_equal(&made, &known[i].answer, sizeof made);
  }
}

/** Words of a purpose are the blocks of its counters, one after another, and no other purpose has them. */
static void words_are_counted(void **state) {
  (void)state;
  const uint32_t counters[3] = {7, 8, 9};
  vxm_random draw = vxm_random_begin(5, counters, VXM_DRAW_SCALE);
  for (uint32_t block = 0; block < 3; block++) {
    vxm_philox_block expected =
        vxm_philox((vxm_philox_block){{7, 8, 9, (uint32_t)VXM_DRAW_SCALE << 24 | block}}, 5);
    for (int w = 0; w < 4; w++)
      assert_int_equal(vxm_random_word(&draw), expected.word[w]);
  }
}

/* ---- Distributions ---- */

enum { BINS = 16, DRAWS = 40000 };

/** Chi squared of 15 degrees of freedom is above 37.7 once in a thousand times; the seeds are fixed. */
static void assert_even(const int count[BINS], const char *what) {
  double expected = (double)DRAWS / BINS, sum = 0;
  for (int b = 0; b < BINS; b++)
    sum += (count[b] - expected) * (count[b] - expected) / expected;
  if (!(sum < 37.7))
    fail_msg("%s: chi squared is %g", what, sum);
}

/** Counts a number that ought to be uniform in 0 to 1. */
static void count_in(int count[BINS], double unit) {
  int bin = (int)(unit * BINS);
  count[bin < 0 ? 0 : bin >= BINS ? BINS - 1 : bin]++;
}

static vxm_random draw_of(uint32_t index, vxm_purpose purpose) {
  return vxm_random_begin(11, (const uint32_t[3]){0, 0, index}, purpose);
}

static void units_are_uniform(void **state) {
  (void)state;
  int count[BINS] = {0};
  for (uint32_t i = 0; i < DRAWS; i++) {
    vxm_random draw = draw_of(i, VXM_DRAW_SCALE);
    double unit = vxm_random_unit(&draw);
    assert_true(unit > 0 && unit < 1);
    count_in(count, unit);
  }
  assert_even(count, "units");
}

static double dot(const double *p, const double *q) {
  return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
}

static void assert_rotation(const double m[9]) {
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      assert_true(fabs(dot(m + 3 * i, m + 3 * k) - (i == k)) < 1e-12);
  double cross[3] = {m[1] * m[5] - m[2] * m[4], m[2] * m[3] - m[0] * m[5], m[0] * m[4] - m[1] * m[3]};
  assert_true(dot(cross, m + 6) > 0.999);
}

/**
 * Under a uniform rotation the image of each axis is uniform on the sphere: its height is uniform in -1 to 1
 * (Archimedes), and so is its longitude. The angle has the density (1 - cos) / pi.
 */
static void rotations_are_uniform(void **state) {
  (void)state;
  int height[3][BINS] = {{0}}, longitude[3][BINS] = {{0}}, angle[BINS] = {0}, fixed[BINS] = {0};
  for (uint32_t i = 0; i < DRAWS; i++) {
    double m[9];
    vxm_random draw = draw_of(i, VXM_DRAW_ROTATION);
    vxm_random_rotation(m, &draw);
    assert_rotation(m);
    for (int a = 0; a < 3; a++) {
      count_in(height[a], (m[6 + a] + 1) / 2);
      count_in(longitude[a], atan2(m[3 + a], m[a]) / (2 * pi) + 0.5);
    }
    double cosine = fmin(1, fmax(-1, (m[0] + m[4] + m[8] - 1) / 2)), turn = acos(cosine);
    count_in(angle, (turn - sin(turn)) / pi);
    /* the axis that stays, too */
    double axis[3] = {m[7] - m[5], m[2] - m[6], m[3] - m[1]};
    count_in(fixed, (axis[2] / sqrt(dot(axis, axis)) + 1) / 2);
  }
  for (int a = 0; a < 3; a++) {
    assert_even(height[a], "height");
    assert_even(longitude[a], "longitude");
  }
  assert_even(angle, "angle");
  assert_even(fixed, "axis");
}

static void turns_are_uniform(void **state) {
  (void)state;
  static const double axes[2][3] = {{0, 0, 1}, {2.0 / 3, -1.0 / 3, 2.0 / 3}};
  for (int k = 0; k < 2; k++) {
    const double *axis = axes[k];
    int count[BINS] = {0};
    for (uint32_t i = 0; i < DRAWS; i++) {
      double m[9];
      vxm_random draw = draw_of(i, VXM_DRAW_ROTATION);
      vxm_random_turn(m, axis, &draw);
      assert_rotation(m);
      for (int row = 0; row < 3; row++)
        assert_true(fabs(dot(m + 3 * row, axis) - axis[row]) < 1e-12);
      double cosine = (m[0] + m[4] + m[8] - 1) / 2;
      double sine = ((m[7] - m[5]) * axis[0] + (m[2] - m[6]) * axis[1] + (m[3] - m[1]) * axis[2]) / 2;
      count_in(count, atan2(sine, cosine) / (2 * pi) + 0.5);
    }
    assert_even(count, "turns");
  }
}

static void normals_are_nearly_normal(void **state) {
  (void)state;
  double sum = 0, squares = 0, within = 0;
  for (uint32_t i = 0; i < DRAWS; i++) {
    vxm_random draw = draw_of(i, VXM_DRAW_NOISE);
    double value = vxm_random_normal(&draw);
    assert_true(fabs(value) <= 3);
    sum += value;
    squares += value * value;
    within += fabs(value) < 1;
  }
  assert_true(fabs(sum / DRAWS) < 0.02);
  assert_true(fabs(squares / DRAWS - 1) < 0.05); /* cut off at 3, a little is missing */
  assert_true(fabs(within / DRAWS - 0.6827) < 0.015);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(philox_gives_the_published_answers),
      cmocka_unit_test(words_are_counted),
      cmocka_unit_test(units_are_uniform),
      cmocka_unit_test(rotations_are_uniform),
      cmocka_unit_test(turns_are_uniform),
      cmocka_unit_test(normals_are_nearly_normal),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "augment/random.h"

#include <math.h>

enum { NORMAL_TERMS = 12, NORMAL_CUT = 3, PURPOSE_SHIFT = 24 };

vxm_random vxm_random_begin(uint64_t seed, const uint32_t counters[3], vxm_purpose purpose) {
  return (vxm_random){
      .seed = seed, .counter = {{counters[0], counters[1], counters[2], (uint32_t)purpose << PURPOSE_SHIFT}}};
}

uint32_t vxm_random_word(vxm_random *draw) {
  if (draw->left == 0) {
    draw->block = vxm_philox(draw->counter, draw->seed);
    draw->counter.word[3]++;
    draw->left = 4;
  }
  return draw->block.word[4 - draw->left--];
}

double vxm_random_normal(vxm_random *draw) {
  for (;;) {
    double sum = -0.5 * NORMAL_TERMS;
    for (int i = 0; i < NORMAL_TERMS; i++)
      sum += vxm_random_unit(draw);
    if (fabs(sum) <= NORMAL_CUT)
      return sum;
  }
}

/** A point in the unit disc, but not its middle; returns the square of its distance from there. */
static double draw_in_disc(double out[2], vxm_random *draw) {
  for (;;) {
    out[0] = vxm_random_signed(draw);
    out[1] = vxm_random_signed(draw);
    double squared = out[0] * out[0] + out[1] * out[1];
    if (squared < 1) /* 0 cannot be drawn */
      return squared;
  }
}

void vxm_random_rotation(double m[9], vxm_random *draw) {
  double p[2], q[2];
  double s = draw_in_disc(p, draw), t = draw_in_disc(q, draw);
  double stretch = sqrt((1 - s) / t);
  double w = p[0], x = p[1], y = q[0] * stretch, z = q[1] * stretch;
  m[0] = 1 - 2 * (y * y + z * z);
  m[1] = 2 * (x * y - w * z);
  m[2] = 2 * (x * z + w * y);
  m[3] = 2 * (x * y + w * z);
  m[4] = 1 - 2 * (x * x + z * z);
  m[5] = 2 * (y * z - w * x);
  m[6] = 2 * (x * z - w * y);
  m[7] = 2 * (y * z + w * x);
  m[8] = 1 - 2 * (x * x + y * y);
}

void vxm_random_turn(double m[9], const double axis[3], vxm_random *draw) {
  double p[2];
  double squared = draw_in_disc(p, draw);
  /* Twice the angle of a point whose angle is uniform is uniform too, and needs no trigonometry. */
  double c = (p[0] * p[0] - p[1] * p[1]) / squared, s = 2 * p[0] * p[1] / squared;
  for (int row = 0; row < 3; row++)
    for (int column = 0; column < 3; column++)
      m[3 * row + column] = (1 - c) * axis[row] * axis[column] + (row == column ? c : 0);
  m[1] -= s * axis[2];
  m[2] += s * axis[1];
  m[3] += s * axis[2];
  m[5] -= s * axis[0];
  m[6] -= s * axis[1];
  m[7] += s * axis[0];
}

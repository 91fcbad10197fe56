/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * What is drawn at random for a variant. The same on every machine: words are counted (base/philox.h), and
 * numbers are made of them by + - * / and square roots alone, which IEEE 754 rounds in one way only.
 */
#ifndef VXM_AUGMENT_RANDOM_H
#define VXM_AUGMENT_RANDOM_H

#include "base/philox.h"

/** Each purpose has words of its own, so that turning one augmentation on or off leaves the others as they
 * are. */
typedef enum vxm_purpose {
  VXM_DRAW_ROTATION = 0,
  VXM_DRAW_SCALE,
  VXM_DRAW_MIRROR,
  VXM_DRAW_TRANSLATION,
  VXM_DRAW_OFFSET, /**< where a variant begins in the noise */
  VXM_DRAW_NOISE   /**< the noise itself, with the number of its vector for the three counters */
} vxm_purpose;

/** A sequence of words; the counter of a block is (three counters, purpose and number of the block). */
typedef struct vxm_random {
  uint64_t seed;
  vxm_philox_block counter, block;
  int left; /**< words of the block that have not been used */
} vxm_random;

vxm_random vxm_random_begin(uint64_t seed, const uint32_t counters[3], vxm_purpose purpose);
uint32_t vxm_random_word(vxm_random *draw);

/** Uniform in (0, 1): one of 2^32 values that lie evenly about 1/2. */
static inline double vxm_random_unit(vxm_random *draw) {
  return ((double)vxm_random_word(draw) + 0.5) * 0x1p-32;
}

/** Uniform in (-1, 1). */
static inline double vxm_random_signed(vxm_random *draw) {
  return 2 * vxm_random_unit(draw) - 1;
}

/** Nearly normal with variance 1, cut off at +-3: the sum of twelve uniform numbers, less its mean. */
double vxm_random_normal(vxm_random *draw);

/** A rotation, uniform over all of them (Marsaglia 1972), as rows of a matrix. */
void vxm_random_rotation(double matrix[9], vxm_random *draw);
/** A rotation about an axis of length 1, uniform over all angles. */
void vxm_random_turn(double matrix[9], const double axis[3], vxm_random *draw);

#endif

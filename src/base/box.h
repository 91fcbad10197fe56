/* SPDX-License-Identifier: BSD-3-Clause */
/** Boxes along the axes, as their lowest and their highest corner. */
#ifndef VXM_BASE_BOX_H
#define VXM_BASE_BOX_H

#include <math.h>

/** Makes a box the one around nothing: low above high, and joined with another one it is that. */
static inline void vxm_box_empty(double low[3], double high[3]) {
  for (int a = 0; a < 3; a++) {
    low[a] = INFINITY;
    high[a] = -INFINITY;
  }
}

/** Grows a box so that it holds another one. What is no number leaves it as it is. */
static inline void vxm_box_join(double low[3], double high[3], const double *other_low,
                                const double *other_high) {
  for (int a = 0; a < 3; a++) {
    low[a] = other_low[a] < low[a] ? other_low[a] : low[a];
    high[a] = other_high[a] > high[a] ? other_high[a] : high[a];
  }
}

/** The same for a point. */
static inline void vxm_box_include(double low[3], double high[3], const double *at) {
  vxm_box_join(low, high, at, at);
}

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Which vertices other programs take for one when they read a file. Some round positions to 1e-8 in model
 * units by default and merge what is then the same, whatever the size of the model; many hold 32-bit floats.
 */
#ifndef VXM_REPAIR_STATE_MERGE_RULE_H
#define VXM_REPAIR_STATE_MERGE_RULE_H

#include "base/exact_math.h"
#include "mesh/unit_scale.h"

#include <math.h>

#define VXM_MERGE_GRID 1e-8
/** Of a model that is smaller, in model units, too much would merge: it has to be scaled before such a
 * program reads it, and is judged by its exact positions. */
#define VXM_MERGE_DIAGONAL 1e-3

/** How positions are taken for the same. */
typedef enum vxm_merge_rule {
  VXM_MERGE_EXACT = 0, /**< where they are */
  VXM_MERGE_ROUNDED,   /**< where they are after rounding to VXM_MERGE_GRID */
  VXM_MERGE_FLOAT      /**< where their 32-bit floats are */
} vxm_merge_rule;

/** The 32-bit float next to a number. */
static inline double vxm_single(double x) {
  volatile float single =
      (float)x; /* gcc 12 at -O2 loses a plain conversion there and back when it vectorizes */
  return (double)single;
}

static inline double vxm_merge_coordinate(double x, vxm_merge_rule rule) {
  if (rule == VXM_MERGE_ROUNDED)
    return nearbyint(x * (1 / VXM_MERGE_GRID)) + 0.0;
  if (rule == VXM_MERGE_FLOAT)
    return vxm_single(x) + 0.0;
  return x + 0.0; /* of both zeros the positive one */
}

/** What holds for a model of this diagonal, in model units. */
static inline vxm_merge_rule vxm_merge_rule_of(double diagonal) {
  return diagonal >= VXM_MERGE_DIAGONAL ? VXM_MERGE_ROUNDED : VXM_MERGE_EXACT;
}

static inline double vxm_extent_diagonal(const double b[6]) {
  return vxm_length3(b[3] - b[0], b[4] - b[1], b[5] - b[2]);
}

/** As vxm_weld_exact, of positions by a rule. */
vxm_status vxm_merge_map(vxm_context *context, const double *positions, size_t count, vxm_merge_rule rule,
                         uint32_t *map, vxm_error *error);

#endif

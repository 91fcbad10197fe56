/* SPDX-License-Identifier: BSD-3-Clause */
/** Answers to a question by each method: how right, and how long it took. */
#ifndef ACCURACY_MEASURE_H
#define ACCURACY_MEASURE_H

#include "damage.h"

typedef enum method {
  METHOD_AUTO,     /**< the defaults */
  METHOD_MAJORITY, /**< majority of x, y and z, every component alone: Chen & Tu */
  METHOD_X,        /**< parity along x */
  METHOD_WINDING,  /**< winding number at every voxel */
  METHOD_COUNT
} method;

/** Short name for the command line, and what it is called in tables. */
extern const char *const method_keys[METHOD_COUNT];
extern const char *const method_names[METHOD_COUNT];

/** One number that may be missing. */
typedef struct figure {
  bool known;
  double value;
} figure;

/** What is known of one damage of one mesh. Times are in milliseconds, each the least of a few runs. */
typedef struct answer {
  figure iou[METHOD_COUNT], time[METHOD_COUNT];
  figure repair_time;
  figure reference; /**< IoU of the winding number of the oriented mesh */
} answer;

/**
 * Repairs the mesh of a question, as a user would, and voxelizes it.
 *
 * @param wanted which methods; the reference is taken with METHOD_WINDING
 * @param timed  whether to repeat runs, so that times can be compared
 */
void measure(answer *out, const question *q, const bool wanted[METHOD_COUNT], bool timed);

/** IoU of one method to the truth, without repair. */
double measure_iou(const vxm_mesh *mesh, const vxm_grid *truth, method by);

#endif

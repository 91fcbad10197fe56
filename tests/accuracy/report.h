/* SPDX-License-Identifier: BSD-3-Clause */
/** The tables made of many answers: worst and median, times, and the bounds that are kept. */
#ifndef ACCURACY_REPORT_H
#define ACCURACY_REPORT_H

#include "measure.h"

#include <stdio.h>

/** All answers: of mesh m and damage d at answers[m * DAMAGE_COUNT + d]. */
typedef struct survey {
  char **names;      /**< of the meshes, without folder */
  size_t *triangles; /**< of the meshes */
  answer *answers;
  size_t mesh_count;
  int64_t resolution;
  int threads;
} survey;

/** What is asked of the defaults: the floor of the worst and, unless 0, of the median IoU. */
typedef struct bound {
  double worst, median;
} bound;
extern const bound bounds[DAMAGE_COUNT];

/** No worse than the winding number of the oriented mesh by more than this. */
extern const double winding_slack;

/** IoU of every damage by every method. */
void report_iou(FILE *to, const survey *all);
/** Time of repair and of every method. */
void report_times(FILE *to, const survey *all);
/** Every bound with what was measured; false if one is missed. */
bool report_bounds(FILE *to, const survey *all);
/** The machine and what was measured on it. */
void report_setting(FILE *to, const survey *all);

/** Puts all of it between the markers of a Markdown file; false if the file cannot be changed. */
bool report_markdown(const char *path, const survey *all);

#endif

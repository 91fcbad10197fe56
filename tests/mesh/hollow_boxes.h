/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Hollow boxes that overlap, lie in each other and in each other's walls: solid is what lies in the wall of
 * one of them, whichever others have a void there. No two of their faces lie in one plane, so which cells are
 * solid is known from whole numbers alone.
 */
#ifndef VXM_TESTS_HOLLOW_BOXES_H
#define VXM_TESTS_HOLLOW_BOXES_H

#include "soups.h"

enum { BODIES_MAX = 5, PLANES_MAX = 4 * BODIES_MAX, CELLS_MAX = PLANES_MAX * PLANES_MAX * PLANES_MAX };

/** Per axis the planes of the skin and of the void: from, void from, void to, to. */
typedef struct hollow_box {
  int planes[3][4];
} hollow_box;

typedef struct assembly {
  hollow_box boxes[BODIES_MAX];
  size_t count;
} assembly;

static inline void shuffle(int *numbers, size_t count, vxm_rng *rng) {
  for (size_t i = count; i-- > 1;) {
    size_t j = (size_t)vxm_rng_below(rng, i + 1);
    int kept = numbers[i];
    numbers[i] = numbers[j];
    numbers[j] = kept;
  }
}

static inline void sort_four(int *p) {
  for (int i = 1; i < 4; i++)
    for (int j = i; j > 0 && p[j - 1] > p[j]; j--) {
      int kept = p[j];
      p[j] = p[j - 1];
      p[j - 1] = kept;
    }
}

/** Boxes of any planes, most of which cut through each other. */
static inline assembly random_boxes(size_t count, vxm_rng *rng) {
  assembly a = {.count = count};
  for (int axis = 0; axis < 3; axis++) {
    int planes[PLANES_MAX];
    for (size_t i = 0; i < 4 * count; i++)
      planes[i] = (int)i;
    shuffle(planes, 4 * count, rng);
    for (size_t i = 0; i < count; i++) {
      for (int k = 0; k < 4; k++)
        a.boxes[i].planes[axis][k] = planes[4 * i + (size_t)k];
      sort_four(a.boxes[i].planes[axis]);
    }
  }
  return a;
}

/** Boxes that lie in each other, skins and voids in any order in which a void lies in its box: none cuts
 * through another. */
static inline assembly nested_boxes(size_t count, vxm_rng *rng) {
  assembly a = {.count = count};
  int owner[2 * BODIES_MAX], seen[BODIES_MAX] = {0};
  for (size_t i = 0; i < 2 * count; i++)
    owner[i] = (int)(i / 2);
  shuffle(owner, 2 * count, rng);
  for (int i = 0; i < (int)(2 * count); i++) {
    hollow_box *box = &a.boxes[owner[i]];
    bool is_void = seen[owner[i]]++ > 0;
    for (int axis = 0; axis < 3; axis++) {
      box->planes[axis][is_void ? 1 : 0] = i;
      box->planes[axis][is_void ? 2 : 3] = (int)(4 * count) - 1 - i;
    }
  }
  return a;
}

static inline void add_skin(vxm_soup *soup, const hollow_box *box, bool is_void, bool inward) {
  static const uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  uint32_t first = (uint32_t)soup->vertex_count;
  for (int v = 0; v < 8; v++) {
    double p[3];
    for (int axis = 0; axis < 3; axis++)
      p[axis] = box->planes[axis][v >> axis & 1 ? (is_void ? 2 : 3) : (is_void ? 1 : 0)];
    add_vertex(soup, p[0], p[1], p[2]);
  }
  for (int f = 0; f < 6; f++) {
    uint32_t corners[4];
    for (int i = 0; i < 4; i++)
      corners[i] = first + faces[f][inward ? 3 - i : i];
    add_face(soup, corners, 4);
  }
}

/** All skins and voids, in any order. @param inside_out all faces are turned over */
static inline vxm_soup *faces_of(vxm_context *context, const assembly *a, bool inside_out, vxm_rng *rng) {
  vxm_soup *soup = new_soup(context);
  int order[2 * BODIES_MAX];
  for (size_t i = 0; i < 2 * a->count; i++)
    order[i] = (int)i;
  shuffle(order, 2 * a->count, rng);
  for (size_t i = 0; i < 2 * a->count; i++) {
    bool is_void = order[i] % 2 == 1;
    add_skin(soup, &a->boxes[order[i] / 2], is_void, is_void != inside_out);
  }
  return soup;
}

/** Whether a cell, of which no plane cuts through the middle, lies in the wall of a box. */
static inline bool is_solid(const assembly *a, const int64_t cell[3]) {
  for (size_t i = 0; i < a->count; i++) {
    bool in = true, in_void = true;
    for (int axis = 0; axis < 3; axis++) {
      const int *p = a->boxes[i].planes[axis];
      in = in && cell[axis] >= p[0] && cell[axis] < p[3];
      in_void = in_void && cell[axis] >= p[1] && cell[axis] < p[2];
    }
    if (in && !in_void)
      return true;
  }
  return false;
}

/** A box, and in its wall another one: of both their voids, the larger is that of the larger box. */
static inline assembly liner_in_vessel(void) {
  static const int planes[2][4] = {{0, 2, 5, 7}, {1, 3, 4, 6}};
  assembly a = {.count = 2};
  for (int i = 0; i < 2; i++)
    for (int axis = 0; axis < 3; axis++)
      for (int k = 0; k < 4; k++)
        a.boxes[i].planes[axis][k] = planes[i][k];
  return a;
}

#endif

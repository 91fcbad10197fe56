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

/** What a box has in it. */
typedef enum hollow {
  HOLLOW_VOID,
  HOLLOW_BORE, /**< goes through the box from end to end: one skin, a ring */
  HOLLOW_PIPE  /**< two tubes whose ends are open, the inner one as long or shorter */
} hollow;

/** Per axis the planes of the skin and of the void: from, void from, void to, to. */
typedef struct hollow_box {
  int planes[3][4];
  hollow kind;
  int along; /**< the axis of a bore or a pipe */
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

/** A box with a bore. */
static inline void add_ring(vxm_soup *soup, const hollow_box *box, bool inward) {
  static const int corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  uint32_t first = (uint32_t)soup->vertex_count;
  int u = (box->along + 1) % 3, v = (box->along + 2) % 3, w = box->along;
  for (int i = 0; i < 16; i++) { /* outer low, outer high, inner low, inner high */
    const int *corner = corners[i % 4], inner = i / 8;
    double p[3];
    p[u] = box->planes[u][inner ? 1 + corner[0] : 3 * corner[0]];
    p[v] = box->planes[v][inner ? 1 + corner[1] : 3 * corner[1]];
    p[w] = box->planes[w][i / 4 % 2 ? 3 : 0];
    add_vertex(soup, p[0], p[1], p[2]);
  }
  static const int from[4] = {0, 12, 8, 4}, to[4] = {4, 8, 0, 12}; /* sides, bore, and both ends */
  for (int side = 0; side < 4; side++)
    for (int i = 0; i < 4; i++) {
      uint32_t a = first + (uint32_t)from[side], b = first + (uint32_t)to[side];
      uint32_t j = (uint32_t)(i + 1) % 4, quad[4] = {a + (uint32_t)i, a + j, b + j, b + (uint32_t)i};
      if (inward) {
        uint32_t kept = quad[1];
        quad[1] = quad[3];
        quad[3] = kept;
      }
      add_face(soup, quad, 4);
    }
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
    if (box->kind == HOLLOW_PIPE && f / 2 == 2 - box->along)
      continue;
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
    const hollow_box *box = &a->boxes[order[i] / 2];
    if (box->kind != HOLLOW_BORE)
      add_skin(soup, box, is_void, is_void != inside_out);
    else if (!is_void)
      add_ring(soup, box, inside_out);
  }
  return soup;
}

/** The same faces, in any order. */
static inline vxm_soup *in_any_order(const vxm_soup *soup, vxm_rng *rng) {
  vxm_soup *out = new_soup(soup->context);
  int *order = malloc((soup->face_count + 1) * sizeof *order);
  assert_non_null(order);
  for (size_t f = 0; f < soup->face_count; f++)
    order[f] = (int)f;
  shuffle(order, soup->face_count, rng);
  for (size_t v = 0; v < soup->vertex_count; v++)
    add_vertex(out, soup->positions[3 * v], soup->positions[3 * v + 1], soup->positions[3 * v + 2]);
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, (size_t)order[f], &count);
    add_face(out, corner, count);
  }
  free(order);
  return out;
}

/** Whether a cell, of which no plane cuts through the middle, lies in the wall of a box. */
static inline bool is_solid(const assembly *a, const int64_t cell[3]) {
  for (size_t i = 0; i < a->count; i++) {
    bool in = true, in_void = true;
    for (int axis = 0; axis < 3; axis++) {
      const int *p = a->boxes[i].planes[axis];
      in = in && cell[axis] >= p[0] && cell[axis] < p[3];
      bool bored = a->boxes[i].kind == HOLLOW_BORE && axis == a->boxes[i].along;
      in_void = in_void && (bored || (cell[axis] >= p[1] && cell[axis] < p[2]));
    }
    if (in && !in_void)
      return true;
  }
  return false;
}

/** A hollow box, and a ring that its void cuts through, though the void does not reach out of the box of the
 * ring. */
static inline assembly ring_in_void(vxm_rng *rng) {
  assembly a = {.count = 2};
  int along = (int)vxm_rng_below(rng, 3);
  a.boxes[1].kind = HOLLOW_BORE;
  a.boxes[1].along = along;
  for (int axis = 0; axis < 3; axis++) {
    int middle[4] = {2, 3, 4, 5}, *body = a.boxes[0].planes[axis], *ring = a.boxes[1].planes[axis];
    shuffle(middle, 4, rng);
    int low = (int)vxm_rng_below(rng, 2), high = (int)vxm_rng_below(rng, 2);
    const int planes[2][4] = {{low, middle[0], middle[1], 7 - high},
                              {1 - low, middle[2], middle[3], 6 + high}};
    memcpy(body, planes[0], sizeof planes[0]);
    memcpy(ring, planes[1], sizeof planes[1]);
    sort_four(body);
    sort_four(ring);
  }
  return a;
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

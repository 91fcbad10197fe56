/* SPDX-License-Identifier: BSD-3-Clause */
/** Polygons of difficult shapes, and bodies with a hole of that shape. */
#ifndef VXM_TESTS_OUTLINES_H
#define VXM_TESTS_OUTLINES_H

#include "../mesh/soups.h"

#include <math.h>

typedef struct outline {
  double (*points)[2]; /**< counter-clockwise */
  size_t count;
} outline;

static inline outline new_outline(size_t most) {
  outline o = {malloc(most * sizeof *o.points), 0};
  assert_non_null(o.points);
  return o;
}

static inline void put_point(outline *o, double x, double y) {
  o->points[o->count][0] = x;
  o->points[o->count++][1] = y;
}

static inline double outline_area(const outline *o) {
  double sum = 0;
  for (size_t i = 0; i < o->count; i++) {
    const double *p = o->points[i], *q = o->points[(i + 1) % o->count];
    sum += p[0] * q[1] - p[1] * q[0];
  }
  return sum / 2;
}

static inline outline l_shape(void) {
  static const double points[6][2] = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0, 2}};
  outline o = new_outline(6);
  for (int i = 0; i < 6; i++)
    put_point(&o, points[i][0], points[i][1]);
  return o;
}

/** Teeth that stand on a thin back. */
static inline outline comb(size_t teeth) {
  outline o = new_outline(4 * teeth + 2);
  put_point(&o, 0, -0.1);
  put_point(&o, 2 * (double)teeth - 1, -0.1);
  for (size_t t = teeth; t-- > 0;) {
    double x = 2 * (double)t;
    put_point(&o, x + 1, 0);
    put_point(&o, x + 1, 10);
    put_point(&o, x, 10);
    put_point(&o, x, 0);
  }
  return o;
}

/** A band that winds outward. */
static inline outline spiral(size_t steps, double turns) {
  outline o = new_outline(2 * steps);
  for (size_t i = 0; i < steps; i++) {
    double angle = 2 * M_PI * turns * (double)i / (double)(steps - 1), radius = 1 + angle / (2 * M_PI);
    put_point(&o, (radius + 0.5) * cos(angle), (radius + 0.5) * sin(angle));
  }
  for (size_t i = steps; i-- > 0;) {
    double angle = 2 * M_PI * turns * (double)i / (double)(steps - 1), radius = 1 + angle / (2 * M_PI);
    put_point(&o, radius * cos(angle), radius * sin(angle));
  }
  return o;
}

static inline outline star(vxm_rng *rng, size_t count, double depth) {
  outline o = new_outline(count);
  for (size_t i = 0; i < count; i++) {
    double angle = 2 * M_PI * (double)i / (double)count, radius = 1 - depth * vxm_rng_unit(rng);
    put_point(&o, radius * cos(angle), radius * sin(angle));
  }
  return o;
}

/** Cells of a lattice grown one by one without closing a ring, so that the outline is one; its vertices are
 * a cell's side apart, many of them in line. */
static inline outline cells_outline(vxm_rng *rng, size_t cells) {
  enum { N = 64 };
  static uint8_t full[N][N];
  memset(full, 0, sizeof full);
  full[N / 2][N / 2] = 1;
  for (size_t made = 1, tries = 0; made < cells && tries < 200 * cells; tries++) {
    int x = 2 + (int)vxm_rng_below(rng, N - 4), y = 2 + (int)vxm_rng_below(rng, N - 4);
    /* going around the cell it has to meet full ones just once, through a side */
    static const int around[8][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
    int changes = 0, sides = 0;
    for (int i = 0; i < 8; i++) {
      int here = full[y + around[i][1]][x + around[i][0]];
      int next = full[y + around[(i + 1) % 8][1]][x + around[(i + 1) % 8][0]];
      changes += here != next;
      sides += i % 2 == 0 && here;
    }
    if (full[y][x] || changes != 2 || sides == 0)
      continue;
    full[y][x] = 1;
    made++;
  }
  outline o = new_outline(4 * cells);
  int x = 0, y = 0;
  for (int i = 0; i < N * N && !full[y][x]; i++) {
    x = i % N;
    y = i / N;
  }
  /* along the lower side of the lowest cell, with the cells to the left */
  int dx = 1, dy = 0, first_x = x, first_y = y;
  do {
    put_point(&o, x, y);
    x += dx;
    y += dy;
    /* cells ahead, to the left and to the right of the way */
    int left = full[y - (dy < 0 || dx < 0)][x - (dy > 0 || dx < 0)];
    int right = full[y - (dy < 0 || dx > 0)][x - (dy < 0 || dx < 0)];
    int turn_x = dx, turn_y = dy;
    if (right) {
      turn_x = dy;
      turn_y = -dx;
    } else if (!left) {
      turn_x = -dy;
      turn_y = dx;
    }
    dx = turn_x;
    dy = turn_y;
  } while (x != first_x || y != first_y);
  return o;
}

/** An orthogonal matrix. */
typedef struct turning {
  double m[3][3];
} turning;

static inline turning random_turning(vxm_rng *rng) {
  double q[4], sum = 0;
  for (int i = 0; i < 4; i++) {
    q[i] = 2 * vxm_rng_unit(rng) - 1;
    sum += q[i] * q[i];
  }
  double s = 2 / sum, a = q[0], b = q[1], c = q[2], d = q[3];
  return (turning){{{1 - s * (c * c + d * d), s * (b * c - a * d), s * (b * d + a * c)},
                    {s * (b * c + a * d), 1 - s * (b * b + d * d), s * (c * d - a * b)},
                    {s * (b * d - a * c), s * (c * d + a * b), 1 - s * (b * b + c * c)}}};
}

/** A prism over the outline, its lower end one polygon, its upper end open; turned in space and moved. */
static inline vxm_soup *open_prism(vxm_context *context, const outline *o, double height, const turning *turn,
                                   double shift) {
  vxm_soup *soup = new_soup(context);
  uint32_t n = (uint32_t)o->count, *floor = malloc(n * sizeof *floor);
  assert_non_null(floor);
  for (uint32_t i = 0; i < 2 * n; i++) {
    const double *at = o->points[i % n], p[3] = {at[0], at[1], i < n ? 0 : height};
    double q[3];
    for (int a = 0; a < 3; a++)
      q[a] = shift + turn->m[a][0] * p[0] + turn->m[a][1] * p[1] + turn->m[a][2] * p[2];
    add_vertex(soup, q[0], q[1], q[2]);
  }
  for (uint32_t i = 0; i < n; i++) {
    uint32_t j = (i + 1) % n, wall[4] = {i, j, n + j, n + i};
    floor[n - 1 - i] = i;
    add_face(soup, wall, 4);
  }
  add_face(soup, floor, n);
  free(floor);
  return soup;
}

#endif

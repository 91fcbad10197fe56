/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/manifold/free_positions.h"

#include "base/hash.h"

#include <stdlib.h>
#include <string.h>

static double rounded(const vxm_free_positions *near, double x) {
  return near->single_precision ? vxm_single(x) : x;
}

/* ---- Whether a position will do ---- */

typedef enum fit {
  FREE = 0,
  TOO_FAR,
  TAKEN,
  TAKEN_FOR_GOOD /**< by a vertex that is not to be moved any more */
} fit;

static fit holder_of(const vxm_free_positions *near, const vxm_position_set *in, const double p[3],
                     uint32_t vertex) {
  uint32_t holder = vxm_position_set_find(in, p);
  if (holder == VXM_NO_VERTEX)
    return FREE;
  return near->number[holder] == VXM_NO_VERTEX || holder < vertex ? TAKEN_FOR_GOOD : TAKEN;
}

/** Whether a position is free, and no farther than `most` along each axis. */
static fit fits(vxm_free_positions *near, uint32_t vertex, const vxm_position_move *by, const double p[3],
                double most) {
  for (int a = 0; a < 3; a++)
    if (!(fabs(p[a] - by->from[a]) <= most))
      return TOO_FAR;
  near->looked_up++;
  fit exact = holder_of(near, near->taken, p, vertex);
  return exact == FREE && by->floats ? holder_of(near, near->floats, p, vertex) : exact;
}

/* ---- In the direction ---- */

/** Moves exactly along the direction, at first by the least step that changes a coordinate: a position
 * beside it might meet what lies on the other side. */
static bool find_straight(vxm_free_positions *near, uint32_t vertex, const vxm_position_move *by,
                          double p[3]) {
  double step = INFINITY;
  for (int a = 0; a < 3; a++)
    if (fabs(by->toward[a]) > VXM_MOVE_AXIS)
      step = fmin(step, by->unit[a] / fabs(by->toward[a]));
  step = fmax(step, by->step);
  for (int quarter = 4; quarter <= 12; quarter++) {
    for (int a = 0; a < 3; a++)
      p[a] = rounded(near, by->from[a] + step * quarter / 4 * by->toward[a]);
    if (fits(near, vertex, by, p, by->fine) == FREE)
      return true;
  }
  return false;
}

/** In the direction of the faces, so that what touched along an edge touches nowhere. */
static bool find_along(vxm_free_positions *near, uint32_t vertex, const vxm_position_move *by, double p[3]) {
  for (int quarter = 4; quarter <= 12; quarter++) {
    for (int a = 0; a < 3; a++) {
      double step = by->step * quarter / 4 * fabs(by->toward[a]);
      if (fabs(by->toward[a]) > VXM_MOVE_AXIS)
        step = fmax(step, by->unit[a] * (quarter / 4));
      p[a] = rounded(near, by->from[a] + copysign(step, by->toward[a]));
    }
    if (fits(near, vertex, by, p, by->fine) == FREE)
      return true;
  }
  return false;
}

/* ---- All around ---- */

/** Positions about one are numbered by how many steps they lie from it along each axis. */
enum { STEPS = 4, POSITIONS = STEPS * STEPS * STEPS };

typedef struct nearby {
  double p[3], distance;
  int number;
} nearby;

static int by_distance(const void *a, const void *b) {
  const nearby *p = a, *q = b;
  if (p->distance != q->distance)
    return p->distance < q->distance ? -1 : 1;
  return (p->number > q->number) - (p->number < q->number);
}

/** What is known of the positions with these steps about this one: where many vertices are in one position,
 * most of them find that all about it is taken. */
static vxm_full_positions *full_positions(const vxm_free_positions *near, const vxm_position_move *by,
                                          const double step[3]) {
  vxm_full_positions key = {.floats = by->floats};
  uint64_t hash = by->floats;
  for (int a = 0; a < 3; a++) {
    uint64_t bits[2];
    key.from[a] = by->from[a];
    key.step[a] = step[a];
    memcpy(&bits[0], &key.from[a], sizeof bits[0]);
    memcpy(&bits[1], &key.step[a], sizeof bits[1]);
    hash = vxm_hash_word(vxm_hash_word(hash, bits[0]), bits[1]);
  }
  vxm_full_positions *full = &near->full[hash % VXM_FULL_POSITIONS];
  if (memcmp(full->from, key.from, sizeof key.from) != 0 ||
      memcmp(full->step, key.step, sizeof key.step) != 0 || full->floats != key.floats)
    *full = key;
  return full;
}

/** Those of the positions about one that lie on the side of the faces and may be free; returns how many. */
static int list_positions(nearby positions[POSITIONS], const vxm_free_positions *near,
                          const vxm_position_move *by, const double step[3], uint64_t taken) {
  int count = 0;
  for (int n = 1; n < POSITIONS; n++) {
    if (taken >> n & 1)
      continue;
    const int steps[3] = {n % STEPS, n / STEPS % STEPS, n / STEPS / STEPS};
    nearby *position = &positions[count];
    double along = 0, squared = 0;
    for (int a = 0; a < 3; a++) {
      double by_axis = steps[a] * step[a];
      position->p[a] = rounded(near, by->from[a] + by_axis);
      along += by_axis * by->toward[a];
      squared += by_axis * by_axis;
    }
    position->distance = sqrt(squared);
    position->number = n;
    count += along >= VXM_MOVE_AXIS * position->distance;
  }
  return count;
}

/** Where numbers are coarse: the nearest position that lies on the side of the faces, such as along the one
 * axis on which they are fine. */
static bool find_nearest(vxm_free_positions *near, uint32_t vertex, const vxm_position_move *by,
                         double p[3]) {
  nearby positions[POSITIONS];
  double step[3];
  for (int a = 0; a < 3; a++)
    step[a] = copysign(fmax(by->step, by->unit[a]), by->toward[a]);
  vxm_full_positions *full = full_positions(near, by, step);
  int count = list_positions(positions, near, by, step, full->taken);
  qsort(positions, (size_t)count, sizeof *positions, by_distance);
  for (int i = 0; i < count; i++) {
    fit found = fits(near, vertex, by, positions[i].p, by->coarse);
    if (found == TAKEN_FOR_GOOD)
      full->taken |= (uint64_t)1 << positions[i].number;
    if (found != FREE)
      continue;
    memcpy(p, positions[i].p, sizeof positions[i].p);
    return true;
  }
  return false;
}

bool vxm_free_positions_find(vxm_free_positions *near, uint32_t vertex, const vxm_position_move *by,
                             double p[3]) {
  return (by->straight && find_straight(near, vertex, by, p)) || find_along(near, vertex, by, p) ||
         find_nearest(near, vertex, by, p);
}

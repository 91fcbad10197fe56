/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/manifold/near_places.h"

#include "base/hash.h"

#include <stdlib.h>
#include <string.h>

static double rounded(const vxm_near_places *near, double x) {
  return near->single_precision ? vxm_single(x) : x;
}

/* ---- Whether a place will do ---- */

typedef enum fit {
  FREE = 0,
  TOO_FAR,
  TAKEN,
  TAKEN_FOR_GOOD /**< by a vertex that is not to be moved any more */
} fit;

static fit holder_of(const vxm_near_places *near, const vxm_position_hash *in, const double p[3],
                     uint32_t vertex) {
  uint32_t holder = vxm_position_hash_find(in, p);
  if (holder == VXM_NO_VERTEX)
    return FREE;
  return near->number[holder] == VXM_NO_VERTEX || holder < vertex ? TAKEN_FOR_GOOD : TAKEN;
}

/** Whether a place is free, and no farther than `most` along each axis. */
static fit fits(vxm_near_places *near, uint32_t vertex, const vxm_near_moves *by, const double p[3],
                double most) {
  for (int a = 0; a < 3; a++)
    if (!(fabs(p[a] - by->from[a]) <= most))
      return TOO_FAR;
  near->looked_up++;
  fit exact = holder_of(near, near->places, p, vertex);
  return exact == FREE && by->floats ? holder_of(near, near->floats, p, vertex) : exact;
}

/* ---- In the direction ---- */

/** Exactly in that direction, by what one axis takes: anything else might meet what is on the other side. */
static bool find_straight(vxm_near_places *near, uint32_t vertex, const vxm_near_moves *by, double p[3]) {
  double step = INFINITY;
  for (int a = 0; a < 3; a++)
    if (fabs(by->toward[a]) > VXM_NEAR_AXIS)
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
static bool find_along(vxm_near_places *near, uint32_t vertex, const vxm_near_moves *by, double p[3]) {
  for (int quarter = 4; quarter <= 12; quarter++) {
    for (int a = 0; a < 3; a++) {
      double step = by->step * quarter / 4 * fabs(by->toward[a]);
      if (fabs(by->toward[a]) > VXM_NEAR_AXIS)
        step = fmax(step, by->unit[a] * (quarter / 4));
      p[a] = rounded(near, by->from[a] + copysign(step, by->toward[a]));
    }
    if (fits(near, vertex, by, p, by->fine) == FREE)
      return true;
  }
  return false;
}

/* ---- All around ---- */

/** Places about one are numbered by how many steps they lie from it along each axis. */
enum { STEPS = 4, PLACES = STEPS * STEPS * STEPS };

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

/** What is known of the places with these steps about this one: where many vertices are in one place, most of
 * them find that all about it is taken. */
static vxm_full_places *full_places(const vxm_near_places *near, const vxm_near_moves *by,
                                    const double step[3]) {
  vxm_full_places key = {.floats = by->floats};
  uint64_t hash = by->floats;
  for (int a = 0; a < 3; a++) {
    uint64_t bits[2];
    key.from[a] = by->from[a];
    key.step[a] = step[a];
    memcpy(&bits[0], &key.from[a], sizeof bits[0]);
    memcpy(&bits[1], &key.step[a], sizeof bits[1]);
    hash = vxm_hash_word(vxm_hash_word(hash, bits[0]), bits[1]);
  }
  vxm_full_places *full = &near->full[hash % VXM_FULL_PLACES];
  if (memcmp(full->from, key.from, sizeof key.from) != 0 ||
      memcmp(full->step, key.step, sizeof key.step) != 0 || full->floats != key.floats)
    *full = key;
  return full;
}

/** Those of the places about one that lie on the side of the faces and may be free; returns how many. */
static int list_places(nearby places[PLACES], const vxm_near_places *near, const vxm_near_moves *by,
                       const double step[3], uint64_t taken) {
  int count = 0;
  for (int n = 1; n < PLACES; n++) {
    if (taken >> n & 1)
      continue;
    const int steps[3] = {n % STEPS, n / STEPS % STEPS, n / STEPS / STEPS};
    nearby *place = &places[count];
    double along = 0, squared = 0;
    for (int a = 0; a < 3; a++) {
      double by_axis = steps[a] * step[a];
      place->p[a] = rounded(near, by->from[a] + by_axis);
      along += by_axis * by->toward[a];
      squared += by_axis * by_axis;
    }
    place->distance = sqrt(squared);
    place->number = n;
    count += along >= VXM_NEAR_AXIS * place->distance;
  }
  return count;
}

/** Where numbers are coarse: the nearest place that lies on the side of the faces, such as along the one axis
 * on which they are fine. */
static bool find_nearest(vxm_near_places *near, uint32_t vertex, const vxm_near_moves *by, double p[3]) {
  nearby places[PLACES];
  double step[3];
  for (int a = 0; a < 3; a++)
    step[a] = copysign(fmax(by->step, by->unit[a]), by->toward[a]);
  vxm_full_places *full = full_places(near, by, step);
  int count = list_places(places, near, by, step, full->taken);
  qsort(places, (size_t)count, sizeof *places, by_distance);
  for (int i = 0; i < count; i++) {
    fit found = fits(near, vertex, by, places[i].p, by->coarse);
    if (found == TAKEN_FOR_GOOD)
      full->taken |= (uint64_t)1 << places[i].number;
    if (found != FREE)
      continue;
    memcpy(p, places[i].p, sizeof places[i].p);
    return true;
  }
  return false;
}

bool vxm_near_places_find(vxm_near_places *near, uint32_t vertex, const vxm_near_moves *by, double p[3]) {
  return (by->straight && find_straight(near, vertex, by, p)) || find_along(near, vertex, by, p) ||
         find_nearest(near, vertex, by, p);
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/manifold/radial_sort.h"

#include "mesh/geometry.h"

#include <stdlib.h>

/** Faces nearer to each other than this, in radians, lie upon each other as far as the order is concerned. */
static const double SAME_ANGLE = 1e-5;

static const double TURN = 6.283185307179586476925286766559;

/* ---- The order around the edge ---- */

/** From the edge into the face: the face lies to the left of its side. */
static vxm_vec3 inward(const vxm_radial_side *s, const vxm_soup *soup, vxm_vec3 axis, double scale) {
  size_t count;
  const uint32_t *corners = vxm_face(soup, s->face, &count);
  vxm_vec3 normal = vxm_polygon_area(soup->positions, corners, count, scale);
  return s->forward ? vxm_vec3_cross(normal, axis) : vxm_vec3_cross(axis, normal);
}

static void measure(vxm_radial_side *sides, size_t count, const vxm_soup *soup, const double *from,
                    const double *to, double scale) {
  vxm_vec3 axis = vxm_vec3_between(to, from, scale), first = {0, 0, 0}, second = {0, 0, 0};
  double length = vxm_vec3_length(axis);
  bool has_first = false;
  for (size_t i = 0; i < count; i++) {
    vxm_vec3 into = inward(&sides[i], soup, axis, scale);
    if (!has_first && vxm_vec3_length(into) > 0) {
      has_first = true;
      first = into;
      second = vxm_vec3_cross(axis, first); /* as long as the first one times the axis */
    }
    double angle = atan2(vxm_vec3_dot(into, second), vxm_vec3_dot(into, first) * length);
    if (!isfinite(angle))
      angle = 0;
    sides[i].angle = angle < 0 ? angle + TURN : angle;
  }
}

static int compare_words(uint32_t p, uint32_t q) {
  return p < q ? -1 : p > q;
}

static int by_angle(const void *a, const void *b) {
  const vxm_radial_side *p = a, *q = b;
  if (p->angle != q->angle)
    return p->angle < q->angle ? -1 : 1;
  return compare_words(p->side, q->side);
}

/**
 * Of faces that lie upon each other the forward ones come first: they end one wedge before the others begin
 * the next, so that two solids with a wall in common keep their halves of it.
 */
static int by_rank(const void *a, const void *b) {
  const vxm_radial_side *p = a, *q = b;
  if (p->rank != q->rank)
    return compare_words(p->rank, q->rank);
  return p->forward != q->forward ? (p->forward ? -1 : 1) : compare_words(p->side, q->side);
}

static int by_group_then_rank(const void *a, const void *b) {
  const vxm_radial_side *p = a, *q = b;
  return p->group != q->group ? compare_words(p->group, q->group) : by_rank(a, b);
}

/** Sorts by angle, and ranks from the largest gap on, which is no place within faces upon each other. */
static void rank_sides(vxm_radial_side *sides, size_t count) {
  qsort(sides, count, sizeof *sides, by_angle);
  size_t cut = 0;
  double largest = sides[0].angle + TURN - sides[count - 1].angle;
  for (size_t i = 1; i < count; i++)
    if (sides[i].angle - sides[i - 1].angle > largest) {
      largest = sides[i].angle - sides[i - 1].angle;
      cut = i;
    }
  uint32_t rank = 0;
  for (size_t i = 0; i < count; i++) {
    vxm_radial_side *s = &sides[(cut + i) % count];
    if (i > 0) {
      double gap = s->angle - sides[(cut + i - 1) % count].angle;
      rank += (gap < 0 ? gap + TURN : gap) > SAME_ANGLE;
    }
    s->rank = rank;
  }
}

/* ---- Pairs ---- */

/** Matches the sides without a partner as brackets, twice around since wedges go on past the last place. */
static void match_brackets(vxm_radial_side *sides, size_t count) {
  uint32_t top = VXM_NO_SIDE;
  for (int round = 0; round < 2; round++)
    for (size_t i = 0; i < count; i++) {
      vxm_radial_side *s = &sides[i];
      if (s->partner != VXM_NO_SIDE)
        continue;
      if (!s->forward && round == 0) {
        s->below = top;
        top = (uint32_t)i;
      } else if (s->forward && top != VXM_NO_SIDE) {
        vxm_radial_side *open = &sides[top];
        top = open->below;
        open->partner = s->side;
        s->partner = open->side;
      }
    }
}

static void match_groups(vxm_radial_side *sides, size_t count) {
  qsort(sides, count, sizeof *sides, by_group_then_rank);
  for (size_t begin = 0, end; begin < count; begin = end) {
    size_t forward = 0;
    for (end = begin; end < count && sides[end].group == sides[begin].group; end++)
      forward += sides[end].forward;
    if (2 * forward == end - begin)
      match_brackets(sides + begin, end - begin);
  }
}

void vxm_radial_sort_order(vxm_radial_side *sides, size_t count, const vxm_soup *soup, const double *from,
                           const double *to, double scale) {
  if (count < 2)
    return;
  measure(sides, count, soup, from, to, scale);
  rank_sides(sides, count);
  qsort(sides, count, sizeof *sides, by_rank);
}

void vxm_radial_sort_match(vxm_radial_side *sides, size_t count, const vxm_soup *soup, const double *from,
                           const double *to, double scale) {
  for (size_t i = 0; i < count; i++)
    sides[i].partner = VXM_NO_SIDE;
  if (count < 2)
    return;
  vxm_radial_sort_order(sides, count, soup, from, to, scale);
  match_groups(sides, count);
  qsort(sides, count, sizeof *sides, by_rank);
  match_brackets(sides, count);
}

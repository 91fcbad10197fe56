/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/manifold/halfedge_pairing.h"

#include "mesh/disjoint_sets.h"
#include "mesh/sort.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Joining sides gives each corner at most one that follows it and one that it follows around its vertex, so
   the corners of a vertex fall into closed and open fans whatever is joined. What could still be wrong is
   that two edges lead from one fan to another: then exchanging the partners of their sides cuts both fans in
   two, as exchanging two images does with a cycle of a permutation, and the edges end at different fans. No
   edge gets worse by that, as fans only become smaller. */

#define CORNERS_MAX ((size_t)1 << 30)

typedef struct building {
  vxm_halfedge_pairing *pairing;
  vxm_error error;
  uint32_t *begin; /**< per vertex: where the sides whose lower end it is begin in `sides`; one more */
  uint64_t *sides; /**< by lower, then by higher end: the higher end << 32 | the side */
  uint32_t *patch; /**< per face: a face of the same patch, the root of it at last */
  vxm_radial_side *around;
  struct bond *bonds;
} building;

/** The sides along one edge: sides[begin] to sides[end - 1]. */
typedef struct span {
  uint32_t low, high, begin, end;
} span;

static void *allocate(building *b, size_t count, size_t size) {
  return vxm_alloc(b->pairing->soup->context, count, size, &b->error);
}

static bool progress(building *b, double fraction) {
  return vxm_progress(b->pairing->soup->context, "separating", fraction, &b->error) == VXM_OK;
}

/* ---- Checks ---- */

static bool fail_face(building *b, size_t face) {
  vxm_fail_at(&b->error, VXM_ERROR_ARGUMENT, (vxm_place){NULL, 0, -1, (int64_t)face},
              "face %zu has fewer than three corners or one of them twice: repair the mesh first", face);
  return false;
}

/** Fills `face`, and looks at the faces; `seen` is scratch per vertex. */
static bool number_corners(building *b, uint32_t *seen) {
  const vxm_soup *soup = b->pairing->soup;
  memset(seen, 0xff, soup->vertex_count * sizeof *seen);
  for (size_t f = 0; f < soup->face_count; f++) {
    if (soup->offsets[f + 1] - soup->offsets[f] < 3)
      return fail_face(b, f);
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++) {
      if (seen[soup->indices[c]] == f)
        return fail_face(b, f);
      seen[soup->indices[c]] = (uint32_t)f;
      b->pairing->face[c] = (uint32_t)f;
    }
  }
  return true;
}

static double find_scale(const vxm_soup *soup) {
  double largest = 0;
  for (size_t i = 0; i < 3 * soup->vertex_count; i++) {
    double size = fabs(soup->positions[i]);
    if (size > largest && isfinite(size))
      largest = size;
  }
  int exponent;
  frexp(largest, &exponent);
  return ldexp(1.0, exponent < -1020 ? 1020 : -exponent);
}

/* ---- Sides by edge ---- */

static bool sort_sides(building *b) {
  const vxm_soup *soup = b->pairing->soup;
  size_t largest = 0;
  memset(b->begin, 0, (soup->vertex_count + 1) * sizeof *b->begin);
  for (uint32_t c = 0; c < soup->corner_count; c++) {
    uint32_t u = soup->indices[c], v = soup->indices[vxm_halfedge_pairing_next(b->pairing, c)];
    b->begin[(u < v ? u : v) + 1]++;
  }
  for (size_t v = 0; v < soup->vertex_count; v++) {
    largest = b->begin[v + 1] > largest ? b->begin[v + 1] : largest;
    b->begin[v + 1] += b->begin[v];
  }
  for (uint32_t c = 0; c < soup->corner_count; c++) {
    uint32_t u = soup->indices[c], v = soup->indices[vxm_halfedge_pairing_next(b->pairing, c)];
    b->sides[b->begin[u < v ? u : v]++] = (uint64_t)(u < v ? v : u) << 32 | c;
  }
  memmove(b->begin + 1, b->begin, soup->vertex_count * sizeof *b->begin);
  b->begin[0] = 0;
  uint64_t *scratch = allocate(b, largest, sizeof *scratch);
  if (!scratch)
    return false;
  for (size_t v = 0; v < soup->vertex_count; v++)
    vxm_sort_keys(b->sides + b->begin[v], scratch, b->begin[v + 1] - b->begin[v]);
  vxm_free(soup->context, scratch);
  return true;
}

/** Goes on to the next edge; start with a span of zeros. */
static bool next_span(const building *b, span *s) {
  uint32_t count = (uint32_t)b->pairing->soup->corner_count;
  s->begin = s->end;
  if (s->begin == count)
    return false;
  while (b->begin[s->low + 1] <= s->begin)
    s->low++;
  s->high = (uint32_t)(b->sides[s->begin] >> 32);
  while (s->end < b->begin[s->low + 1] && b->sides[s->end] >> 32 == s->high)
    s->end++;
  return true;
}

static uint32_t side_of(const building *b, uint32_t place) {
  return (uint32_t)b->sides[place];
}

static bool is_forward(const building *b, const span *s, uint32_t side) {
  return b->pairing->soup->indices[side] == s->low;
}

/* ---- Joining ---- */

static uint32_t patch_of(const building *b, uint32_t side) {
  return vxm_set_of_u32(b->patch, b->pairing->face[side]);
}

/** Joins the sides of plain edges and makes patches of the faces; returns the largest number of sides. */
static uint32_t join_plain(building *b) {
  uint32_t largest = 0;
  for (span s = {0}; next_span(b, &s);) {
    uint32_t count = s.end - s.begin;
    largest = count > largest ? count : largest;
    if (count != 2)
      continue;
    uint32_t p = side_of(b, s.begin), q = side_of(b, s.begin + 1);
    if (is_forward(b, &s, p) == is_forward(b, &s, q))
      continue;
    vxm_halfedge_pairing_join(b->pairing, p, q);
    b->patch[patch_of(b, p)] = patch_of(b, q);
  }
  return largest;
}

static void join_wedges(building *b) {
  const vxm_soup *soup = b->pairing->soup;
  for (span s = {0}; next_span(b, &s);) {
    size_t count = s.end - s.begin;
    if (count < 3)
      continue;
    for (size_t i = 0; i < count; i++) {
      uint32_t side = side_of(b, s.begin + (uint32_t)i);
      b->around[i] = (vxm_radial_side){.side = side,
                                       .face = b->pairing->face[side],
                                       .group = patch_of(b, side),
                                       .forward = is_forward(b, &s, side)};
    }
    vxm_radial_sort_match(b->around, count, soup, vxm_position(soup, s.low), vxm_position(soup, s.high),
                          b->pairing->scale);
    for (size_t i = 0; i < count; i++)
      b->pairing->partner[b->around[i].side] = b->around[i].partner;
  }
}

/* ---- Fans ---- */

/** Gives a number to the fan of a corner. */
static void label(vxm_halfedge_pairing *pairing, uint32_t corner, uint32_t number) {
  uint32_t first = corner;
  for (uint32_t c = vxm_halfedge_pairing_before(pairing, corner); c != VXM_NO_SIDE && c != corner;
       c = vxm_halfedge_pairing_before(pairing, c))
    first = c;
  if (vxm_halfedge_pairing_before(pairing, first) != VXM_NO_SIDE)
    first = corner;
  pairing->start[number] = first;
  uint32_t c = first;
  do {
    pairing->fan[c] = number;
    c = vxm_halfedge_pairing_after(pairing, c);
  } while (c != VXM_NO_SIDE && c != first);
}

static void label_all(vxm_halfedge_pairing *pairing) {
  size_t corners = pairing->soup->corner_count;
  memset(pairing->fan, 0xff, corners * sizeof *pairing->fan);
  for (uint32_t c = 0; c < corners; c++)
    if (pairing->fan[c] == UINT32_MAX)
      label(pairing, c, pairing->fan_count++);
}

/* ---- Edges between the same two fans ---- */

/** A joined pair of sides along an edge, or one side alone; VXM_NO_SIDE for what is missing. */
typedef struct bond {
  uint32_t forward, backward;
  uint32_t low_fan, high_fan; /**< at the ends of the edge */
} bond;

static void find_ends(const vxm_halfedge_pairing *pairing, bond *p) {
  if (p->forward != VXM_NO_SIDE) {
    p->low_fan = pairing->fan[p->forward];
    p->high_fan = pairing->fan[vxm_halfedge_pairing_next(pairing, p->forward)];
  } else {
    p->low_fan = pairing->fan[vxm_halfedge_pairing_next(pairing, p->backward)];
    p->high_fan = pairing->fan[p->backward];
  }
}

static bool have_same_ends(const bond *p, const bond *q) {
  return p->low_fan == q->low_fan && p->high_fan == q->high_fan;
}

static int by_ends(const void *a, const void *b) {
  const bond *p = a, *q = b;
  if (p->low_fan != q->low_fan)
    return p->low_fan < q->low_fan ? -1 : 1;
  if (p->high_fan != q->high_fan)
    return p->high_fan < q->high_fan ? -1 : 1;
  return p->forward != q->forward ? (p->forward < q->forward ? -1 : 1)
                                  : (p->backward > q->backward) - (p->backward < q->backward);
}

static void set_partner(vxm_halfedge_pairing *pairing, const bond *p) {
  if (p->forward != VXM_NO_SIDE)
    pairing->partner[p->forward] = p->backward;
  if (p->backward != VXM_NO_SIDE)
    pairing->partner[p->backward] = p->forward;
}

/** Exchanges the backward sides of two bonds between the same two fans, which cuts either fan in two. */
static void exchange(vxm_halfedge_pairing *pairing, bond *p, bond *q) {
  uint32_t backward = p->backward;
  p->backward = q->backward;
  q->backward = backward;
  set_partner(pairing, p);
  set_partner(pairing, q);
  uint32_t side = p->forward != VXM_NO_SIDE ? p->forward : p->backward,
           end = vxm_halfedge_pairing_next(pairing, side);
  label(pairing, side, pairing->fan[side]);
  label(pairing, end, pairing->fan[end]);
  side = q->forward != VXM_NO_SIDE ? q->forward : q->backward;
  label(pairing, side, pairing->fan_count++);
  label(pairing, vxm_halfedge_pairing_next(pairing, side), pairing->fan_count++);
}

static size_t list_bonds(building *b, const span *s) {
  size_t count = 0;
  for (uint32_t i = s->begin; i < s->end; i++) {
    uint32_t side = side_of(b, i), partner = b->pairing->partner[side];
    if (is_forward(b, s, side))
      b->bonds[count++] = (bond){.forward = side, .backward = partner};
    else if (partner == VXM_NO_SIDE)
      b->bonds[count++] = (bond){.forward = VXM_NO_SIDE, .backward = side};
  }
  return count;
}

static void part_bonds(vxm_halfedge_pairing *pairing, bond *bonds, size_t count) {
  bool changed = true;
  while (changed) {
    changed = false;
    for (size_t i = 0; i < count; i++)
      find_ends(pairing, &bonds[i]);
    qsort(bonds, count, sizeof *bonds, by_ends);
    for (size_t i = 0; i + 1 < count; i++) {
      find_ends(pairing, &bonds[i]); /* an exchange before may have parted these already */
      find_ends(pairing, &bonds[i + 1]);
      if (!have_same_ends(&bonds[i], &bonds[i + 1]))
        continue;
      exchange(pairing, &bonds[i], &bonds[i + 1]);
      changed = true;
    }
  }
}

static void part_fans(building *b) {
  for (span s = {0}; next_span(b, &s);)
    if (s.end - s.begin > 2)
      part_bonds(b->pairing, b->bonds, list_bonds(b, &s));
}

/* ---- All of it ---- */

static bool allocate_all(building *b) {
  const vxm_soup *soup = b->pairing->soup;
  vxm_halfedge_pairing *pairing = b->pairing;
  pairing->face = allocate(b, soup->corner_count, sizeof *pairing->face);
  pairing->partner = allocate(b, soup->corner_count, sizeof *pairing->partner);
  pairing->fan = allocate(b, soup->corner_count, sizeof *pairing->fan);
  pairing->start = allocate(b, soup->corner_count, sizeof *pairing->start);
  b->begin = allocate(b, soup->vertex_count + 1, sizeof *b->begin);
  b->sides = allocate(b, soup->corner_count, sizeof *b->sides);
  b->patch = allocate(b, soup->face_count, sizeof *b->patch);
  return pairing->face && pairing->partner && pairing->fan && pairing->start && b->begin && b->sides &&
         b->patch;
}

static bool build(building *b) {
  const vxm_soup *soup = b->pairing->soup;
  if (!allocate_all(b) || !number_corners(b, b->begin) || !progress(b, 0.0) || !sort_sides(b))
    return false;
  memset(b->pairing->partner, 0xff, soup->corner_count * sizeof *b->pairing->partner);
  for (uint32_t f = 0; f < soup->face_count; f++)
    b->patch[f] = f;
  b->pairing->scale = find_scale(soup);
  uint32_t largest = join_plain(b);
  b->around = allocate(b, largest, sizeof *b->around);
  b->bonds = allocate(b, largest, sizeof *b->bonds);
  if (!b->around || !b->bonds || !progress(b, 0.4))
    return false;
  join_wedges(b);
  label_all(b->pairing);
  if (!progress(b, 0.7))
    return false;
  part_fans(b);
  return true;
}

vxm_status vxm_halfedge_pairing_build(vxm_halfedge_pairing *out, const vxm_soup *soup, vxm_error *error) {
  *out = (vxm_halfedge_pairing){.soup = soup};
  if (soup->corner_count > CORNERS_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "%zu corners; at most %zu can be separated: split the mesh",
                    soup->corner_count, CORNERS_MAX);
  building b = {.pairing = out, .error = VXM_ERROR_INIT};
  bool done = build(&b);
  vxm_free(soup->context, b.bonds);
  vxm_free(soup->context, b.around);
  vxm_free(soup->context, b.patch);
  vxm_free(soup->context, b.sides);
  vxm_free(soup->context, b.begin);
  if (done)
    return VXM_OK;
  vxm_halfedge_pairing_destroy(out);
  vxm_error_pass(error, &b.error);
  return b.error.code;
}

void vxm_halfedge_pairing_destroy(vxm_halfedge_pairing *pairing) {
  if (!pairing->soup)
    return;
  vxm_context *context = pairing->soup->context;
  vxm_free(context, pairing->start);
  vxm_free(context, pairing->fan);
  vxm_free(context, pairing->partner);
  vxm_free(context, pairing->face);
  *pairing = (vxm_halfedge_pairing){0};
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/sort.h"
#include "repair/manifold/halfedge_pairing.h"

#include <stdlib.h>
#include <string.h>

/* Joining two sides makes one fan of those at their starts and ends. Fans only grow by it, so what may not be
   joined once may never be, and one look at every edge leaves nothing to do. */

enum { TRIES_PER_SIDE = 32, LOOK_EVERY = 1024 };

/** A side without a partner, between two places: positions of vertices. */
typedef struct rim_side {
  uint32_t low, high; /**< places */
  uint32_t side;
} rim_side;

/** A fan at a rim. */
typedef struct rim_fan {
  double position[3];
  uint32_t fan;
} rim_fan;

typedef struct stitching {
  vxm_halfedge_pairing *pairing;
  vxm_error error;
  rim_side *rim;
  size_t rim_count;
  rim_fan *rim_fans;
  uint32_t *place;          /**< per fan at a rim: its position's number */
  uint32_t *left, *entered; /**< per fan: the last look that found a side to it and one from it */
  uint32_t look;
  vxm_radial_side *around;
  int64_t stitched;
  size_t tries;
} stitching;

static void *allocate(stitching *s, size_t count, size_t size) {
  return vxm_alloc(s->pairing->soup->context, count, size, &s->error);
}

static uint32_t end_fan(const vxm_halfedge_pairing *pairing, uint32_t side) {
  return pairing->fan[vxm_halfedge_pairing_next(pairing, side)];
}

static const double *position_of(const vxm_halfedge_pairing *pairing, uint32_t corner) {
  return vxm_position(pairing->soup, pairing->soup->indices[corner]);
}

/* ---- Places ---- */

static int by_position(const void *a, const void *b) {
  const rim_fan *p = a, *q = b;
  for (int i = 0; i < 3; i++)
    if (p->position[i] != q->position[i])
      return p->position[i] < q->position[i] ? -1 : 1;
  return (p->fan > q->fan) - (p->fan < q->fan);
}

static void note_fan(stitching *s, size_t *count, uint32_t corner) {
  uint32_t fan = s->pairing->fan[corner];
  if (s->place[fan] == 0)
    return;
  s->place[fan] = 0;
  const double *p = position_of(s->pairing, corner);
  /* of both zeros the positive one */
  s->rim_fans[(*count)++] = (rim_fan){{p[0] + 0.0, p[1] + 0.0, p[2] + 0.0}, fan};
}

/** Numbers the positions of the fans at rims; false if no two fans are at the same one. */
static bool number_places(stitching *s) {
  size_t count = 0;
  uint32_t next = 0;
  memset(s->place, 0xff, s->pairing->fan_count * sizeof *s->place);
  for (size_t i = 0; i < s->rim_count; i++) {
    note_fan(s, &count, s->rim[i].side);
    note_fan(s, &count, vxm_halfedge_pairing_next(s->pairing, s->rim[i].side));
  }
  qsort(s->rim_fans, count, sizeof *s->rim_fans, by_position);
  for (size_t i = 0; i < count; i++) {
    const rim_fan *f = &s->rim_fans[i];
    next += i > 0 && memcmp(f->position, f[-1].position, sizeof f->position) != 0;
    s->place[f->fan] = next;
  }
  return count > 0 && next + 1 < count;
}

static int by_places(const void *a, const void *b) {
  const rim_side *p = a, *q = b;
  if (p->low != q->low)
    return p->low < q->low ? -1 : 1;
  return vxm_compare_pairs(p->high, p->side, q->high, q->side);
}

static void sort_rim(stitching *s) {
  for (size_t i = 0; i < s->rim_count; i++) {
    rim_side *r = &s->rim[i];
    uint32_t from = s->place[s->pairing->fan[r->side]], to = s->place[end_fan(s->pairing, r->side)];
    r->low = from < to ? from : to;
    r->high = from < to ? to : from;
  }
  qsort(s->rim, s->rim_count, sizeof *s->rim, by_places);
}

/* ---- Whether sides may be joined ---- */

/** Fans that would become one: `gone` would take the number `kept`. */
typedef struct merging {
  uint32_t kept[2], gone[2];
} merging;

static uint32_t number_after(const merging *m, uint32_t fan) {
  return fan == m->gone[0] ? m->kept[0] : fan == m->gone[1] ? m->kept[1] : fan;
}

static bool face_has_fan(const vxm_halfedge_pairing *pairing, uint32_t face, uint32_t fan) {
  for (uint64_t c = pairing->soup->offsets[face]; c < pairing->soup->offsets[face + 1]; c++)
    if (pairing->fan[c] == fan)
      return true;
  return false;
}

/** Looks at the sides of a fan: false if it would meet a vertex twice in the same direction. */
static bool note_sides(stitching *s, const merging *m, uint32_t fan) {
  const vxm_halfedge_pairing *pairing = s->pairing;
  uint32_t first = pairing->start[fan], c = first;
  do {
    uint32_t to = number_after(m, end_fan(pairing, c));
    uint32_t from = number_after(m, pairing->fan[vxm_halfedge_pairing_previous(pairing, c)]);
    if (s->left[to] == s->look || s->entered[from] == s->look)
      return false;
    s->left[to] = s->entered[from] = s->look;
    c = vxm_halfedge_pairing_after(pairing, c);
  } while (c != VXM_NO_SIDE && c != first);
  return true;
}

static bool share_face(const vxm_halfedge_pairing *pairing, uint32_t p, uint32_t q) {
  uint32_t first = pairing->start[p], c = first;
  do {
    if (face_has_fan(pairing, pairing->face[c], q))
      return true;
    c = vxm_halfedge_pairing_after(pairing, c);
  } while (c != VXM_NO_SIDE && c != first);
  return false;
}

static bool may_merge(stitching *s, const merging *m) {
  for (int i = 0; i < 2; i++) {
    if (m->kept[i] == m->gone[i])
      continue;
    s->look++;
    if (!note_sides(s, m, m->kept[i]) || !note_sides(s, m, m->gone[i]) ||
        share_face(s->pairing, m->gone[i], m->kept[i]))
      return false;
  }
  return true;
}

/* ---- Joining ---- */

static void renumber(vxm_halfedge_pairing *pairing, uint32_t fan, uint32_t number) {
  uint32_t first = pairing->start[fan], c = first;
  do {
    pairing->fan[c] = number;
    c = vxm_halfedge_pairing_after(pairing, c);
  } while (c != VXM_NO_SIDE && c != first);
}

/** Where the two ends of an open fan meet the same vertex, they are one edge. */
static void close_fan(stitching *s, uint32_t fan) {
  vxm_halfedge_pairing *pairing = s->pairing;
  uint32_t first = pairing->start[fan], last = first, in = vxm_halfedge_pairing_previous(pairing, first);
  if (pairing->partner[in] != VXM_NO_SIDE)
    return;
  for (uint32_t c = vxm_halfedge_pairing_after(pairing, first); c != VXM_NO_SIDE;
       c = vxm_halfedge_pairing_after(pairing, c))
    last = c;
  if (end_fan(pairing, last) != pairing->fan[in])
    return;
  vxm_halfedge_pairing_join(pairing, last, in);
  s->stitched++;
}

static bool try_join(stitching *s, uint32_t p, uint32_t q) {
  vxm_halfedge_pairing *pairing = s->pairing;
  if (pairing->partner[p] != VXM_NO_SIDE || pairing->partner[q] != VXM_NO_SIDE)
    return false;
  /* going around the start of a side it is the last one, around its end the first */
  merging m = {{pairing->fan[p], pairing->fan[q]}, {end_fan(pairing, q), end_fan(pairing, p)}};
  s->tries++;
  if (!may_merge(s, &m))
    return false;
  for (int i = 0; i < 2; i++)
    if (m.kept[i] != m.gone[i])
      renumber(pairing, m.gone[i], m.kept[i]);
  vxm_halfedge_pairing_join(pairing, p, q);
  s->stitched++;
  close_fan(s, m.kept[0]);
  close_fan(s, m.kept[1]);
  return true;
}

/** Tries those that bound a wedge first, then all others that run opposite ways. */
static void join_along(stitching *s, size_t count) {
  for (size_t i = 0; i < count; i++) {
    const vxm_radial_side *w = &s->around[i];
    if (w->forward && w->partner != VXM_NO_SIDE)
      try_join(s, w->side, w->partner);
  }
  for (size_t i = 0; i < count; i++)
    for (size_t j = 1, tries = 0; j < count && tries < TRIES_PER_SIDE; j++) {
      const vxm_radial_side *w = &s->around[i], *other = &s->around[(i + j) % count];
      if (!w->forward || s->pairing->partner[w->side] != VXM_NO_SIDE)
        break;
      if (other->forward || s->pairing->partner[other->side] != VXM_NO_SIDE)
        continue;
      tries++;
      try_join(s, w->side, other->side);
    }
}

static void stitch_edge(stitching *s, size_t begin, size_t end) {
  vxm_halfedge_pairing *pairing = s->pairing;
  size_t forward = 0, count = end - begin;
  for (size_t i = 0; i < count; i++) {
    uint32_t side = s->rim[begin + i].side;
    bool is_forward = s->place[pairing->fan[side]] == s->rim[begin].low;
    forward += is_forward;
    s->around[i] = (vxm_radial_side){.side = side, .face = pairing->face[side], .forward = is_forward};
  }
  if (forward == 0 || forward == count || s->rim[begin].low == s->rim[begin].high)
    return;
  const double *p = position_of(pairing, s->rim[begin].side);
  const double *q = position_of(pairing, vxm_halfedge_pairing_next(pairing, s->rim[begin].side));
  bool upward = s->place[pairing->fan[s->rim[begin].side]] == s->rim[begin].low;
  vxm_radial_sort_match(s->around, count, pairing->soup, upward ? p : q, upward ? q : p, pairing->scale);
  join_along(s, count);
}

static bool stitch_all(stitching *s) {
  for (size_t begin = 0, end, next_look = LOOK_EVERY; begin < s->rim_count; begin = end) {
    for (end = begin; end < s->rim_count && s->rim[end].low == s->rim[begin].low &&
                      s->rim[end].high == s->rim[begin].high;)
      end++;
    if (end - begin > 1)
      stitch_edge(s, begin, end);
    if (s->tries < next_look)
      continue;
    next_look = s->tries + LOOK_EVERY;
    if (vxm_progress(s->pairing->soup->context, "stitching", (double)begin / (double)s->rim_count,
                     &s->error) != VXM_OK)
      return false;
  }
  return true;
}

/* ---- All of it ---- */

static bool list_rim(stitching *s) {
  const vxm_halfedge_pairing *pairing = s->pairing;
  size_t count = 0;
  for (uint32_t c = 0; c < pairing->soup->corner_count; c++)
    count += pairing->partner[c] == VXM_NO_SIDE;
  s->rim = allocate(s, count, sizeof *s->rim);
  for (uint32_t c = 0; s->rim && c < pairing->soup->corner_count; c++)
    if (pairing->partner[c] == VXM_NO_SIDE)
      s->rim[s->rim_count++].side = c;
  return s->rim != NULL;
}

static bool stitch(stitching *s) {
  if (!list_rim(s))
    return false;
  if (s->rim_count < 2)
    return true;
  s->place = allocate(s, s->pairing->fan_count, sizeof *s->place);
  s->rim_fans = allocate(s, 2 * s->rim_count, sizeof *s->rim_fans);
  if (!s->place || !s->rim_fans)
    return false;
  if (!number_places(s))
    return true;
  sort_rim(s);
  s->around = allocate(s, s->rim_count, sizeof *s->around);
  s->left = s->around
                ? vxm_calloc(s->pairing->soup->context, s->pairing->fan_count, sizeof *s->left, &s->error)
                : NULL;
  s->entered =
      s->left ? vxm_calloc(s->pairing->soup->context, s->pairing->fan_count, sizeof *s->entered, &s->error)
              : NULL;
  return s->entered && stitch_all(s);
}

vxm_status vxm_halfedge_pairing_stitch(vxm_halfedge_pairing *pairing, int64_t *stitched, vxm_error *error) {
  stitching s = {.pairing = pairing, .error = VXM_ERROR_INIT};
  vxm_context *context = pairing->soup->context;
  bool done = stitch(&s);
  vxm_free(context, s.entered);
  vxm_free(context, s.left);
  vxm_free(context, s.around);
  vxm_free(context, s.rim_fans);
  vxm_free(context, s.place);
  vxm_free(context, s.rim);
  *stitched = done ? s.stitched : 0;
  if (!done)
    vxm_error_pass(error, &s.error);
  return done ? VXM_OK : s.error.code;
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/touching_bodies.h"
#include "mesh/caps.h"
#include "mesh/disjoint_sets.h"
#include "mesh/geometry.h"
#include "mesh/rim_owners.h"
#include "mesh/unit_scale.h"

#include <math.h>
#include <string.h>

typedef vxm_rim_joins builder;

/** Caps over walks as they are that have less than this part of the area they have over rims by themselves
 * close a slit between bodies, whose rims follow each other. */
static const double SLIT_PART = 0.25;

typedef struct parting {
  builder *b;
  vxm_boundary_loops *loops;
  double scale; /**< of lengths where areas are computed, see vxm_unit_scale */
  vxm_rim_owners owners;
  uint8_t *mixed;  /**< per vertex: rims of several owners meet */
  uint8_t *chosen; /**< per vertex: walks are parted there, or are not to be after all */
  uint32_t *last;  /**< per vertex: 1 + the last loop that passed there */
  uint32_t *set;   /**< per loop as it was before: a union-find forest of those that share chosen vertices */
  uint32_t *set_of_edge;  /**< per odd edge: the set of its loop, or NONE if this has no chosen vertex */
  double *before, *after; /**< per set: the area of its caps */
} parting;

static const uint32_t NONE = UINT32_MAX;

static void *allocate(builder *b, size_t count, size_t size) {
  return vxm_calloc(b->context, count, size, &b->error);
}

/** Adds the area of the cap of each loop to that of the set which its edges have, if any. */
static bool add_caps(const parting *p, const uint32_t *set_of_edge, double *area) {
  builder *b = p->b;
  const vxm_boundary_loops *loops = p->loops;
  vxm_caps caps = {.soup = b->soup, .edges = b->edges, .scale = p->scale};
  bool done = true;
  for (size_t l = 0; l < loops->count && done; l++) {
    uint32_t set = set_of_edge[loops->edge[loops->begin[l]]];
    if (set == NONE)
      continue;
    done = vxm_caps_add(&caps, loops, l, true, &b->error) == VXM_OK;
    if (done)
      area[set] += vxm_caps_area(&caps, 0, caps.triangle_count);
    caps.triangle_count = caps.point_count = 0; /* its area is all that is wanted */
    done = done && vxm_check_cancelled_at(l, b->context, &b->error) == VXM_OK;
  }
  vxm_caps_destroy(&caps);
  return done;
}

/* ---- Owners ---- */

static void find_mixed(const parting *p) {
  const builder *b = p->b;
  for (size_t v = 0; v < b->soup->vertex_count; v++) {
    uint32_t first = VXM_NO_OWNER;
    p->mixed[v] = 0;
    for (size_t i = b->first_end[v]; i < b->first_end[v + 1]; i++) {
      uint32_t owner = p->owners.of_edge[b->odd[b->ends[i] / 2].edge];
      p->mixed[v] |= first != VXM_NO_OWNER && owner != VXM_NO_OWNER && owner != first;
      first = first == VXM_NO_OWNER ? owner : first;
    }
  }
}

/** Compares the area of the caps over the rims of each owner with its own: sheets have no owner. Loops are
 * those of each owner by itself. */
static bool tell_sheets(const parting *p) {
  builder *b = p->b;
  const vxm_soup *soup = b->soup;
  double *area = allocate(b, soup->face_count, sizeof *area);
  double *caps = area ? allocate(b, soup->face_count, sizeof *caps) : NULL;
  for (size_t f = 0; caps && f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    area[p->owners.of_face[f]] += vxm_polygon_fan_area(soup->positions, corner, count, p->scale);
  }
  bool done = caps && add_caps(p, p->owners.of_edge, caps);
  for (size_t o = 0; done && o < b->odd_count; o++) {
    uint32_t *owner = &p->owners.of_edge[b->odd[o].edge];
    if (!(caps[*owner] < VXM_SHEET_PART * area[*owner]))
      *owner = VXM_NO_OWNER;
  }
  vxm_free(b->context, caps);
  vxm_free(b->context, area);
  return done;
}

/** Joins the rims of each owner by itself to see which are sheets; then they are joined as before. */
static bool find_bodies(parting *p) {
  builder *b = p->b;
  vxm_extent extent;
  size_t *joined = b->partner;
  if (vxm_rim_owners_find(&p->owners, b->soup, b->edges, &b->error) != VXM_OK ||
      vxm_extent_find(&extent, b->context, b->soup, &b->error) != VXM_OK)
    return false;
  p->scale = vxm_unit_scale_of(extent.bounds).scale;
  b->partner = allocate(b, 2 * b->odd_count, sizeof *b->partner);
  bool done = b->partner && vxm_rim_joins_make(b, NULL, p->owners.of_edge) &&
              vxm_rim_joins_walk(b, p->loops) && tell_sheets(p);
  vxm_free(b->context, b->partner);
  b->partner = joined;
  if (done)
    find_mixed(p);
  return done && vxm_rim_joins_walk(b, p->loops);
}

/* ---- Parting ---- */

/** Chooses the vertices that a walk passes more than once, and at which rims of several owners meet. */
static bool choose(const parting *p) {
  bool any = false;
  memset(p->last, 0, p->b->soup->vertex_count * sizeof *p->last);
  memset(p->chosen, 0, p->b->soup->vertex_count);
  for (size_t l = 0; l < p->loops->count; l++)
    for (size_t s = p->loops->begin[l]; s < p->loops->begin[l + 1]; s++) {
      uint32_t v = p->loops->vertex[s];
      p->chosen[v] |= p->last[v] == l + 1 && p->mixed[v];
      any |= p->chosen[v];
      p->last[v] = (uint32_t)l + 1;
    }
  return any;
}

/** Puts loops that share chosen vertices into one set, and says which one each of their edges is in. */
static void find_sets(const parting *p) {
  const vxm_boundary_loops *loops = p->loops;
  memset(p->last, 0, p->b->soup->vertex_count * sizeof *p->last);
  for (size_t l = 0; l < loops->count; l++) {
    bool changes = false;
    p->set[l] = (uint32_t)l;
    p->before[l] = p->after[l] = 0;
    for (size_t s = loops->begin[l]; s < loops->begin[l + 1]; s++) {
      uint32_t *last = &p->last[loops->vertex[s]];
      if (!p->chosen[loops->vertex[s]])
        continue;
      changes = true;
      if (*last > 0)
        vxm_set_unite_in_order(p->set, (uint32_t)l, *last - 1);
      *last = (uint32_t)l + 1;
    }
    for (size_t s = loops->begin[l]; s < loops->begin[l + 1]; s++)
      p->set_of_edge[loops->edge[s]] = changes ? (uint32_t)l : NONE;
  }
  for (size_t o = 0; o < p->b->odd_count; o++) {
    uint32_t *set = &p->set_of_edge[p->b->odd[o].edge];
    *set = *set == NONE ? NONE : vxm_set_of_u32(p->set, *set);
  }
}

/** Loops that still have several owners are no rims of bodies by themselves: that counts as if their caps had
 * no bounds. */
static void rule_out_mixed(const parting *p) {
  const vxm_boundary_loops *loops = p->loops;
  const uint32_t *owner = p->owners.of_edge;
  for (size_t l = 0; l < loops->count; l++) {
    const size_t *edge = loops->edge + loops->begin[l];
    size_t count = loops->begin[l + 1] - loops->begin[l];
    for (size_t s = 1; s < count && p->set_of_edge[*edge] != NONE; s++)
      if (owner[edge[s]] != owner[*edge])
        p->after[p->set_of_edge[*edge]] = INFINITY;
  }
}

/** Of the chosen vertices those remain where walks are not parted; says whether there are any. */
static bool refuse(const parting *p) {
  const builder *b = p->b;
  bool any = false;
  for (size_t v = 0; v < b->soup->vertex_count; v++) {
    if (!p->chosen[v])
      continue;
    uint32_t set = p->set_of_edge[b->odd[b->ends[b->first_end[v]] / 2].edge];
    p->chosen[v] = p->before[set] < SLIT_PART * p->after[set];
    any |= p->chosen[v];
  }
  return any;
}

static bool part(const parting *p) {
  builder *b = p->b;
  if (!choose(p))
    return true;
  find_sets(p);
  bool done = add_caps(p, p->set_of_edge, p->before) && vxm_rim_joins_make(b, p->chosen, p->owners.of_edge) &&
              vxm_rim_joins_walk(b, p->loops) && add_caps(p, p->set_of_edge, p->after);
  if (!done)
    return false;
  rule_out_mixed(p);
  return !refuse(p) || (vxm_rim_joins_make(b, p->chosen, NULL) && vxm_rim_joins_walk(b, p->loops));
}

static bool allocate_sets(parting *p) {
  builder *b = p->b;
  p->set = allocate(b, b->odd_count, sizeof *p->set);
  p->before = allocate(b, b->odd_count, sizeof *p->before);
  p->after = allocate(b, b->odd_count, sizeof *p->after);
  p->set_of_edge = allocate(b, b->edges->count, sizeof *p->set_of_edge);
  return p->set && p->before && p->after && p->set_of_edge;
}

static bool allocate_marks(parting *p) {
  builder *b = p->b;
  size_t vertices = b->soup->vertex_count;
  p->mixed = allocate(b, vertices, sizeof *p->mixed);
  p->chosen = allocate(b, vertices, sizeof *p->chosen);
  p->last = allocate(b, vertices, sizeof *p->last);
  if (p->mixed)
    memset(p->mixed, 1, vertices); /* before the owners are known */
  return p->mixed && p->chosen && p->last;
}

bool vxm_touching_bodies_part(vxm_rim_joins *b, vxm_boundary_loops *loops) {
  if (!b->fan) /* no vertex has more than two odd edges */
    return true;
  parting p = {.b = b, .loops = loops};
  bool done = allocate_marks(&p);
  if (done && choose(&p))
    done = allocate_sets(&p) && find_bodies(&p) && part(&p);
  vxm_rim_owners_destroy(&p.owners, b->context);
  vxm_free(b->context, p.set_of_edge);
  vxm_free(b->context, p.after);
  vxm_free(b->context, p.before);
  vxm_free(b->context, p.set);
  vxm_free(b->context, p.last);
  vxm_free(b->context, p.chosen);
  vxm_free(b->context, p.mixed);
  return done;
}

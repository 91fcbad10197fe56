/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/clean/repeats.h"

#include "mesh/geometry.h"
#include "repair/state/face_set_sides.h"

#include <string.h>

enum { PEELS_MAX = 16 };

bool vxm_repeats_is_turned(const vxm_repeats *d, size_t face) {
  int64_t surplus = vxm_repeats_surplus(&d->copies[face]);
  return surplus != 0 ? surplus < 0 : d->turned[face];
}

/* ---- Fins ---- */

static void look_at_kind(vxm_repeats *d, size_t face) {
  size_t fin_face = vxm_set_of(d->parent, face), count;
  vxm_fin *f = &d->fins[fin_face];
  const uint32_t *corner = vxm_face(d->soup, face, &count);
  double area = vxm_vec3_length(vxm_polygon_area(d->soup->positions, corner, count, d->frame.scale));
  if (f->least == 0 || vxm_repeats_kept(d, face) < f->least)
    f->least = vxm_repeats_kept(d, face);
  if (vxm_repeats_kept(d, face) > f->most)
    f->most = vxm_repeats_kept(d, face);
  if (!(area <= f->area)) {
    f->area = area;
    f->largest = face;
  }
  for (uint64_t c = d->soup->offsets[face]; c < d->soup->offsets[face + 1]; c++) {
    size_t edge = d->groups.sides[c];
    if (edge == VXM_NO_EDGE)
      continue;
    size_t place = 2 * edge + (d->kinds[face] == VXM_KIND_SAME_WAY);
    bool odd = d->single[place] % 2 == 1, others = d->state->edges.edges[edge].count > d->sides[place];
    f->touches |= others;
    f->hangs |= odd && others;
    f->rimmed |= odd && !others;
    f->ends |= d->single[place] == 1 && !others;
    f->unbalanced |= d->balance[place] != 0;
  }
}

void vxm_repeats_find_fins(vxm_repeats *d) {
  memset(d->at_edge, 0, 2 * d->state->edges.count * sizeof *d->at_edge);
  memset(d->single, 0, 2 * d->state->edges.count * sizeof *d->single);
  memset(d->sides, 0, 2 * d->state->edges.count * sizeof *d->sides);
  memset(d->balance, 0, 2 * d->state->edges.count * sizeof *d->balance);
  for (size_t face = 0; face < d->soup->face_count; face++) {
    d->parent[face] = face;
    d->fins[face] = (vxm_fin){0};
  }
  for (size_t face = 0; face < d->soup->face_count; face++) {
    const vxm_copies *copies = &d->copies[face];
    bool same_way = d->kinds[face] == VXM_KIND_SAME_WAY;
    if (d->kinds[face] == VXM_KIND_PLAIN)
      continue;
    bool turned = vxm_repeats_is_turned(d, face);
    for (uint64_t c = d->soup->offsets[face]; c < d->soup->offsets[face + 1]; c++) {
      size_t edge = d->groups.sides[c], place = 2 * edge + same_way;
      if (edge == VXM_NO_EDGE)
        continue;
      d->single[place]++;
      d->sides[place] += copies->same + copies->opposite;
      d->balance[place] += (d->soup->indices[c] == d->state->edges.edges[edge].a) != turned ? 1 : -1;
      if (d->at_edge[place] == 0)
        d->at_edge[place] = face + 1;
      else
        vxm_set_unite(d->parent, face, d->at_edge[place] - 1);
    }
  }
  for (size_t face = 0; face < d->soup->face_count; face++)
    if (d->kinds[face] != VXM_KIND_PLAIN)
      look_at_kind(d, face);
}

/**
 * A body that is there several times needs no more than one of them: where the kinds of a fin, each taken
 * once, are balanced, so is what stays without them. What is left of a doubled body that shares faces with
 * another one is found anew. Returns whether there was one.
 */
static bool peel(vxm_repeats *d) {
  bool any = false;
  for (size_t face = 0; face < d->soup->face_count; face++) {
    if (d->kinds[face] != VXM_KIND_SAME_WAY || !d->groups.groups[d->groups.of_face[face]].balanced)
      continue;
    const vxm_fin *f = &d->fins[vxm_set_of(d->parent, face)];
    if (f->unbalanced || f->least < 2)
      continue;
    uint32_t *keep = &d->keep[2 * face + (vxm_repeats_surplus(&d->copies[face]) < 0)];
    *keep -= f->least - 1;
    if (*keep == 1)
      d->kinds[face] = VXM_KIND_PLAIN;
    any = true;
  }
  return any;
}

/** Whether of a face that is there either way round one copy stays: a wall between a body that may be there
 * twice and another one that shares it. */
static bool may_be_shared(const vxm_repeats *d, size_t face) {
  const vxm_copies *c = &d->copies[face];
  return vxm_repeats_is_first(d, face) && d->kinds[face] == VXM_KIND_PLAIN && c->same > 0 &&
         c->opposite > 0 && vxm_repeats_kept(d, face) == 1 &&
         d->groups.groups[d->groups.of_face[face]].balanced;
}

/** Adds shared walls to the fins of the same way that they touch; false if there is none. */
static bool join_shared(vxm_repeats *d) {
  bool any = false;
  for (size_t face = 0; face < d->soup->face_count; face++) {
    if (!may_be_shared(d, face))
      continue;
    bool turned = d->keep[2 * face] == 0;
    any = true;
    for (uint64_t c = d->soup->offsets[face]; c < d->soup->offsets[face + 1]; c++) {
      size_t edge = d->groups.sides[c], place = 2 * edge + 1;
      if (edge == VXM_NO_EDGE)
        continue;
      d->balance[place] += (d->soup->indices[c] == d->state->edges.edges[edge].a) != turned ? 1 : -1;
      if (d->at_edge[place] == 0)
        d->at_edge[place] = face + 1;
      else
        vxm_set_unite(d->parent, face, d->at_edge[place] - 1);
    }
  }
  return any;
}

/** Finds which of these sets bound something, and are there twice but for the walls. */
static void look_at_shared(vxm_repeats *d) {
  for (size_t face = 0; face < d->soup->face_count; face++)
    d->fins[face] = (vxm_fin){0};
  for (size_t face = 0; face < d->soup->face_count; face++) {
    bool same_way = d->kinds[face] == VXM_KIND_SAME_WAY, shared = may_be_shared(d, face);
    vxm_fin *f = &d->fins[vxm_set_of(d->parent, face)];
    f->touches |= same_way; /* are there any? */
    f->ends |= shared;
    for (uint64_t c = d->soup->offsets[face]; (same_way || shared) && c < d->soup->offsets[face + 1]; c++)
      f->unbalanced |= d->groups.sides[c] == VXM_NO_EDGE || d->balance[2 * d->groups.sides[c] + 1] != 0;
  }
}

/** The same for a body that shares faces with another one, which has these the other way round: there is one
 * copy more of the rest, and the faces become sheets. */
static bool peel_shared(vxm_repeats *d) {
  bool found = false;
  if (!join_shared(d))
    return false;
  look_at_shared(d);
  for (size_t face = 0; face < d->soup->face_count; face++) {
    const vxm_fin *f = &d->fins[vxm_set_of(d->parent, face)];
    bool shared = may_be_shared(d, face), turned = d->keep[2 * face] == 0;
    if (f->unbalanced || !f->touches || !f->ends || (d->kinds[face] != VXM_KIND_SAME_WAY && !shared))
      continue;
    uint32_t *keep = &d->keep[2 * face];
    found = true;
    if (shared) {
      vxm_repeats_keep_one(d, face, vxm_repeats_is_turned(d, face));
      d->kinds[face] = VXM_KIND_SHEET;
    } else if (--keep[turned] == 1)
      d->kinds[face] = VXM_KIND_PLAIN;
  }
  if (!found) /* the walls are no fins */
    vxm_repeats_find_fins(d);
  return found;
}

void vxm_repeats_peel(vxm_repeats *d) {
  for (int round = 0; round < PEELS_MAX && (peel(d) || peel_shared(d)); round++)
    vxm_repeats_find_fins(d);
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/clean/repeated_faces.h"

#include "mesh/geometry.h"
#include "repair/clean/outer_sides.h"
#include "repair/clean/repeats.h"
#include "repair/state/face_set_sides.h"

#include <string.h>

/** Of the area of the rest of a group: fins that have no more are removed. */
static const double FIN_PART = 0.1;

/* ---- Kinds ---- */

/** What stays where nothing speaks against it. */
static void begin_kind(vxm_repeats *d, size_t face) {
  const vxm_copies *c = &d->copies[face];
  const vxm_edge_group *group = &d->groups.groups[d->groups.of_face[face]];
  int64_t surplus = vxm_repeats_surplus(c);
  vxm_repeats_keep_one(d, face, vxm_repeats_is_turned(d, face));
  if (group->balanced && surplus != 0) {
    d->keep[2 * face] = surplus > 0 ? (uint32_t)surplus : 0;
    d->keep[2 * face + 1] = surplus < 0 ? (uint32_t)-surplus : 0;
    d->kinds[face] = surplus > 1 || surplus < -1 ? VXM_KIND_SAME_WAY : VXM_KIND_PLAIN;
  } else if (group->balanced)
    d->kinds[face] = VXM_KIND_SHEET;
  else if (group->closed && (c->same + c->opposite) % 2 == 0)
    d->kinds[face] = c->opposite > 0 ? VXM_KIND_SHEET : VXM_KIND_SAME_WAY;
}

static void sum_areas(vxm_repeats *d) {
  for (size_t face = 0; face < d->soup->face_count; face++) {
    if (!vxm_repeats_is_first(d, face) ||
        (d->kinds[face] != VXM_KIND_PLAIN && !d->fins[vxm_set_of(d->parent, face)].rimmed))
      continue;
    size_t count, group = d->groups.of_face[face];
    const uint32_t *corner = vxm_face(d->soup, face, &count);
    double area = vxm_vec3_length(vxm_polygon_area(d->soup->positions, corner, count, d->frame.scale));
    if (d->kinds[face] == VXM_KIND_PLAIN)
      d->rest_area[group] += area;
    else
      d->fin_area[group] += area;
  }
}

/* ---- Which bodies lie on the same side of a fin ---- */

/** On which side of a face another one lies that shares an edge with it: 1 above, -1 below, 0 in its plane.
 */
static int side_of(const vxm_repeats *d, size_t face, size_t other) {
  size_t count;
  const uint32_t *corner = vxm_face(d->soup, face, &count);
  vxm_vec3 normal = vxm_polygon_area(d->soup->positions, corner, count, d->frame.scale), sum = {0, 0, 0};
  const double *origin = vxm_position(d->soup, corner[0]);
  corner = vxm_face(d->soup, other, &count);
  for (size_t c = 0; c < count; c++) {
    vxm_vec3 to = vxm_vec3_between(vxm_position(d->soup, corner[c]), origin, d->frame.scale);
    sum = vxm_vec3_sum(sum, to);
  }
  double above = vxm_vec3_dot(normal, sum), none = 1e-9 * vxm_vec3_length(normal) * vxm_vec3_length(sum);
  return above > none ? 1 : above < -none ? -1 : 0;
}

/** Sees where two plain faces hang on a fin of the same way; `tally` is scratch per edge, twice. */
static void look_at_sides(vxm_repeats *d, int8_t *tally) {
  for (size_t face = 0; face < d->soup->face_count; face++)
    for (uint64_t c = d->soup->offsets[face]; c < d->soup->offsets[face + 1]; c++) {
      size_t e = d->groups.sides[c];
      if (e == VXM_NO_EDGE || d->at_edge[2 * e + 1] == 0 || d->state->edges.edges[e].count != 4 ||
          d->kinds[d->copies[face].first] != VXM_KIND_PLAIN)
        continue;
      int side = side_of(d, d->at_edge[2 * e + 1] - 1, face);
      tally[2 * e] = (int8_t)(tally[2 * e] + side);
      tally[2 * e + 1] = (int8_t)(tally[2 * e + 1] + (side != 0));
    }
  for (size_t e = 0; e < d->state->edges.count; e++)
    if (tally[2 * e + 1] == 2)
      d->fins[vxm_set_of(d->parent, d->at_edge[2 * e + 1] - 1)].overlaps += tally[2 * e] != 0 ? 1 : -1;
}

/* ---- What lies within the solid ---- */

/** Whether a face stays as far as has been decided. */
static bool stays(const vxm_repeats *d, size_t face) {
  const vxm_copies *c = &d->copies[face];
  return c->rank < d->keep[2 * c->first + c->turned];
}

/** Whether a face is one of those that tell inside from outside; in groups that are not balanced only faces
 * that repeat no other are. */
static bool bounds(const vxm_repeats *d, size_t face) {
  vxm_face_kind k = (vxm_face_kind)d->kinds[d->copies[face].first];
  bool balanced = d->groups.groups[d->groups.of_face[face]].balanced;
  return stays(d, face) && (k == VXM_KIND_PLAIN || (k == VXM_KIND_SAME_WAY && balanced));
}

/** Whether a face belongs to sheets that are closed for themselves: they may be a body that lies at the solid
 * with a face or two, so that one face does not tell of the others; or cores with the cavity that they fill,
 * and walls between them. */
static bool may_be_body(const vxm_repeats *d, size_t face) {
  const vxm_fin *f = &d->fins[vxm_set_of(d->parent, face)];
  return d->kinds[face] == VXM_KIND_SHEET && !f->hangs && (f->touches ? !f->rimmed : !f->ends);
}

/** Decides about the fins, of which `within` are inside the solid. */
static void settle(vxm_repeats *d, const uint8_t *within) {
  for (size_t face = 0; face < d->soup->face_count; face++) {
    if (d->kinds[face] == VXM_KIND_PLAIN)
      continue;
    size_t root = vxm_set_of(d->parent, face), group = d->groups.of_face[face];
    const vxm_fin *f = &d->fins[root];
    const vxm_copies *c = &d->copies[face];
    bool balanced = d->groups.groups[group].balanced, sheet = d->kinds[face] == VXM_KIND_SHEET;
    uint32_t *keep = &d->keep[2 * face];
    if (vxm_repair_state_guards(d->state, face))
      continue;
    bool drifts =
        f->touches && f->unbalanced && balanced; /* one copy alone would leave the group unbalanced */
    if (within[root] ||
        (sheet && f->hangs && f->rimmed && d->fin_area[group] <= FIN_PART * d->rest_area[group]))
      keep[0] = keep[1] = 0;
    else if (sheet && !f->rimmed && (f->hangs || drifts))
      keep[0] = keep[1] = 1;
    else if (!sheet && !balanced && f->hangs && !f->rimmed && f->overlaps > 0)
      keep[0] = c->same;
  }
}

/**
 * A wall between a room and another one that is inside out may go only where the rooms can be turned alike
 * afterwards: where no edge of the group has more than two sides without it.
 */
static void keep_tangled(vxm_repeats *d, uint8_t *within) {
  uint32_t *going = d->single;
  memset(going, 0, d->state->edges.count * sizeof *going);
  for (size_t face = 0; face < d->soup->face_count; face++)
    for (uint64_t c = d->soup->offsets[face]; c < d->soup->offsets[face + 1]; c++)
      if (d->kinds[face] != VXM_KIND_PLAIN && d->groups.sides[c] != VXM_NO_EDGE &&
          within[vxm_set_of(d->parent, face)])
        going[d->groups.sides[c]] += d->copies[face].same + d->copies[face].opposite;
  for (size_t face = 0; face < d->soup->face_count; face++)
    for (uint64_t c = d->soup->offsets[face]; c < d->soup->offsets[face + 1]; c++) {
      size_t e = d->groups.sides[c];
      if (e != VXM_NO_EDGE && d->state->edges.edges[e].count > going[e] + 2)
        d->tangled[d->groups.of_face[face]] = 1;
    }
  for (size_t face = 0; face < d->soup->face_count; face++)
    if (d->kinds[face] == VXM_KIND_SAME_WAY && d->tangled[d->groups.of_face[face]])
      within[face] = 0;
}

/** Whether the sides of a face of the same way, in a balanced group, have to be asked: all of these, as a fin
 * may go on from a wall between bodies to a skin that two of them share. */
static bool may_be_wall(const vxm_repeats *d, size_t face) {
  return d->kinds[face] == VXM_KIND_SAME_WAY && d->groups.groups[d->groups.of_face[face]].balanced &&
         d->fins[vxm_set_of(d->parent, face)].most == 2;
}

static bool is_asked(const vxm_repeats *d, size_t face) {
  size_t root = vxm_set_of(d->parent, face);
  if (d->kinds[face] == VXM_KIND_PLAIN)
    return false;
  if (!d->fins[root].touches)
    return may_be_body(d, face);
  bool whole = d->kinds[face] == VXM_KIND_SHEET || !d->groups.groups[d->groups.of_face[face]].balanced;
  return whole ? root == face || may_be_body(d, face) : may_be_wall(d, face);
}

/** Whether a face is the wall between a room and another one that is inside out, unless that is a void in
 * what is around it. */
static bool is_wall(const vxm_face_set_side *s) {
  return s->front == -1 && s->back == 1 && (s->front + s->around[0]) * (s->back + s->around[1]) < 0;
}

/** Asks one face of a fin, or all of them, whether they lie within the solid: all have to. */
static vxm_status ask(vxm_repeats *d, vxm_face_set_side *sets, size_t asked, const uint8_t *bound,
                      uint8_t *within, vxm_error *error) {
  vxm_status status = vxm_face_set_sides_find(sets, asked, d->state, &d->groups, bound, false, error);
  for (size_t i = 0; status == VXM_OK && i < asked; i++)
    within[sets[i].set] = 1;
  for (size_t i = 0; status == VXM_OK && i < asked; i++) {
    const vxm_face_set_side *s = &sets[i];
    bool wall = may_be_wall(d, s->face) ? is_wall(s) : s->within;
    within[s->set] = within[s->set] && wall;
  }
  if (status == VXM_OK && asked > 0)
    keep_tangled(d, within);
  return status;
}

static vxm_status find_within(vxm_repeats *d, uint8_t *within, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t faces = d->soup->face_count, asked = 0;
  uint8_t *bound = vxm_repair_state_scratch(d->state, faces, sizeof *bound, &status, error);
  vxm_face_set_side *sets = NULL;
  for (size_t face = 0; bound && face < faces; face++) {
    bound[face] = bounds(d, face);
    asked += is_asked(d, face);
  }
  if (bound)
    sets = vxm_repair_state_scratch(d->state, asked, sizeof *sets, &status, error);
  asked = 0;
  for (size_t face = 0; sets && face < faces; face++)
    if (is_asked(d, face)) {
      size_t root = vxm_set_of(d->parent, face);
      bool wall = may_be_wall(d, face), each = wall || may_be_body(d, face);
      sets[asked++] = (vxm_face_set_side){.face = each ? face : d->fins[root].largest,
                                          .set = root,
                                          .asks_within = !wall,
                                          .asks_around = wall};
    }
  if (sets)
    status = ask(d, sets, asked, bound, within, error);
  vxm_free(d->state->context, sets);
  vxm_free(d->state->context, bound);
  return status;
}

/* ---- The outer side ---- */

/** Of what is closed for itself, and was drawn from both sides, the outer one stays where one does: what lies
 * in other things is taken for a cavity of these if it is turned inward. `counts` and `turn` are scratch per
 * face.
 */
static vxm_status keep_outer(vxm_repeats *d, uint8_t *counts, uint8_t *turn, vxm_error *error) {
  bool any = false;
  for (size_t face = 0; face < d->soup->face_count; face++) {
    counts[face] = may_be_body(d, face) && !d->fins[vxm_set_of(d->parent, face)].rimmed &&
                   vxm_repeats_kept(d, face) == 1;
    any |= counts[face];
  }
  if (!any || d->groups.count < 2) /* alone it is turned outward later */
    return VXM_OK;
  vxm_status status = vxm_outer_sides_find(turn, d->state, d->groups.sides, counts, error);
  for (size_t face = 0; status == VXM_OK && face < d->soup->face_count; face++)
    if (counts[face])
      vxm_repeats_keep_one(d, face, turn[face]);
  return status;
}

/* ---- All of it ---- */

/** Of what is there as often either way, which side looks outward; `counts` is scratch per face. */
static vxm_status find_turned(vxm_repeats *d, uint8_t *counts, vxm_error *error) {
  bool any = false;
  for (size_t face = 0; face < d->soup->face_count; face++) {
    counts[face] = vxm_repeats_is_first(d, face) && vxm_repeats_surplus(&d->copies[face]) == 0;
    any |= counts[face];
  }
  return any ? vxm_outer_sides_find(d->turned, d->state, d->groups.sides, counts, error) : VXM_OK;
}

static vxm_status decide(vxm_repeats *d, int8_t *tally, uint8_t *within, uint8_t *remove, vxm_error *error) {
  vxm_status status = find_turned(d, remove, error);
  if (status != VXM_OK)
    return status;
  for (size_t face = 0; face < d->soup->face_count; face++)
    if (vxm_repeats_is_first(d, face))
      begin_kind(d, face);
  vxm_repeats_find_fins(d);
  vxm_repeats_peel(d);
  sum_areas(d);
  look_at_sides(d, tally);
  status = find_within(d, within, error);
  if (status != VXM_OK)
    return status;
  settle(d, within);
  memset(within, 0, d->soup->face_count);
  status = keep_outer(d, remove, within, error);
  if (status != VXM_OK)
    return status;
  for (size_t face = 0; face < d->soup->face_count; face++)
    remove[face] = !stays(d, face);
  return VXM_OK;
}

static vxm_status prepare(vxm_repeats *d, int8_t **tally, uint8_t **within, vxm_error *error) {
  vxm_repair_state *state = d->state;
  size_t faces = d->soup->face_count;
  vxm_status status = vxm_edge_groups_find(&d->groups, state, error);
  if (status == VXM_OK)
    d->kinds = vxm_repair_state_scratch(state, faces, sizeof *d->kinds, &status, error);
  if (status == VXM_OK)
    d->turned = vxm_repair_state_scratch(state, faces, sizeof *d->turned, &status, error);
  if (status == VXM_OK)
    d->keep = vxm_repair_state_scratch(state, 2 * faces, sizeof *d->keep, &status, error);
  if (status == VXM_OK)
    d->parent = vxm_repair_state_scratch(state, faces, sizeof *d->parent, &status, error);
  if (status == VXM_OK)
    d->fins = vxm_repair_state_scratch(state, faces, sizeof *d->fins, &status, error);
  if (status == VXM_OK)
    d->at_edge = vxm_repair_state_scratch(state, 2 * state->edges.count, sizeof *d->at_edge, &status, error);
  if (status == VXM_OK)
    d->single = vxm_repair_state_scratch(state, 2 * state->edges.count, sizeof *d->single, &status, error);
  if (status == VXM_OK)
    d->sides = vxm_repair_state_scratch(state, 2 * state->edges.count, sizeof *d->sides, &status, error);
  if (status == VXM_OK)
    d->balance = vxm_repair_state_scratch(state, 2 * state->edges.count, sizeof *d->balance, &status, error);
  if (status == VXM_OK)
    d->fin_area = vxm_repair_state_scratch(state, d->groups.count, sizeof *d->fin_area, &status, error);
  if (status == VXM_OK)
    d->rest_area = vxm_repair_state_scratch(state, d->groups.count, sizeof *d->rest_area, &status, error);
  if (status == VXM_OK)
    d->tangled = vxm_repair_state_scratch(state, d->groups.count, sizeof *d->tangled, &status, error);
  if (status == VXM_OK)
    *tally = vxm_repair_state_scratch(state, 2 * state->edges.count, sizeof **tally, &status, error);
  if (status == VXM_OK)
    *within = vxm_repair_state_scratch(state, faces, sizeof **within, &status, error);
  return status;
}

vxm_status vxm_repeated_faces_mark(vxm_repair_state *state, const vxm_copies *copies, uint8_t *remove,
                                   vxm_error *error) {
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  vxm_repeats d = {
      .state = state, .soup = state->soup, .copies = copies, .frame = vxm_unit_scale_of(extent.bounds)};
  int8_t *tally = NULL;
  uint8_t *within = NULL;
  vxm_status status = prepare(&d, &tally, &within, error);
  if (status == VXM_OK)
    status = decide(&d, tally, within, remove, error);
  vxm_free(state->context, within);
  vxm_free(state->context, tally);
  vxm_free(state->context, d.tangled);
  vxm_free(state->context, d.rest_area);
  vxm_free(state->context, d.fin_area);
  vxm_free(state->context, d.balance);
  vxm_free(state->context, d.sides);
  vxm_free(state->context, d.single);
  vxm_free(state->context, d.at_edge);
  vxm_free(state->context, d.fins);
  vxm_free(state->context, d.parent);
  vxm_free(state->context, d.keep);
  vxm_free(state->context, d.turned);
  vxm_free(state->context, d.kinds);
  vxm_edge_groups_destroy(&d.groups, state->context);
  return status;
}

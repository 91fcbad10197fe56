/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/clean/other_diagonals.h"

#include "base/hash.h"
#include "mesh/duplicate_faces.h"
#include "mesh/geometry.h"
#include "mesh/sort.h"
#include "repair/state/edge_groups.h"

#include <stdlib.h>
#include <string.h>

/** Cosine of the angle between triangles and their polygon: less than the first is no polygon, and less than
 * the other is not plane. */
static const double NEARLY_PLANE = 0.95, PLANE = 1 - 1e-10;

/** Of the area of a group times the diagonal: less volume is none. */
static const double NO_VOLUME = 1e-9;

/** Triangles that go on over edges; stored at the one that stands for them. */
typedef struct polygon {
  size_t triangles, border; /**< how many, and of the sides how many are on the border */
  uint64_t hash;            /**< of the edges there, whatever their order */
  vxm_vec3 area;
  bool rimmed;  /**< one of those has no more than two sides */
  bool bent;    /**< a triangle points elsewhere */
  bool plane;   /**< all lie in one plane */
  bool mixed;   /**< its triangles have several tags */
  int turn;     /**< 1 or -1: it is the polygon at `model`, the other way round if -1; else 0 */
  size_t model; /**< place in the list of members */
} polygon;

/** A triangle of a polygon that may have the border of another one. */
typedef struct member {
  uint64_t hash;
  size_t polygon, face;
} member;

/** What is known of a group of faces. */
typedef struct group_sums {
  double volume, area;
  size_t faces, again; /**< how many; how many of them are there already, or will be */
  bool open;           /**< without those, an edge has an odd number of sides */
} group_sums;

/** A side on a border. */
typedef struct border_side {
  uint32_t edge;
  bool forward;
} border_side;

typedef struct aligning {
  vxm_repair_state *state;
  vxm_soup *soup;
  const uint32_t *sides;
  const vxm_edge *edges;
  vxm_unit_scale frame;
  size_t *parent;    /**< per face: another one of its polygon, or itself */
  polygon *polygons; /**< per face that stands for one */
  uint64_t *hashes;  /**< of those that may have the border of another one, sorted */
  size_t hash_count;
  member *members;
  size_t member_count;
  border_side *border[2]; /**< scratch for two of them */
  vxm_edge_groups groups;
  group_sums *sums; /**< per group */
  uint8_t *again;   /**< per face: it is there already, or will be */
} aligning;

static bool is_triangle(const aligning *a, size_t face) {
  return a->soup->offsets[face + 1] - a->soup->offsets[face] == 3;
}

static vxm_vec3 area_of(const aligning *a, size_t face) {
  size_t count;
  const uint32_t *corner = vxm_face(a->soup, face, &count);
  return vxm_polygon_area(a->soup->positions, corner, count, a->frame.scale);
}

static bool points_along(vxm_vec3 area, vxm_vec3 other, double cosine) {
  double both = vxm_vec3_length(area) * vxm_vec3_length(other);
  return both > 0 && vxm_vec3_dot(area, other) >= cosine * both;
}

/* ---- Polygons ---- */

/** Joins two triangles over each edge that has no more and that they run along opposite ways; `first` is
 * scratch per edge. */
static vxm_status join_triangles(aligning *a, size_t *first, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t f = 0; f < a->soup->face_count; f++)
    a->parent[f] = f;
  for (size_t f = 0; f < a->soup->face_count && status == VXM_OK; f++) {
    status = vxm_check_cancelled_at(f, a->state->context, error);
    for (uint64_t c = a->soup->offsets[f]; is_triangle(a, f) && c < a->soup->offsets[f + 1]; c++) {
      uint32_t e = a->sides[c];
      if (e == VXM_NO_EDGE || a->edges[e].count != 2 || a->edges[e].forward != 1)
        continue;
      if (first[e] == 0)
        first[e] = f + 1;
      else if (points_along(area_of(a, f), area_of(a, first[e] - 1), NEARLY_PLANE))
        a->parent[vxm_set_of(a->parent, f)] = vxm_set_of(a->parent, first[e] - 1);
      else
        first[e] = SIZE_MAX; /* the two are on the border of theirs */
    }
  }
  return status;
}

/** Whether a side is on the border of its polygon; of two polygons or, as it were, of one that turns back
 * here. */
static bool is_on_border(const size_t *first, const vxm_edge *edges, uint32_t e) {
  return edges[e].count != 2 || edges[e].forward != 1 || first[e] == 0 || first[e] == SIZE_MAX;
}

/** Adds up what the polygons are made of; marks sides that are on a border in `on_border`. */
static void add_up(aligning *a, const size_t *first, uint8_t *on_border) {
  for (size_t f = 0; f < a->soup->face_count; f++) {
    if (!is_triangle(a, f))
      continue;
    size_t root = vxm_set_of(a->parent, f);
    polygon *p = &a->polygons[root];
    vxm_vec3 area = area_of(a, f);
    p->plane = true;
    p->triangles++;
    p->area = (vxm_vec3){p->area.x + area.x, p->area.y + area.y, p->area.z + area.z};
    p->mixed |= a->soup->face_tags && a->soup->face_tags[f] != a->soup->face_tags[root];
    for (uint64_t c = a->soup->offsets[f]; c < a->soup->offsets[f + 1]; c++) {
      uint32_t e = a->sides[c];
      if (e == VXM_NO_EDGE)
        p->bent = true;
      else if (is_on_border(first, a->edges, e)) {
        on_border[c] = 1;
        p->border++;
        p->hash += vxm_mix(e + UINT64_C(1));
        p->rimmed |= a->edges[e].count <= 2;
      }
    }
  }
  for (size_t f = 0; f < a->soup->face_count; f++) {
    polygon *p = &a->polygons[vxm_set_of(a->parent, f)];
    p->bent = p->bent || !is_triangle(a, f) || !points_along(area_of(a, f), p->area, NEARLY_PLANE);
    p->plane = p->plane && !p->bent && points_along(area_of(a, f), p->area, PLANE);
  }
}

/** No vertex is elsewhere than on the border where that has two sides more than there are triangles, as these
 * hang together like a tree. */
static bool is_polygon(const polygon *p) {
  return p->triangles > 1 && p->border == p->triangles + 2 && !p->rimmed && !p->bent;
}

/* ---- Those with the same border ---- */

static bool is_repeated(const aligning *a, uint64_t hash) {
  size_t low = 0, high = a->hash_count;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (a->hashes[middle] < hash)
      low = middle + 1;
    else
      high = middle;
  }
  return low + 1 < a->hash_count && a->hashes[low + 1] == hash;
}

static int by_hash_then_polygon(const void *p, const void *q) {
  const member *s = p, *t = q;
  if (s->hash != t->hash)
    return s->hash < t->hash ? -1 : 1;
  if (s->polygon != t->polygon)
    return s->polygon < t->polygon ? -1 : 1;
  return s->face < t->face ? -1 : s->face > t->face;
}

/** Lists the triangles of polygons whose hash another one has. */
static vxm_status list_members(aligning *a, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t faces = a->soup->face_count, count = 0;
  for (size_t f = 0; f < faces; f++)
    a->hash_count += is_polygon(&a->polygons[f]);
  a->hashes = vxm_repair_state_scratch(a->state, 2 * a->hash_count, sizeof *a->hashes, &status, error);
  if (!a->hashes)
    return status;
  for (size_t f = 0; f < faces; f++)
    if (is_polygon(&a->polygons[f]))
      a->hashes[count++] = a->polygons[f].hash;
  vxm_sort_keys(a->hashes, a->hashes + count, count);
  for (size_t f = 0; f < faces; f++) {
    const polygon *p = &a->polygons[f];
    a->member_count += is_polygon(p) && is_repeated(a, p->hash) ? p->triangles : 0;
  }
  a->members = vxm_repair_state_scratch(a->state, a->member_count, sizeof *a->members, &status, error);
  count = 0;
  for (size_t f = 0; a->members && a->member_count > 0 && f < faces; f++) {
    size_t root = vxm_set_of(a->parent, f);
    const polygon *p = &a->polygons[root];
    if (is_polygon(p) && is_repeated(a, p->hash))
      a->members[count++] = (member){p->hash, root, f};
  }
  if (a->members)
    qsort(a->members, count, sizeof *a->members, by_hash_then_polygon);
  return status;
}

static int by_edge(const void *p, const void *q) {
  const border_side *s = p, *t = q;
  return s->edge < t->edge ? -1 : s->edge > t->edge;
}

/** The border of the polygon whose triangles begin at `m`; returns how many sides it has. */
static size_t list_border(const aligning *a, const member *m, const uint8_t *on_border, border_side *out) {
  size_t count = 0;
  for (size_t i = 0; i < a->polygons[m->polygon].triangles; i++)
    for (uint64_t c = a->soup->offsets[m[i].face]; c < a->soup->offsets[m[i].face + 1]; c++)
      if (on_border[c])
        out[count++] = (border_side){a->sides[c], a->soup->indices[c] == a->edges[a->sides[c]].a};
  qsort(out, count, sizeof *out, by_edge);
  return count;
}

/** 1 where both have the same border and run along it the same way, -1 where they run opposite ways; else 0.
 */
static int compare_borders(const border_side *s, const border_side *t, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (s[i].edge != t[i].edge || (i > 0 && s[i].edge == s[i - 1].edge) ||
        (s[i].forward == t[i].forward) != (s[0].forward == t[0].forward))
      return 0;
  return s[0].forward == t[0].forward ? 1 : -1;
}

/** Gives a polygon the triangles of another one, turned over if its border runs the other way. */
static void copy_triangles(aligning *a, const member *from, const member *to, int turn) {
  for (size_t i = 0; i < a->polygons[from->polygon].triangles; i++) {
    const uint32_t *corner = a->soup->indices + a->soup->offsets[from[i].face];
    uint32_t *other = a->soup->indices + a->soup->offsets[to[i].face];
    other[0] = corner[0];
    other[1] = corner[turn > 0 ? 1 : 2];
    other[2] = corner[turn > 0 ? 2 : 1];
  }
}

/** Whether it is one polygon that is there twice. Front and back of what is drawn from both sides may be a
 * little bent, while of two surfaces that look the same way one may be meant to lie behind the other. */
static bool may_be_aligned(const polygon *p, const polygon *q, int turn) {
  vxm_vec3 area = {turn * q->area.x, turn * q->area.y, turn * q->area.z};
  bool plane = p->plane && q->plane;
  return (plane || turn < 0) && points_along(p->area, area, plane ? PLANE : NEARLY_PLANE);
}

/** Polygons of one hash, of which the first is at `begin`: looks which of the others are that one. */
static void find_twice(aligning *a, size_t begin, size_t end, const uint8_t *on_border) {
  const member *first = &a->members[begin];
  size_t triangles = a->polygons[first->polygon].triangles;
  size_t count = list_border(a, first, on_border, a->border[0]);
  for (size_t i = begin + triangles; i < end; i += a->polygons[a->members[i].polygon].triangles) {
    polygon *p = &a->polygons[a->members[i].polygon];
    if (p->triangles != triangles || p->mixed)
      continue;
    list_border(a, &a->members[i], on_border, a->border[1]);
    int turn = compare_borders(a->border[0], a->border[1], count);
    if (turn != 0 && may_be_aligned(&a->polygons[first->polygon], p, turn)) {
      p->turn = turn;
      p->model = begin;
    }
  }
}

static vxm_status find_all_twice(aligning *a, const uint8_t *on_border, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t longest = 0;
  for (size_t i = 0; i < a->member_count; i++) {
    const polygon *p = &a->polygons[a->members[i].polygon];
    longest = p->border > longest ? p->border : longest;
  }
  for (int i = 0; i < 2 && status == VXM_OK; i++)
    a->border[i] = vxm_repair_state_scratch(a->state, longest, sizeof *a->border[i], &status, error);
  for (size_t i = 0, j; i < a->member_count && status == VXM_OK; i = j) {
    for (j = i; j < a->member_count && a->members[j].hash == a->members[i].hash; j++)
      ;
    find_twice(a, i, j, on_border);
  }
  return status;
}

/* ---- In which groups ---- */

static void add_to_group(aligning *a, size_t face, uint8_t *odd) {
  size_t count;
  const uint32_t *corner = vxm_face(a->soup, face, &count);
  vxm_vec3 area = area_of(a, face);
  group_sums *g = &a->sums[a->groups.of_face[face]];
  g->faces++;
  g->again += a->again[face];
  g->area += vxm_vec3_length(area);
  if (count > 0)
    g->volume += vxm_polygon_cone(
        vxm_vec3_between(vxm_position(a->soup, corner[0]), a->frame.centre, a->frame.scale), area);
  for (uint64_t c = a->soup->offsets[face]; c < a->soup->offsets[face + 1] && !a->again[face]; c++)
    if (a->sides[c] != VXM_NO_EDGE)
      odd[a->sides[c]] ^= 1;
}

/** Sums up the groups; `odd` is scratch per edge. */
static void sum_up(aligning *a, uint8_t *odd) {
  for (size_t f = 0; f < a->soup->face_count; f++) {
    a->again[f] = a->again[f] != VXM_REPEAT_NONE || a->polygons[vxm_set_of(a->parent, f)].turn != 0;
    add_to_group(a, f, odd);
  }
  for (size_t f = 0; f < a->soup->face_count; f++)
    for (uint64_t c = a->soup->offsets[f]; c < a->soup->offsets[f + 1] && !a->again[f]; c++)
      if (a->sides[c] != VXM_NO_EDGE && odd[a->sides[c]])
        a->sums[a->groups.of_face[f]].open = true;
}

static vxm_status measure_groups(aligning *a, vxm_error *error) {
  vxm_duplicates found;
  vxm_status status = vxm_edge_groups_find(&a->groups, a->state, error);
  uint8_t *odd = NULL;
  if (status == VXM_OK)
    a->sums = vxm_repair_state_scratch(a->state, a->groups.count, sizeof *a->sums, &status, error);
  if (a->sums)
    a->again = vxm_repair_state_scratch(a->state, a->soup->face_count, sizeof *a->again, &status, error);
  if (a->again)
    odd = vxm_repair_state_scratch(a->state, a->state->edges.count, sizeof *odd, &status, error);
  if (odd)
    status = vxm_duplicates_find(&found, a->state->context, a->soup, NULL, a->again, NULL, error);
  if (odd && status == VXM_OK)
    sum_up(a, odd);
  vxm_free(a->state->context, odd);
  return status;
}

/** Whether polygons of a group are there twice as those of a body that is drawn twice, in whole or in part:
 * without the others it is closed, or they are a third or more of its faces. Where winding numbers are whole
 * and there is a volume they are rather of bodies that touch or overlap. */
static bool is_drawn_twice(const aligning *a, size_t group) {
  const group_sums *g = &a->sums[group];
  if (a->groups.groups[group].balanced && fabs(g->volume) > NO_VOLUME * g->area * a->frame.diagonal)
    return false;
  return !g->open || 3 * g->again >= g->faces;
}

static bool align_members(aligning *a) {
  bool any = false;
  for (size_t i = 0; i < a->member_count; i += a->polygons[a->members[i].polygon].triangles) {
    const polygon *p = &a->polygons[a->members[i].polygon];
    if (p->turn == 0 || !is_drawn_twice(a, a->groups.of_face[a->members[i].face]))
      continue;
    copy_triangles(a, &a->members[p->model], &a->members[i], p->turn);
    any = true;
  }
  return any;
}

/* ---- All of it ---- */

static vxm_status align(aligning *a, bool *changed, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t faces = a->soup->face_count, *first = NULL;
  uint8_t *on_border = NULL;
  a->parent = vxm_repair_state_scratch(a->state, faces, sizeof *a->parent, &status, error);
  if (a->parent)
    a->polygons = vxm_repair_state_scratch(a->state, faces, sizeof *a->polygons, &status, error);
  if (a->polygons)
    first = vxm_repair_state_scratch(a->state, a->state->edges.count, sizeof *first, &status, error);
  if (first)
    on_border = vxm_repair_state_scratch(a->state, a->soup->corner_count, sizeof *on_border, &status, error);
  if (on_border)
    status = join_triangles(a, first, error);
  if (on_border && status == VXM_OK) {
    add_up(a, first, on_border);
    status = list_members(a, error);
  }
  if (on_border && status == VXM_OK)
    status = find_all_twice(a, on_border, error);
  if (on_border && status == VXM_OK && a->member_count > 0) {
    status = measure_groups(a, error);
    *changed = status == VXM_OK && align_members(a);
  }
  vxm_free(a->state->context, on_border);
  vxm_free(a->state->context, first);
  return status;
}

vxm_status vxm_align_diagonals(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  vxm_status status = vxm_repair_state_count_edges(state, error);
  if (status != VXM_OK || state->edges.crowded == 0)
    return status;
  status = vxm_repair_state_edges(state, error);
  if (status != VXM_OK)
    return status;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  aligning a = {.state = state,
                .soup = state->soup,
                .sides = state->edges.sides,
                .edges = state->edges.edges,
                .frame = vxm_unit_scale_of(extent.bounds)};
  status = align(&a, changed, error);
  for (int i = 0; i < 2; i++)
    vxm_free(state->context, a.border[i]);
  vxm_edge_groups_destroy(&a.groups, state->context);
  vxm_free(state->context, a.again);
  vxm_free(state->context, a.sums);
  vxm_free(state->context, a.members);
  vxm_free(state->context, a.hashes);
  vxm_free(state->context, a.polygons);
  vxm_free(state->context, a.parent);
  if (*changed)
    vxm_repair_state_touch(state);
  return status;
}

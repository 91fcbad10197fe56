/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/clean/other_diagonals.h"

#include "base/hash.h"
#include "mesh/duplicate_faces.h"
#include "mesh/geometry.h"
#include "mesh/sort.h"
#include "repair/state/edge_groups.h"
#include "repair/state/face_subset.h"

#include <stdlib.h>
#include <string.h>

#define NONE SIZE_MAX

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

/** A triangle of a polygon that may have the border of another one: places in the list of triangles. */
typedef struct member {
  uint64_t hash;
  size_t polygon, triangle;
} member;

/** What is known of a group of faces; of one that is not asked for, nothing. */
typedef struct group_sums {
  bool asked;          /**< polygons are there twice */
  double volume, area; /**< of a balanced one */
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
  uint8_t *rim;      /**< per vertex: it is on an edge with more than two sides */
  size_t *triangles; /**< faces that may be of such polygons, in order; what follows is per place in there */
  size_t triangle_count;
  size_t *across;    /**< per side: the triangle there, or NONE on a border */
  size_t *parent;    /**< another one of its polygon, or itself */
  polygon *polygons; /**< of those that stand for one */
  uint64_t *hashes;  /**< of those that may have the border of another one, sorted */
  size_t hash_count;
  member *members;
  size_t member_count;
  border_side *border[2]; /**< scratch for two of them */
  vxm_edge_groups groups;
  group_sums *sums; /**< per group */
  uint8_t *again;   /**< per face: it is there already, or will be */
} aligning;

static vxm_vec3 area_of(const aligning *a, size_t face) {
  size_t count;
  const uint32_t *corner = vxm_face(a->soup, face, &count);
  return vxm_polygon_area(a->soup->positions, corner, count, a->frame.scale);
}

static size_t face_of(const aligning *a, const member *m) {
  return a->triangles[m->triangle];
}

static bool points_along(vxm_vec3 area, vxm_vec3 other, double cosine) {
  double both = vxm_vec3_length(area) * vxm_vec3_length(other);
  return both > 0 && vxm_vec3_dot(area, other) >= cosine * both;
}

/* ---- Polygons ---- */

/** Whether a face may be of such a polygon: of few of a mesh all corners are at edges with more than two
 * sides, which is why that is asked first. */
static bool may_be_of_one(const aligning *a, size_t face) {
  size_t count;
  const uint32_t *corner = vxm_face(a->soup, face, &count), *side = a->sides + a->soup->offsets[face];
  if (count != 3 || !a->rim[corner[0]] || !a->rim[corner[1]] || !a->rim[corner[2]])
    return false;
  for (int i = 0; i < 3; i++)
    if (side[i] == VXM_NO_EDGE || a->edges[side[i]].count < 2 ||
        (a->edges[side[i]].count == 2 && a->edges[side[i]].forward != 1))
      return false;
  return true;
}

static vxm_status list_triangles(aligning *a, vxm_error *error) {
  vxm_status status = VXM_OK;
  a->rim = vxm_repair_state_scratch(a->state, a->soup->vertex_count, sizeof *a->rim, &status, error);
  if (!a->rim)
    return status;
  for (size_t e = 0; e < a->state->edges.count; e++)
    if (a->edges[e].count > 2)
      a->rim[a->edges[e].a] = a->rim[a->edges[e].b] = 1;
  size_t capacity = 0;
  void *grown = NULL;
  for (size_t f = 0; f < a->soup->face_count && status == VXM_OK; f++) {
    if (!may_be_of_one(a, f))
      continue;
    status =
        vxm_grow(a->state->context, &grown, &capacity, a->triangle_count + 1, sizeof *a->triangles, error);
    a->triangles = grown;
    if (status == VXM_OK)
      a->triangles[a->triangle_count++] = f;
  }
  return status;
}

/** Joins two triangles over each edge that has no more; `first` is scratch per edge. */
static vxm_status join_triangles(aligning *a, size_t *first, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t t = 0; t < a->triangle_count; t++)
    a->parent[t] = t;
  for (size_t t = 0; t < a->triangle_count && status == VXM_OK; t++) {
    status = vxm_check_cancelled_at(t, a->state->context, error);
    for (size_t i = 3 * t; i < 3 * t + 3; i++) {
      uint32_t e = a->sides[a->soup->offsets[a->triangles[t]] + i % 3];
      a->across[i] = NONE;
      if (a->edges[e].count != 2)
        continue;
      if (first[e] == 0) {
        first[e] = i + 1;
        continue;
      }
      size_t other = first[e] - 1;
      a->across[i] = other / 3;
      a->across[other] = t;
      a->parent[vxm_set_of(a->parent, t)] = vxm_set_of(a->parent, other / 3);
    }
  }
  return status;
}

/** Adds up what the edges tell of the polygons. */
static void add_up(aligning *a) {
  for (size_t t = 0; t < a->triangle_count; t++) {
    size_t root = vxm_set_of(a->parent, t), face = a->triangles[t];
    const uint32_t *side = a->sides + a->soup->offsets[face];
    polygon *p = &a->polygons[root];
    p->triangles++;
    p->mixed |= a->soup->face_tags && a->soup->face_tags[face] != a->soup->face_tags[a->triangles[root]];
    for (size_t i = 0; i < 3; i++)
      if (a->across[3 * t + i] == NONE) {
        p->border++;
        p->hash += vxm_mix(side[i] + UINT64_C(1));
        p->rimmed |= a->edges[side[i]].count <= 2;
      }
  }
}

/** Looks which of them are nearly plane, and which are plane. */
static void look_at_planes(aligning *a) {
  for (size_t t = 0; t < a->triangle_count; t++) {
    polygon *p = &a->polygons[vxm_set_of(a->parent, t)];
    vxm_vec3 area = area_of(a, a->triangles[t]);
    p->plane = true;
    p->area = vxm_vec3_sum(p->area, area);
  }
  for (size_t t = 0; t < a->triangle_count; t++) {
    polygon *p = &a->polygons[vxm_set_of(a->parent, t)];
    vxm_vec3 area = area_of(a, a->triangles[t]);
    p->bent = p->bent || !points_along(area, p->area, NEARLY_PLANE);
    p->plane = p->plane && points_along(area, p->area, PLANE);
    for (size_t i = 3 * t; i < 3 * t + 3; i++)
      p->bent = p->bent || (a->across[i] != NONE && a->across[i] < t &&
                            !points_along(area, area_of(a, a->triangles[a->across[i]]), NEARLY_PLANE));
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
  return s->triangle < t->triangle ? -1 : s->triangle > t->triangle;
}

/** Lists the hashes of polygons; `any`: one is there several times. */
static vxm_status list_hashes(aligning *a, bool *any, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t count = 0;
  for (size_t t = 0; t < a->triangle_count; t++)
    a->hash_count += is_polygon(&a->polygons[t]);
  a->hashes = vxm_repair_state_scratch(a->state, 2 * a->hash_count, sizeof *a->hashes, &status, error);
  if (!a->hashes)
    return status;
  for (size_t t = 0; t < a->triangle_count; t++)
    if (is_polygon(&a->polygons[t]))
      a->hashes[count++] = a->polygons[t].hash;
  vxm_sort_keys(a->hashes, a->hashes + count, count);
  for (size_t i = 1; i < count; i++)
    *any |= a->hashes[i] == a->hashes[i - 1];
  return status;
}

/** Lists the triangles of polygons whose hash another one has. */
static vxm_status list_members(aligning *a, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t count = 0;
  for (size_t t = 0; t < a->triangle_count; t++) {
    const polygon *p = &a->polygons[t];
    a->member_count += is_polygon(p) && is_repeated(a, p->hash) ? p->triangles : 0;
  }
  a->members = vxm_repair_state_scratch(a->state, a->member_count, sizeof *a->members, &status, error);
  for (size_t t = 0; a->members && count < a->member_count; t++) {
    size_t root = vxm_set_of(a->parent, t);
    const polygon *p = &a->polygons[root];
    if (is_polygon(p) && is_repeated(a, p->hash))
      a->members[count++] = (member){p->hash, root, t};
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
static size_t list_border(const aligning *a, const member *m, border_side *out) {
  size_t count = 0;
  for (size_t i = 0; i < a->polygons[m->polygon].triangles; i++) {
    uint64_t c = a->soup->offsets[face_of(a, &m[i])];
    for (size_t j = 3 * m[i].triangle; j < 3 * m[i].triangle + 3; j++, c++)
      if (a->across[j] == NONE)
        out[count++] = (border_side){a->sides[c], a->soup->indices[c] == a->edges[a->sides[c]].a};
  }
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
    const uint32_t *corner = a->soup->indices + a->soup->offsets[face_of(a, &from[i])];
    uint32_t *other = a->soup->indices + a->soup->offsets[face_of(a, &to[i])];
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

/** Polygons of one hash, of which the first is at `begin`: looks which of the others are that one; `any`: one
 * is. */
static void find_twice(aligning *a, size_t begin, size_t end, bool *any) {
  const member *first = &a->members[begin];
  size_t triangles = a->polygons[first->polygon].triangles;
  size_t count = list_border(a, first, a->border[0]);
  for (size_t i = begin + triangles; i < end; i += a->polygons[a->members[i].polygon].triangles) {
    polygon *p = &a->polygons[a->members[i].polygon];
    if (p->triangles != triangles || p->mixed)
      continue;
    list_border(a, &a->members[i], a->border[1]);
    int turn = compare_borders(a->border[0], a->border[1], count);
    if (turn != 0 && may_be_aligned(&a->polygons[first->polygon], p, turn)) {
      p->turn = turn;
      p->model = begin;
      *any = true;
    }
  }
}

static vxm_status find_all_twice(aligning *a, bool *any, vxm_error *error) {
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
    find_twice(a, i, j, any);
  }
  return status;
}

/* ---- In which groups ---- */

static group_sums *group_of(const aligning *a, size_t face) {
  return &a->sums[a->groups.of_face[face]];
}

static void ask_for_groups(aligning *a) {
  for (size_t i = 0; i < a->member_count; i++)
    if (a->polygons[a->members[i].polygon].turn != 0)
      group_of(a, face_of(a, &a->members[i]))->asked = true;
}

/** Whether a face has an edge with more than two sides, as one that another repeats has unless these two are
 * a group. */
static bool is_at_crowded_edge(const aligning *a, size_t face) {
  for (uint64_t c = a->soup->offsets[face]; c < a->soup->offsets[face + 1]; c++)
    if (a->sides[c] != VXM_NO_EDGE && a->edges[a->sides[c]].count > 2)
      return true;
  return false;
}

/** Marks in `again` the faces of groups asked for that are there already. */
static vxm_status mark_repeated(aligning *a, vxm_error *error) {
  vxm_duplicates found;
  vxm_soup *some = NULL;
  uint64_t *numbers = NULL;
  uint8_t *kinds = NULL;
  for (size_t f = 0; f < a->soup->face_count; f++)
    a->again[f] = group_of(a, f)->asked && is_at_crowded_edge(a, f);
  vxm_status status = vxm_face_subset_create(&some, &numbers, a->soup, a->again, 1, error);
  if (status != VXM_OK)
    return status;
  kinds = vxm_repair_state_scratch(a->state, some->face_count, sizeof *kinds, &status, error);
  if (kinds)
    status = vxm_duplicates_find(&found, a->state->context, some, NULL, kinds, NULL, error);
  for (size_t i = 0; kinds && status == VXM_OK && i < some->face_count; i++)
    a->again[numbers[i]] = kinds[i] != VXM_REPEAT_NONE;
  vxm_free(a->state->context, kinds);
  vxm_free(a->state->context, numbers);
  vxm_soup_destroy(some);
  return status;
}

static void add_volume(aligning *a, size_t face) {
  size_t count;
  const uint32_t *corner = vxm_face(a->soup, face, &count);
  vxm_vec3 area = area_of(a, face);
  group_sums *g = group_of(a, face);
  g->area += vxm_vec3_length(area);
  if (count > 0)
    g->volume += vxm_polygon_cone(
        vxm_vec3_between(vxm_position(a->soup, corner[0]), a->frame.centre, a->frame.scale), area);
}

/** Sums up the groups asked for; `odd` is scratch per edge. */
static void sum_up(aligning *a, uint8_t *odd) {
  for (size_t i = 0; i < a->member_count; i++)
    a->again[face_of(a, &a->members[i])] |= a->polygons[a->members[i].polygon].turn != 0;
  for (size_t f = 0; f < a->soup->face_count; f++) {
    group_sums *g = group_of(a, f);
    if (!g->asked)
      continue;
    g->faces++;
    g->again += a->again[f];
    if (a->groups.groups[a->groups.of_face[f]].balanced)
      add_volume(a, f);
    for (uint64_t c = a->soup->offsets[f]; c < a->soup->offsets[f + 1] && !a->again[f]; c++)
      if (a->sides[c] != VXM_NO_EDGE)
        odd[a->sides[c]] ^= 1;
  }
  for (size_t f = 0; f < a->soup->face_count; f++)
    for (uint64_t c = a->soup->offsets[f]; c < a->soup->offsets[f + 1] && group_of(a, f)->asked; c++)
      if (!a->again[f] && a->sides[c] != VXM_NO_EDGE && odd[a->sides[c]])
        group_of(a, f)->open = true;
}

static vxm_status measure_groups(aligning *a, vxm_error *error) {
  vxm_status status = vxm_edge_groups_find(&a->groups, a->state, error);
  uint8_t *odd = NULL;
  if (status == VXM_OK)
    a->sums = vxm_repair_state_scratch(a->state, a->groups.count, sizeof *a->sums, &status, error);
  if (a->sums)
    a->again = vxm_repair_state_scratch(a->state, a->soup->face_count, sizeof *a->again, &status, error);
  if (a->again)
    odd = vxm_repair_state_scratch(a->state, a->state->edges.count, sizeof *odd, &status, error);
  if (odd) {
    ask_for_groups(a);
    status = mark_repeated(a, error);
  }
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
    if (p->turn == 0 || !is_drawn_twice(a, a->groups.of_face[face_of(a, &a->members[i])]))
      continue;
    copy_triangles(a, &a->members[p->model], &a->members[i], p->turn);
    any = true;
  }
  return any;
}

/* ---- All of it ---- */

/** `any`: some have a border that seems to be that of another one. */
static vxm_status find_polygons(aligning *a, bool *any, vxm_error *error) {
  vxm_status status = list_triangles(a, error);
  size_t count = a->triangle_count, *first = NULL;
  if (status == VXM_OK && count < 4) /* for two of two triangles */
    return VXM_OK;
  if (status == VXM_OK)
    a->across = vxm_repair_state_scratch(a->state, 3 * count, sizeof *a->across, &status, error);
  if (a->across)
    a->parent = vxm_repair_state_scratch(a->state, count, sizeof *a->parent, &status, error);
  if (a->parent)
    a->polygons = vxm_repair_state_scratch(a->state, count, sizeof *a->polygons, &status, error);
  if (a->polygons)
    first = vxm_repair_state_scratch(a->state, a->state->edges.count, sizeof *first, &status, error);
  if (first)
    status = join_triangles(a, first, error);
  vxm_free(a->state->context, first);
  if (status != VXM_OK)
    return status;
  add_up(a);
  return list_hashes(a, any, error);
}

/** `any`: some are there twice. */
static vxm_status compare_polygons(aligning *a, bool *any, vxm_error *error) {
  vxm_extent extent;
  vxm_repair_state_extent(a->state, &extent);
  a->frame = vxm_unit_scale_of(extent.bounds);
  look_at_planes(a);
  vxm_status status = list_members(a, error);
  return status == VXM_OK ? find_all_twice(a, any, error) : status;
}

static vxm_status align(aligning *a, bool *changed, vxm_error *error) {
  bool alike = false, twice = false;
  vxm_status status = find_polygons(a, &alike, error);
  if (status == VXM_OK && alike)
    status = compare_polygons(a, &twice, error);
  if (status == VXM_OK && twice)
    status = measure_groups(a, error);
  *changed = status == VXM_OK && twice && align_members(a);
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
  aligning a = {
      .state = state, .soup = state->soup, .sides = state->edges.sides, .edges = state->edges.edges};
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
  vxm_free(state->context, a.across);
  vxm_free(state->context, a.triangles);
  vxm_free(state->context, a.rim);
  if (*changed)
    vxm_repair_state_touch(state);
  return status;
}

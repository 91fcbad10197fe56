/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/bodies/other_diagonals.h"

#include "mesh/duplicate_faces.h"
#include "mesh/sort.h"
#include "repair/bodies/inner_walls.h"
#include "repair/bodies/rimmed_sheets.h"
#include "repair/clean/triangulated_polygons.h"
#include "repair/state/edge_groups.h"
#include "repair/state/face_subset.h"

#include <stdlib.h>

/** Of the area of a group times the diagonal: less volume is none. */
static const double NO_VOLUME = 1e-9;

/** A polygon that is there already. */
typedef struct twin {
  int turn;     /**< 1 or -1: it is the polygon at `model`, the other way round if -1; else 0 */
  size_t model; /**< place in the list of members */
} twin;

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
  bool open; /**< without those, an edge has an odd number of sides; where walls go, one side if sheets that
                hang go, too */
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
  vxm_polygons all;
  uint64_t *hashes; /**< of those that may have the border of another one, sorted */
  size_t hash_count;
  member *members;
  size_t member_count;
  twin *twins;            /**< per triangle that stands for a polygon */
  border_side *border[2]; /**< scratch for two of them */
  vxm_edge_groups groups;
  group_sums *sums; /**< per group */
  uint8_t *again;   /**< per face: it is there already, or will be */
} aligning;

static size_t face_of(const aligning *a, const member *m) {
  return a->all.triangles[m->triangle];
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
  for (size_t t = 0; t < a->all.triangle_count; t++)
    a->hash_count += vxm_is_polygon(&a->all.polygons[t]);
  a->hashes = vxm_repair_state_scratch(a->state, 2 * a->hash_count, sizeof *a->hashes, &status, error);
  if (!a->hashes)
    return status;
  for (size_t t = 0; t < a->all.triangle_count; t++)
    if (vxm_is_polygon(&a->all.polygons[t]))
      a->hashes[count++] = a->all.polygons[t].hash;
  vxm_sort_keys(a->hashes, a->hashes + count, count);
  for (size_t i = 1; i < count; i++)
    *any |= a->hashes[i] == a->hashes[i - 1];
  return status;
}

/** Lists the triangles of polygons whose hash another one has. */
static vxm_status list_members(aligning *a, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t count = 0;
  for (size_t t = 0; t < a->all.triangle_count; t++) {
    const vxm_triangulated *p = &a->all.polygons[t];
    a->member_count += vxm_is_polygon(p) && is_repeated(a, p->hash) ? p->triangles : 0;
  }
  a->members = vxm_repair_state_scratch(a->state, a->member_count, sizeof *a->members, &status, error);
  for (size_t t = 0; a->members && count < a->member_count; t++) {
    size_t root = vxm_set_of(a->all.parent, t);
    const vxm_triangulated *p = &a->all.polygons[root];
    if (vxm_is_polygon(p) && is_repeated(a, p->hash))
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
  for (size_t i = 0; i < a->all.polygons[m->polygon].triangles; i++) {
    uint64_t c = a->soup->offsets[face_of(a, &m[i])];
    for (size_t j = 3 * m[i].triangle; j < 3 * m[i].triangle + 3; j++, c++)
      if (a->all.across[j] == SIZE_MAX)
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
  for (size_t i = 0; i < a->all.polygons[from->polygon].triangles; i++) {
    const uint32_t *corner = a->soup->indices + a->soup->offsets[face_of(a, &from[i])];
    uint32_t *other = a->soup->indices + a->soup->offsets[face_of(a, &to[i])];
    other[0] = corner[0];
    other[1] = corner[turn > 0 ? 1 : 2];
    other[2] = corner[turn > 0 ? 2 : 1];
  }
}

/** Polygons of one hash, of which the first is at `begin`: looks which of the others are that one; `any`: one
 * is. */
static void find_twice(aligning *a, size_t begin, size_t end, bool *any) {
  const member *first = &a->members[begin];
  size_t triangles = a->all.polygons[first->polygon].triangles;
  size_t count = list_border(a, first, a->border[0]);
  for (size_t i = begin + triangles; i < end; i += a->all.polygons[a->members[i].polygon].triangles) {
    const vxm_triangulated *p = &a->all.polygons[a->members[i].polygon];
    if (p->triangles != triangles || p->mixed)
      continue;
    list_border(a, &a->members[i], a->border[1]);
    int turn = compare_borders(a->border[0], a->border[1], count);
    if (turn != 0 && vxm_polygons_may_be_one(&a->all.polygons[first->polygon], p, turn)) {
      a->twins[a->members[i].polygon] = (twin){turn, begin};
      *any = true;
    }
  }
}

static vxm_status find_all_twice(aligning *a, bool *any, vxm_error *error) {
  vxm_status status = VXM_OK;
  size_t longest = 0;
  for (size_t i = 0; i < a->member_count; i++) {
    const vxm_triangulated *p = &a->all.polygons[a->members[i].polygon];
    longest = p->border > longest ? p->border : longest;
  }
  a->twins = vxm_repair_state_scratch(a->state, a->all.triangle_count, sizeof *a->twins, &status, error);
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
    if (a->twins[a->members[i].polygon].turn != 0)
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
    status = vxm_duplicates_find(&found, a->state->context, some, kinds, NULL, error);
  for (size_t i = 0; kinds && status == VXM_OK && i < some->face_count; i++)
    a->again[numbers[i]] = kinds[i] != VXM_REPEAT_NONE;
  vxm_free(a->state->context, kinds);
  vxm_free(a->state->context, numbers);
  vxm_soup_destroy(some);
  return status;
}

static void add_volume(aligning *a, size_t face) {
  vxm_vec3 area;
  group_sums *g = group_of(a, face);
  g->volume += vxm_face_cone(&area, a->soup, face, a->frame.centre, a->frame.scale);
  g->area += vxm_vec3_length(area);
}

/** Whether an edge with so many sides, as sum_up counts them, is open; three are those of a wall. */
static bool is_open(const aligning *a, uint8_t count) {
  return vxm_inner_walls_go(a->state) ? count == 1 : count % 2 == 1;
}

/** Sums up the groups asked for; `count` is scratch per edge: up to 1, then 2 for an even and 3 for an odd
 * number. */
static void sum_up(aligning *a, const uint8_t *sheet, uint8_t *count) {
  for (size_t i = 0; i < a->member_count; i++)
    a->again[face_of(a, &a->members[i])] |= a->twins[a->members[i].polygon].turn != 0;
  for (size_t f = 0; f < a->soup->face_count; f++) {
    group_sums *g = group_of(a, f);
    if (!g->asked)
      continue;
    g->faces++;
    g->again += a->again[f];
    if (a->groups.groups[a->groups.of_face[f]].balanced)
      add_volume(a, f);
    for (uint64_t c = a->soup->offsets[f]; c < a->soup->offsets[f + 1] && !a->again[f]; c++)
      if (a->sides[c] != VXM_NO_EDGE && !(sheet && sheet[f]))
        count[a->sides[c]] = count[a->sides[c]] == 0 ? 1 : count[a->sides[c]] == 2 ? 3 : 2;
  }
  for (size_t f = 0; f < a->soup->face_count; f++)
    for (uint64_t c = a->soup->offsets[f]; c < a->soup->offsets[f + 1] && group_of(a, f)->asked; c++)
      if (!a->again[f] && a->sides[c] != VXM_NO_EDGE && is_open(a, count[a->sides[c]]))
        group_of(a, f)->open = true;
}

static vxm_status measure_groups(aligning *a, vxm_error *error) {
  vxm_rimmed_sheets sheets = {0};
  uint8_t *count = NULL;
  vxm_status status = vxm_edge_groups_find(&a->groups, a->state, error);
  if (status == VXM_OK && vxm_inner_walls_go(a->state))
    status = vxm_rimmed_sheets_find(&sheets, a->state, &a->groups, error);
  if (status == VXM_OK)
    a->sums = vxm_repair_state_scratch(a->state, a->groups.count, sizeof *a->sums, &status, error);
  if (a->sums)
    a->again = vxm_repair_state_scratch(a->state, a->soup->face_count, sizeof *a->again, &status, error);
  if (a->again)
    count = vxm_repair_state_scratch(a->state, a->state->edges.count, sizeof *count, &status, error);
  if (count) {
    ask_for_groups(a);
    status = mark_repeated(a, error);
  }
  if (count && status == VXM_OK)
    sum_up(a, sheets.sheet, count);
  vxm_free(a->state->context, count);
  vxm_rimmed_sheets_destroy(&sheets, a->state->context);
  return status;
}

/** Whether polygons of a group are there twice as those of a body that is drawn twice, in whole or in part:
 * without the others it is closed, or divided by walls, or they are a third or more of its faces. Where
 * winding numbers are whole and there is a volume they are rather of bodies that touch or overlap. */
static bool is_drawn_twice(const aligning *a, size_t group) {
  const group_sums *g = &a->sums[group];
  if (a->groups.groups[group].balanced && fabs(g->volume) > NO_VOLUME * g->area * a->frame.diagonal)
    return false;
  return !g->open || 3 * g->again >= g->faces;
}

static bool align_members(aligning *a) {
  bool any = false;
  for (size_t i = 0; i < a->member_count; i += a->all.polygons[a->members[i].polygon].triangles) {
    const twin *t = &a->twins[a->members[i].polygon];
    if (t->turn == 0 || !is_drawn_twice(a, a->groups.of_face[face_of(a, &a->members[i])]))
      continue;
    copy_triangles(a, &a->members[t->model], &a->members[i], t->turn);
    any = true;
  }
  return any;
}

/* ---- All of it ---- */

/** `any`: some are there twice. */
static vxm_status compare_polygons(aligning *a, bool *any, vxm_error *error) {
  vxm_extent extent;
  vxm_repair_state_extent(a->state, &extent);
  a->frame = vxm_unit_scale_of(extent.bounds);
  vxm_polygons_measure(&a->all, a->frame.scale);
  vxm_status status = list_members(a, error);
  return status == VXM_OK ? find_all_twice(a, any, error) : status;
}

static vxm_status align(aligning *a, bool *changed, vxm_error *error) {
  bool alike = false, twice = false;
  vxm_status status = vxm_polygons_find(&a->all, a->state, error);
  if (status == VXM_OK && a->all.polygons)
    status = list_hashes(a, &alike, error);
  if (status == VXM_OK && alike)
    status = compare_polygons(a, &twice, error);
  if (status == VXM_OK && twice)
    status = measure_groups(a, error);
  *changed = status == VXM_OK && twice && align_members(a);
  return status;
}

vxm_status vxm_pass_other_diagonals(vxm_repair_state *state, bool *changed, vxm_error *error) {
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
  vxm_free(state->context, a.twins);
  vxm_polygons_destroy(&a.all);
  if (*changed)
    vxm_repair_state_touch(state);
  return status;
}

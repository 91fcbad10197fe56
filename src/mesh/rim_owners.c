/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/rim_owners.h"
#include "mesh/disjoint_sets.h"
#include "mesh/sort.h"

/** Rounds after which all faces of an edge become one group, so that time stays linear. */
enum { ROUNDS_MAX = 32 };

typedef struct finder {
  const vxm_soup *soup;
  const vxm_edges *edges;
  vxm_context *context;
  vxm_error error;  /**< of the last allocation that failed */
  uint32_t *parent; /**< per face: a union-find forest */
  uint32_t *group;  /**< per face, as they were when the round began */
  uint32_t *owner;  /**< per edge */
  uint8_t *odd;     /**< per group: has an odd number of sides along the edge that is looked at */
  uint64_t *sides;  /**< edge << 32 | face, sorted: along edges that have not two sides */
  size_t side_count;
} finder;

static void *allocate(finder *f, size_t count, size_t size) {
  return vxm_calloc(f->context, count, size, &f->error);
}

/** The edge of a side, or edges->count. */
static size_t edge_of(const finder *f, const uint32_t *corner, size_t count, size_t side) {
  return vxm_edges_find(f->edges, corner[side], corner[side + 1 < count ? side + 1 : 0]);
}

/** Joins faces across edges of two sides, and counts the sides along others. */
static void join_pairs(finder *f) {
  for (size_t face = 0; face < f->soup->face_count; face++)
    f->parent[face] = (uint32_t)face;
  for (size_t e = 0; e < f->edges->count; e++)
    f->owner[e] = VXM_NO_OWNER;
  for (size_t face = 0; face < f->soup->face_count; face++) {
    size_t count;
    const uint32_t *corner = vxm_face(f->soup, face, &count);
    for (size_t side = 0; side < count; side++) {
      size_t e = edge_of(f, corner, count, side);
      if (e == f->edges->count)
        continue;
      if (f->edges->edges[e].count != 2)
        f->side_count++;
      else if (f->owner[e] == VXM_NO_OWNER)
        f->owner[e] = (uint32_t)face;
      else
        vxm_set_unite_in_order(f->parent, (uint32_t)face, f->owner[e]);
    }
  }
}

static bool list_sides(finder *f) {
  f->sides = allocate(f, f->side_count, 2 * sizeof *f->sides); /* the second half is scratch of the sort */
  size_t next = 0;
  for (size_t face = 0; f->sides && face < f->soup->face_count; face++) {
    size_t count;
    const uint32_t *corner = vxm_face(f->soup, face, &count);
    for (size_t side = 0; side < count; side++) {
      size_t e = edge_of(f, corner, count, side);
      if (e < f->edges->count && f->edges->edges[e].count != 2)
        f->sides[next++] = (uint64_t)e << 32 | face;
    }
  }
  if (f->sides)
    vxm_sort_keys(f->sides, f->sides + f->side_count, f->side_count);
  return f->sides != NULL;
}

static void look_up_groups(finder *f) {
  for (size_t face = 0; face < f->soup->face_count; face++)
    f->group[face] = f->parent[face] = f->parent[f->parent[face]]; /* faces before have theirs already */
}

/** Joins the groups with an odd number of sides along an edge, or `all`; the first one owns the edge. */
static bool join_along(finder *f, size_t begin, size_t end, bool all) {
  uint32_t first = VXM_NO_OWNER;
  bool joined = false;
  for (size_t s = begin; s < end; s++) {
    uint8_t *odd = &f->odd[f->group[(uint32_t)f->sides[s]]];
    *odd = all || !*odd;
  }
  for (size_t s = begin; s < end; s++) {
    uint32_t group = f->group[(uint32_t)f->sides[s]];
    if (!f->odd[group])
      continue;
    f->odd[group] = 0;
    if (first == VXM_NO_OWNER)
      first = group;
    else {
      vxm_set_unite_in_order(f->parent, first, group);
      joined = true;
    }
  }
  f->owner[f->sides[begin] >> 32] = first;
  return joined;
}

/** All edges see the same groups, so that nothing hangs on their order. */
static bool join_odd(finder *f, bool all) {
  bool joined = false;
  look_up_groups(f);
  for (size_t s = 0, end; s < f->side_count; s = end) {
    for (end = s + 1; end < f->side_count && f->sides[end] >> 32 == f->sides[s] >> 32;)
      end++;
    joined |= join_along(f, s, end, all);
  }
  return joined;
}

static bool find(finder *f) {
  size_t faces = f->soup->face_count;
  f->parent = allocate(f, faces, sizeof *f->parent);
  f->group = allocate(f, faces, sizeof *f->group);
  f->odd = allocate(f, faces, sizeof *f->odd);
  f->owner = allocate(f, f->edges->count, sizeof *f->owner);
  if (!f->parent || !f->group || !f->odd || !f->owner)
    return false;
  join_pairs(f);
  if (!list_sides(f))
    return false;
  for (int round = 0; join_odd(f, round >= ROUNDS_MAX); round++)
    ;
  return true;
}

vxm_status vxm_rim_owners_find(vxm_rim_owners *out, const vxm_soup *soup, const vxm_edges *edges,
                               vxm_error *error) {
  finder f = {.soup = soup, .edges = edges, .context = soup->context, .error = VXM_ERROR_INIT};
  bool done = find(&f);
  *out = (vxm_rim_owners){.of_face = f.group, .of_edge = f.owner};
  vxm_free(f.context, f.sides);
  vxm_free(f.context, f.odd);
  vxm_free(f.context, f.parent);
  if (done)
    return VXM_OK;
  vxm_error_pass(error, &f.error);
  return f.error.code;
}

void vxm_rim_owners_destroy(vxm_rim_owners *owners, vxm_context *context) {
  vxm_free(context, owners->of_edge);
  vxm_free(context, owners->of_face);
}

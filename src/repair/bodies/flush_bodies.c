/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/bodies/flush_bodies.h"

#include "mesh/boundary_loops.h"
#include "mesh/disjoint_sets.h"
#include "mesh/sort.h"
#include "repair/state/flat_fold.h"

#include <stdlib.h>

/** A side along an edge that has not just two opposite ones. */
typedef struct crowded_side {
  vxm_edge_side side;
  size_t patch;
} crowded_side;

/** One at an end of it. */
typedef struct rim_end {
  uint32_t vertex;
  vxm_edge_side side;
} rim_end;

/** What the faces of a body sum up to. */
typedef struct body_sums {
  double area, volume; /**< about the middle of the mesh */
  vxm_vec3 vector_area;
} body_sums;

/** A vertex of a body that is to get another one in its place. */
typedef struct own_vertex {
  size_t body;
  uint32_t vertex, own;
} own_vertex;

typedef struct parting {
  vxm_repair_state *state;
  vxm_soup *soup;
  vxm_unit_scale frame;
  size_t *body;    /**< per face: another one of its patch, later of its body, or itself; see vxm_set_of */
  uint8_t *cut;    /**< per face that stands for a body: it touches others so */
  body_sums *sums; /**< the same; NULL = not asked for yet */
  vxm_vec3 *areas; /**< vxm_face_areas */
  crowded_side *sides;
  size_t side_count;
  vxm_error error;
} parting;

static void *scratch(parting *p, size_t count, size_t size) {
  return vxm_calloc(p->state->context, count, size, &p->error);
}

/** Asks now and then whether to go on. */
static bool goes_on(parting *p, size_t step) {
  return vxm_check_cancelled_at(step, p->state->context, &p->error) == VXM_OK;
}

/* ---- Patches, and what is not plain about their edges ---- */

static bool is_plain(const vxm_edge *edge) {
  return edge->count == 2 && edge->forward == 1;
}

/** Joins the faces at plain edges. */
static bool find_patches(parting *p) {
  const vxm_edges *edges = &p->state->edges;
  size_t *first = scratch(p, edges->count, sizeof *first); /* per edge: 1 + a face there */
  for (size_t f = 0; first && f < p->soup->face_count; f++)
    p->body[f] = f;
  for (size_t f = 0; first && f < p->soup->face_count && goes_on(p, f); f++)
    for (uint64_t c = p->soup->offsets[f]; c < p->soup->offsets[f + 1]; c++) {
      size_t e = edges->sides[c];
      if (e == VXM_NO_EDGE || !is_plain(&edges->edges[e]))
        continue;
      if (first[e] == 0)
        first[e] = f + 1;
      else
        vxm_set_unite(p->body, f, first[e] - 1);
    }
  vxm_free(p->state->context, first);
  return p->error.code == VXM_OK;
}

/** Lists (or, with NULL, counts) the sides at other edges. */
static size_t list_sides(const parting *p, crowded_side *sides) {
  const vxm_edges *edges = &p->state->edges;
  size_t listed = 0;
  for (size_t f = 0; f < p->soup->face_count; f++)
    for (uint64_t c = p->soup->offsets[f]; c < p->soup->offsets[f + 1]; c++) {
      size_t e = edges->sides[c];
      if (e == VXM_NO_EDGE || is_plain(&edges->edges[e]))
        continue;
      if (sides)
        sides[listed] = (crowded_side){{(uint32_t)e, p->soup->indices[c] == edges->edges[e].a, f},
                                       vxm_set_of(p->body, f)};
      listed++;
    }
  return listed;
}

static int by_edge_then_patch(const void *a, const void *b) {
  const crowded_side *s = a, *t = b;
  return vxm_compare_pairs(s->side.edge, s->patch, t->side.edge, t->patch);
}

static bool find_sides(parting *p) {
  p->side_count = list_sides(p, NULL);
  p->sides = scratch(p, p->side_count, sizeof *p->sides);
  if (!p->sides)
    return false;
  list_sides(p, p->sides);
  qsort(p->sides, p->side_count, sizeof *p->sides, by_edge_then_patch);
  return true;
}

static const vxm_edge *edge_of(const parting *p, const vxm_edge_side *side) {
  return &p->state->edges.edges[side->edge];
}

static bool is_rim(const vxm_edge *edge) {
  return 2 * (uint64_t)edge->forward != edge->count;
}

/* ---- Which patches are one body ---- */

enum { SIDES_MAX = 64 /* comparing more would be quadratic */ };

/** Whether two sides that run the same way are of faces of two patches that lie on each other. */
static bool has_fold(const parting *p, size_t begin, size_t end) {
  for (size_t i = begin; i < end && end - begin <= SIDES_MAX; i++)
    for (size_t j = i + 1; j < end; j++) {
      const crowded_side *one = &p->sides[i], *other = &p->sides[j];
      if (one->side.forward == other->side.forward && one->patch != other->patch &&
          vxm_is_flat_fold(p->soup, edge_of(p, &one->side), &one->side, &other->side, p->areas,
                           p->frame.scale))
        return true;
    }
  return false;
}

/** Of the sides of a patch at an edge, how many more run one way than the other; *next: where those end. */
static int balance_at(const parting *p, size_t begin, size_t end, size_t *next) {
  int balance = 0;
  size_t i = begin;
  for (; i < end && p->sides[i].patch == p->sides[begin].patch; i++)
    balance += p->sides[i].side.forward ? 1 : -1;
  *next = i;
  return balance;
}

/** Joins the patches at an edge that are not balanced there by themselves. */
static void join_at_edge(parting *p, size_t begin, size_t end) {
  size_t last = SIZE_MAX;
  for (size_t i = begin, next; i < end; i = next)
    if (balance_at(p, i, end, &next) != 0) {
      if (last != SIZE_MAX)
        vxm_set_unite(p->body, p->sides[i].patch, last);
      last = p->sides[i].patch;
    }
}

static size_t end_of_edge(const parting *p, size_t begin) {
  size_t end = begin;
  while (end < p->side_count && p->sides[end].side.edge == p->sides[begin].side.edge)
    end++;
  return end;
}

static bool find_bodies(parting *p) {
  for (size_t i = 0, end; i < p->side_count && goes_on(p, i); i = end) {
    end = end_of_edge(p, i);
    if (!is_rim(edge_of(p, &p->sides[i].side)) || !has_fold(p, i, end))
      join_at_edge(p, i, end);
  }
  return p->error.code == VXM_OK;
}

/* ---- Which bodies touch ---- */

/** Lists the ends of sides along rims, of patches that are not balanced there by themselves. */
static size_t list_ends(const parting *p, rim_end *ends) {
  size_t listed = 0;
  for (size_t i = 0, end, next; i < p->side_count; i = end) {
    end = end_of_edge(p, i);
    const vxm_edge *edge = edge_of(p, &p->sides[i].side);
    for (size_t k = i; k < end && is_rim(edge); k = next) {
      bool open = balance_at(p, k, end, &next) != 0;
      for (size_t s = k; s < next && open; s++) {
        ends[listed++] = (rim_end){edge->a, p->sides[s].side};
        ends[listed++] = (rim_end){edge->b, p->sides[s].side};
      }
    }
  }
  return listed;
}

static int by_vertex(const void *a, const void *b) {
  const rim_end *s = a, *t = b;
  return vxm_compare_pairs(s->vertex, s->side.edge, t->vertex, t->side.edge);
}

/** The other vertex of an edge, from here. */
static vxm_vec3 way_along(const parting *p, const rim_end *at) {
  const vxm_edge *edge = edge_of(p, &at->side);
  return vxm_vec3_between(vxm_position(p->soup, edge->a == at->vertex ? edge->b : edge->a),
                          vxm_position(p->soup, at->vertex), p->frame.scale);
}

/** Whether two rims go on from a vertex the same way, upon each other, and so do the faces at them. */
static bool lie_on_each_other(const parting *p, const rim_end *one, const rim_end *other) {
  const vxm_edge *e = edge_of(p, &one->side), *f = edge_of(p, &other->side);
  return (one->side.forward == (e->a == one->vertex)) == (other->side.forward == (f->a == other->vertex)) &&
         vxm_are_parallel(way_along(p, one), way_along(p, other)) &&
         vxm_are_parallel(vxm_leaves_edge(p->soup, e, &one->side, p->areas, p->frame.scale),
                          vxm_leaves_edge(p->soup, f, &other->side, p->areas, p->frame.scale));
}

static bool measure_bodies(parting *p) {
  p->sums = scratch(p, p->soup->face_count, sizeof *p->sums);
  for (size_t f = 0; p->sums && f < p->soup->face_count && goes_on(p, f); f++) {
    body_sums *sums = &p->sums[vxm_set_of(p->body, f)];
    sums->area += vxm_vec3_length(p->areas[f]);
    sums->vector_area = vxm_vec3_sum(sums->vector_area, p->areas[f]);
    sums->volume += vxm_face_cone(NULL, p->soup, f, p->frame.centre, p->frame.scale);
  }
  return p->error.code == VXM_OK;
}

/** Whether a body with a vertex on its rim bounds a volume and looks outward: a sheet that is folded upon
 * another one stays with it. */
static bool is_solid(const parting *p, size_t body, uint32_t vertex) {
  const double volume_min = 1e-6; /* of an area, each in units of the model's size */
  const body_sums *sums = &p->sums[body];
  vxm_vec3 apex = vxm_vec3_between(vxm_position(p->soup, vertex), p->frame.centre, p->frame.scale);
  return vxm_vec3_length(sums->vector_area) < VXM_SHEET_PART * sums->area &&
         sums->volume - vxm_polygon_cone(apex, sums->vector_area) > volume_min * sums->area;
}

/** Marks the bodies that do at a vertex. */
static bool mark_at_vertex(parting *p, const rim_end *ends, size_t count) {
  bool any = false;
  for (size_t i = 0; i < count && count <= SIDES_MAX; i++)
    for (size_t k = i + 1; k < count; k++) {
      size_t one = vxm_set_of(p->body, ends[i].side.face), other = vxm_set_of(p->body, ends[k].side.face);
      if (one == other || (p->cut[one] && p->cut[other]) || !lie_on_each_other(p, &ends[i], &ends[k]))
        continue;
      if (!p->sums && !measure_bodies(p))
        return false;
      bool parts = is_solid(p, one, ends[i].vertex) && is_solid(p, other, ends[i].vertex);
      p->cut[one] |= parts;
      p->cut[other] |= parts;
      any |= parts;
    }
  return any;
}

/** *any: some bodies touch others. */
static bool find_touching(parting *p, bool *any) {
  rim_end *ends = scratch(p, 2 * p->side_count, sizeof *ends);
  size_t count = ends ? list_ends(p, ends) : 0;
  if (ends)
    qsort(ends, count, sizeof *ends, by_vertex);
  for (size_t i = 0, next; i < count && goes_on(p, i); i = next) {
    for (next = i; next < count && ends[next].vertex == ends[i].vertex;)
      next++;
    *any |= mark_at_vertex(p, ends + i, next - i);
  }
  vxm_free(p->state->context, ends);
  return p->error.code == VXM_OK;
}

/* ---- Vertices ---- */

/** Whose a vertex stays: the others', or the first of the bodies that touch. */
static bool find_owners(parting *p, size_t *owner) {
  const vxm_soup *soup = p->soup;
  for (int cut = 0; cut < 2; cut++)
    for (size_t f = 0; f < soup->face_count && goes_on(p, f); f++) {
      size_t body = vxm_set_of(p->body, f);
      for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1] && p->cut[body] == cut; c++)
        if (owner[soup->indices[c]] == 0)
          owner[soup->indices[c]] = cut ? body + 1 : SIZE_MAX;
    }
  return p->error.code == VXM_OK;
}

static int by_body_then_vertex(const void *a, const void *b) {
  const own_vertex *s = a, *t = b;
  return vxm_compare_pairs(s->body, s->vertex, t->body, t->vertex);
}

/** Lists (or, with NULL, counts) the corners of bodies at vertices that are others'. */
static size_t list_corners(const parting *p, const size_t *owner, own_vertex *corners) {
  const vxm_soup *soup = p->soup;
  size_t listed = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t body = vxm_set_of(p->body, f);
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1] && p->cut[body]; c++) {
      if (owner[soup->indices[c]] == body + 1)
        continue;
      if (corners)
        corners[listed] = (own_vertex){body, soup->indices[c], 0};
      listed++;
    }
  }
  return listed;
}

/** Adds a vertex for each that is listed, once. */
static bool add_vertices(parting *p, own_vertex *list, size_t count) {
  size_t from = p->soup->vertex_count;
  for (size_t i = 0; i < count; i++) {
    if (i == 0 || by_body_then_vertex(&list[i], &list[i - 1]) != 0) {
      const double *at = vxm_position(p->soup, list[i].vertex), x = at[0], y = at[1], z = at[2];
      if (vxm_soup_add_vertex(p->soup, x, y, z, &p->error) != VXM_OK)
        return false;
    }
    list[i].own = (uint32_t)(p->soup->vertex_count - 1);
  }
  return vxm_repair_state_grow_marks(p->state, from, p->soup->vertex_count, &p->error);
}

static bool give_vertices(parting *p, const size_t *owner) {
  vxm_soup *soup = p->soup;
  size_t count = list_corners(p, owner, NULL);
  own_vertex *list = scratch(p, count, sizeof *list);
  if (!list)
    return false;
  list_corners(p, owner, list);
  qsort(list, count, sizeof *list, by_body_then_vertex);
  bool done = add_vertices(p, list, count);
  for (size_t f = 0; done && f < soup->face_count; f++) {
    size_t body = vxm_set_of(p->body, f);
    for (uint64_t c = soup->offsets[f]; c < soup->offsets[f + 1] && p->cut[body]; c++) {
      own_vertex wanted = {body, soup->indices[c], 0};
      const own_vertex *found = bsearch(&wanted, list, count, sizeof *list, by_body_then_vertex);
      soup->indices[c] = found ? found->own : soup->indices[c];
    }
  }
  vxm_free(p->state->context, list);
  return done;
}

static bool part(parting *p) {
  bool any = false;
  p->body = scratch(p, p->soup->face_count, sizeof *p->body);
  p->cut = scratch(p, p->soup->face_count, sizeof *p->cut);
  p->areas = vxm_face_areas(p->state->context, p->soup, p->frame.scale, &p->error);
  if (!p->body || !p->cut || !p->areas || !find_patches(p) || !find_sides(p) || !find_bodies(p) ||
      !find_touching(p, &any))
    return false;
  size_t *owner = any ? scratch(p, p->soup->vertex_count, sizeof *owner) : NULL;
  bool done = !any || (owner && find_owners(p, owner) && give_vertices(p, owner));
  vxm_free(p->state->context, owner);
  return done;
}

/** Whether it is plain that no bodies touch: there is no rim, or patches have no vertex in common. */
static vxm_status are_apart(bool *apart, vxm_repair_state *state, vxm_error *error) {
  vxm_status status = vxm_repair_state_count_edges(state, error);
  const vxm_edges *edges = &state->edges;
  *apart = status == VXM_OK && edges->odd == 0 && edges->against == 0;
  if (status != VXM_OK || *apart || edges->against > 0 || edges->crowded > 0)
    return status;
  status = vxm_repair_state_patches(state, error);
  return status == VXM_OK ? vxm_patches_are_apart(apart, &state->patches, state->soup, error) : status;
}

vxm_status vxm_part_flush_bodies(vxm_repair_state *state, bool *changed, vxm_error *error) {
  *changed = false;
  bool apart;
  vxm_status status = are_apart(&apart, state, error);
  if (status != VXM_OK || apart)
    return status;
  status = vxm_repair_state_edges(state, error);
  if (status != VXM_OK)
    return status;
  vxm_extent extent;
  vxm_repair_state_extent(state, &extent);
  parting p = {.state = state,
               .soup = state->soup,
               .frame = vxm_unit_scale_of(extent.bounds),
               .error = VXM_ERROR_INIT};
  size_t before = state->soup->vertex_count;
  bool done = part(&p);
  vxm_free(state->context, p.areas);
  vxm_free(state->context, p.sums);
  vxm_free(state->context, p.sides);
  vxm_free(state->context, p.cut);
  vxm_free(state->context, p.body);
  state->counts[VXM_PASS_CUT_NONMANIFOLD] += (int64_t)(state->soup->vertex_count - before);
  *changed = state->soup->vertex_count > before;
  if (*changed)
    vxm_repair_state_touch(state);
  if (!done)
    vxm_error_pass(error, &p.error);
  return done ? VXM_OK : p.error.code;
}

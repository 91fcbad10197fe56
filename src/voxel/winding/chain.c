/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/chain.h"
#include "mesh/disjoint_sets.h"

#include <stdlib.h>
#include <string.h>

static const uint32_t none = UINT32_MAX;

/** A side of a triangle, kept with its lower point. */
typedef struct side {
  uint32_t high;
  uint32_t triangle;
  bool forward; /**< runs from the lower point to the higher one */
} side;

/** An edge of the boundary, linked to the next one that begins at the same point. */
typedef struct boundary_edge {
  uint32_t from, to, component, next;
} boundary_edge;

typedef struct builder {
  vxm_winding_chain *out;
  const uint32_t (*corners)[3];
  size_t count, point_count;
  uint32_t *side_begin; /**< of each point: its sides, those of triangles of which it is the lower one */
  side *sides;
  uint32_t *parent; /**< of each triangle, in its component's tree */
  boundary_edge *boundary;
  size_t boundary_count, boundary_capacity;
  uint32_t *own, *cost; /**< of each component: its triangles, and the edges of its boundary */
  uint32_t *first;      /**< of each point: a boundary edge that begins there */
  uint32_t *place;      /**< of each point: where it is on the path */
  uint32_t *path, *loop;
  vxm_error error;
} builder;

static void *allocate(builder *b, size_t count, size_t size) {
  return vxm_alloc(b->out->context, count, size, &b->error);
}

static bool is_triangle(const uint32_t c[3]) {
  return c[0] != c[1] && c[1] != c[2] && c[2] != c[0];
}

/* ---- Components and their boundary ---- */

static uint32_t component_of(const builder *b, uint32_t triangle) {
  return vxm_set_of_u32(b->parent, triangle);
}

/** The sides of all triangles, by their lower point. */
static bool collect_sides(builder *b) {
  b->side_begin = vxm_calloc(b->out->context, b->point_count + 2, sizeof *b->side_begin, &b->error);
  b->sides = allocate(b, 3 * b->count, sizeof *b->sides);
  if (!b->side_begin || !b->sides)
    return false;
  uint32_t *end = b->side_begin + 1; /* moves on to be the end of each point's sides */
  for (int pass = 0; pass < 2; pass++) {
    for (size_t t = 0; t < b->count; t++) {
      const uint32_t *c = b->corners[t];
      if (!is_triangle(c))
        continue;
      for (int k = 0; k < 3; k++) {
        uint32_t p = c[k], q = c[(k + 1) % 3], low = p < q ? p : q;
        if (pass == 0)
          end[low + 1]++;
        else
          b->sides[end[low]++] = (side){p < q ? q : p, (uint32_t)t, p < q};
      }
    }
    for (size_t v = 0; pass == 0 && v < b->point_count; v++)
      end[v + 1] += end[v];
  }
  return true;
}

static int compare_sides(const void *a, const void *b) {
  const side *p = a, *q = b;
  return p->high != q->high ? (p->high < q->high ? -1 : 1)
                            : (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

/** Sorts the sides of a point by their other end, and by triangle. They come in the order of triangles. */
static void sort_sides(side *sides, size_t count) {
  enum { MANY = 32 };
  if (count > MANY) {
    qsort(sides, count, sizeof *sides, compare_sides);
    return;
  }
  for (size_t i = 1; i < count; i++) {
    side moved = sides[i];
    size_t k = i;
    for (; k > 0 && sides[k - 1].high > moved.high; k--)
      sides[k] = sides[k - 1];
    sides[k] = moved;
  }
}

static bool add_boundary(builder *b, uint32_t from, uint32_t to, uint32_t triangle) {
  if (vxm_grow(b->out->context, (void **)&b->boundary, &b->boundary_capacity, b->boundary_count + 1,
               sizeof *b->boundary, &b->error) != VXM_OK)
    return false;
  b->boundary[b->boundary_count++] = (boundary_edge){from, to, triangle, none};
  return true;
}

/** Joins the triangles at every edge, and notes what is left of it when opposite sides cancel. */
static bool join_triangles(builder *b) {
  b->parent = allocate(b, b->count, sizeof *b->parent);
  if (!b->parent)
    return false;
  for (size_t t = 0; t < b->count; t++)
    b->parent[t] = (uint32_t)t;
  for (size_t v = 0; v < b->point_count; v++) {
    side *sides = b->sides + b->side_begin[v];
    size_t count = b->side_begin[v + 1] - b->side_begin[v];
    sort_sides(sides, count);
    for (size_t i = 0; i < count;) {
      uint32_t high = sides[i].high, triangle = sides[i].triangle, root = component_of(b, triangle);
      int64_t net = 0;
      for (; i < count && sides[i].high == high; i++) {
        net += sides[i].forward ? 1 : -1;
        b->parent[component_of(b, sides[i].triangle)] = root;
      }
      for (; net > 0; net--)
        if (!add_boundary(b, (uint32_t)v, high, triangle))
          return false;
      for (; net < 0; net++)
        if (!add_boundary(b, high, (uint32_t)v, triangle))
          return false;
    }
  }
  return true;
}

/** Counts the triangles and boundary edges of the components, which then have their final numbers. */
static bool weigh_components(builder *b) {
  b->own = vxm_calloc(b->out->context, b->count, sizeof *b->own, &b->error);
  b->cost = vxm_calloc(b->out->context, b->count, sizeof *b->cost, &b->error);
  if (!b->own || !b->cost)
    return false;
  for (size_t t = 0; t < b->count; t++)
    b->own[component_of(b, (uint32_t)t)] += is_triangle(b->corners[t]);
  for (size_t i = 0; i < b->boundary_count; i++) {
    b->boundary[i].component = component_of(b, b->boundary[i].component);
    b->cost[b->boundary[i].component]++;
  }
  return true;
}

static bool is_filled(const builder *b, uint32_t component) {
  return b->own[component] > b->cost[component];
}

/* ---- Filling ---- */

static void add_filling(builder *b, uint32_t p, uint32_t q, uint32_t r) {
  vxm_winding_chain *out = b->out;
  uint32_t *rest = out->rest[out->rest_count++], *closed = out->closed[out->closed_count++];
  rest[0] = closed[0] = p;
  rest[1] = closed[2] = q;
  rest[2] = closed[1] = r;
}

/** Fills a loop of `count` points, which are overwritten. */
static void fill_loop(builder *b, uint32_t *loop, size_t count) {
  while (count > 2) {
    size_t kept = 0, i = 0;
    for (; i + 1 < count; i += 2) { /* corner i + 1 is cut off */
      loop[kept++] = loop[i];
      add_filling(b, loop[i], loop[i + 1], i + 2 < count ? loop[i + 2] : loop[0]);
      if (count == 3)
        return;
    }
    if (i < count)
      loop[kept++] = loop[i];
    count = kept;
  }
}

/** Goes along the boundary from a point until nothing is left there; each time it comes to a point of its
 * path again it cuts off a loop. A boundary comes to each point as often as it leaves it. */
static void walk_from(builder *b, uint32_t start) {
  size_t last = 0;
  b->path[0] = start;
  b->place[start] = 0;
  for (uint32_t at = start; b->first[at] != none;) {
    const boundary_edge *edge = &b->boundary[b->first[at]];
    b->first[at] = edge->next;
    at = edge->to;
    if (b->place[at] == none) {
      b->path[++last] = at;
      b->place[at] = (uint32_t)last;
      continue;
    }
    size_t begin = b->place[at];
    memcpy(b->loop, b->path + begin, (last - begin + 1) * sizeof *b->loop);
    fill_loop(b, b->loop, last - begin + 1);
    for (; last > begin; last--)
      b->place[b->path[last]] = none;
  }
  b->place[start] = none;
}

static bool fill_boundary(builder *b) {
  b->first = allocate(b, b->point_count, sizeof *b->first);
  b->place = allocate(b, b->point_count, sizeof *b->place);
  b->path = allocate(b, b->boundary_count + 1, sizeof *b->path);
  b->loop = allocate(b, b->boundary_count + 1, sizeof *b->loop);
  if (!b->first || !b->place || !b->path || !b->loop)
    return false;
  for (size_t v = 0; v < b->point_count; v++)
    b->first[v] = b->place[v] = none;
  for (size_t i = b->boundary_count; i-- > 0;) {
    boundary_edge *edge = &b->boundary[i];
    if (!is_filled(b, edge->component))
      continue;
    edge->next = b->first[edge->from];
    b->first[edge->from] = (uint32_t)i;
  }
  for (size_t v = 0; v < b->point_count; v++)
    while (b->first[v] != none)
      walk_from(b, (uint32_t)v);
  return true;
}

/** The triangles of components that are filled are in T - R, the others are in R. */
static bool divide(builder *b) {
  vxm_winding_chain *out = b->out;
  out->closed = allocate(b, b->count + b->boundary_count, sizeof *out->closed);
  out->rest = allocate(b, b->count + b->boundary_count, sizeof *out->rest);
  if (!out->closed || !out->rest)
    return false;
  for (size_t t = 0; t < b->count; t++) {
    if (!is_triangle(b->corners[t]))
      continue;
    uint32_t *to = is_filled(b, component_of(b, (uint32_t)t)) ? out->closed[out->closed_count++]
                                                              : out->rest[out->rest_count++];
    memcpy(to, b->corners[t], sizeof b->corners[t]);
  }
  return true;
}

/** Gives back the room that is not used. */
static void trim(vxm_winding_chain *out) {
  void *closed = vxm_realloc(out->context, out->closed, out->closed_count, sizeof *out->closed, NULL);
  void *rest = vxm_realloc(out->context, out->rest, out->rest_count, sizeof *out->rest, NULL);
  out->closed = closed ? closed : out->closed;
  out->rest = rest ? rest : out->rest;
}

vxm_status vxm_winding_chain_create(vxm_winding_chain *out, vxm_context *context,
                                    const uint32_t (*corners)[3], size_t count, size_t point_count,
                                    vxm_error *error) {
  *out = (vxm_winding_chain){.context = context};
  if (count > UINT32_MAX / 6)
    return vxm_fail(error, VXM_ERROR_RANGE, "%zu triangles are too many for winding numbers; split the mesh",
                    count);
  builder b = {
      .out = out, .corners = corners, .count = count, .point_count = point_count, .error = VXM_ERROR_INIT};
  bool done =
      collect_sides(&b) && join_triangles(&b) && weigh_components(&b) && divide(&b) && fill_boundary(&b);
  vxm_free(context, b.loop);
  vxm_free(context, b.path);
  vxm_free(context, b.place);
  vxm_free(context, b.first);
  vxm_free(context, b.cost);
  vxm_free(context, b.own);
  vxm_free(context, b.boundary);
  vxm_free(context, b.parent);
  vxm_free(context, b.sides);
  vxm_free(context, b.side_begin);
  if (done) {
    trim(out);
    return VXM_OK;
  }
  vxm_winding_chain_destroy(out);
  vxm_error_pass(error, &b.error);
  return b.error.code;
}

void vxm_winding_chain_destroy(vxm_winding_chain *chain) {
  vxm_free(chain->context, chain->rest);
  vxm_free(chain->context, chain->closed);
  *chain = (vxm_winding_chain){.context = chain->context};
}

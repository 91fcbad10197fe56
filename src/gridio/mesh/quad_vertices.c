/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/mesh/quad_vertices.h"

#include <string.h>

/** A corner on its way through the sort. */
typedef struct record {
  uint64_t point;
  uint32_t corner;
} record;

/** Blocks that live only while the corners are sorted. */
typedef struct scratch {
  vxm_context *context;
  record *records[2];
  size_t
      *starts; /**< of the buckets of a counting sort: one per coordinate of the longest axis, and one more */
} scratch;

static void scratch_destroy(scratch *s) {
  vxm_free(s->context, s->records[0]);
  vxm_free(s->context, s->records[1]);
  vxm_free(s->context, s->starts);
}

static void *take(vxm_context *context, size_t count, size_t size, vxm_status *status, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  void *block = *status == VXM_OK ? vxm_alloc(context, count, size, &local) : NULL;
  if (*status == VXM_OK && !block) {
    *status = local.code;
    vxm_error_pass(error, &local);
  }
  return block;
}

/* ---- Points of all corners ---- */

static void put_corners(record *to, const vxm_greedy_quad *r, int axis, uint32_t first) {
  const uint32_t u[4] = {r->u0, r->u1, r->u1, r->u0}, v[4] = {r->v0, r->v0, r->v1, r->v1};
  uint32_t level = r->level / 2;
  for (uint32_t c = 0; c < 4; c++) {
    uint64_t point = axis == 0   ? vxm_quad_point(level, u[c], v[c])
                     : axis == 1 ? vxm_quad_point(u[c], level, v[c])
                                 : vxm_quad_point(u[c], v[c], level);
    to[c] = (record){point, first + c};
  }
}

static void put_all_corners(record *to, const vxm_greedy_quads *quads) {
  uint32_t first = 0;
  for (size_t l = 0; l < quads->list_count; l++) {
    const vxm_greedy_quad_list *list = &quads->lists[l];
    for (size_t r = 0; r < list->count; r++, first += 4)
      put_corners(to + first, &list->items[r], list->axis, first);
  }
}

/* ---- Sorting by coordinates ---- */

/** Turns the counts in starts[1..] into the start of each bucket. */
static void sum_starts(size_t *starts, size_t buckets) {
  for (size_t b = 1; b <= buckets; b++)
    starts[b] += starts[b - 1];
}

/** One stable pass; three of them, by x, y and z, sort by z, then y, then x. */
static void sort_records(record *to, const record *from, size_t count, int axis, size_t *starts,
                         size_t buckets) {
  memset(starts, 0, (buckets + 1) * sizeof *starts);
  for (size_t i = 0; i < count; i++)
    starts[vxm_quad_point_coordinate(from[i].point, axis) + 1]++;
  sum_starts(starts, buckets);
  for (size_t i = 0; i < count; i++)
    to[starts[vxm_quad_point_coordinate(from[i].point, axis)]++] = from[i];
}

/** As sort_records, for vertices in the order `from` (NULL = by number). */
static void sort_vertices(uint32_t *to, const uint32_t *from, const vxm_quad_vertices *c, int axis,
                          size_t *starts, size_t buckets) {
  memset(starts, 0, (buckets + 1) * sizeof *starts);
  for (size_t i = 0; i < c->vertex_count; i++)
    starts[vxm_quad_point_coordinate(c->points[i], axis) + 1]++;
  sum_starts(starts, buckets);
  for (size_t i = 0; i < c->vertex_count; i++) {
    uint32_t vertex = from ? from[i] : (uint32_t)i;
    to[starts[vxm_quad_point_coordinate(c->points[vertex], axis)]++] = vertex;
  }
}

/* ---- Vertices and their neighbours ---- */

/** Equal points follow each other in sorted order: each becomes one vertex. */
static size_t count_points(const record *sorted, size_t count) {
  size_t points = 0;
  for (size_t i = 0; i < count; i++)
    points += i == 0 || sorted[i].point != sorted[i - 1].point;
  return points;
}

static void number_points(vxm_quad_vertices *c, const record *sorted, size_t count) {
  uint32_t vertex = 0;
  for (size_t i = 0; i < count; i++) {
    if (i > 0 && sorted[i].point != sorted[i - 1].point)
      vertex++;
    c->points[vertex] = sorted[i].point;
    c->vertex[sorted[i].corner] = vertex;
  }
}

static uint64_t drop_coordinate(uint64_t point, int axis) {
  return point & ~((uint64_t)((1u << 21) - 1) << (21 * axis));
}

/** In `order` the vertices of a line along `axis` follow each other; NULL = by number. */
static void link_line(vxm_quad_vertices *c, const uint32_t *order, int axis) {
  for (size_t i = 0; i < c->vertex_count; i++) {
    uint32_t here = order ? order[i] : (uint32_t)i, next = VXM_NO_CORNER;
    if (i + 1 < c->vertex_count) {
      uint32_t candidate = order ? order[i + 1] : (uint32_t)i + 1;
      if (drop_coordinate(c->points[here], axis) == drop_coordinate(c->points[candidate], axis))
        next = candidate;
    }
    c->next[axis][here] = next;
  }
}

/**
 * Numbers go by (z, y, x): lines along x are together. A stable sort by x gives (x, z, y): lines along y. One
 * more by y gives (y, x, z): lines along z.
 */
static vxm_status link_lines(vxm_quad_vertices *c, const int64_t dims[3], size_t *starts, vxm_error *error) {
  vxm_status status = VXM_OK;
  uint32_t *by_x = take(c->context, c->vertex_count, sizeof *by_x, &status, error);
  uint32_t *by_yx = take(c->context, c->vertex_count, sizeof *by_yx, &status, error);
  if (status == VXM_OK) {
    link_line(c, NULL, 0);
    sort_vertices(by_x, NULL, c, 0, starts, (size_t)dims[0] + 1);
    link_line(c, by_x, 1);
    sort_vertices(by_yx, by_x, c, 1, starts, (size_t)dims[1] + 1);
    link_line(c, by_yx, 2);
  }
  vxm_free(c->context, by_x);
  vxm_free(c->context, by_yx);
  return status;
}

static vxm_status find(vxm_quad_vertices *c, scratch *s, const vxm_greedy_quads *quads, const int64_t dims[3],
                       vxm_error *error) {
  size_t count = 4 * quads->count, longest = 0;
  for (int a = 0; a < 3; a++)
    longest = (size_t)dims[a] > longest ? (size_t)dims[a] : longest;
  vxm_status status = VXM_OK;
  s->starts = take(s->context, longest + 2, sizeof *s->starts, &status, error);
  c->vertex = take(s->context, count, sizeof *c->vertex, &status, error);
  for (int r = 0; r < 2; r++)
    s->records[r] = take(s->context, count, sizeof *s->records[r], &status, error);
  if (status != VXM_OK)
    return status;
  put_all_corners(s->records[0], quads);
  for (int axis = 0; status == VXM_OK && axis < 3; axis++) {
    sort_records(s->records[(axis + 1) % 2], s->records[axis % 2], count, axis, s->starts,
                 (size_t)dims[axis] + 1);
    status = vxm_progress(s->context, "sharing corners", (double)(axis + 1) / 4, error);
  }
  const record *sorted = s->records[1];
  vxm_free(s->context, s->records[0]);
  s->records[0] = NULL;
  c->vertex_count = count_points(sorted, count);
  c->points = take(s->context, c->vertex_count, sizeof *c->points, &status, error);
  for (int a = 0; a < 3; a++)
    c->next[a] = take(s->context, c->vertex_count, sizeof *c->next[a], &status, error);
  if (status != VXM_OK)
    return status;
  number_points(c, sorted, count);
  vxm_free(s->context, s->records[1]);
  s->records[1] = NULL;
  return link_lines(c, dims, s->starts, error);
}

vxm_status vxm_quad_vertices_find(vxm_quad_vertices *out, const vxm_greedy_quads *quads,
                                  const int64_t dims[3], vxm_error *error) {
  *out = (vxm_quad_vertices){.context = quads->context};
  scratch s = {.context = quads->context};
  vxm_status status = find(out, &s, quads, dims, error);
  scratch_destroy(&s);
  if (status != VXM_OK)
    vxm_quad_vertices_destroy(out);
  return status;
}

void vxm_quad_vertices_destroy(vxm_quad_vertices *corners) {
  vxm_free(corners->context, corners->vertex);
  vxm_free(corners->context, corners->points);
  for (int a = 0; a < 3; a++)
    vxm_free(corners->context, corners->next[a]);
  *corners = (vxm_quad_vertices){.context = corners->context};
}

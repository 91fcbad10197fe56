/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/facets.h"

#include <string.h>

/** What is needed while facets are made. */
typedef struct builder {
  vxm_facets *facets;
  const vxm_soup *soup;
  vxm_error error; /**< of the last allocation that failed */
} builder;

static void *allocate(builder *b, size_t count, size_t size) {
  return vxm_calloc(b->facets->context, count, size, &b->error);
}

/* ---- Covering polygons by triangles ---- */

static bool comes_before(const vxm_point *p, const vxm_point *q) {
  for (int a = 0; a < 3; a++)
    if (p->at[a] != q->at[a])
      return p->at[a] < q->at[a];
  return false;
}

/** The corner from which a polygon is covered: the first in space, so that equal polygons are covered alike.
 */
static size_t covering_corner(const vxm_point *points, const uint32_t *corner, size_t n) {
  size_t first = 0;
  for (size_t c = 1; c < n; c++)
    if (comes_before(&points[corner[c]], &points[corner[first]]))
      first = c;
  return first;
}

/** A triangle with two equal corners covers nothing. */
static bool has_three_corners(uint32_t p, uint32_t q, uint32_t r) {
  return p != q && q != r && r != p;
}

/** Counts a facet in its part's `end` (facets NULL) or puts it there. */
static void add(builder *b, vxm_facet *facets, vxm_facet facet) {
  size_t *end = &b->facets->parts[facet.part].end;
  if (facets)
    facets[*end] = facet;
  ++*end;
}

static void cover_face(builder *b, size_t face, vxm_facet *facets) {
  const vxm_split *split = &b->facets->split;
  size_t n;
  const uint32_t *corner = vxm_face(b->soup, face, &n);
  uint32_t part = split->part[split->component[face]];
  size_t apex = n > 3 ? covering_corner(b->facets->points, corner, n) : 0;
  for (size_t i = 1; i + 1 < n; i++) {
    uint32_t p = corner[apex], q = corner[(apex + i) % n], r = corner[(apex + i + 1) % n];
    if (has_three_corners(p, q, r))
      add(b, facets, (vxm_facet){{p, q, r}, part, VXM_FACET_TRIANGLE});
  }
}

/** The triangles from the apex of a part to its odd edges. */
static void add_cones(builder *b, vxm_facet *facets) {
  const vxm_split *split = &b->facets->split;
  const vxm_loops *loops = &split->loops;
  for (size_t l = 0; l < loops->count; l++) {
    uint32_t part = split->loop_part[l], apex = (uint32_t)(b->facets->first_apex + part);
    for (size_t s = loops->begin[l]; s < loops->begin[l + 1]; s++) {
      const vxm_edge *edge = &split->edges.edges[loops->edge[s]];
      add(b, facets, (vxm_facet){{edge->a, edge->b, apex}, part, VXM_FACET_CONE});
    }
  }
}

/** The caps of all loops; their own points are numbered behind the soup's vertices, and here behind the
 * apexes. */
static void add_caps(builder *b, vxm_facet *facets) {
  const vxm_split *split = &b->facets->split;
  size_t vertices = b->soup->vertex_count, first_cap = b->facets->first_cap;
  for (size_t l = 0; split->cap_begin && l < split->loops.count; l++)
    for (size_t t = split->cap_begin[l]; t < split->cap_begin[l + 1]; t++) {
      vxm_facet facet = {{0, 0, 0}, split->loop_part[l], VXM_FACET_CAP};
      for (int c = 0; c < 3; c++) {
        uint32_t v = split->caps.triangles[t][c];
        facet.corner[c] = v < vertices ? v : (uint32_t)(v - vertices + first_cap);
      }
      add(b, facets, facet);
    }
}

/** Two rounds of the same walk: the first counts the facets of each part, the second puts them in place. */
static vxm_status make_facets(builder *b) {
  vxm_facets *facets = b->facets;
  size_t part_count = facets->split.part_count;
  facets->parts = allocate(b, part_count, sizeof *facets->parts);
  if (!facets->parts)
    return b->error.code;
  for (int round = 0; round < 2; round++) {
    for (size_t f = 0; f < b->soup->face_count; f++)
      cover_face(b, f, facets->facets);
    add_cones(b, facets->facets);
    add_caps(b, facets->facets);
    if (round == 1)
      break;
    size_t total = 0;
    for (size_t p = 0; p < part_count; p++) {
      size_t count = facets->parts[p].end;
      facets->parts[p].begin = facets->parts[p].end = total;
      total += count;
    }
    if (total > UINT32_MAX)
      return vxm_fail(&b->error, VXM_ERROR_RANGE, "%zu triangles are too many to number; split the mesh",
                      total);
    facets->facet_count = total;
    facets->facets = allocate(b, total, sizeof *facets->facets);
    if (!facets->facets)
      return b->error.code;
  }
  return VXM_OK;
}

/* ---- Boxes and apexes ---- */

/** The mean of `count` points, rounded toward zero, so that it stays in their box. */
static vxm_point mean_of(const vxm_int128 sum[3], size_t count) {
  vxm_point mean = {{0, 0, 0}};
  for (int a = 0; a < 3 && count > 0; a++)
    mean.at[a] = (int64_t)(sum[a] / (vxm_int128)count);
  return mean;
}

static void measure_part(vxm_facets *facets, size_t part) {
  vxm_part *p = &facets->parts[part];
  vxm_int128 sum[3] = {0, 0, 0};
  size_t corners = 0;
  for (int a = 0; a < 3; a++) {
    p->low.at[a] = VXM_LATTICE_MAX;
    p->high.at[a] = -VXM_LATTICE_MAX;
  }
  for (size_t f = p->begin; f < p->end; f++) {
    const vxm_facet *facet = &facets->facets[f];
    if (facet->role != VXM_FACET_TRIANGLE)
      break;
    for (int c = 0; c < 3; c++, corners++) {
      const vxm_point *q = &facets->points[facet->corner[c]];
      for (int a = 0; a < 3; a++) {
        p->low.at[a] = q->at[a] < p->low.at[a] ? q->at[a] : p->low.at[a];
        p->high.at[a] = q->at[a] > p->high.at[a] ? q->at[a] : p->high.at[a];
        sum[a] += q->at[a];
      }
    }
  }
  p->apex = (uint32_t)(facets->first_apex + part);
  facets->points[p->apex] = mean_of(sum, corners);
}

/** Appends room for the apexes to the points. */
static vxm_status reserve_apexes(builder *b, vxm_error *error) {
  vxm_facets *facets = b->facets;
  facets->first_apex = b->soup->vertex_count;
  facets->first_cap = facets->first_apex + facets->split.part_count;
  size_t count = facets->first_cap + facets->split.caps.point_count;
  if (count > VXM_VERTICES_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, "too many vertices, parts and holes to number; split the mesh");
  vxm_point *points = vxm_realloc(facets->context, facets->points, count, sizeof *points, &b->error);
  if (!points)
    return b->error.code;
  facets->points = points;
  return VXM_OK;
}

vxm_status vxm_facets_create(vxm_facets *out, const vxm_soup *soup, const vxm_lattice *lattice,
                             vxm_split_rule rule, vxm_error *error) {
  *out = (vxm_facets){.context = soup->context, .split = {.context = soup->context}};
  builder b = {.facets = out, .soup = soup, .error = VXM_ERROR_INIT};
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = VXM_OK;
  out->points = allocate(&b, soup->vertex_count, sizeof *out->points);
  if (!out->points)
    status = b.error.code;
  if (status == VXM_OK)
    status = vxm_lattice_snap(lattice, soup, out->points, &local);
  if (status == VXM_OK)
    status = vxm_split_create(&out->split, soup, lattice, rule, &local);
  if (status == VXM_OK)
    status = reserve_apexes(&b, &local);
  if (status == VXM_OK)
    status = make_facets(&b);
  if (status == VXM_OK) {
    for (size_t p = 0; p < out->split.part_count; p++)
      measure_part(out, p);
    for (size_t p = 0; p < out->split.caps.point_count; p++)
      vxm_lattice_place(lattice, out->split.caps.points[p], &out->points[out->first_cap + p]);
  } else if (error)
    *error = local.code != VXM_OK ? local : b.error;
  return status;
}

void vxm_facets_destroy(vxm_facets *facets) {
  vxm_split_destroy(&facets->split);
  vxm_free(facets->context, facets->parts);
  vxm_free(facets->context, facets->facets);
  vxm_free(facets->context, facets->points);
  *facets = (vxm_facets){.context = facets->context, .split = {.context = facets->context}};
}

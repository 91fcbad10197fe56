/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/facets.h"
#include "mesh/components.h"
#include "mesh/edges.h"

#include <string.h>

/** What is needed while facets are made. */
typedef struct builder {
  vxm_facets *facets;
  const vxm_soup *soup;
  vxm_context *context;
  uint32_t *component; /**< of every face */
  size_t component_count;
  uint32_t *part;             /**< of every component */
  uint32_t *vertex_component; /**< of every vertex that a face uses */
  vxm_edges edges;
  vxm_error error; /**< of the last allocation that failed */
} builder;

static void *allocate(builder *b, size_t count, size_t size) {
  return vxm_calloc(b->context, count, size, &b->error);
}

/* ---- Splitting into parts ---- */

static vxm_status find_components(builder *b, vxm_parts split, vxm_error *error) {
  const vxm_soup *soup = b->soup;
  b->component = allocate(b, soup->face_count, sizeof *b->component);
  b->vertex_component = allocate(b, soup->vertex_count, sizeof *b->vertex_component);
  if (!b->component || !b->vertex_component)
    return b->error.code;
  b->component_count = 1;
  if (split != VXM_PARTS_WHOLE) {
    vxm_status status = vxm_components(b->context, soup, NULL, b->component, &b->component_count, error);
    if (status != VXM_OK)
      return status;
  }
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n);
    for (size_t c = 0; c < n; c++)
      b->vertex_component[corner[c]] = b->component[f];
  }
  return VXM_OK;
}

/** Numbers the parts: closed components first; the others after them, or all together with VXM_PARTS_AUTO. */
static vxm_status number_parts(builder *b, vxm_parts split) {
  b->part = allocate(b, b->component_count, sizeof *b->part);
  uint8_t *open = allocate(b, b->component_count, sizeof *open);
  if (!b->part || !open) {
    vxm_free(b->context, open);
    return b->error.code;
  }
  for (size_t e = 0; e < b->edges.count; e++)
    if (vxm_edge_is_odd(&b->edges.edges[e])) {
      open[b->vertex_component[b->edges.edges[e].a]] = 1;
      b->facets->odd_edge_count++;
    }
  size_t next = 0, open_count = 0;
  for (size_t c = 0; c < b->component_count; c++)
    if (!open[c])
      b->part[c] = (uint32_t)next++;
  b->facets->closed_count = next;
  for (size_t c = 0; c < b->component_count; c++)
    if (open[c])
      b->part[c] = (uint32_t)(split == VXM_PARTS_AUTO ? next : next + open_count++);
  b->facets->part_count = b->facets->odd_edge_count == 0 ? next
                          : split == VXM_PARTS_AUTO      ? next + 1
                                                         : next + open_count;
  vxm_free(b->context, open);
  return VXM_OK;
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

/** Counts the facets of a face in its part's `end` (facets NULL) or puts them there. */
static void cover_face(builder *b, size_t face, vxm_facet *facets) {
  size_t n;
  const uint32_t *corner = vxm_face(b->soup, face, &n);
  if (n < 3)
    return;
  uint32_t part = b->part[b->component[face]];
  size_t *end = &b->facets->parts[part].end;
  size_t apex = n > 3 ? covering_corner(b->facets->points, corner, n) : 0;
  for (size_t i = 1; i + 1 < n; i++) {
    uint32_t p = corner[apex], q = corner[(apex + i) % n], r = corner[(apex + i + 1) % n];
    if (!has_three_corners(p, q, r))
      continue;
    if (facets)
      facets[*end] = (vxm_facet){{p, q, r}, part};
    ++*end;
  }
}

/** Counts or puts the cones over all odd edges. */
static void cover_odd_edges(builder *b, vxm_facet *facets) {
  for (size_t e = 0; e < b->edges.count; e++) {
    const vxm_edge *edge = &b->edges.edges[e];
    if (!vxm_edge_is_odd(edge))
      continue;
    uint32_t part = b->part[b->vertex_component[edge->a]];
    size_t *end = &b->facets->parts[part].end;
    if (facets)
      facets[*end] = (vxm_facet){{edge->a, edge->b, (uint32_t)(b->facets->first_apex + part)}, part};
    ++*end;
  }
}

/** Two rounds of the same walk: the first counts the facets of each part, the second puts them in place. */
static vxm_status make_facets(builder *b) {
  vxm_facets *facets = b->facets;
  facets->parts = allocate(b, facets->part_count, sizeof *facets->parts);
  if (!facets->parts)
    return b->error.code;
  for (int round = 0; round < 2; round++) {
    for (size_t f = 0; f < b->soup->face_count; f++)
      cover_face(b, f, facets->facets);
    cover_odd_edges(b, facets->facets);
    if (round == 1)
      break;
    size_t total = 0;
    for (size_t p = 0; p < facets->part_count; p++) {
      size_t count = facets->parts[p].end;
      facets->parts[p].begin = facets->parts[p].end = total;
      total += count;
    }
    facets->facet_count = total;
    facets->facets = allocate(b, total, sizeof *facets->facets);
    if (!facets->facets)
      return b->error.code;
  }
  return VXM_OK;
}

/* ---- Boxes and apexes ---- */

static void measure_part(vxm_facets *facets, size_t part) {
  vxm_part *p = &facets->parts[part];
  vxm_int128 sum[3] = {0, 0, 0};
  int64_t corners = 0;
  for (int a = 0; a < 3; a++) {
    p->low.at[a] = VXM_LATTICE_MAX;
    p->high.at[a] = -VXM_LATTICE_MAX;
  }
  for (size_t f = p->begin; f < p->end && !vxm_facet_is_cone(facets, f); f++, corners += 3)
    for (int c = 0; c < 3; c++) {
      const vxm_point *q = &facets->points[facets->facets[f].corner[c]];
      for (int a = 0; a < 3; a++) {
        p->low.at[a] = q->at[a] < p->low.at[a] ? q->at[a] : p->low.at[a];
        p->high.at[a] = q->at[a] > p->high.at[a] ? q->at[a] : p->high.at[a];
        sum[a] += q->at[a];
      }
    }
  p->apex = (uint32_t)(facets->first_apex + part);
  for (int a = 0; a < 3; a++)
    facets->points[p->apex].at[a] = corners ? (int64_t)(sum[a] / corners) : 0;
}

static vxm_status place_points(builder *b, const vxm_lattice *lattice, vxm_error *error) {
  vxm_facets *facets = b->facets;
  facets->first_apex = b->soup->vertex_count;
  if (facets->part_count > UINT32_MAX - facets->first_apex)
    return vxm_fail(error, VXM_ERROR_RANGE, "too many vertices and parts to number; split the mesh");
  facets->points = allocate(b, facets->first_apex + facets->part_count, sizeof *facets->points);
  if (!facets->points)
    return b->error.code;
  return vxm_lattice_snap(lattice, b->soup, facets->points, error);
}

vxm_status vxm_facets_create(vxm_facets *out, const vxm_soup *soup, const vxm_lattice *lattice,
                             vxm_parts split, vxm_error *error) {
  *out = (vxm_facets){.context = soup->context};
  builder b = {.facets = out, .soup = soup, .context = soup->context, .error = VXM_ERROR_INIT};
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = vxm_edges_build(&b.edges, soup->context, soup, NULL, &local);
  if (status == VXM_OK)
    status = find_components(&b, split, &local);
  if (status == VXM_OK)
    status = number_parts(&b, split);
  if (status == VXM_OK)
    status = place_points(&b, lattice, &local);
  if (status == VXM_OK)
    status = make_facets(&b);
  for (size_t p = 0; status == VXM_OK && p < out->part_count; p++)
    measure_part(out, p);
  vxm_edges_destroy(&b.edges);
  vxm_free(b.context, b.part);
  vxm_free(b.context, b.vertex_component);
  vxm_free(b.context, b.component);
  if (status != VXM_OK) {
    if (error)
      *error = local.code != VXM_OK ? local : b.error;
    vxm_facets_destroy(out);
  }
  return status;
}

void vxm_facets_destroy(vxm_facets *facets) {
  vxm_free(facets->context, facets->parts);
  vxm_free(facets->context, facets->facets);
  vxm_free(facets->context, facets->points);
  *facets = (vxm_facets){.context = facets->context};
}

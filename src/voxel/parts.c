/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parts.h"
#include "mesh/components.h"
#include "mesh/nesting.h"

#include <math.h>

/** Area of the caps against that of the component, above which it is a sheet rather than a body with holes.
 */
static const double capped_part_max = 0.75;

/** What is needed while parts are numbered. */
typedef struct builder {
  vxm_split *split;
  const vxm_soup *soup;
  const vxm_point *points;
  vxm_split_rule rule;
  uint8_t *kind;            /**< of every component */
  uint32_t *loop_component; /**< of every loop */
  uint32_t *root;           /**< component whose part a component shares */
  vxm_error error;          /**< of the last allocation that failed */
} builder;

static void *allocate(builder *b, size_t count, size_t size) {
  return vxm_calloc(b->split->context, count, size, &b->error);
}

/* ---- Components ---- */

static vxm_status find_components(builder *b, vxm_error *error) {
  vxm_split *s = b->split;
  s->component = allocate(b, b->soup->face_count, sizeof *s->component);
  if (!s->component)
    return b->error.code;
  s->component_count = 1;
  if (b->rule.parts == VXM_PARTS_WHOLE)
    return VXM_OK;
  return vxm_components(s->context, b->soup, NULL, s->component, &s->component_count, error);
}

/** The loops of a component, found through the component of their first vertex. */
static vxm_status assign_loops(builder *b) {
  vxm_split *s = b->split;
  uint32_t *of_vertex = allocate(b, b->soup->vertex_count, sizeof *of_vertex);
  b->loop_component = allocate(b, s->loops.count, sizeof *b->loop_component);
  if (!of_vertex || !b->loop_component) {
    vxm_free(s->context, of_vertex);
    return b->error.code;
  }
  for (size_t f = 0; f < b->soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(b->soup, f, &n);
    for (size_t c = 0; c < n; c++)
      of_vertex[corner[c]] = s->component[f];
  }
  for (size_t l = 0; l < s->loops.count; l++)
    b->loop_component[l] = of_vertex[s->loops.vertex[s->loops.begin[l]]];
  vxm_free(s->context, of_vertex);
  return VXM_OK;
}

/* ---- Kinds ---- */

/** Twice the area of the triangle from `apex` over an edge, in lattice steps squared. */
static double double_area(const double apex[3], const vxm_point *p, const vxm_point *q) {
  double u[3], v[3], sum = 0;
  for (int a = 0; a < 3; a++) {
    u[a] = (double)p->at[a] - apex[a];
    v[a] = (double)q->at[a] - apex[a];
  }
  for (int a = 0; a < 3; a++) {
    double n = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
    sum += n * n;
  }
  return sqrt(sum);
}

static double face_area(const builder *b, size_t face) {
  size_t n;
  const uint32_t *corner = vxm_face(b->soup, face, &n);
  double area = 0;
  for (size_t c = 2; c < n; c++) {
    const int64_t *first = b->points[corner[0]].at;
    const double apex[3] = {(double)first[0], (double)first[1], (double)first[2]};
    area += double_area(apex, &b->points[corner[c - 1]], &b->points[corner[c]]);
  }
  return area;
}

/** Area of the cap over a loop: the triangles from the mean of its vertices. */
static double cap_area(const builder *b, size_t loop) {
  const vxm_loops *loops = &b->split->loops;
  size_t begin = loops->begin[loop], end = loops->begin[loop + 1];
  double mean[3] = {0, 0, 0}, area = 0;
  for (size_t s = begin; s < end; s++)
    for (int a = 0; a < 3; a++)
      mean[a] += (double)b->points[loops->vertex[s]].at[a] / (double)(end - begin);
  for (size_t s = begin; s < end; s++) {
    uint32_t next = loops->vertex[s + 1 < end ? s + 1 : begin];
    area += double_area(mean, &b->points[loops->vertex[s]], &b->points[next]);
  }
  return area;
}

static vxm_status find_kinds(builder *b) {
  vxm_split *s = b->split;
  b->kind = allocate(b, s->component_count, sizeof *b->kind);
  double *area = allocate(b, s->component_count, sizeof *area);
  double *caps = allocate(b, s->component_count, sizeof *caps);
  if (!b->kind || !area || !caps) {
    vxm_free(s->context, caps);
    vxm_free(s->context, area);
    return b->error.code;
  }
  bool measure = b->rule.cap && s->loops.count > 0;
  for (size_t f = 0; measure && f < b->soup->face_count; f++)
    area[s->component[f]] += face_area(b, f);
  for (size_t l = 0; l < s->loops.count; l++) {
    uint32_t c = b->loop_component[l];
    b->kind[c] = VXM_PART_OPEN;
    if (measure)
      caps[c] += cap_area(b, l);
  }
  for (size_t c = 0; c < s->component_count; c++)
    if (measure && b->kind[c] == VXM_PART_OPEN && caps[c] < capped_part_max * area[c])
      b->kind[c] = VXM_PART_CAPPED;
  vxm_free(s->context, caps);
  vxm_free(s->context, area);
  return VXM_OK;
}

/* ---- Cavities ---- */

static uint32_t root_of(const builder *b, uint32_t component) {
  while (b->root[component] != component)
    component = b->root[component] = b->root[b->root[component]];
  return component;
}

static vxm_status find_cavities(builder *b, vxm_error *error) {
  vxm_split *s = b->split;
  size_t solid_count = 0;
  b->root = allocate(b, s->component_count, sizeof *b->root);
  uint8_t *solid = allocate(b, s->component_count, sizeof *solid);
  if (!b->root || !solid) {
    vxm_free(s->context, solid);
    return b->error.code;
  }
  for (size_t c = 0; c < s->component_count; c++) {
    b->root[c] = (uint32_t)c;
    solid[c] = b->kind[c] != VXM_PART_OPEN;
    solid_count += solid[c];
  }
  vxm_status status = VXM_OK;
  if (b->rule.parts == VXM_PARTS_AUTO && b->rule.cavities != VXM_CAVITIES_FILL && solid_count > 1) {
    vxm_nesting nesting;
    status = vxm_nesting_build(&nesting, b->soup, s->component, s->component_count, solid, error);
    for (size_t c = 0; status == VXM_OK && c < s->component_count; c++) {
      uint32_t parent = nesting.parent[c];
      if (parent == VXM_NO_COMPONENT)
        continue;
      bool against = (nesting.volume[c] < 0) != (nesting.volume[parent] < 0);
      if (against || b->rule.cavities == VXM_CAVITIES_KEEP) {
        b->root[c] = parent;
        s->cavity_count++;
      }
    }
    vxm_nesting_destroy(&nesting);
  }
  /* A part with a capped component is capped. */
  for (size_t c = 0; status == VXM_OK && c < s->component_count; c++)
    if (b->kind[c] == VXM_PART_CAPPED)
      b->kind[root_of(b, (uint32_t)c)] = VXM_PART_CAPPED;
  vxm_free(s->context, solid);
  return status;
}

/* ---- Numbers ---- */

static vxm_status number_parts(builder *b) {
  vxm_split *s = b->split;
  s->part = allocate(b, s->component_count, sizeof *s->part);
  s->loop_part = allocate(b, s->loops.count, sizeof *s->loop_part);
  if (!s->part || !s->loop_part)
    return b->error.code;
  size_t next = 0;
  for (int kind = VXM_PART_CLOSED; kind <= VXM_PART_OPEN; kind++) {
    bool pool = kind == VXM_PART_OPEN && b->rule.parts == VXM_PARTS_AUTO;
    size_t first = next;
    for (size_t c = 0; c < s->component_count; c++)
      if (b->root[c] == c && b->kind[c] == kind) {
        s->part[c] = (uint32_t)(pool ? first : next);
        next = pool ? first + 1 : next + 1;
      }
    s->kind_end[kind] = next;
  }
  s->part_count = next;
  for (size_t c = 0; c < s->component_count; c++)
    s->part[c] = s->part[root_of(b, (uint32_t)c)];
  for (size_t l = 0; l < s->loops.count; l++) {
    s->loop_part[l] = s->part[b->loop_component[l]];
    s->capped_loops += s->loop_part[l] < s->kind_end[VXM_PART_CAPPED];
  }
  return VXM_OK;
}

vxm_status vxm_split_create(vxm_split *out, const vxm_soup *soup, const vxm_point *points,
                            vxm_split_rule rule, vxm_error *error) {
  *out = (vxm_split){.context = soup->context};
  builder b = {.split = out, .soup = soup, .points = points, .rule = rule, .error = VXM_ERROR_INIT};
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = vxm_edges_build(&out->edges, soup->context, soup, NULL, &local);
  if (status == VXM_OK) {
    out->odd_edge_count = vxm_edges_count_odd(&out->edges);
    status = vxm_loops_build(&out->loops, soup, &out->edges, &local);
  }
  if (status == VXM_OK)
    status = find_components(&b, &local);
  if (status == VXM_OK)
    status = assign_loops(&b);
  if (status == VXM_OK)
    status = find_kinds(&b);
  if (status == VXM_OK)
    status = find_cavities(&b, &local);
  if (status == VXM_OK)
    status = number_parts(&b);
  vxm_free(soup->context, b.root);
  vxm_free(soup->context, b.kind);
  vxm_free(soup->context, b.loop_component);
  if (status != VXM_OK && error)
    *error = local.code != VXM_OK ? local : b.error;
  return status;
}

void vxm_split_destroy(vxm_split *split) {
  vxm_context *context = split->context;
  vxm_free(context, split->loop_part);
  vxm_free(context, split->part);
  vxm_free(context, split->component);
  if (split->loops.context)
    vxm_loops_destroy(&split->loops);
  if (split->edges.context)
    vxm_edges_destroy(&split->edges);
  *split = (vxm_split){.context = context};
}

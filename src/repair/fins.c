/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/fins.h"

#include "mesh/components.h"
#include "mesh/geometry.h"
#include "repair/sides.h"

/** Of the area of the rest of a component: fins with rims that have no more are removed. */
static const double FIN_PART = 0.1;

typedef struct component {
  double fins, rest; /**< area, of one side of the fins with rims; in the frame */
  bool odd;          /**< along some edge */
} component;

typedef struct finding {
  vxm_work *work;
  const vxm_soup *soup;
  const uint8_t *even;
  size_t *sides;           /**< per corner: its edge */
  size_t *parent;          /**< per face: another one of its fin, or itself */
  size_t *first;           /**< per edge: 1 + the first of the repeated faces at it, or 0 */
  uint32_t *count;         /**< per edge: their sides */
  uint8_t *hangs, *rimmed; /**< per face that stands for a fin */
  uint32_t *label;         /**< per face: its component */
  component *components;
  size_t component_count;
} finding;

static size_t root_of(size_t *parent, size_t face) {
  while (parent[face] != face)
    face = parent[face] = parent[parent[face]];
  return face;
}

static void join_faces(finding *f) {
  for (size_t face = 0; face < f->soup->face_count; face++)
    f->parent[face] = face;
  for (size_t face = 0; face < f->soup->face_count; face++)
    for (uint64_t c = f->soup->offsets[face]; c < f->soup->offsets[face + 1] && f->even[face]; c++) {
      size_t edge = f->sides[c];
      if (edge == VXM_NO_EDGE)
        continue;
      f->count[edge]++;
      if (f->first[edge] == 0)
        f->first[edge] = face + 1;
      else
        f->parent[root_of(f->parent, face)] = root_of(f->parent, f->first[edge] - 1);
    }
}

/** Sees what the edges tell of fins, and of components. */
static void look_at_edges(finding *f) {
  const vxm_edges *edges = &f->work->edges;
  for (size_t e = 0; e < edges->count; e++) {
    if (f->first[e] == 0)
      continue;
    size_t fin = root_of(f->parent, f->first[e] - 1);
    f->hangs[fin] |= edges->edges[e].count > f->count[e];
    f->rimmed[fin] |= edges->edges[e].count == 2 && f->count[e] == 2;
  }
  for (size_t face = 0; face < f->soup->face_count; face++)
    for (uint64_t c = f->soup->offsets[face]; c < f->soup->offsets[face + 1]; c++)
      if (f->sides[c] != VXM_NO_EDGE && vxm_edge_is_odd(&edges->edges[f->sides[c]]))
        f->components[f->label[face]].odd = true;
}

static void sum_areas(finding *f) {
  vxm_extent extent;
  vxm_work_extent(f->work, &extent);
  double scale = vxm_frame_of(extent.bounds).scale;
  for (size_t face = 0; face < f->soup->face_count; face++) {
    size_t count;
    const uint32_t *corner = vxm_face(f->soup, face, &count);
    component *c = &f->components[f->label[face]];
    double area = vxm_vec3_length(vxm_polygon_area(f->soup->positions, corner, count, scale));
    if (!f->even[face])
      c->rest += area;
    else if (f->rimmed[root_of(f->parent, face)])
      c->fins += 0.5 * area;
  }
}

static void mark(finding *f, uint8_t *remove) {
  join_faces(f);
  look_at_edges(f);
  sum_areas(f);
  for (size_t face = 0; face < f->soup->face_count; face++) {
    size_t fin = root_of(f->parent, face);
    const component *c = &f->components[f->label[face]];
    if (f->even[face] && f->hangs[fin] && !c->odd && (!f->rimmed[fin] || c->fins <= FIN_PART * c->rest))
      remove[face] = 1;
  }
}

static vxm_status prepare(finding *f, vxm_error *error) {
  vxm_work *work = f->work;
  size_t faces = f->soup->face_count;
  vxm_status status = vxm_sides_find(&f->sides, work, error);
  if (status == VXM_OK)
    f->parent = vxm_work_scratch(work, faces, sizeof *f->parent, &status, error);
  if (status == VXM_OK)
    f->first = vxm_work_scratch(work, work->edges.count, sizeof *f->first, &status, error);
  if (status == VXM_OK)
    f->count = vxm_work_scratch(work, work->edges.count, sizeof *f->count, &status, error);
  if (status == VXM_OK)
    f->hangs = vxm_work_scratch(work, faces, sizeof *f->hangs, &status, error);
  if (status == VXM_OK)
    f->rimmed = vxm_work_scratch(work, faces, sizeof *f->rimmed, &status, error);
  if (status == VXM_OK)
    f->label = vxm_work_scratch(work, faces, sizeof *f->label, &status, error);
  if (status == VXM_OK)
    status = vxm_components(work->context, f->soup, NULL, f->label, &f->component_count, error);
  if (status == VXM_OK)
    f->components = vxm_work_scratch(work, f->component_count, sizeof *f->components, &status, error);
  return status;
}

vxm_status vxm_fins_mark(vxm_work *work, const uint8_t *even, uint8_t *remove, vxm_error *error) {
  finding f = {.work = work, .soup = work->soup, .even = even};
  vxm_status status = prepare(&f, error);
  if (status == VXM_OK)
    mark(&f, remove);
  vxm_free(work->context, f.components);
  vxm_free(work->context, f.label);
  vxm_free(work->context, f.rimmed);
  vxm_free(work->context, f.hangs);
  vxm_free(work->context, f.count);
  vxm_free(work->context, f.first);
  vxm_free(work->context, f.parent);
  vxm_free(work->context, f.sides);
  return status;
}

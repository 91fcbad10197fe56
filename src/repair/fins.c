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
  size_t *sides;        /**< per corner: its edge */
  size_t *parent;       /**< per face: another one of its fin, or itself */
  size_t *first;        /**< per edge, twice: 1 + the first of the repeated faces at it that are of both
                           orientations, or 0; the same for those of one */
  uint32_t *count;      /**< per edge: their sides */
  int8_t *side, *sided; /**< per edge: of the other faces, how many more lie above a face of one orientation
                           than below it, and how many do either */
  uint8_t *hangs, *rimmed; /**< per face that stands for a fin */
  int32_t *overlaps;       /**< the same: edges where the other faces lie on one side of it, less those where
                              they lie on both */
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
      size_t *first = &f->first[2 * edge + (f->even[face] == VXM_EVEN_ONE_WAY)];
      f->count[edge]++;
      if (*first == 0)
        *first = face + 1;
      else
        f->parent[root_of(f->parent, face)] = root_of(f->parent, *first - 1);
    }
}

/** Sees what the edges tell of fins, and of components. */
static void look_at_edges(finding *f) {
  const vxm_edges *edges = &f->work->edges;
  for (size_t e = 0; e < edges->count; e++) {
    for (size_t k = 2 * e; k < 2 * e + 2; k++) {
      if (f->first[k] == 0)
        continue;
      size_t fin = root_of(f->parent, f->first[k] - 1);
      f->hangs[fin] |= edges->edges[e].count > f->count[e];
      f->rimmed[fin] |= edges->edges[e].count == 2 && f->count[e] == 2;
    }
  }
  for (size_t face = 0; face < f->soup->face_count; face++)
    for (uint64_t c = f->soup->offsets[face]; c < f->soup->offsets[face + 1]; c++)
      if (f->sides[c] != VXM_NO_EDGE && vxm_edge_is_odd(&edges->edges[f->sides[c]]))
        f->components[f->label[face]].odd = true;
}

/** On which side of a face another one lies that shares an edge with it: 1 above, -1 below, 0 in its plane.
 */
static int side_of(const finding *f, size_t face, size_t other, double scale) {
  size_t count;
  const uint32_t *corner = vxm_face(f->soup, face, &count);
  vxm_vec3 normal = vxm_polygon_area(f->soup->positions, corner, count, scale), sum = {0, 0, 0};
  const double *origin = vxm_position(f->soup, corner[0]);
  corner = vxm_face(f->soup, other, &count);
  for (size_t c = 0; c < count; c++) {
    vxm_vec3 to = vxm_vec3_between(vxm_position(f->soup, corner[c]), origin, scale);
    sum = (vxm_vec3){sum.x + to.x, sum.y + to.y, sum.z + to.z};
  }
  double above = vxm_vec3_dot(normal, sum), none = 1e-9 * vxm_vec3_length(normal) * vxm_vec3_length(sum);
  return above > none ? 1 : above < -none ? -1 : 0;
}

/** Sees which fins of one orientation have two bodies on the same side of them. */
static void look_at_sides(finding *f, double scale) {
  const vxm_edges *edges = &f->work->edges;
  for (size_t face = 0; face < f->soup->face_count; face++)
    for (uint64_t c = f->soup->offsets[face]; c < f->soup->offsets[face + 1] && !f->even[face]; c++) {
      size_t e = f->sides[c];
      if (e == VXM_NO_EDGE || f->first[2 * e + 1] == 0 || edges->edges[e].count != 4)
        continue;
      int side = side_of(f, f->first[2 * e + 1] - 1, face, scale);
      f->side[e] = (int8_t)(f->side[e] + side);
      f->sided[e] = (int8_t)(f->sided[e] + (side != 0));
    }
  for (size_t e = 0; e < edges->count; e++)
    if (f->sided[e] == 2)
      f->overlaps[root_of(f->parent, f->first[2 * e + 1] - 1)] += f->side[e] != 0 ? 1 : -1;
}

static void sum_areas(finding *f) {
  vxm_extent extent;
  vxm_work_extent(f->work, &extent);
  double scale = vxm_frame_of(extent.bounds).scale;
  look_at_sides(f, scale);
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

static void mark(finding *f, uint8_t *remove, size_t *kept) {
  *kept = 0;
  join_faces(f);
  look_at_edges(f);
  sum_areas(f);
  for (size_t face = 0; face < f->soup->face_count; face++) {
    size_t fin = root_of(f->parent, face);
    const component *c = &f->components[f->label[face]];
    if (!f->even[face] || !f->hangs[fin] || c->odd)
      continue;
    if (f->even[face] == VXM_EVEN_ONE_WAY && !f->rimmed[fin] && f->overlaps[fin] > 0) {
      *kept += remove[face] == VXM_REPEAT_SAME;
      remove[face] = 0;
    } else if (!f->rimmed[fin] || c->fins <= FIN_PART * c->rest)
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
    f->first = vxm_work_scratch(work, 2 * work->edges.count, sizeof *f->first, &status, error);
  if (status == VXM_OK)
    f->count = vxm_work_scratch(work, work->edges.count, sizeof *f->count, &status, error);
  if (status == VXM_OK)
    f->hangs = vxm_work_scratch(work, faces, sizeof *f->hangs, &status, error);
  if (status == VXM_OK)
    f->rimmed = vxm_work_scratch(work, faces, sizeof *f->rimmed, &status, error);
  if (status == VXM_OK)
    f->side = vxm_work_scratch(work, work->edges.count, sizeof *f->side, &status, error);
  if (status == VXM_OK)
    f->sided = vxm_work_scratch(work, work->edges.count, sizeof *f->sided, &status, error);
  if (status == VXM_OK)
    f->overlaps = vxm_work_scratch(work, faces, sizeof *f->overlaps, &status, error);
  if (status == VXM_OK)
    f->label = vxm_work_scratch(work, faces, sizeof *f->label, &status, error);
  if (status == VXM_OK)
    status = vxm_components(work->context, f->soup, NULL, f->label, &f->component_count, error);
  if (status == VXM_OK)
    f->components = vxm_work_scratch(work, f->component_count, sizeof *f->components, &status, error);
  return status;
}

vxm_status vxm_fins_mark(vxm_work *work, const uint8_t *even, uint8_t *remove, size_t *kept,
                         vxm_error *error) {
  finding f = {.work = work, .soup = work->soup, .even = even};
  vxm_status status = prepare(&f, error);
  if (status == VXM_OK)
    mark(&f, remove, kept);
  vxm_free(work->context, f.components);
  vxm_free(work->context, f.label);
  vxm_free(work->context, f.overlaps);
  vxm_free(work->context, f.sided);
  vxm_free(work->context, f.side);
  vxm_free(work->context, f.rimmed);
  vxm_free(work->context, f.hangs);
  vxm_free(work->context, f.count);
  vxm_free(work->context, f.first);
  vxm_free(work->context, f.parent);
  vxm_free(work->context, f.sides);
  return status;
}

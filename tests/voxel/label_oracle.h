/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The labels of voxels by brute force: each label's faces voxelized alone in the whole grid, and the distance
 * from every centre to every triangle by another formula.
 */
#ifndef TEST_VOXEL_LABEL_ORACLE_H
#define TEST_VOXEL_LABEL_ORACLE_H

#include "shapes.h"

#include "mesh/components.h"
#include "voxel/model/voxelize.h"
#include "voxel/parts/face_labels.h"

#include <math.h>
#include <stdlib.h>

typedef struct vec {
  double x, y, z;
} vec;

static inline vec sub(vec a, vec b) {
  return (vec){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline double dot(vec a, vec b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline vec along(vec a, vec d, double t) {
  return (vec){a.x + t * d.x, a.y + t * d.y, a.z + t * d.z};
}

static inline double to_segment(vec p, vec a, vec b) {
  vec ab = sub(b, a);
  double square = dot(ab, ab), t = square > 0 ? dot(sub(p, a), ab) / square : 0;
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  vec off = sub(p, along(a, ab, t));
  return sqrt(dot(off, off));
}

/** The foot on the plane by barycentric coordinates where they are all positive; else the edges. */
static inline double to_triangle(vec p, vec a, vec b, vec c) {
  vec ab = sub(b, a), ac = sub(c, a), ap = sub(p, a);
  double aa = dot(ab, ab), bb = dot(ac, ac), cc = dot(ab, ac), determinant = aa * bb - cc * cc;
  if (determinant > 1e-9 * aa * bb) {
    double u = (dot(ap, ab) * bb - dot(ap, ac) * cc) / determinant;
    double v = (dot(ap, ac) * aa - dot(ap, ab) * cc) / determinant;
    if (u >= 0 && v >= 0 && u + v <= 1) {
      vec off = sub(p, along(along(a, ab, u), ac, v));
      return sqrt(dot(off, off));
    }
  }
  return fmin(to_segment(p, a, b), fmin(to_segment(p, b, c), to_segment(p, c, a)));
}

static inline vec position(const vxm_soup *soup, uint32_t vertex) {
  const double *p = vxm_position(soup, vertex);
  return (vec){p[0], p[1], p[2]};
}

/** Distance to the faces of a label, which are triangles, or flat and convex. */
static inline double to_label(const vxm_face_labels *l, size_t label, vec p) {
  double least = INFINITY;
  for (size_t i = l->begin[label - 1]; i < l->begin[label]; i++) {
    size_t n;
    const uint32_t *corner = vxm_face(l->soup, l->faces[i], &n);
    for (size_t c = 2; c < n; c++)
      least = fmin(least, to_triangle(p, position(l->soup, corner[0]), position(l->soup, corner[c - 1]),
                                      position(l->soup, corner[c])));
  }
  return least;
}

static inline vec centre_of(const vxm_space *s, int64_t i, int64_t j, int64_t k) {
  return (vec){s->origin[0] + ((double)i + 0.5) * s->voxel_size[0],
               s->origin[1] + ((double)j + 0.5) * s->voxel_size[1],
               s->origin[2] + ((double)k + 0.5) * s->voxel_size[2]};
}

static inline size_t voxels_of(const vxm_space *space) {
  return (size_t)(space->dims[0] * space->dims[1] * space->dims[2]);
}

/** Some faces of a soup, with all its vertices. */
static inline vxm_soup *take_faces(const vxm_soup *from, const uint8_t *taken) {
  vxm_soup *soup = shape_empty(from->context);
  for (size_t v = 0; v < from->vertex_count; v++)
    shape_vertex(soup, vxm_position(from, v)[0], vxm_position(from, v)[1], vxm_position(from, v)[2]);
  for (size_t f = 0; f < from->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(from, f, &n);
    if (taken[f])
      shape_face(soup, corner, n);
  }
  return soup;
}

/** Whether some faces alone are a part that stays open. */
static inline bool stays_open(const vxm_soup *from, const uint8_t *taken,
                              const vxm_voxelize_options *options) {
  vxm_soup *soup = take_faces(from, taken);
  vxm_model *model;
  bool is_open = false;
  if (vxm_model_make(&model, soup, options, NULL) == VXM_OK) {
    is_open = model->analysis.triangles.split.kind_end[VXM_PART_CAPPED] == 0;
    vxm_model_destroy(model);
  }
  vxm_soup_destroy(soup);
  return is_open;
}

/** Takes a sheet out of a label's faces if it is the only one. */
static inline void drop_lone_sheet(const vxm_soup *from, uint8_t *taken,
                                   const vxm_voxelize_options *options) {
  vxm_soup *soup = take_faces(from, taken);
  uint32_t *component = malloc((soup->face_count + 1) * sizeof *component), lone = 0;
  uint8_t *of = malloc(from->face_count + 1);
  size_t count, open = 0;
  assert_int_equal(vxm_components(soup->context, soup, NULL, component, &count, NULL), VXM_OK);
  for (uint32_t c = 0; c < count; c++) {
    for (size_t f = 0, at = 0; f < from->face_count; f++)
      of[f] = taken[f] && component[at++] == c;
    if (stays_open(from, of, options)) {
      open++;
      lone = c;
    }
  }
  for (size_t f = 0, at = 0; f < from->face_count && open == 1; f++)
    if (taken[f] && component[at++] == lone)
      taken[f] = 0;
  free(of);
  free(component);
  vxm_soup_destroy(soup);
}

/** The voxels that a label claims; NULL = none. */
static inline vxm_grid *claims_of(const vxm_face_labels *l, size_t label, const vxm_space *space,
                                  const vxm_voxelize_options *options) {
  vxm_voxelize_options solid = *options;
  solid.mode = VXM_MODE_SOLID;
  uint8_t *taken = calloc(l->soup->face_count + 1, 1);
  for (size_t i = l->begin[label - 1]; i < l->begin[label]; i++)
    taken[l->faces[i]] = 1;
  if (solid.method == VXM_METHOD_VOTE && solid.vote == VXM_VOTE_AUTO &&
      solid.split_mode != VXM_SPLIT_MODE_WHOLE)
    drop_lone_sheet(l->soup, taken, &solid);
  vxm_soup *soup = take_faces(l->soup, taken);
  vxm_grid *grid = NULL;
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  vxm_status status = vxm_voxelize_run(&grid, &report, soup, space, &solid, NULL);
  assert_true(status == VXM_OK || status == VXM_ERROR_EMPTY);
  vxm_soup_destroy(soup);
  free(taken);
  return grid;
}

#endif

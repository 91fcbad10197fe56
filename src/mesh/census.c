/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/census.h"

#include "base/threads.h"
#include "mesh/components.h"
#include "mesh/duplicate_faces.h"
#include "mesh/edges.h"
#include "mesh/geometry.h"
#include "mesh/weld.h"

#include <float.h>
#include <string.h>

/* Sums are taken over slices of a fixed length, so that they do not depend on the number of threads. */
enum { FACES_PER_SLICE = 4096 };
enum { WIDE_AREA, WIDE_VOLUME, WIDE_VALUES };

typedef struct face_sums {
  double area, volume;           /**< in the frame */
  long double wide[WIDE_VALUES]; /**< the same as it is, of an extreme mesh */
  size_t triangles, degenerate, largest;
} face_sums;

typedef struct taking {
  vxm_census *census;
  const vxm_soup *soup;
  vxm_context *context;
  uint32_t *map; /**< vertex_count: first vertex of the same position */
  vxm_unit_scale frame;
  bool is_extreme; /**< the frame loses what lies beyond the range of its numbers */
  face_sums *sums; /**< per slice of faces */
} taking;

/* ---- Faces ---- */

/** Whether areas and volumes, or their squares, leave the range of doubles. */
static bool is_extreme(const double bounds[6]) {
  const double least = ldexp(1.0, -250), most = ldexp(1.0, 250);
  bool found = false;
  for (int axis = 0; axis < 3; axis++) {
    double length = bounds[3 + axis] - bounds[axis];
    found |= (length > 0 && length < least) || length > most || fabs(bounds[axis]) > most;
  }
  return found;
}

/** Area and volume without a frame: the exponents of long double hold the cube of any double. */
static void add_wide(const taking *t, const uint32_t *corners, size_t count, face_sums *sums) {
  const double *origin = vxm_position(t->soup, corners[0]);
  long double last[3], sum[3] = {0, 0, 0}, volume = 0;
  for (size_t i = 1; i < count; i++) {
    const double *p = vxm_position(t->soup, corners[i]);
    long double next[3];
    for (int a = 0; a < 3; a++)
      next[a] = (long double)p[a] - (long double)origin[a];
    for (int a = 0, b = 1, c = 2; i > 1 && a < 3; a++, b = (a + 1) % 3, c = (a + 2) % 3)
      sum[a] += last[b] * next[c] - last[c] * next[b];
    memcpy(last, next, sizeof last);
  }
  for (int a = 0; a < 3; a++)
    volume += ((long double)origin[a] - (long double)t->frame.centre[a]) * sum[a];
  long double area = sqrtl(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
  if (!isfinite(area) || !isfinite(volume))
    return;
  sums->wide[WIDE_AREA] += area / 2;
  sums->wide[WIDE_VOLUME] += volume / 6;
}

static void add_face(const taking *t, size_t face, face_sums *sums) {
  size_t count;
  const uint32_t *corners = vxm_face(t->soup, face, &count);
  sums->largest = count > sums->largest ? count : sums->largest;
  sums->triangles += count > 2 ? count - 2 : 0;
  vxm_vec3 normal = vxm_polygon_area(t->soup->positions, corners, count, t->frame.scale);
  double area = vxm_vec3_length(normal);
  if (vxm_unit_scale_no_area(&t->frame, t->soup, face) || !vxm_face_has_three(corners, count, t->map))
    sums->degenerate++;
  if (count == 0)
    return;
  if (t->is_extreme)
    add_wide(t, corners, count, sums);
  vxm_vec3 corner = vxm_vec3_between(vxm_position(t->soup, corners[0]), t->frame.centre, t->frame.scale);
  double volume = vxm_polygon_cone(corner, normal);
  if (isfinite(area) && isfinite(volume)) {
    sums->area += area;
    sums->volume += volume;
  }
}

static void add_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  taking *t = payload;
  size_t begin = slice * FACES_PER_SLICE, end = begin + FACES_PER_SLICE;
  face_sums sums = {0};
  for (size_t f = begin; f < end && f < t->soup->face_count; f++)
    add_face(t, f, &sums);
  t->sums[slice] = sums;
}

/** Infinite beyond the range of doubles, NaN where long double has no more range than these; never -0.0. */
static double narrow(long double x) {
  return LDBL_MAX_EXP > 4 * DBL_MAX_EXP ? (double)x + 0.0 : NAN;
}

static vxm_status measure_faces(taking *t, vxm_error *error) {
  size_t slices = t->soup->face_count / FACES_PER_SLICE + 1;
  vxm_error local = VXM_ERROR_INIT;
  t->sums = vxm_alloc(t->context, slices, sizeof *t->sums, &local);
  if (!t->sums) {
    vxm_error_pass(error, &local);
    return local.code;
  }
  vxm_status status = vxm_parallel_asked(t->context, slices, add_slice, t, error);
  face_sums all = {0};
  for (size_t i = 0; i < slices && status == VXM_OK; i++) {
    all.area += t->sums[i].area;
    all.volume += t->sums[i].volume;
    for (int w = 0; w < WIDE_VALUES; w++)
      all.wide[w] += t->sums[i].wide[w];
    all.triangles += t->sums[i].triangles;
    all.degenerate += t->sums[i].degenerate;
    all.largest = t->sums[i].largest > all.largest ? t->sums[i].largest : all.largest;
  }
  vxm_free(t->context, t->sums);
  double scale = t->frame.scale;
  t->census->area = t->is_extreme ? narrow(all.wide[WIDE_AREA]) : all.area / scale / scale;
  t->census->volume =
      t->is_extreme ? narrow(all.wide[WIDE_VOLUME]) : all.volume / scale / scale / scale + 0.0;
  t->census->triangles = (int64_t)all.triangles;
  t->census->degenerate_faces = (int64_t)all.degenerate;
  t->census->largest_face = (int64_t)all.largest;
  return status;
}

/* ---- Edges, duplicates, components ---- */

static vxm_status count_edges(taking *t, vxm_error *error) {
  vxm_edges edges;
  vxm_status status = vxm_edges_build(&edges, t->context, t->soup, t->map, error);
  if (status != VXM_OK)
    return status;
  vxm_census *census = t->census;
  size_t odd = 0;
  for (size_t e = 0; e < edges.count; e++) {
    const vxm_edge *edge = &edges.edges[e];
    census->boundary_edges += edge->count == 1;
    census->nonmanifold_edges += edge->count > 2;
    census->inconsistent_edges += edge->count == 2 && edge->forward != 1;
    odd += vxm_edge_is_odd(edge);
  }
  bool faces = t->soup->face_count > 0;
  census->watertight = faces && census->boundary_edges == 0 && census->nonmanifold_edges == 0;
  census->closed = faces && odd == 0;
  vxm_edges_destroy(&edges);
  return VXM_OK;
}

static vxm_status count_duplicates(taking *t, vxm_error *error) {
  vxm_duplicates found;
  vxm_status status = vxm_duplicates_find(&found, t->context, t->soup, t->map, NULL, NULL, error);
  t->census->duplicate_faces = (int64_t)found.same;
  t->census->opposite_duplicate_faces = (int64_t)found.opposite_pairs;
  return status;
}

static vxm_status count_components(taking *t, vxm_error *error) {
  size_t raw, welded;
  vxm_status status = vxm_components(t->context, t->soup, NULL, NULL, &raw, error);
  if (status != VXM_OK)
    return status;
  status = vxm_components(t->context, t->soup, t->map, NULL, &welded, error);
  t->census->components_raw = (int64_t)raw;
  t->census->components = (int64_t)welded;
  return status;
}

static void measure_vertices(taking *t, uint8_t *used) {
  vxm_extent extent;
  vxm_extent_of(&extent, t->context, t->soup, used);
  t->census->nonfinite_vertices = (int64_t)extent.nonfinite;
  t->census->unused_vertices = (int64_t)extent.unused;
  for (int i = 0; i < 6; i++)
    t->census->bounds[i] = extent.bounds[i];
  t->frame = vxm_unit_scale_of(extent.bounds);
  t->is_extreme = is_extreme(extent.bounds);
}

static vxm_status take(taking *t, vxm_error *error) {
  typedef vxm_status (*step)(taking * t, vxm_error * error);
  static const step steps[] = {measure_faces, count_edges, count_duplicates, count_components};
  enum { STEPS = sizeof steps / sizeof *steps };
  vxm_status status =
      vxm_weld_exact(t->context, t->soup->positions, t->soup->vertex_count, t->map, NULL, error);
  for (int i = 0; i < STEPS && status == VXM_OK; i++) {
    status = vxm_progress(t->context, "inspecting", (1.0 + i) / (1.0 + STEPS), error);
    if (status == VXM_OK)
      status = steps[i](t, error);
  }
  return status;
}

vxm_status vxm_soup_census(vxm_census *out, const vxm_soup *soup, vxm_error *error) {
  *out = (vxm_census){.vertices = (int64_t)soup->vertex_count, .faces = (int64_t)soup->face_count};
  taking t = {.census = out, .soup = soup, .context = soup->context};
  vxm_error local = VXM_ERROR_INIT;
  vxm_status status = VXM_OK;
  uint8_t *used = vxm_alloc(t.context, soup->vertex_count, sizeof *used, &local);
  if (used) {
    measure_vertices(&t, used);
    vxm_free(t.context, used);
    t.map = vxm_alloc(t.context, soup->vertex_count, sizeof *t.map, &local);
  }
  status = t.map ? take(&t, &local) : local.code;
  vxm_free(t.context, t.map);
  if (status != VXM_OK) {
    *out = (vxm_census){0};
    vxm_error_pass(error, &local);
  }
  return status;
}

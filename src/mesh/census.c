/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/census.h"

#include "base/threads.h"
#include "mesh/components.h"
#include "mesh/duplicate_faces.h"
#include "mesh/geometry.h"
#include "mesh/nonfinite.h"
#include "mesh/patches.h"
#include "mesh/quad_diagonal.h"
#include "mesh/weld.h"

#include <float.h>
#include <string.h>

/* Sums are taken over slices of a fixed length, so that they do not depend on the number of threads. */
enum { FACES_PER_SLICE = 4096, CORNERS_PER_SLICE = 1 << 16 };
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
  uint32_t *map;       /**< vertex_count: number of its position */
  vxm_soup welded;     /**< with these in the place of vertices; without positions */
  vxm_edges edges;     /**< of the welded soup */
  vxm_patches patches; /**< likewise, where no edge has more than two sides */
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
  if (vxm_face_is_finite(t->soup, corners, count) &&
      (vxm_unit_scale_no_area(&t->frame, t->soup, face) ||
       !vxm_face_has_three(t->welded.indices + (corners - t->soup->indices), count, NULL)))
    sums->degenerate++;
  if (count == 0)
    return;
  if (t->is_extreme)
    add_wide(t, corners, count, sums);
  const double *apex = vxm_position(t->soup, corners[vxm_polygon_apex(t->soup->positions, corners, count)]);
  vxm_vec3 corner = vxm_vec3_between(apex, t->frame.centre, t->frame.scale);
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
  vxm_status status = VXM_OK;
  t->sums = vxm_try_alloc(t->context, slices, sizeof *t->sums, &status, error);
  if (!t->sums)
    return status;
  status = vxm_parallel_cancellable(t->context, slices, add_slice, t, error);
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

/* ---- The soup with one vertex for each position ---- */

static void rename_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  taking *t = payload;
  size_t begin = slice * CORNERS_PER_SLICE, rest = t->soup->corner_count - begin;
  for (size_t c = begin; c < begin + (rest < CORNERS_PER_SLICE ? rest : CORNERS_PER_SLICE); c++)
    t->welded.indices[c] = t->map[t->soup->indices[c]];
}

/** Numbers positions in the order of their first vertices, and gives corners these numbers. Faces of vertices
 * that are not finite have one corner left, and nothing is closed by them. */
static vxm_status weld(taking *t, vxm_error *error) {
  size_t next = 0;
  vxm_status status =
      vxm_weld_exact(t->context, t->soup->positions, t->soup->vertex_count, t->map, NULL, error);
  if (status != VXM_OK)
    return status;
  for (size_t v = 0; v < t->soup->vertex_count; v++)
    t->map[v] = t->map[v] == v ? (uint32_t)next++ : t->map[t->map[v]];
  t->welded = (vxm_soup){.context = t->context,
                         .offsets = t->soup->offsets,
                         .indices = t->soup->indices,
                         .vertex_count = next,
                         .face_count = t->soup->face_count,
                         .corner_count = t->soup->corner_count};
  if (next == t->soup->vertex_count && t->census->nonfinite_vertices == 0) /* each has its own position */
    return VXM_OK;
  t->welded.indices = vxm_alloc(t->context, t->soup->corner_count, sizeof *t->welded.indices, error);
  if (!t->welded.indices)
    return error->code;
  status = vxm_parallel_cancellable(t->context, t->soup->corner_count / CORNERS_PER_SLICE + 1, rename_slice,
                                    t, error);
  vxm_nonfinite_collapse(t->welded.indices, t->soup);
  vxm_free(t->context, t->map);
  t->map = NULL;
  return status;
}

/* ---- Edges, duplicates, components ---- */

static vxm_status count_edges(taking *t, vxm_error *error) {
  vxm_status status = vxm_edges_build_pairs(&t->edges, t->context, &t->welded, error);
  if (status == VXM_OK && t->edges.crowded == 0)
    status = vxm_patches_build(&t->patches, &t->welded, &t->edges, error);
  if (status != VXM_OK)
    return status;
  vxm_census *census = t->census;
  census->boundary_edges = (int64_t)t->edges.open;
  census->nonmanifold_edges = (int64_t)t->edges.crowded;
  census->inconsistent_edges = (int64_t)t->edges.against;
  bool any = t->edges.count > 0; /* faces of fewer than three corners have none */
  census->watertight = any && census->boundary_edges == 0 && census->nonmanifold_edges == 0;
  census->closed = any && t->edges.odd == 0;
  vxm_edges_destroy(&t->edges);
  return VXM_OK;
}

static bool has_patches(const taking *t) {
  return t->patches.context != NULL;
}

static vxm_status count_duplicates(taking *t, vxm_error *error) {
  vxm_duplicates found = {0};
  vxm_status status = VXM_OK;
  if (!has_patches(t) || t->patches.may_repeat)
    status = vxm_duplicates_find(&found, t->context, &t->welded, NULL, NULL, error);
  t->census->duplicate_faces = (int64_t)found.same;
  t->census->opposite_duplicate_faces = (int64_t)found.opposite_pairs;
  return status;
}

/** Patches are the components if no vertex joins two of them. */
static vxm_status count_welded(taking *t, size_t *count, vxm_error *error) {
  bool apart = false;
  vxm_status status = has_patches(t) ? vxm_patches_are_apart(&apart, &t->patches, &t->welded, error) : VXM_OK;
  *count = t->patches.count;
  return status == VXM_OK && !apart ? vxm_components(t->context, &t->welded, NULL, NULL, count, error)
                                    : status;
}

static vxm_status count_components(taking *t, vxm_error *error) {
  size_t raw, welded;
  vxm_status status = count_welded(t, &welded, error);
  raw = welded;
  if (status == VXM_OK && t->welded.indices != t->soup->indices)
    status = vxm_components(t->context, t->soup, NULL, NULL, &raw, error);
  t->census->components_raw = status == VXM_OK ? (int64_t)raw : 0;
  t->census->components = status == VXM_OK ? (int64_t)welded : 0;
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
  vxm_status status = weld(t, error);
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
  vxm_patches_destroy(&t.patches);
  vxm_edges_destroy(&t.edges);
  if (t.welded.indices != soup->indices)
    vxm_free(t.context, t.welded.indices);
  vxm_free(t.context, t.map);
  if (status != VXM_OK) {
    *out = (vxm_census){0};
    vxm_error_pass(error, &local);
  }
  return status;
}

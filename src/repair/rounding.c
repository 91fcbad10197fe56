/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Takes a soup to what .stl files hold: triangles between positions of 32-bit floats, so that everything else
 * sees what will be written.
 */
#include "meshio/triangulate.h"
#include "repair/work.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>

/* ---- Triangles ---- */

/** Arrays of faces, to take the place of a soup's. */
typedef struct faces {
  uint64_t *offsets;
  uint32_t *indices, *tags, *parts;
  size_t count, corners;
} faces;

static bool is_split(const vxm_soup *soup, size_t face) {
  return soup->offsets[face + 1] - soup->offsets[face] > 3;
}

static void put(faces *to, const vxm_soup *soup, size_t face, const uint32_t *corner, size_t corners) {
  for (size_t i = 0; i < corners; i++)
    to->indices[to->corners + i] = corner[i];
  if (to->tags)
    to->tags[to->count] = soup->face_tags[face];
  if (to->parts)
    to->parts[to->count] = soup->face_parts[face];
  to->corners += corners;
  to->offsets[++to->count] = to->corners;
}

/** Splits the polygons by their positions before these are rounded, which would bend and fold the long sides
 * of large ones. */
static vxm_status split(faces *to, const vxm_soup *soup, vxm_error *error) {
  vxm_triangulator tri;
  vxm_triangulator_open(&tri, soup->context);
  vxm_status status = VXM_OK;
  for (size_t f = 0; f < soup->face_count && status == VXM_OK; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count), *triangles;
    if (!is_split(soup, f)) {
      put(to, soup, f, corner, count);
      continue;
    }
    status = vxm_triangulate(&tri, soup->positions, corner, count, &triangles, error);
    for (size_t t = 0; t + 2 < count && status == VXM_OK; t++)
      put(to, soup, f, triangles + 3 * t, 3);
  }
  vxm_triangulator_close(&tri);
  return status;
}

static void drop(vxm_work *work, faces *f) {
  vxm_free(work->context, f->parts);
  vxm_free(work->context, f->tags);
  vxm_free(work->context, f->indices);
  vxm_free(work->context, f->offsets);
}

/** Exchanges the faces of a soup and `f`. */
static void exchange(vxm_soup *soup, faces *f) {
  faces old = {soup->offsets, soup->indices, soup->face_tags, soup->face_parts, 0, 0};
  soup->offsets = f->offsets;
  soup->indices = f->indices;
  soup->face_tags = f->tags;
  soup->face_parts = f->parts;
  soup->face_count = soup->face_capacity = f->count;
  soup->corner_count = soup->corner_capacity = f->corners;
  *f = old;
}

static vxm_status triangulate(vxm_work *work, vxm_error *error) {
  vxm_soup *soup = work->soup;
  size_t count = soup->face_count, corners = soup->corner_count;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n = (size_t)(soup->offsets[f + 1] - soup->offsets[f]);
    count += n > 3 ? n - 3 : 0;
    corners += n > 3 ? 3 * (n - 2) - n : 0;
  }
  if (count == soup->face_count)
    return VXM_OK;
  faces made = {0};
  vxm_status status = VXM_OK;
  made.offsets = vxm_work_scratch(work, count + 1, sizeof *made.offsets, &status, error);
  if (status == VXM_OK)
    made.indices = vxm_work_scratch(work, corners, sizeof *made.indices, &status, error);
  if (status == VXM_OK && soup->face_tags)
    made.tags = vxm_work_scratch(work, count, sizeof *made.tags, &status, error);
  if (status == VXM_OK && soup->face_parts)
    made.parts = vxm_work_scratch(work, count, sizeof *made.parts, &status, error);
  if (status == VXM_OK)
    status = split(&made, soup, error);
  if (status == VXM_OK) {
    exchange(soup, &made);
    work->renumbered = true;
    vxm_work_touch(work);
  }
  drop(work, &made);
  return status;
}

/* ---- Positions ---- */

/** Moves the vertices of faces to the nearest positions that 32-bit floats hold. */
static vxm_status round_positions(vxm_work *work, vxm_error *error) {
  vxm_soup *soup = work->soup;
  vxm_extent extent;
  vxm_work_extent(work, &extent);
  for (size_t v = 0; v < soup->vertex_count; v++) {
    double *p = soup->positions + 3 * v;
    bool same = true;
    for (int a = 0; a < 3 && work->used[v]; a++) {
      if (isfinite(p[a]) && fabs(p[a]) > (double)FLT_MAX)
        return vxm_fail_at(
            error, VXM_ERROR_RANGE, (vxm_place){NULL, 0, -1, (int64_t)v},
            "vertex %zu lies at %g, beyond what 32-bit floats hold; write another format than stl", v, p[a]);
      double rounded = vxm_work_round(work, p[a]);
      same = same && (rounded == p[a] || isnan(p[a]));
      p[a] = rounded;
    }
    if (!same)
      vxm_work_note_vertex(work, VXM_PASS_ROUNDING, v);
    work->counts[VXM_PASS_ROUNDING] += !same;
  }
  return VXM_OK;
}

/** Before it, faces have been reduced, and of those that repeat others one is left: triangles would hide
 * that. */
vxm_status vxm_pass_rounding(vxm_work *work, bool *changed, vxm_error *error) {
  *changed = false;
  if (!work->options.single_precision)
    return VXM_OK;
  int64_t before = work->counts[VXM_PASS_ROUNDING];
  vxm_status status = triangulate(work, error);
  if (status == VXM_OK)
    status = round_positions(work, error);
  *changed = work->counts[VXM_PASS_ROUNDING] > before;
  return status;
}

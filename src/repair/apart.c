/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Vertices at the same position that belong to different patches would be one again for every program that
 * welds, and the edges between them have too many faces again. So each is moved a very little toward the
 * faces of its own.
 */
#include "mesh/geometry.h"
#include "mesh/weld.h"
#include "repair/work.h"

#include <float.h>
#include <math.h>

/** Of the diagonal: far below any tolerance, and far above the rounding of doubles. */
static const double STEP = 1e-9;

typedef struct moving {
  vxm_work *work;
  vxm_soup *soup;
  uint32_t *map;    /**< vertex: the first one at its position */
  uint8_t *shared;  /**< first vertex of a position: several are there that faces have */
  vxm_vec3 *toward; /**< per vertex: sum of the directions to the middles of its faces */
  uint32_t *part;   /**< per vertex, if parts are followed */
  double step;
} moving;

static vxm_vec3 middle_of(const vxm_soup *soup, const uint32_t *corner, size_t count) {
  vxm_vec3 sum = {0, 0, 0};
  for (size_t i = 0; i < count; i++) {
    const double *p = vxm_position(soup, corner[i]);
    sum =
        (vxm_vec3){sum.x + p[0] / (double)count, sum.y + p[1] / (double)count, sum.z + p[2] / (double)count};
  }
  return sum;
}

static void look_around(moving *m) {
  for (size_t f = 0; f < m->soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(m->soup, f, &count);
    vxm_vec3 middle = middle_of(m->soup, corner, count);
    for (size_t i = 0; i < count; i++) {
      uint32_t v = corner[i];
      if (!m->shared[m->map[v]])
        continue;
      const double *p = vxm_position(m->soup, v);
      vxm_vec3 d = {middle.x - p[0], middle.y - p[1], middle.z - p[2]};
      double length = vxm_vec3_length(d);
      if (length > 0)
        m->toward[v] = (vxm_vec3){m->toward[v].x + d.x / length, m->toward[v].y + d.y / length,
                                  m->toward[v].z + d.z / length};
      if (m->part)
        m->part[v] = m->soup->face_parts[f];
    }
  }
}

/** How far a vertex moves: enough for the numbers that hold its position to differ. */
static double step_of(const moving *m, const double p[3]) {
  double most = fmax(fmax(fabs(p[0]), fabs(p[1])), fabs(p[2]));
  return fmax(m->step,
              most * (m->work->options.single_precision ? 8 * (double)FLT_EPSILON : 32 * DBL_EPSILON));
}

/** @param turn how many at this position were moved before: where the faces lie alike, distances still differ
 */
static void move(moving *m, uint32_t v, uint8_t turn) {
  double *p = m->soup->positions + 3 * (size_t)v, from[3] = {p[0], p[1], p[2]};
  vxm_vec3 d = m->toward[v];
  double length = vxm_vec3_length(d), step = step_of(m, p) * (1 + (double)turn / 4);
  if (!(length > 0)) {
    d = (vxm_vec3){turn % 3 == 0, turn % 3 == 1, turn % 3 == 2};
    length = 1;
  }
  p[0] = vxm_work_round(m->work, p[0] + d.x / length * step);
  p[1] = vxm_work_round(m->work, p[1] + d.y / length * step);
  p[2] = vxm_work_round(m->work, p[2] + d.z / length * step);
  if (m->part)
    vxm_track_move(m->work->track, m->part[v], hypot(hypot(p[0] - from[0], p[1] - from[1]), p[2] - from[2]));
}

static int64_t move_all(moving *m) {
  int64_t moved = 0;
  size_t vertices = m->soup->vertex_count;
  for (size_t v = 0; v < vertices; v++)
    if (m->work->used[v] && m->shared[m->map[v]] < 2)
      m->shared[m->map[v]]++;
  for (size_t v = 0; v < vertices; v++)
    m->shared[v] = m->shared[v] == 2;
  look_around(m);
  for (size_t v = 0; v < vertices; v++) {
    uint8_t *turn = &m->shared[m->map[v]];
    if (*turn == 0 || !m->work->used[v])
      continue;
    move(m, (uint32_t)v, *turn);
    *turn = *turn < UINT8_MAX ? (uint8_t)(*turn + 1) : 1;
    moved++;
  }
  return moved;
}

static vxm_status move_shared(moving *m, int64_t *moved, vxm_error *error) {
  vxm_work *work = m->work;
  size_t vertices = m->soup->vertex_count;
  vxm_status status = VXM_OK;
  m->shared = vxm_work_scratch(work, vertices, sizeof *m->shared, &status, error);
  if (status == VXM_OK)
    m->toward = vxm_work_scratch(work, vertices, sizeof *m->toward, &status, error);
  if (status == VXM_OK && work->track && m->soup->face_parts)
    m->part = vxm_work_scratch(work, vertices, sizeof *m->part, &status, error);
  if (status == VXM_OK)
    *moved = move_all(m);
  vxm_free(work->context, m->part);
  vxm_free(work->context, m->toward);
  vxm_free(work->context, m->shared);
  return status;
}

vxm_status vxm_pass_apart(vxm_work *work, bool *changed, vxm_error *error) {
  *changed = false;
  if (!vxm_work_reaches(work, VXM_LEVEL_MANIFOLD))
    return VXM_OK;
  vxm_extent extent;
  vxm_work_extent(work, &extent);
  const double *b = extent.bounds;
  moving m = {
      .work = work, .soup = work->soup, .step = STEP * hypot(hypot(b[3] - b[0], b[4] - b[1]), b[5] - b[2])};
  vxm_status status = VXM_OK;
  int64_t moved = 0;
  size_t distinct, vertices = work->soup->vertex_count;
  m.map = vxm_work_scratch(work, vertices, sizeof *m.map, &status, error);
  if (status == VXM_OK)
    status = vxm_weld_exact(work->context, work->soup->positions, vertices, m.map, &distinct, error);
  if (status == VXM_OK && distinct < vertices)
    status = move_shared(&m, &moved, error);
  vxm_free(work->context, m.map);
  work->counts[VXM_PASS_APART] += moved;
  *changed = moved > 0;
  return status;
}

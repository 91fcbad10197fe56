/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/face_points.h"

#include "mesh/geometry.h"
#include "mesh/nonfinite.h"

#include <math.h>

/* ---- A few ---- */

static int axis_across(vxm_vec3 area) {
  double x = fabs(area.x), y = fabs(area.y), z = fabs(area.z);
  return z >= x && z >= y ? 2 : y >= x ? 1 : 0;
}

/** A mean of three corners, of which rounding does not make a point beyond them. */
static void weigh(const vxm_soup *soup, double scale, const uint32_t corner[3], const double weight[3],
                  double point[3]) {
  for (int a = 0; a < 3; a++) {
    double x = vxm_position(soup, corner[0])[a] * scale, y = vxm_position(soup, corner[1])[a] * scale;
    double z = vxm_position(soup, corner[2])[a] * scale;
    point[a] = vxm_between_three(weight[0] * x + (weight[1] * y + weight[2] * z), x, y, z);
  }
}

bool vxm_face_sample_take(const vxm_face_list *list, int number, vxm_face_sample *out) {
  static const double first[VXM_FACE_SAMPLES] = {0.35355339, 0.31415927, 0.33873241};
  size_t start = list->count * (2 * (size_t)number + 1) / (2 * VXM_FACE_SAMPLES);
  for (size_t i = 0; i < list->count; i++) {
    size_t count;
    const uint32_t *corner = vxm_face(list->soup, list->faces[(start + i) % list->count], &count);
    if (count < 3 || !vxm_face_is_finite(list->soup, corner, count))
      continue;
    double other = (1 - first[number]) / 2;
    weigh(list->soup, list->scale, (const uint32_t[3]){corner[0], corner[1], corner[count - 1]},
          (const double[3]){first[number], other, other}, out->point);
    out->axis = axis_across(vxm_polygon_area(list->soup->positions, corner, count, list->scale));
    return true;
  }
  return false;
}

/** Whether more rays, along `axes` axes, cannot change that most of them say no. */
static bool is_lost(int votes, int count, int axes) {
  return 2 * (votes + 2 * count * axes) < 3 * 2 * count;
}

vxm_status vxm_face_samples_vote(vxm_point_in_mesh *around, const vxm_face_sample *samples, int count,
                                 bool all, bool *result, vxm_error *error) {
  int rays = 0, votes = 0;
  vxm_status status = VXM_OK;
  for (int axis = 2; axis >= 0 && status == VXM_OK; axis--) {
    for (int s = 0; s < count && status == VXM_OK; s++) {
      int more;
      status = vxm_point_in_mesh_surrounds(around, samples[s].point, axis, &more, error);
      rays += 2;
      votes += more;
    }
    if (all ? votes < rays : votes == rays || is_lost(votes, count, axis))
      break;
    bool closed = false;
    if (votes == 0 && status == VXM_OK)
      status = vxm_point_in_mesh_is_closed(around, &closed, error);
    if (closed)
      break;
  }
  /* a missing face turns a ray that should be odd; outside, most rays cross nothing that could be missing */
  *result = rays > 0 && (all ? votes == rays : 2 * votes >= rays);
  return status;
}

/* ---- Many ---- */

enum { ROWS_MAX = 64 /**< of points on a triangle */ };

typedef struct spread {
  vxm_point_in_mesh *around;
  const vxm_face_list *list;
  size_t wanted;
  double gap, per_area; /**< points */
  vxm_points_outside count;
  vxm_error *error;
} spread;

static vxm_status count_point(spread *s, const double point[3]) {
  vxm_status status = VXM_OK;
  int votes = 0;
  bool on_face = false;
  for (int axis = 2; axis >= 0 && votes == 0 && status == VXM_OK; axis--)
    status = vxm_point_in_mesh_surrounds(s->around, point, axis, &votes, s->error);
  if (votes == 0 && status == VXM_OK)
    status = vxm_point_in_mesh_on_face(s->around, point, s->gap, &on_face, s->error);
  s->count.points++;
  s->count.outside += votes == 0 && !on_face;
  return status;
}

static vxm_status count_corners(spread *s, const uint32_t *corner, size_t count) {
  vxm_status status = VXM_OK;
  for (size_t c = 0; c < count && status == VXM_OK; c += count / (s->wanted + 1) + 1) {
    const double *p = vxm_position(s->list->soup, corner[c]);
    double scale = s->list->scale;
    status = count_point(s, (const double[3]){p[0] * scale, p[1] * scale, p[2] * scale});
  }
  return status;
}

/** In rows, the same from whichever corner one begins: the middles of the triangles into which lines along
 * the sides divide it, of those that look the way that it looks. */
static vxm_status count_within(spread *s, const uint32_t corner[3], double area) {
  double rows = ceil(sqrt(2 * s->per_area * area));
  int n = rows > 1 ? (rows < ROWS_MAX ? (int)rows : ROWS_MAX) : 1;
  vxm_status status = VXM_OK;
  for (int i = 0; i < n; i++)
    for (int j = 0; i + j < n && status == VXM_OK; j++) {
      double point[3], weight[3] = {(i + 1 / 3.0) / n, (j + 1 / 3.0) / n, (n - 1 - i - j + 1 / 3.0) / n};
      weigh(s->list->soup, s->list->scale, corner, weight, point);
      status = count_point(s, point);
    }
  return status;
}

static vxm_vec3 triangle_area(const vxm_face_list *list, const uint32_t corner[3]) {
  return vxm_polygon_area(list->soup->positions, corner, 3, list->scale);
}

/** Whether the triangles from the first corner lie within the face. */
static bool is_fan(const vxm_face_list *list, const uint32_t *corner, size_t count) {
  vxm_vec3 area = vxm_polygon_area(list->soup->positions, corner, count, list->scale);
  for (size_t c = 2; c < count; c++)
    if (vxm_vec3_dot(area, triangle_area(list, (const uint32_t[3]){corner[0], corner[c - 1], corner[c]})) < 0)
      return false;
  return true;
}

static vxm_status count_face(spread *s, size_t face) {
  size_t count;
  const uint32_t *corner = vxm_face(s->list->soup, face, &count);
  if (count < 3 || !vxm_face_is_finite(s->list->soup, corner, count))
    return VXM_OK;
  vxm_status status = count_corners(s, corner, count);
  if (status != VXM_OK || !is_fan(s->list, corner, count))
    return status;
  for (size_t c = 2; c < count && status == VXM_OK; c++) {
    const uint32_t triangle[3] = {corner[0], corner[c - 1], corner[c]};
    status = count_within(s, triangle, vxm_vec3_length(triangle_area(s->list, triangle)));
  }
  return status;
}

static double area_of(const vxm_face_list *list, size_t step) {
  double area = 0;
  for (size_t i = 0; i < list->count; i += step) {
    size_t count;
    const uint32_t *corner = vxm_face(list->soup, list->faces[i], &count);
    if (count >= 3 && vxm_face_is_finite(list->soup, corner, count))
      area += vxm_polygon_fan_area(list->soup->positions, corner, count, list->scale);
  }
  return area;
}

vxm_status vxm_face_points_outside(vxm_point_in_mesh *around, const vxm_face_list *list, double gap,
                                   size_t wanted, vxm_points_outside *out, vxm_error *error) {
  size_t step = list->count / (wanted / 2 + 1) + 1;
  double area = area_of(list, step);
  spread s = {.around = around,
              .list = list,
              .wanted = wanted,
              .gap = gap,
              .per_area = area > 0 ? (double)wanted / area : 0,
              .error = error};
  vxm_status status = VXM_OK;
  for (size_t i = 0; i < list->count && status == VXM_OK; i += step)
    status = count_face(&s, list->faces[i]);
  *out = s.count;
  return status;
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** Solids of many kinds, and what must hold of those that the module for CGAL makes. */
#ifndef VXM_TESTS_SOLIDS_H
#define VXM_TESTS_SOLIDS_H

#include "manifold.h"

#include "mesh/census.h"
#include "mesh/geometry.h"
#include "repair/external/cgal.h"
#include "repair/manifold/cut_nonmanifold.h"

#include <math.h>

static const vxm_cgal *cgal;
static vxm_context *context;

static inline int hold_context(void **state) {
  (void)state;
  context = context_of_threads(2);
  return 0;
}

static inline int release_context(void **state) {
  (void)state;
  vxm_context_destroy(context);
  return 0;
}

/** Whether the module is there; says so if not. */
static inline bool open_cgal(void) {
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_cgal_open(&cgal, "this test", &error) == VXM_OK)
    return true;
  fprintf(stderr, "%s\n", error.text);
  return false;
}

/* ---- Solids ---- */

typedef struct frame3 {
  double m[3][3], move[3];
} frame3;

static const frame3 upright = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}};

/** A random rotation, from a random quaternion. */
static inline frame3 random_frame(vxm_rng *rng) {
  double q[4], length = 0;
  for (int i = 0; i < 4; i++) {
    q[i] = 2 * vxm_rng_unit(rng) - 1;
    length += q[i] * q[i];
  }
  for (int i = 0; i < 4; i++)
    q[i] /= sqrt(length);
  double w = q[0], x = q[1], y = q[2], z = q[3];
  return (frame3){{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                   {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                   {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}},
                  {0, 0, 0}};
}

static inline void add_framed(vxm_soup *soup, const frame3 *frame, double x, double y, double z) {
  double p[3];
  for (int i = 0; i < 3; i++)
    p[i] = frame->m[i][0] * x + frame->m[i][1] * y + frame->m[i][2] * z + frame->move[i];
  add_vertex(soup, p[0], p[1], p[2]);
}

static inline void turn_faces(vxm_soup *soup, size_t first) {
  for (size_t f = first; f < soup->face_count; f++)
    for (uint64_t a = soup->offsets[f], b = soup->offsets[f + 1] - 1; a < b; a++, b--) {
      uint32_t kept = soup->indices[a];
      soup->indices[a] = soup->indices[b];
      soup->indices[b] = kept;
    }
}

/** A box of quadrilaterals or triangles. */
static inline void add_box(vxm_soup *soup, const double low[3], const double high[3], const frame3 *frame,
                           bool triangles, bool inward) {
  static const uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  uint32_t first = (uint32_t)soup->vertex_count;
  size_t face = soup->face_count;
  for (int v = 0; v < 8; v++)
    add_framed(soup, frame, v & 1 ? high[0] : low[0], v & 2 ? high[1] : low[1], v & 4 ? high[2] : low[2]);
  for (int q = 0; q < 6; q++) {
    uint32_t c[4];
    for (int k = 0; k < 4; k++)
      c[k] = first + quads[q][k];
    if (triangles) {
      add_triangle(soup, c[0], c[1], c[2]);
      add_triangle(soup, c[0], c[2], c[3]);
    } else
      add_face(soup, c, 4);
  }
  if (inward)
    turn_faces(soup, face);
}

static inline void add_cuboid(vxm_soup *soup, double x0, double y0, double z0, double x1, double y1,
                              double z1) {
  add_box(soup, (double[]){x0, y0, z0}, (double[]){x1, y1, z1}, &upright, true, false);
}

static inline void add_hollow(vxm_soup *soup, double x0, double y0, double z0, double x1, double y1,
                              double z1) {
  add_box(soup, (double[]){x0, y0, z0}, (double[]){x1, y1, z1}, &upright, true, true);
}

/** A ball of 4 rings * (rings - 1) triangles. */
static inline void add_ball(vxm_soup *soup, const double centre[3], double radius, uint32_t rings,
                            const frame3 *turned, bool inward) {
  frame3 frame = *turned;
  memcpy(frame.move, centre, sizeof frame.move);
  uint32_t around = 2 * rings, first = (uint32_t)soup->vertex_count;
  size_t face = soup->face_count;
  add_framed(soup, &frame, 0, 0, radius);
  for (uint32_t j = 1; j < rings; j++)
    for (uint32_t i = 0; i < around; i++) {
      double polar = M_PI * j / rings, azimuth = 2 * M_PI * i / around;
      add_framed(soup, &frame, radius * sin(polar) * cos(azimuth), radius * sin(polar) * sin(azimuth),
                 radius * cos(polar));
    }
  add_framed(soup, &frame, 0, 0, -radius);
  uint32_t last = (uint32_t)soup->vertex_count - 1;
  for (uint32_t j = 0; j < rings; j++)
    for (uint32_t i = 0; i < around; i++) {
      uint32_t k = (i + 1) % around, up = first + 1 + (j - 1) * around, down = first + 1 + j * around;
      if (j == 0)
        add_triangle(soup, first, down + i, down + k);
      else if (j == rings - 1)
        add_triangle(soup, up + i, last, up + k);
      else {
        add_triangle(soup, up + i, down + i, down + k);
        add_triangle(soup, up + i, down + k, up + k);
      }
    }
  if (inward)
    turn_faces(soup, face);
}

/* ---- What must hold ---- */

/** How often a surface winds around a point, by solid angles (Van Oosterom and Strackee 1983). */
static inline double winding_at(const vxm_soup *soup, const double p[3]) {
  double sum = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    vxm_vec3 v[3];
    double length[3];
    for (int i = 0; i < 3; i++) {
      v[i] = vxm_vec3_between(vxm_position(soup, soup->indices[3 * f + (size_t)i]), p, 1);
      length[i] = vxm_vec3_length(v[i]);
    }
    double volume = vxm_vec3_dot(v[0], vxm_vec3_cross(v[1], v[2]));
    sum += atan2(volume, length[0] * length[1] * length[2] + vxm_vec3_dot(v[0], v[1]) * length[2] +
                             vxm_vec3_dot(v[1], v[2]) * length[0] + vxm_vec3_dot(v[2], v[0]) * length[1]);
  }
  return sum / (2 * M_PI);
}

static inline size_t count_meetings(const vxm_soup *soup) {
  vxm_face_pairs pairs;
  vxm_error error = VXM_ERROR_INIT;
  if (cgal->self_intersections(&pairs, soup, 1000000, &error) != VXM_OK)
    fail_msg("%s", error.text);
  vxm_free(soup->context, pairs.pairs);
  return pairs.count;
}

/** Every edge has two faces in opposite directions, every vertex one umbrella. */
static inline void assert_closed_manifold(const vxm_soup *soup) {
  brute_report report = look_brute(soup);
  assert_true(report.manifold);
  assert_int_equal(report.boundary_edges, 0);
  assert_int_equal(report.unpaired, 0);
}

/** And also when it is read back and welded every edge has an even number of faces. */
static inline void assert_solid(const vxm_soup *soup) {
  assert_closed_manifold(soup);
  vxm_census census = VXM_CENSUS_INIT;
  assert_int_equal(vxm_soup_census(&census, soup, NULL), VXM_OK);
  assert_true(census.closed);
  assert_int_equal(count_meetings(soup), 0);
}

/** The same once edges with four faces are parted, which a union leaves where it touches itself. */
static inline void assert_united(const vxm_soup *soup) {
  vxm_soup *apart;
  int64_t split, stitched;
  assert_int_equal(vxm_cut_nonmanifold(&apart, &split, &stitched, soup, NULL), VXM_OK);
  assert_solid(apart);
  vxm_soup_destroy(apart);
}

/** A prism over a bow tie, upright: one half, of 16/3, is wound outward, the other, of 4/3, is not. */
static inline void add_bow(vxm_soup *soup) {
  static const double corners[4][2] = {{0, 2}, {4, 0}, {4, 4}, {0, 0}};
  uint32_t first = (uint32_t)soup->vertex_count;
  for (int i = 0; i < 8; i++)
    add_vertex(soup, corners[i % 4][0], corners[i % 4][1], i / 4);
  for (uint32_t i = 0; i < 4; i++)
    add_face(soup, (uint32_t[]){first + i, first + (i + 1) % 4, first + (i + 1) % 4 + 4, first + i + 4}, 4);
  add_face(soup, (uint32_t[]){first + 3, first + 2, first + 1, first}, 4);
  add_face(soup, (uint32_t[]){first + 4, first + 5, first + 6, first + 7}, 4);
}

#endif

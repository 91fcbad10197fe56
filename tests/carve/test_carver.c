/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Carvers against the plain way: the tool's signed distance at many places along its path, by solid angles
 * and by the nearest points of its triangles. What is clearly within at one of them is cut; what is clearly
 * outside of all is not.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "voxmend.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 12, PLACES = 48 };

static const double pi = 3.14159265358979323846;

/* ---- Tools ---- */

typedef struct tool {
  const char *name;
  size_t vertex_count, face_count;
  const double (*vertices)[3];
  const int64_t (*faces)[3];
} tool;

static const double box_vertices[][3] = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1},
                                         {-1, -1, 1},  {1, -1, 1},  {-1, 1, 1},  {1, 1, 1}};
static const int64_t box_faces[][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                       {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

/* A tetrahedron whose origin is not within it. */
static const double corner_vertices[][3] = {{0.5, 0, 0}, {3.2, 0.3, 0.1}, {0.7, 2.9, 0.2}, {0.9, 0.4, 3.1}};
static const int64_t corner_faces[][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

/* An L: its notch must not be cut by a tool that only goes along it. */
static const double angle_vertices[][3] = {{0, 0, 0},   {4, 0, 0},     {4, 1.3, 0}, {1.3, 1.3, 0},
                                           {1.3, 4, 0}, {0, 4, 0},     {0, 0, 2},   {4, 0, 2},
                                           {4, 1.3, 2}, {1.3, 1.3, 2}, {1.3, 4, 2}, {0, 4, 2}};
static const int64_t angle_faces[][3] = {{0, 3, 1},  {1, 3, 2},  {0, 5, 3},   {3, 5, 4},  {6, 7, 9},
                                         {7, 8, 9},  {6, 9, 11}, {9, 10, 11}, {0, 1, 6},  {1, 7, 6},
                                         {1, 2, 7},  {2, 8, 7},  {2, 3, 8},   {3, 9, 8},  {3, 4, 9},
                                         {4, 10, 9}, {4, 5, 10}, {5, 11, 10}, {5, 0, 11}, {0, 6, 11}};

static const tool box = {"box", 8, 12, box_vertices, box_faces},
                  corner = {"corner", 4, 4, corner_vertices, corner_faces},
                  angle = {"angle", 12, 20, angle_vertices, angle_faces};

static vxm_mesh *mesh_of(vxm_context *context, const tool *t) {
  vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
  arrays.vertices = t->vertices;
  arrays.vertex_count = (int64_t)t->vertex_count;
  arrays.indices = t->faces;
  arrays.index_count = (int64_t)(3 * t->face_count);
  arrays.face_count = (int64_t)t->face_count;
  vxm_mesh *mesh = NULL;
  assert_int_equal(vxm_mesh_create(&mesh, context, &arrays, NULL), VXM_OK);
  return mesh;
}

/* ---- The plain way ---- */

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(double out[3], const double a[3], const double b[3]) {
  for (int i = 0; i < 3; i++)
    out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/** Van Oosterom and Strackee. */
static double solid_angle(const double a[3], const double b[3], const double c[3]) {
  double la = sqrt(dot(a, a)), lb = sqrt(dot(b, b)), lc = sqrt(dot(c, c)), n[3];
  cross(n, b, c);
  return 2 * atan2(dot(a, n), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

static double distance_to_segment(const double a[3], const double b[3]) {
  double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, t = fmin(1, fmax(0, -dot(a, d) / dot(d, d))), p[3];
  for (int i = 0; i < 3; i++)
    p[i] = a[i] + t * d[i];
  return sqrt(dot(p, p));
}

/** Of a triangle from the origin. */
static double distance_to_triangle(const double a[3], const double b[3], const double c[3]) {
  double u[3], v[3], n[3],
      least = fmin(distance_to_segment(a, b), fmin(distance_to_segment(b, c), distance_to_segment(c, a)));
  for (int i = 0; i < 3; i++) {
    u[i] = b[i] - a[i];
    v[i] = c[i] - a[i];
  }
  cross(n, u, v);
  double area = dot(n, n), height = dot(a, n) / sqrt(area), foot[3], w[3], s[3];
  for (int i = 0; i < 3; i++)
    foot[i] = n[i] * dot(a, n) / area - a[i];
  cross(w, foot, v);
  cross(s, u, foot);
  double x = dot(w, n) / area, y = dot(s, n) / area;
  return x >= 0 && y >= 0 && x + y <= 1 ? fmin(least, fabs(height)) : least;
}

/** How far a point lies outside of the tool; negative within. */
static double signed_distance(const tool *t, const double point[3]) {
  double sum = 0, least = INFINITY;
  for (size_t f = 0; f < t->face_count; f++) {
    double p[3][3];
    for (int c = 0; c < 3; c++)
      for (int a = 0; a < 3; a++)
        p[c][a] = t->vertices[t->faces[f][c]][a] - point[a];
    sum += solid_angle(p[0], p[1], p[2]);
    least = fmin(least, distance_to_triangle(p[0], p[1], p[2]));
  }
  return sum > 2 * pi ? -least : least;
}

/** A motion: from one place to another, while the tool turns by an angle about an axis. */
typedef struct motion {
  double from[3], to[3], first_axis[3], first_angle, axis[3], angle;
} motion;

static void rotation_about(double m[9], const double axis[3], double angle_) {
  double c = cos(angle_), s = sin(angle_), l = sqrt(dot(axis, axis)),
         u[3] = {axis[0] / l, axis[1] / l, axis[2] / l};
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      m[3 * i + k] = u[i] * u[k] * (1 - c) + (i == k ? c : 0);
  m[1] -= s * u[2], m[2] += s * u[1], m[5] -= s * u[0];
  m[3] += s * u[2], m[6] -= s * u[1], m[7] += s * u[0];
}

static void pose_on(double pose[12], const motion *w, double part) {
  double first[9], more[9];
  rotation_about(first, w->first_axis, w->first_angle);
  rotation_about(more, w->axis, part * w->angle);
  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < 3; k++)
      pose[4 * i + k] =
          more[3 * i] * first[k] + more[3 * i + 1] * first[3 + k] + more[3 * i + 2] * first[6 + k];
    pose[4 * i + 3] = w->from[i] + part * (w->to[i] - w->from[i]);
  }
}

/** The least signed distance of a point during the motion. */
static double least_distance(const tool *t, double poses[][12], const double at[3]) {
  double least = INFINITY;
  for (int s = 0; s <= PLACES; s++) {
    const double *m = poses[s], d[3] = {at[0] - m[3], at[1] - m[7], at[2] - m[11]};
    const double back[3] = {m[0] * d[0] + m[4] * d[1] + m[8] * d[2], m[1] * d[0] + m[5] * d[1] + m[9] * d[2],
                            m[2] * d[0] + m[6] * d[1] + m[10] * d[2]};
    least = fmin(least, signed_distance(t, back));
  }
  return least;
}

/* ---- Carving ---- */

static vxm_grid *full_grid(vxm_context *context, const vxm_space *space) {
  vxm_grid *grid = NULL;
  assert_int_equal(vxm_grid_create(&grid, context, space, NULL), VXM_OK);
  for (int64_t k = 0; k < space->dims[2]; k++)
    for (int64_t j = 0; j < space->dims[1]; j++)
      for (int64_t i = 0; i < space->dims[0]; i++)
        vxm_grid_set(grid, i, j, k, true);
  return grid;
}

/** Steps by poses, of which the report must tell what the grid shows. */
static void move(vxm_carver *carver, const vxm_grid *grid, const double pose[12]) {
  vxm_carve_report report = VXM_CARVE_REPORT_INIT;
  vxm_error error = VXM_ERROR_INIT;
  int64_t before = vxm_grid_count(grid);
  if (vxm_carver_move(&report, carver, pose, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_int_equal(report.removed, before - vxm_grid_count(grid));
  for (int a = 0; a < 3; a++)
    assert_true(report.removed > 0 ? report.begin[a] < report.end[a] : report.end[a] == 0);
}

static const vxm_space cube = {{SIDE, SIDE, SIDE}, {-1.5, 2, 0.25}, {0.5, 0.5, 0.5}};
static const vxm_space oblong = {{SIDE + 3, SIDE, 2 * SIDE}, {-1.5, 2, 0.25}, {0.4, 0.5, 0.25}};

static void compare_to_plain(const tool *t, const motion *w, const vxm_space *space) {
  vxm_grid *grid = full_grid(NULL, space);
  vxm_mesh *mesh = mesh_of(NULL, t);
  vxm_carver *carver = NULL;
  assert_int_equal(vxm_carver_create(&carver, grid, mesh, NULL), VXM_OK);
  double poses[PLACES + 1][12], reach = 0;
  for (int s = 0; s <= PLACES; s++)
    pose_on(poses[s], w, (double)s / PLACES);
  move(carver, grid, poses[0]);
  move(carver, grid, poses[PLACES]);
  for (size_t v = 0; v < t->vertex_count; v++)
    reach = fmax(reach, sqrt(dot(t->vertices[v], t->vertices[v])));
  const double d[3] = {w->to[0] - w->from[0], w->to[1] - w->from[1], w->to[2] - w->from[2]};
  /* Corners lie on a lattice, turns go in chords; and the nearest of the places may be half a step away. */
  double close = 0.01 * 0.5, between = close + (sqrt(dot(d, d)) + reach * fabs(w->angle)) / PLACES / 2;
  int64_t cut = 0, wrong = 0;
  for (int64_t k = 0; k < space->dims[2]; k++)
    for (int64_t j = 0; j < space->dims[1]; j++)
      for (int64_t i = 0; i < space->dims[0]; i++) {
        const double at[3] = {space->origin[0] + ((double)i + 0.5) * space->voxel_size[0],
                              space->origin[1] + ((double)j + 0.5) * space->voxel_size[1],
                              space->origin[2] + ((double)k + 0.5) * space->voxel_size[2]};
        double distance = least_distance(t, poses, at);
        bool is_cut = !vxm_grid_get(grid, i, j, k);
        wrong += is_cut ? distance > between : distance < -close;
        cut += is_cut;
      }
  if (wrong > 0 || cut == 0)
    fail_msg("%s: %lld voxels cut, %lld wrong", t->name, (long long)cut, (long long)wrong);
  vxm_carver_destroy(carver);
  vxm_mesh_destroy(mesh);
  vxm_grid_destroy(grid);
}

static void straight_ways_are_covered(void **state) {
  (void)state;
  static const motion motions[] = {
      {{-0.03, 3.01, 1.13}, {3.4, 6.77, 5.2}, {1, 2, 3}, 0.7, {0, 0, 1}, 0},
      {{1.9, 4.1, 3.3}, {1.9, 4.1, 1.7}, {0, 0, 1}, 0, {0, 0, 1}, 0},
      {{-9.1, -2.2, 2.9}, {15.3, 14.2, 3.1}, {3, -1, 1}, 2.1, {0, 0, 1}, 0},
  };
  for (size_t w = 0; w < sizeof motions / sizeof *motions; w++) {
    compare_to_plain(&box, &motions[w], &cube);
    compare_to_plain(&corner, &motions[w], &oblong);
    compare_to_plain(&angle, &motions[w], &cube);
  }
}

static void turns_are_covered(void **state) {
  (void)state;
  static const motion motions[] = {
      {{1.1, 4.7, 3.2}, {1.1, 4.7, 3.2}, {1, 2, 3}, 0.7, {0.1, 0.2, 1}, 2.5},
      {{-0.03, 3.01, 1.13}, {2.4, 5.77, 4.2}, {1, 0, 0}, 0, {1, 0.3, -0.2}, -1.4},
      {{0.4, 4.4, 2.5}, {2.4, 4.4, 2.5}, {0, 0, 1}, 0, {0, 0, 1}, 0.01},
  };
  for (size_t w = 0; w < sizeof motions / sizeof *motions; w++) {
    compare_to_plain(&box, &motions[w], &oblong);
    compare_to_plain(&corner, &motions[w], &cube);
    compare_to_plain(&angle, &motions[w], &cube);
  }
}

/** By the rule for centres on faces: a box from 3.5 to 5.5 has the centres 3.5 and 4.5, moving or not. */
static void faces_through_centres_count_once(void **state) {
  (void)state;
  static const vxm_space units = {{SIDE, SIDE, SIDE}, {0, 0, 0}, {1, 1, 1}};
  static const double steps[][3] = {
      {3.5, 3.5, 3.5}, {8.5, 3.5, 3.5}, {8.5, 7.5, 3.5}, {5.5, 4.5, 6.5}, {5.5, 4.5, 3.5}};
  vxm_grid *grid = full_grid(NULL, &units);
  vxm_mesh *mesh = mesh_of(NULL, &box);
  vxm_carver *carver = NULL;
  assert_int_equal(vxm_carver_create(&carver, grid, mesh, NULL), VXM_OK);
  double pose[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  for (int s = 0; s < 3; s++) {
    for (int a = 0; a < 3; a++)
      pose[4 * a + 3] = steps[s][a];
    move(carver, grid, pose);
  }
  for (int64_t k = 0; k < SIDE; k++)
    for (int64_t j = 0; j < SIDE; j++)
      for (int64_t i = 0; i < SIDE; i++) {
        bool first = i >= 2 && i < 9 && j >= 2 && j < 4, second = i >= 7 && i < 9 && j >= 2 && j < 8;
        bool is_cut = k >= 2 && k < 4 && (first || second);
        assert_int_equal(vxm_grid_get(grid, i, j, k), !is_cut);
      }
  vxm_carver_destroy(carver);
  vxm_mesh_destroy(mesh);
  vxm_grid_destroy(grid);
}

/** Makes a motion of some steps, each of which turns and moves. */
static void go(vxm_carver *carver, double part) {
  motion w = {{-1, 1, 0}, {20, 30, 40}, {1, 1, 0}, 0.3, {0.2, 1, 0.1}, 4};
  for (int s = 0; s <= 14; s++) {
    double pose[12];
    pose_on(pose, &w, part + (s % 2 ? s - 1 : s) / 14.0);
    pose[3] += s % 2; /* every other step is straight */
    vxm_error error = VXM_ERROR_INIT;
    if (vxm_carver_move(NULL, carver, pose, &error) != VXM_OK)
      fail_msg("%s", error.text);
  }
}

/** The same for an octree, and for any number of threads. */
static void octrees_and_threads_give_the_same(void **state) {
  (void)state;
  static const vxm_space space = {{130, 70, 150}, {-20, -5, -5}, {0.5, 0.6, 0.4}};
  uint64_t hash[3];
  for (int threads = 1; threads <= 3; threads++) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = threads;
    vxm_context *context = NULL;
    assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
    vxm_grid *grid = full_grid(context, &space);
    vxm_mesh *mesh = mesh_of(context, &angle);
    vxm_sparse *stock = NULL, *made = NULL, *from_grid = NULL;
    vxm_carver *carver = NULL, *sparse = NULL;
    assert_int_equal(vxm_sparse_from_grid(&stock, grid, NULL), VXM_OK);
    assert_int_equal(vxm_carver_create(&carver, grid, mesh, NULL), VXM_OK);
    assert_int_equal(vxm_carver_create_sparse(&sparse, stock, mesh, NULL), VXM_OK);
    int64_t whole = vxm_grid_count(grid);
    go(carver, 0);
    go(sparse, 0);
    assert_int_equal(vxm_carver_sparse(&made, sparse, NULL), VXM_OK);
    assert_int_equal(vxm_sparse_hash(made), vxm_grid_hash(grid));
    assert_int_equal(vxm_sparse_count(stock), whole);
    assert_true(whole - vxm_grid_count(grid) > 5000);
    assert_int_equal(vxm_sparse_from_grid(&from_grid, grid, NULL), VXM_OK);
    assert_int_equal(vxm_sparse_bricks(made), vxm_sparse_bricks(from_grid));
    hash[threads - 1] = vxm_grid_hash(grid);
    vxm_carver_destroy(carver);
    vxm_carver_destroy(sparse);
    vxm_sparse_destroy(stock);
    vxm_sparse_destroy(made);
    vxm_sparse_destroy(from_grid);
    vxm_mesh_destroy(mesh);
    vxm_grid_destroy(grid);
    vxm_context_destroy(context);
  }
  assert_int_equal(hash[0], hash[1]);
  assert_int_equal(hash[0], hash[2]);
}

/** A sheet has no inside: where it is put nothing is cut, and where it passes all is. */
static void a_sheet_cuts_where_it_passes(void **state) {
  (void)state;
  static const double corners[][3] = {{0, 2.25, 0.5}, {0, 5.25, 0.5}, {0, 2.25, 9.5}, {0, 5.25, 9.5}};
  static const int64_t faces[][3] = {{0, 1, 2}, {1, 3, 2}};
  static const tool sheet = {"sheet", 4, 2, corners, faces};
  static const vxm_space units = {{SIDE, SIDE, SIDE}, {0, 0, 0}, {1, 1, 1}};
  vxm_grid *grid = full_grid(NULL, &units);
  vxm_mesh *mesh = mesh_of(NULL, &sheet);
  vxm_carver *carver = NULL;
  assert_int_equal(vxm_carver_create(&carver, grid, mesh, NULL), VXM_OK);
  double pose[12] = {1, 0, 0, 1.25, 0, 1, 0, 0, 0, 0, 1, 0};
  move(carver, grid, pose);
  assert_int_equal(vxm_grid_count(grid), SIDE * SIDE * SIDE);
  pose[3] = 9.25;
  move(carver, grid, pose);
  assert_int_equal(SIDE * SIDE * SIDE - vxm_grid_count(grid), 8 * 3 * 9);
  vxm_carver_destroy(carver);
  vxm_mesh_destroy(mesh);
  vxm_grid_destroy(grid);
}

/** Outside of the stock nothing happens, however far away; poses and tools that cannot be are refused. */
static void what_cannot_be_is_refused(void **state) {
  (void)state;
  vxm_grid *grid = full_grid(NULL, &cube);
  vxm_mesh *mesh = mesh_of(NULL, &box);
  vxm_carver *carver = NULL, *none = (vxm_carver *)grid;
  vxm_sparse *sparse = (vxm_sparse *)grid;
  assert_int_equal(vxm_carver_create(&carver, grid, mesh, NULL), VXM_OK);
  double pose[12] = {1, 0, 0, -100000, 0, 1, 0, 4000, 0, 0, 1, 0};
  move(carver, grid, pose);
  pose[3] = 100000;
  move(carver, grid, pose); /* past it */
  pose[0] = pose[5] = 0, pose[1] = -1, pose[4] = 1;
  move(carver, grid, pose);
  assert_int_equal(vxm_grid_count(grid), SIDE * SIDE * SIDE);
  pose[7] = 4.5; /* a long way through it in one step */
  pose[11] = 2.5;
  move(carver, grid, pose);
  pose[3] = -100000;
  move(carver, grid, pose);
  assert_int_equal(SIDE * SIDE * SIDE - vxm_grid_count(grid), SIDE * 4 * 4);
  pose[3] = 1e300;
  assert_int_equal(vxm_carver_move(NULL, carver, pose, NULL), VXM_ERROR_RANGE);
  pose[3] = NAN;
  assert_int_equal(vxm_carver_move(NULL, carver, pose, NULL), VXM_ERROR_ARGUMENT);
  pose[3] = 0;
  pose[1] = 1; /* a mirror */
  assert_int_equal(vxm_carver_place(NULL, carver, pose, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_carver_sparse(&sparse, carver, NULL), VXM_ERROR_ARGUMENT);
  assert_null(sparse);
  static const double far_vertices[][3] = {{0, 0, 0}, {0, 3000, 0}, {0, 0, 1}};
  static const int64_t one_face[][3] = {{0, 1, 2}};
  static const tool large = {"large", 3, 1, far_vertices, one_face};
  vxm_mesh *other = mesh_of(NULL, &large);
  assert_int_equal(vxm_carver_create(&none, grid, other, NULL), VXM_ERROR_RANGE);
  assert_null(none);
  static const vxm_space tiny = {{8, 8, 8}, {0, 0, 0}, {1e-310, 1e-310, 1e-310}};
  vxm_grid *small;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_grid_create(&small, NULL, &tiny, NULL), VXM_OK);
  assert_int_equal(vxm_carver_create(&none, small, other, &error), VXM_ERROR_RANGE);
  assert_non_null(strstr(error.text, "too small to be computed with"));
  vxm_grid_destroy(small);
  vxm_mesh_destroy(other);
  vxm_carver_destroy(carver);
  vxm_mesh_destroy(mesh);
  vxm_grid_destroy(grid);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(straight_ways_are_covered),        cmocka_unit_test(turns_are_covered),
      cmocka_unit_test(faces_through_centres_count_once), cmocka_unit_test(octrees_and_threads_give_the_same),
      cmocka_unit_test(a_sheet_cuts_where_it_passes),     cmocka_unit_test(what_cannot_be_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

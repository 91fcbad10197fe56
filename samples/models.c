/* SPDX-License-Identifier: BSD-3-Clause */
#include "models.h"

#include <math.h>

enum { SEGMENTS = 48, POINTS = 25 };

/* ---- Clean ---- */

static shape make_cube(void) {
  return shape_box(0, 0, 0, 1, 1, 1);
}

static shape make_sphere(void) {
  double profile[2 * POINTS];
  shape_half_circle(profile, POINTS, 1);
  return shape_revolve(POINTS, profile, false, SEGMENTS);
}

static shape make_torus(void) {
  double profile[2 * POINTS];
  shape_circle(profile, POINTS, 1, 0.4);
  shape made = shape_revolve(POINTS, profile, true, SEGMENTS);
  shape_split_triangles(&made);
  return made;
}

static const double l_corners[] = {0, 0, 2, 0, 2, 1, 1, 1, 1, 2, 0, 2};

static shape make_l_prism(void) {
  return shape_prism(6, l_corners, 0, 1);
}

enum { STAR = 5 };

/** A star of STAR points between the radii 0.4 and 1: not convex, and its centre is no corner. */
static shape make_star_prism(void) {
  double corners[4 * STAR];
  for (int i = 0; i < 2 * STAR; i++) {
    double angle = 3.14159265358979323846 * i / STAR, radius = i % 2 ? 0.4 : 1;
    corners[2 * i] = radius * shape_cosine(angle);
    corners[2 * i + 1] = radius * shape_sine(angle);
  }
  return shape_prism(2 * (size_t)STAR, corners, -0.3, 0.3);
}

/* ---- Whole, but not simple ---- */

static shape join(shape first, shape second) {
  shape_append(&first, &second);
  shape_free(&second);
  return first;
}

static shape make_overlapping(void) {
  return join(shape_box(0, 0, 0, 1, 1, 1), shape_box(0.5, 0.5, 0.5, 1.5, 1.5, 1.5));
}

static shape make_edge_cubes(void) {
  return join(shape_box(0, 0, 0, 1, 1, 1), shape_box(1, 1, 0, 2, 2, 1));
}

static shape make_vertex_cubes(void) {
  return join(shape_box(0, 0, 0, 1, 1, 1), shape_box(1, 1, 1, 2, 2, 2));
}

static shape make_cavity(void) {
  shape inside = shape_box(0.5, 0.5, 0.5, 1.5, 1.5, 1.5);
  shape_reverse_faces(&inside, 1, 0);
  return join(shape_box(0, 0, 0, 2, 2, 2), inside);
}

/* ---- Broken ---- */

static shape make_doubled(void) {
  shape made = make_sphere();
  shape_repeat_faces(&made, true, 1, 0);
  return made;
}

static shape make_repeated(void) {
  shape made = make_sphere();
  shape_repeat_faces(&made, false, 0.1, 11);
  return made;
}

static shape make_flipped(void) {
  shape made = make_sphere();
  shape_reverse_faces(&made, 0.3, 12);
  return made;
}

static shape make_missing(void) {
  shape made = make_torus();
  shape_remove_faces(&made, 0.05, 13);
  return made;
}

static shape make_open_box(void) {
  shape made = make_cube(), open = {0};
  for (size_t v = 0; v < made.vertex_count; v++)
    shape_add_vertex(&open, made.positions[3 * v], made.positions[3 * v + 1], made.positions[3 * v + 2]);
  for (size_t f = 0; f < made.face_count; f++)
    if (f != 1) /* the top */
      shape_add_face(&open, 4, made.indices + made.offsets[f]);
  shape_free(&made);
  return open;
}

static shape make_inner_sheet(void) {
  shape made = make_sphere();
  int64_t corners[4];
  for (int i = 0; i < 4; i++)
    corners[i] = shape_add_vertex(&made, i == 0 || i == 3 ? -0.4 : 0.4, 0.1, i < 2 ? -0.4 : 0.4);
  shape_add_face(&made, 4, corners);
  return made;
}

static shape make_soup(void) {
  shape made = make_torus();
  shape_crack(&made, 0, 0);
  return made;
}

static shape make_cracks(void) {
  shape made = make_torus();
  shape_crack(&made, 1e-7, 14);
  return made;
}

/** A repeated corner, two corners, three on a line, and one without area among distinct corners. */
static shape make_degenerate(void) {
  shape made = make_cube();
  int64_t middle = shape_add_vertex(&made, 0.5, 0, 0);
  shape_add_face(&made, 3, (int64_t[]){0, 0, 6});
  shape_add_face(&made, 4, (int64_t[]){2, 3, 2, 3});
  shape_add_face(&made, 3, (int64_t[]){0, middle, 1});
  return made;
}

static shape make_nonfinite(void) {
  shape made = make_cube();
  int64_t nan_vertex = shape_add_vertex(&made, NAN, 0, 0);
  int64_t far_vertex = shape_add_vertex(&made, 0, INFINITY, 0);
  shape_add_face(&made, 3, (int64_t[]){0, 1, nan_vertex});
  shape_add_face(&made, 4, (int64_t[]){0, 1, 2, far_vertex});
  return made;
}

static shape make_unused(void) {
  shape made = make_cube();
  shape_add_vertex(&made, 10, 0, 0);
  shape_add_vertex(&made, 0, -10, 0.5);
  return made;
}

/* ---- The rocket ---- */

/** A fin in the plane of x and z, four hundredths thick. */
static shape make_fin(double degrees) {
  const double corners[] = {0.2, -0.05, 0.95, -0.45, 0.95, 0.0, 0.6, 0.55, 0.2, 1.0};
  shape fin = shape_prism(5, corners, -0.05, 0.05);
  shape_turn(&fin, 0, 90); /* the profile's y becomes z */
  shape_turn(&fin, 2, degrees);
  return fin;
}

/** A body of revolution, standing at (x, y, z). */
static shape make_turned(size_t count, const double *profile, bool ring, size_t segments, double x, double y,
                         double z) {
  shape made = shape_revolve(count, profile, ring, segments);
  shape_move(&made, x, y, z);
  return made;
}

static void add(shape *to, shape part) {
  shape_append(to, &part);
  shape_free(&part);
}

shape model_rocket(void) {
  enum { ROUND = 40 };
  static const double hull[] = {0.30, 0.00, 0.42, 0.30, 0.50, 0.80, 0.52, 1.30, 0.48,
                                1.90, 0.38, 2.40, 0.22, 2.80, 0.08, 3.05, 0.00, 3.15};
  static const double nozzle[] = {0.36, -0.35, 0.24, -0.05, 0.24, 0.25};
  static const double booster[] = {0.12, -0.20, 0.17, 0.00, 0.17, 1.00, 0.12, 1.25, 0.00, 1.45};
  static const double pad[] = {1.35, -0.62, 1.35, -0.50, 1.25, -0.45};
  static const double mast[] = {0.03, 3.00, 0.03, 3.45};
  double band[2 * 12], window[2 * 12];
  shape_circle(band, 12, 0.5, 0.05);
  shape_circle(window, 12, 0.16, 0.05);

  shape rocket = {0};
  shape body = make_turned(9, hull, false, ROUND, 0, 0, 0);
  shape_split_triangles(&body);
  shape_remove_faces(&body, 0.005, 5);
  shape_reverse_faces(&body, 0.2, 22);
  shape_repeat_faces(&body, true, 0.3, 23);
  add(&rocket, body);
  shape engine = make_turned(3, nozzle, false, ROUND, 0, 0, 0);
  shape_repeat_faces(&engine, false, 0.4, 24);
  add(&rocket, engine);
  for (int i = 0; i < 4; i++) {
    shape fin = make_fin(90 * i);
    shape_repeat_faces(&fin, true, i % 2 ? 1 : 0, 25);
    add(&rocket, fin);
    double angle = 45 + 90 * i, along = angle * 3.14159265358979323846 / 180;
    shape tank =
        make_turned(5, booster, false, 20, 0.56 * shape_cosine(along), 0.56 * shape_sine(along), -0.1);
    shape_crack(&tank, i % 2 ? 2e-8 : 0, 26 + (uint64_t)i);
    shape_reverse_faces(&tank, 0.3, 31 + (uint64_t)i);
    add(&rocket, tank);
  }
  add(&rocket, make_turned(12, band, true, ROUND, 0, 0, 0.95));
  add(&rocket, make_turned(12, band, true, ROUND, 0, 0, 1.6));
  shape porthole = shape_revolve(12, window, true, 24);
  shape_turn(&porthole, 1, 90);
  shape_move(&porthole, 0.46, 0, 2.0);
  add(&rocket, porthole);
  add(&rocket, make_turned(2, mast, false, 12, 0, 0, 0));
  shape base = make_turned(3, pad, false, 64, 0, 0, 0);
  shape_crack(&base, 1e-8, 41);
  add(&rocket, base);
  int64_t line[3] = {0, 1, 1};
  shape_add_face(&rocket, 3, line);
  shape_add_vertex(&rocket, 0, 0, 20); /* used by no face */
  return rocket;
}

/* ---- The list ---- */

/* Volumes of the faceted bodies: frustums over regular 48-gons, (48/2) sin(2 pi/48) times the sum of
   (z1 - z0) (r0^2 + r0 r1 + r1^2) / 3 along the profile; and five kites of the star. */
#define SPHERE 4.15897144
#define TORUS 3.11621223
#define STAR_PRISM 0.705342303

/* The counts follow from the definitions; those of the random damage were counted by a second program. */
const model models[] = {
    {"cube",
     "unit cube of six rectangles",
     make_cube,
     {8, 6, 12, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, true, true},
     1,
     "auto",
     NULL},
    {"sphere",
     "unit sphere: 48 segments, 24 bands of rectangles, triangles at the poles",
     make_sphere,
     {1106, 1152, 2208, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, true, true},
     SPHERE,
     "auto",
     NULL},
    {"torus",
     "torus of radii 1 and 0.4: 48 times 25 rectangles as triangles",
     make_torus,
     {1200, 2400, 2400, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, true, true},
     TORUS,
     "auto",
     NULL},
    {"l_prism",
     "L-shaped prism whose ends are one non-convex polygon each",
     make_l_prism,
     {12, 8, 20, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, true, true},
     3,
     "auto",
     NULL},
    {"star_prism",
     "five-pointed star prism whose ends are one non-convex polygon each",
     make_star_prism,
     {20, 12, 36, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, true, true},
     STAR_PRISM,
     "auto",
     NULL},
    {"overlapping",
     "two cubes that run into each other: their union is meant",
     make_overlapping,
     {16, 12, 24, 2, 2, 0, 0, 0, 0, 0, 0, 0, 0, true, true},
     1.875,
     "auto",
     NULL},
    {"edge_cubes",
     "two cubes that share an edge",
     make_edge_cubes,
     {16, 12, 24, 1, 2, 0, 0, 0, 0, 1, 0, 0, 0, false, true},
     2,
     "auto",
     NULL},
    {"vertex_cubes",
     "two cubes that share a corner",
     make_vertex_cubes,
     {16, 12, 24, 1, 2, 0, 0, 0, 0, 0, 0, 0, 0, true, true},
     2,
     "auto",
     NULL},
    {"cavity",
     "cube with a cubic cavity, wound inward",
     make_cavity,
     {16, 12, 24, 2, 2, 0, 0, 0, 0, 0, 0, 0, 0, true, true},
     7,
     "whole",
     NULL},
    {"doubled",
     "the sphere with every face a second time, turned over",
     make_doubled,
     {1106, 2304, 4416, 1, 1, 0, 1152, 0, 0, 2256, 0, 0, 0, false, true},
     SPHERE,
     "auto",
     "sphere"},
    {"repeated",
     "the sphere with a tenth of the faces a second time",
     make_repeated,
     {1106, 1263, 2420, 1, 1, 111, 0, 0, 0, 413, 0, 0, 0, false, false},
     SPHERE,
     "auto",
     "sphere"},
    {"flipped",
     "the sphere with 30 % of the faces turned over",
     make_flipped,
     {1106, 1152, 2208, 1, 1, 0, 0, 0, 0, 0, 924, 0, 0, true, true},
     SPHERE,
     "auto",
     "sphere"},
    {"soup",
     "the torus with triangles that share no vertex, as in STL files",
     make_soup,
     {7200, 2400, 2400, 1, 2400, 0, 0, 0, 0, 0, 0, 0, 0, true, true},
     TORUS,
     "auto",
     "torus"},
    {"cracks",
     "the same, every corner moved by up to 1e-7: nothing fits any more",
     make_cracks,
     {7200, 2400, 2400, 2400, 2400, 0, 0, 0, 7200, 0, 0, 0, 0, false, false},
     TORUS,
     "auto",
     NULL},
    {"degenerate",
     "the cube with faces that repeat corners or have no area",
     make_degenerate,
     {9, 9, 16, 1, 1, 0, 0, 3, 2, 1, 0, 0, 0, false, false},
     1,
     "auto",
     "cube"},
    {"nonfinite",
     "the cube with faces at a NaN and at an infinite vertex",
     make_nonfinite,
     {10, 8, 15, 1, 1, 0, 0, 0, 0, 0, 0, 2, 0, true, true},
     1,
     "auto",
     "cube"},
    {"unused",
     "the cube with vertices far away that no face uses",
     make_unused,
     {10, 6, 12, 1, 1, 0, 0, 0, 0, 0, 0, 0, 2, true, true},
     1,
     "auto",
     "cube"},
    {"missing",
     "the torus with 5 % of the triangles missing",
     make_missing,
     {1200, 2272, 2272, 1, 1, 0, 0, 0, 364, 0, 0, 0, 0, false, false},
     TORUS,
     NULL,
     NULL},
    {"open_box",
     "the cube without its top",
     make_open_box,
     {8, 5, 10, 1, 1, 0, 0, 0, 4, 0, 0, 0, 0, false, false},
     1,
     NULL,
     NULL},
    {"inner_sheet",
     "the sphere with a loose square inside: the sphere is meant",
     make_inner_sheet,
     {1110, 1153, 2210, 2, 2, 0, 0, 0, 4, 0, 0, 0, 0, false, false},
     SPHERE,
     NULL,
     NULL},
};
const size_t model_count = sizeof models / sizeof models[0];

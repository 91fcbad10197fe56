/* SPDX-License-Identifier: BSD-3-Clause */
/** T-junctions, and bodies that are inside out: assemblies of unit cubes with faces divided and bodies turned
 * at random, whose volumes are known. */
#include "repair_test.h"

#include "mesh/edges.h"

#include <math.h>

enum { N = 3, CELLS = N * N * N };

/** What is built, and how. */
typedef struct assembly {
  int body[CELLS]; /**< of each cell, from 1, or 0 */
  int bodies, cells;
  double divided;  /**< probability that a face is divided */
  bool is_turned;  /**< about an axis, so that nothing is exact any more */
  uint64_t inward; /**< bit b: body b is inside out */
  vxm_soup *soup;
  vxm_rng rng;
} assembly;

static int body_at(const assembly *a, const int *cell) {
  for (int i = 0; i < 3; i++)
    if (cell[i] < 0 || cell[i] >= N)
      return 0;
  return a->body[(cell[0] * N + cell[1]) * N + cell[2]];
}

/** Walks of some steps from a random cell, one after the other. */
static void grow(assembly *a, int bodies, int steps) {
  for (int b = 1; b <= bodies; b++) {
    int cell[3] = {(int)vxm_rng_below(&a->rng, N), (int)vxm_rng_below(&a->rng, N),
                   (int)vxm_rng_below(&a->rng, N)};
    for (int s = 0; s < steps; s++) {
      int *at = &a->body[(cell[0] * N + cell[1]) * N + cell[2]];
      if (*at == 0) {
        *at = b;
        a->cells++;
      }
      int next[3] = {cell[0], cell[1], cell[2]};
      next[vxm_rng_below(&a->rng, 3)] += vxm_rng_below(&a->rng, 2) ? 1 : -1;
      if (body_at(a, next) == b || (body_at(a, next) == 0 && next[0] >= 0 && next[1] >= 0 && next[2] >= 0 &&
                                    next[0] < N && next[1] < N && next[2] < N))
        memcpy(cell, next, sizeof cell);
    }
  }
}

/** A vertex for each corner of a face: welding is the repair's work. */
static void add_quad(assembly *a, double (*p)[3]) {
  uint32_t corners[4];
  for (int i = 0; i < 4; i++) {
    double x = p[i][0], y = p[i][1], c = a->is_turned ? cos(0.7) : 1, s = a->is_turned ? sin(0.7) : 0;
    corners[i] = (uint32_t)a->soup->vertex_count;
    add_vertex(a->soup, c * x - s * y, s * x + c * y, p[i][2]);
  }
  if (vxm_rng_below(&a->rng, 3) == 0)
    add_face(a->soup, corners, 4);
  else {
    add_triangle(a->soup, corners[0], corners[1], corners[2]);
    add_triangle(a->soup, corners[0], corners[2], corners[3]);
  }
}

static void between(double *out, const double *p, const double *q, double part) {
  for (int i = 0; i < 3; i++)
    out[i] = p[i] + (q[i] - p[i]) * part;
}

/** A face, or two or three strips of it. */
static void add_divided(assembly *a, double (*p)[3]) {
  double rest[4][3];
  memcpy(rest, p, sizeof rest);
  while (vxm_rng_unit(&a->rng) < a->divided) {
    double part = 0.2 + 0.6 * vxm_rng_unit(&a->rng), strip[4][3];
    memcpy(strip, rest, sizeof strip);
    between(strip[1], rest[0], rest[1], part);
    between(strip[2], rest[3], rest[2], part);
    add_quad(a, strip);
    memcpy(rest[0], strip[1], sizeof rest[0]);
    memcpy(rest[3], strip[2], sizeof rest[3]);
  }
  add_quad(a, rest);
}

static void add_side(assembly *a, const int *cell, int axis, int side) {
  bool outward = (a->inward >> body_at(a, cell) & 1) == 0;
  int u = (axis + 1) % 3, v = (axis + 2) % 3, first = (int)vxm_rng_below(&a->rng, 4);
  double p[4][3];
  for (int i = 0; i < 4; i++) {
    int k = ((side != 0) == outward ? i : 3 - i) + first;
    for (int j = 0; j < 3; j++)
      p[i][j] = cell[j];
    p[i][axis] += side;
    p[i][u] += (k % 4 == 1) || (k % 4 == 2);
    p[i][v] += k % 4 >= 2;
  }
  add_divided(a, p);
}

static void build(assembly *a, vxm_context *context) {
  a->soup = new_soup(context);
  for (int i = 0; i < CELLS; i++) {
    int cell[3] = {i / (N * N), i / N % N, i % N};
    for (int s = 0; s < 6 && a->body[i]; s++) {
      int beside[3] = {cell[0], cell[1], cell[2]};
      beside[s / 2] += s % 2 ? 1 : -1;
      if (body_at(a, beside) != a->body[i])
        add_side(a, cell, s / 2, s % 2);
    }
  }
}

/** The volume is that of the cells, nothing is left open, no plate is made, and the repair is done. */
static void check(const assembly *a, vxm_level level, bool triangles, uint64_t seed) {
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.level = level;
  options.triangles = triangles;
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(a->soup, &options, &report);
  if (fabs(report.after->volume - a->cells) > 1e-4 || report.after->boundary_edges > 0 || report.sheets > 0)
    fail_msg("seed %llu, level %d: volume %.9g of %d, %lld open edges, %lld sheets", (unsigned long long)seed,
             (int)level, report.after->volume, a->cells, (long long)report.after->boundary_edges,
             (long long)report.sheets);
  assert_repair_is_done(out, &options);
  vxm_soup_destroy(out);
}

static void check_random(vxm_context *context, int bodies, bool is_turned, int trials) {
  for (uint64_t seed = 1; seed <= (uint64_t)trials; seed++) {
    assembly a = {.is_turned = is_turned, .rng = {seed}};
    a.divided = 0.1 + 0.5 * vxm_rng_unit(&a.rng);
    grow(&a, bodies, 1 + (int)vxm_rng_below(&a.rng, 6));
    build(&a, context);
    for (int level = VXM_LEVEL_CLEAN; level <= VXM_LEVEL_CLOSED; level++)
      check(&a, (vxm_level)level, seed % 2, seed);
    vxm_soup_destroy(a.soup);
  }
}

static void one_body(void **state) {
  check_random(*state, 1, false, 150);
}

static void one_body_turned(void **state) {
  check_random(*state, 1, true, 150);
}

static void touching_bodies(void **state) {
  check_random(*state, 2, false, 150);
  check_random(*state, 3, true, 60);
}

/** Bodies that touch, some of them inside out: from VXM_LEVEL_MANIFOLD on all look outward. */
static void bodies_inside_out(void **state) {
  for (uint64_t seed = 1; seed <= 150; seed++) {
    assembly a = {.rng = {seed}};
    grow(&a, 2 + seed % 2, 1 + (int)vxm_rng_below(&a.rng, 6));
    a.inward = vxm_rng_below(&a.rng, 16);
    build(&a, *state);
    check(&a, VXM_LEVEL_MANIFOLD, seed % 2, seed);
    check(&a, VXM_LEVEL_CLOSED, seed % 2, seed);
    vxm_soup_destroy(a.soup);
  }
}

/** A face of a cube that is missing stays a hole of as many edges, whatever lies along the others. */
static void hole_stays(void **state) {
  for (uint64_t seed = 1; seed <= 20; seed++) {
    assembly a = {.divided = 0.5, .rng = {seed}, .soup = new_soup(*state)};
    static const int cell[3] = {0, 0, 0};
    for (int s = 0; s < 5; s++)
      add_side(&a, cell, s / 2, s % 2);
    REPAIR_REPORT(report);
    vxm_soup *out = repaired(a.soup, NULL, &report);
    double length = 0;
    vxm_edges edges;
    assert_int_equal(vxm_edges_build(&edges, out->context, out, NULL, NULL), VXM_OK);
    for (size_t e = 0; e < edges.count; e++)
      if (edges.edges[e].count == 1)
        length += distance_between(vxm_position(out, edges.edges[e].a), vxm_position(out, edges.edges[e].b));
    assert_true(fabs(length - 4) < 1e-9);
    vxm_edges_destroy(&edges);
    vxm_soup_destroy(out);
    vxm_soup_destroy(a.soup);
  }
}

/** How far beside an edge a vertex may lie. */
static void tolerance(void **state) {
  for (int i = 0; i < 3; i++) {
    /* a square, with a vertex that its left neighbour has on their edge */
    const double off[] = {0, 1e-6, 1e-4},
                 positions[7][3] = {{0, 0, 0},        {1, 0, 0},  {1, 1, 0}, {0, 1, 0},
                                    {off[i], 0.5, 0}, {-1, 0, 0}, {-1, 1, 0}};
    static const int faces[] = {0, 1, 2, -1, 0, 2, 3, -1, 0, 4, 5, -1, 4, 6, 5, -1, 4, 3, 6, -1};
    vxm_soup *soup = soup_of(*state, positions, 7, faces, 5);
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
    vxm_soup *out = repaired(soup, &options, &report);
    assert_int_equal(count_of(&report, "t_junctions"), i < 2);
    vxm_soup_destroy(out);
    options.weld = VXM_WELD_OFF;
    out = repaired(soup, &options, &report);
    assert_int_equal(count_of(&report, "t_junctions"), i < 1);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(one_body),        cmocka_unit_test(one_body_turned),
      cmocka_unit_test(touching_bodies), cmocka_unit_test(bodies_inside_out),
      cmocka_unit_test(hole_stays),      cmocka_unit_test(tolerance),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}

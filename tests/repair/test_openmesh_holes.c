/* SPDX-License-Identifier: BSD-3-Clause */
/** The module for OpenMesh: which rims are filled, in which of several ways, and beside what. */
#include "halfedges.h"
#include "outlines.h"

#include "repair/manifold/cut_nonmanifold.h"

#include <math.h>

/** Seven vertices, each joined with each other: a torus. */
static vxm_soup *joined_torus(vxm_context *context) {
  vxm_soup *soup = new_soup(context);
  vxm_rng rng = {10};
  for (int v = 0; v < 7; v++)
    add_vertex(soup, vxm_rng_unit(&rng), vxm_rng_unit(&rng), vxm_rng_unit(&rng));
  for (uint32_t i = 0; i < 7; i++) {
    add_triangle(soup, i, (i + 1) % 7, (i + 3) % 7);
    add_triangle(soup, i, (i + 3) % 7, (i + 2) % 7);
  }
  return soup;
}

/** No edge is made that exists: of the two diagonals of a hole only one is free, or of six corners none. */
static void edges_that_exist(void **state) {
  vxm_soup *torus = joined_torus(*state);
  check_inspection(torus);
  for (size_t first = 0; first < torus->face_count; first++)
    for (size_t second = 0; second < first; second++) {
      vxm_soup *soup = new_soup(*state);
      for (size_t v = 0; v < 7; v++)
        add_vertex(soup, vxm_position(torus, v)[0], vxm_position(torus, v)[1], vxm_position(torus, v)[2]);
      for (size_t f = 0; f < torus->face_count; f++)
        if (f != first && f != second)
          add_face(soup, torus->indices + 3 * f, 3);
      /* two faces with no more than a vertex in common leave two holes, with that vertex on both */
      if (look_brute(soup).manifold) {
        outcome out = fill(soup, 0);
        assert_int_equal(out.left, 0);
        assert_true(fabs(volume_of(out.soup) - volume_of(torus)) < 1e-12);
        drop(soup, out);
      }
      vxm_soup_destroy(soup);
    }
  vxm_soup *soup = new_soup(*state);
  for (size_t v = 0; v < 7; v++)
    add_vertex(soup, vxm_position(torus, v)[0], vxm_position(torus, v)[1], vxm_position(torus, v)[2]);
  for (size_t f = 0; f < torus->face_count; f++) {
    const uint32_t *t = torus->indices + 3 * f;
    if (t[0] != 6 && t[1] != 6 && t[2] != 6)
      add_face(soup, t, 3);
  }
  outcome out = fill(soup, 0);
  assert_int_equal(out.left, 1);
  drop(soup, out);
  vxm_soup_destroy(soup);
  vxm_soup_destroy(torus);
}

static void kept_open(void **state) {
  /* a triangle alone, with area and without, and a slit all of whose corners lie in line */
  static const double line[8][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0},  {3, 0, 0},
                                    {0, 1, 0}, {3, 1, 0}, {0, -1, 0}, {3, -1, 0}};
  static const int triangles[2][4] = {{1, 4, 6, -1}, {0, 4, 6, -1}};
  static const int slit[] = {0, 1, 5, 4, -1, 1, 2, 5, -1, 2, 3, 5, -1,
                             3, 0, 6, 7, -1, 0, 4, 6, -1, 5, 3, 7, -1};
  for (int i = 0; i < 2; i++) {
    vxm_soup *soup = soup_of(*state, line, 8, triangles[i], 1);
    outcome out = fill(soup, 0);
    assert_int_equal(out.left, 1);
    drop(soup, out);
    vxm_soup_destroy(soup);
  }
  vxm_soup *soup = soup_of(*state, line, 8, slit, 6);
  outcome out = fill(soup, 0);
  assert_int_equal(out.filled, 1); /* the slit, by faces without area; the sheet's own rim stays */
  assert_int_equal(out.left, 1);
  drop(soup, out);
  vxm_soup_destroy(soup);
}

static void sizes_of_holes(void **state) {
  for (size_t most = 0; most < 8; most++) {
    vxm_soup *soup = new_soup(*state);
    uint32_t n = 3 + (uint32_t)(most % 4);
    for (uint32_t k = 0; k < 2 * n; k++)
      add_vertex(soup, cos(2 * M_PI * k / n), sin(2 * M_PI * k / n), k < n ? 0 : 3);
    for (uint32_t k = 0; k < n; k++) {
      uint32_t wall[4] = {k, (k + 1) % n, n + (k + 1) % n, n + k};
      add_face(soup, wall, 4);
    }
    outcome out = fill(soup, most);
    bool fits = most == 0 || n <= most;
    assert_int_equal(out.filled, fits ? 2 : 0);
    assert_int_equal(out.left, 0); /* longer ones were not to be filled */
    drop(soup, out);
    vxm_soup_destroy(soup);
  }
}

/** Of the two ways to fill four edges that with the flatter worst bend is taken, then the smaller one. */
static double bend(const double *p, const double *q, const double *r, const double *n) {
  double u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, v[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]};
  double w[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  double length = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
  double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  return (w[0] * n[0] + w[1] * n[1] + w[2] * n[2]) / (length * size);
}

static void normal_of(const double *p, const double *q, const double *r, double n[3]) {
  double u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, v[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]};
  for (int a = 0; a < 3; a++)
    n[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
}

/** A hole of four edges, p[0] to p[3], with the face beyond each edge given by its third corner, p[4] to
 * p[7]. */
static vxm_soup *hole_of_four(vxm_context *context, const double (*p)[3]) {
  vxm_soup *soup = new_soup(context);
  for (int v = 0; v < 8; v++)
    add_vertex(soup, p[v][0], p[v][1], p[v][2]);
  for (uint32_t v = 0; v < 4; v++) {
    add_triangle(soup, (v + 1) % 4, v, 4 + v);
    add_triangle(soup, (v + 1) % 4, 4 + v, 4 + (v + 1) % 4);
  }
  return soup;
}

/** Which diagonal fills the hole: 0 = from 0 to 2, 1 = from 1 to 3. */
static int way_taken(const vxm_soup *soup) {
  outcome out = fill(soup, 0);
  int uses[8] = {0};
  /* the outer rim is a hole too, if it is not that of a sheet */
  for (size_t f = soup->face_count; f < out.soup->face_count; f++) {
    const uint32_t *t = out.soup->indices + out.soup->offsets[f];
    for (int c = 0; c < 3 && t[0] < 4 && t[1] < 4 && t[2] < 4; c++)
      uses[t[c]]++;
  }
  assert_int_equal(uses[0] + uses[1] + uses[2] + uses[3], 6);
  drop(soup, out);
  return uses[0] == 2 ? 0 : 1;
}

static void four_edges(void **state) {
  vxm_rng rng = {11};
  int taken[2] = {0, 0};
  for (int i = 0; i < 500; i++) {
    double p[8][3], worst[2] = {1, 1};
    for (int v = 0; v < 8; v++) {
      static const double base[8][2] = {{0, 0},    {1, 0},   {1, 1},   {0, 1},
                                        {0.5, -1}, {2, 0.5}, {0.5, 2}, {-1, 0.5}};
      for (int a = 0; a < 3; a++)
        p[v][a] = (a < 2 ? base[v][a] : 0) + (a < 2 ? 0.3 : v < 4 ? 0.4 : 3) * (vxm_rng_unit(&rng) - 0.5);
    }
    for (int way = 0; way < 2; way++) {
      double half[3];
      for (int h = 0; h < 2; h++) {
        int a = way + 2 * h, b = (a + 1) % 4, c = (a + 2) % 4, outer[2][2] = {{a % 4, b}, {b, c}};
        normal_of(p[a % 4], p[b], p[c], half);
        for (int e = 0; e < 2; e++) {
          double beyond[3];
          normal_of(p[outer[e][1]], p[outer[e][0]], p[4 + outer[e][0]], beyond);
          worst[way] = fmin(worst[way], bend(p[a % 4], p[b], p[c], beyond));
        }
      }
      worst[way] = fmin(worst[way], bend(p[way], p[way + 1], p[way + 2], half));
    }
    vxm_soup *soup = hole_of_four(*state, (const double(*)[3])p);
    int way = way_taken(soup);
    if (fabs(worst[0] - worst[1]) > 1e-6)
      assert_true(worst[way] > worst[1 - way]);
    taken[way]++;
    vxm_soup_destroy(soup);
  }
  assert_true(taken[0] > 50 && taken[1] > 50);
}

/** Where both ways to fill four edges have the same worst bend, the smaller one is taken. */
static void four_edges_bent_alike(void **state) {
  vxm_rng rng = {12};
  int checked = 0;
  for (int i = 0; i < 300; i++) {
    double p[8][3], n[2][3], up[3];
    for (int v = 0; v < 4; v++) {
      static const double base[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
      for (int a = 0; a < 3; a++)
        p[v][a] = (a < 2 ? base[v][a] : 0) + 0.4 * vxm_rng_unit(&rng);
    }
    double area[2], other[3];
    for (int way = 0; way < 2; way++) {
      normal_of(p[0], p[1], p[2 + way], n[way]);
      double size = sqrt(n[way][0] * n[way][0] + n[way][1] * n[way][1] + n[way][2] * n[way][2]);
      if (way == 1)
        normal_of(p[1], p[2], p[3], other);
      else
        normal_of(p[0], p[2], p[3], other);
      area[way] = size + sqrt(other[0] * other[0] + other[1] * other[1] + other[2] * other[2]);
      for (int a = 0; a < 3; a++)
        n[way][a] /= size;
    }
    for (int a = 0; a < 3; a++)
      up[a] = n[0][a] + n[1][a];
    double size = sqrt(up[0] * up[0] + up[1] * up[1] + up[2] * up[2]);
    /* beyond the first edge a face that folds back alike over both, beyond the others faces that go on */
    for (int v = 0; v < 4; v++) {
      const double *q = p[v], *r = p[(v + 1) % 4];
      double d[3] = {q[0] - r[0], q[1] - r[1], q[2] - r[2]}, sign = (v == 0 ? -1 : 1) / size;
      for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        p[4 + v][a] = (q[a] + r[a]) / 2 + sign * (up[b] * d[c] - up[c] * d[b]);
      }
    }
    vxm_soup *soup = hole_of_four(*state, (const double(*)[3])p);
    int way = way_taken(soup);
    if (fabs(area[0] - area[1]) > 1e-3) {
      assert_true(area[way] < area[1 - way]);
      checked++;
    }
    vxm_soup_destroy(soup);
  }
  assert_true(checked > 100);
}

/** Anything, separated: whatever touches itself on a rim, the result is manifold. */
static void holes_in_tangles(void **state) {
  vxm_rng rng = {13};
  int64_t filled = 0, left = 0;
  for (int i = 0; i < 1500; i++) {
    vxm_soup *soup, *apart;
    if (i % 2) {
      uint8_t full[27];
      for (int c = 0; c < 27; c++)
        full[c] = vxm_rng_below(&rng, 2) == 0;
      vxm_soup *whole = cell_surface(*state, 3, full);
      soup = new_soup(*state);
      for (size_t v = 0; v < whole->vertex_count; v++)
        add_vertex(soup, vxm_position(whole, v)[0], vxm_position(whole, v)[1], vxm_position(whole, v)[2]);
      for (size_t f = 0; f < whole->face_count; f++)
        if (vxm_rng_below(&rng, 3) > 0)
          add_face(soup, whole->indices + whole->offsets[f], 4);
      vxm_soup_destroy(whole);
    } else
      soup = tangle(*state, &rng, 5 + (size_t)vxm_rng_below(&rng, 10), 40, i % 4 ? 100 : 3);
    int64_t split, stitched;
    assert_int_equal(vxm_cut_nonmanifold(&apart, &split, &stitched, soup, NULL), VXM_OK);
    outcome out = fill(apart, 0);
    filled += out.filled;
    left += out.left;
    drop(apart, out);
    vxm_soup_destroy(apart);
    vxm_soup_destroy(soup);
  }
  assert_true(filled > 2000 && left > 100);
}

static void tags_of_new_faces(void **state) {
  outline o = l_shape();
  turning turn = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  vxm_soup *soup = open_prism(*state, &o, 1, &turn, 0);
  free(o.points);
  tag_faces(soup);
  static const uint32_t tags[7] = {3, 5, 5, 2, 5, 2, 6};
  memcpy(soup->face_tags, tags, sizeof tags);
  outcome out = fill(soup, 0);
  for (size_t f = 0; f < out.soup->face_count; f++)
    assert_int_equal(out.soup->face_tags[f], f < 7 ? tags[f] : 5);
  for (size_t f = 7; f < out.soup->face_count; f++)
    assert_int_equal(tags[out.origin[f]], 5);
  assert_int_equal(out.soup->tag_count, soup->tag_count);
  /* the origin may be left out */
  vxm_soup *plain;
  int64_t filled, left;
  assert_int_equal(openmesh->fill(&plain, NULL, &filled, &left, soup, 0, NULL), VXM_OK);
  assert_same_soup(plain, out.soup);
  vxm_soup_destroy(plain);
  drop(soup, out);
  vxm_soup_destroy(soup);
}

/** Filling beside sheets, whose faces are separated too, leaves all of it manifold for readers that weld. */
static void sheets_beside_a_hole(void **state) {
  outline o = l_shape();
  turning turn = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  vxm_soup *soup = open_prism(*state, &o, 1, &turn, 0);
  free(o.points);
  /* five fins about one edge */
  uint32_t first = (uint32_t)soup->vertex_count;
  add_vertex(soup, 10, 0, 0);
  add_vertex(soup, 10, 0, 1);
  for (uint32_t k = 0; k < 5; k++) {
    add_vertex(soup, 10 + cos(k), sin(k), 0);
    add_triangle(soup, first, first + 1, first + 2 + k);
  }
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.level = VXM_LEVEL_CLOSED;
  options.hole_fill = VXM_HOLE_FILL_MINIMAL;
  options.sheets = VXM_SHEETS_KEEP;
  vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
  vxm_soup *out = repaired(soup, &options, &report);
  assert_int_equal(count_of(&report, "closing"), 4);
  assert_true(report.open_parts > 0);
  weld_positions(out);
  brute_report brute = look_brute(out);
  assert_true(brute.manifold);
  assert_true(brute.boundary_edges >= 11);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

int main(void) {
  if (open_openmesh() != 0)
    return 77;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(edges_that_exist),      cmocka_unit_test(kept_open),
      cmocka_unit_test(sizes_of_holes),        cmocka_unit_test(four_edges),
      cmocka_unit_test(four_edges_bent_alike), cmocka_unit_test(holes_in_tangles),
      cmocka_unit_test(tags_of_new_faces),     cmocka_unit_test(sheets_beside_a_hole),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}

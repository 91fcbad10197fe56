/* SPDX-License-Identifier: BSD-3-Clause */
/** The module for OpenMesh: what it says of soups, and the holes that it fills. */
#include "manifold.h"
#include "outlines.h"
#include "repairing.h"

#include "../mesh/shared.h"
#include "repair/openmesh.h"
#include "repair/separate.h"

#include <pthread.h>
#include <time.h>
#include <unistd.h>

static const vxm_openmesh *openmesh;

/* ---- The second opinion ---- */

/** Closed walks along the boundary of a manifold. */
static int64_t count_holes(const vxm_soup *soup) {
  brute_side *sides = list_brute_sides(soup);
  uint32_t *next = malloc((soup->vertex_count + 1) * sizeof *next);
  assert_non_null(next);
  for (size_t v = 0; v < soup->vertex_count; v++)
    next[v] = UINT32_MAX;
  for (size_t i = 0; i < soup->corner_count; i++) {
    bool before = i > 0 && sides[i - 1].from == sides[i].to && sides[i - 1].to == sides[i].from;
    bool after =
        i + 1 < soup->corner_count && sides[i + 1].from == sides[i].to && sides[i + 1].to == sides[i].from;
    if (!before && !after)
      next[sides[i].to] = sides[i].from;
  }
  int64_t count = 0;
  for (size_t v = 0; v < soup->vertex_count; v++) {
    count += next[v] != UINT32_MAX;
    for (uint32_t at = (uint32_t)v; next[at] != UINT32_MAX;) {
      uint32_t to = next[at];
      next[at] = UINT32_MAX;
      at = to;
    }
  }
  free(next);
  free(sides);
  return count;
}

static vxm_halfedge_report inspected(const vxm_soup *soup) {
  vxm_halfedge_report report;
  vxm_error error = VXM_ERROR_INIT;
  if (openmesh->inspect(&report, soup, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return report;
}

static void check_inspection(const vxm_soup *soup) {
  vxm_halfedge_report report = inspected(soup);
  brute_report brute = look_brute(soup);
  assert_int_equal(report.manifold, brute.manifold);
  assert_int_equal(report.faces + report.rejected, soup->face_count);
  assert_true(brute.complex_edges == 0 || report.rejected > 0);
  if (!brute.manifold)
    return;
  assert_int_equal(report.rejected, 0);
  assert_int_equal(report.boundary_edges, brute.boundary_edges);
  assert_int_equal(report.components, count_components_brute(soup));
  assert_int_equal(report.holes, count_holes(soup));
}

/** Soups of all kinds, and what separating makes of them. */
static void opinions_agree(void **state) {
  vxm_rng rng = {1};
  int manifold = 0;
  for (int i = 0; i < 4000; i++) {
    vxm_soup *soup =
                 tangle(*state, &rng, 4 + (size_t)i % 30, (size_t)vxm_rng_below(&rng, i % 2 ? 8 : 40), 100),
             *apart;
    int64_t split, stitched;
    manifold += look_brute(soup).manifold;
    check_inspection(soup);
    assert_int_equal(vxm_separate(&apart, &split, &stitched, soup, NULL), VXM_OK);
    check_inspection(apart);
    vxm_soup_destroy(apart);
    vxm_soup_destroy(soup);
  }
  assert_true(manifold > 400);
}

static void blocks_are_closed(void **state) {
  vxm_rng rng = {2};
  for (int i = 0; i < 400; i++) {
    uint8_t full[27];
    for (int c = 0; c < 27; c++)
      full[c] = vxm_rng_below(&rng, 2) == 0;
    vxm_soup *soup = cell_surface(*state, 3, full), *mixed = shuffled(soup, &rng, 0, i % 2), *apart;
    int64_t split, stitched;
    check_inspection(mixed);
    assert_int_equal(vxm_separate(&apart, &split, &stitched, mixed, NULL), VXM_OK);
    check_inspection(apart);
    assert_int_equal(inspected(apart).boundary_edges, 0);
    vxm_soup_destroy(apart);
    vxm_soup_destroy(mixed);
    vxm_soup_destroy(soup);
  }
}

/** Anything goes: faces of no, one or two corners, corners twice. */
static void any_soup_is_inspected(void **state) {
  vxm_rng rng = {3};
  for (int i = 0; i < 2000; i++) {
    vxm_soup *soup = random_soup(*state, &rng, 1 + (size_t)vxm_rng_below(&rng, 20), 30, 4, 8);
    vxm_halfedge_report report = inspected(soup);
    int64_t bad = 0;
    for (size_t f = 0; f < soup->face_count; f++) {
      size_t n;
      bool twice = false;
      const uint32_t *corner = vxm_face(soup, f, &n);
      for (size_t c = 0; c < n; c++)
        for (size_t d = 0; d < c; d++)
          twice = twice || corner[c] == corner[d];
      bad += n < 3 || twice;
    }
    assert_true(report.rejected >= bad);
    assert_int_equal(report.faces + report.rejected, soup->face_count);
    vxm_soup_destroy(soup);
  }
}

/** OpenMesh reports what it does not take on stderr, of which users must not see anything. */
static void nothing_is_printed(void **state) {
  char name[] = "/tmp/voxmend-test-XXXXXX";
  int file = mkstemp(name), kept = dup(STDERR_FILENO);
  assert_true(file >= 0 && kept >= 0);
  unlink(name);
  dup2(file, STDERR_FILENO);
  vxm_rng rng = {4};
  vxm_soup *soup = tangle(*state, &rng, 6, 50, 100);
  vxm_halfedge_report report = inspected(soup);
  dup2(kept, STDERR_FILENO);
  close(kept);
  assert_true(report.rejected > 0);
  assert_int_equal(lseek(file, 0, SEEK_END), 0);
  close(file);
  vxm_soup_destroy(soup);
}

static void *inspect_often(void *payload) {
  const vxm_soup *soup = payload;
  vxm_halfedge_report first = inspected(soup);
  for (int i = 0; i < 100; i++) {
    vxm_halfedge_report again = inspected(soup);
    if (memcmp(&first, &again, sizeof first) != 0)
      return payload;
  }
  return NULL;
}

static void from_many_threads(void **state) {
  enum { THREADS = 4 };
  pthread_t threads[THREADS];
  vxm_soup *soups[THREADS];
  vxm_rng rng = {5};
  for (int t = 0; t < THREADS; t++) {
    soups[t] = tangle(*state, &rng, 8, 60, 100);
    assert_int_equal(pthread_create(&threads[t], NULL, inspect_often, soups[t]), 0);
  }
  for (int t = 0; t < THREADS; t++) {
    void *wrong;
    pthread_join(threads[t], &wrong);
    assert_null(wrong);
    vxm_soup_destroy(soups[t]);
  }
}

/* ---- Holes ---- */

typedef struct outcome {
  vxm_soup *soup;
  uint64_t *origin;
  int64_t filled, left;
} outcome;

/** Fills, and checks what has to hold of any manifold. */
static outcome fill(const vxm_soup *soup, size_t max_edges) {
  outcome out;
  vxm_error error = VXM_ERROR_INIT;
  vxm_halfedge_report before = inspected(soup);
  if (openmesh->fill(&out.soup, &out.origin, &out.filled, &out.left, soup, max_edges, &error) != VXM_OK)
    fail_msg("%s", error.text);
  vxm_halfedge_report after = inspected(out.soup);
  assert_true(look_brute(out.soup).manifold && after.manifold);
  assert_true(max_edges > 0 || out.left >= after.holes);
  assert_int_equal(after.components, before.components);
  /* what was there is there as it was, at most on another vertex at the same position */
  assert_int_equal(out.soup->vertex_count, soup->vertex_count);
  assert_memory_equal(out.soup->positions, soup->positions, 24 * soup->vertex_count);
  assert_memory_equal(out.soup->offsets, soup->offsets, 8 * (soup->face_count + 1));
  for (size_t c = 0; c < soup->corner_count; c++)
    for (int a = 0; a < 3; a++)
      assert_true(vxm_position(soup, soup->indices[c])[a] == vxm_position(out.soup, out.soup->indices[c])[a]);
  for (size_t f = 0; f < out.soup->face_count; f++)
    assert_true(f < soup->face_count ? out.origin[f] == f : out.origin[f] < soup->face_count);
  /* a hole of n edges takes n - 2 triangles */
  size_t made = out.soup->face_count - soup->face_count;
  assert_int_equal(made, before.boundary_edges - after.boundary_edges - 2 * out.filled);
  assert_int_equal(out.soup->corner_count, soup->corner_count + 3 * made);
  return out;
}

static void drop(const vxm_soup *soup, outcome out) {
  vxm_free(soup->context, out.origin);
  vxm_soup_destroy(out.soup);
}

/** The areas of faces from a number on: of each its size, and all together as vectors. */
static void areas_from(const vxm_soup *soup, size_t first, double *sum, double *of_sum) {
  double total[3] = {0, 0, 0};
  *sum = 0;
  for (size_t f = first; f < soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n);
    const double *a = vxm_position(soup, corner[0]), *b = vxm_position(soup, corner[1]);
    const double *c = vxm_position(soup, corner[2]);
    double area[3];
    for (int i = 0; i < 3; i++) {
      int j = (i + 1) % 3, k = (i + 2) % 3;
      area[i] = ((b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j])) / 2;
      total[i] += area[i];
    }
    *sum += sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
  }
  *of_sum = sqrt(total[0] * total[0] + total[1] * total[1] + total[2] * total[2]);
}

/** Fills the open end of a prism over the outline: flat, covered once, closed. */
static void check_outline(vxm_context *context, outline o, vxm_rng *rng, double shift) {
  turning turn = random_turning(rng);
  double height = 0.5 + vxm_rng_unit(rng), area = outline_area(&o), sum, of_sum;
  vxm_soup *soup = open_prism(context, &o, height, &turn, shift);
  outcome out = fill(soup, 0);
  assert_int_equal(out.filled, 1);
  areas_from(out.soup, soup->face_count, &sum, &of_sum);
  double exact = 1e-9 * (1 + shift);
  if (fabs(sum / area - 1) > exact || fabs(of_sum / area - 1) > exact)
    fail_msg("%zu edges: area %.12g, faces %.12g, together %.12g", o.count, area, sum, of_sum);
  drop(soup, out);
  vxm_soup_destroy(soup);
  free(o.points);
}

static void flat_holes(void **state) {
  vxm_rng rng = {6};
  for (int i = 0; i < 20; i++) {
    check_outline(*state, l_shape(), &rng, i % 2 ? 1000 : 0);
    check_outline(*state, comb(1 + (size_t)i), &rng, 0);
    check_outline(*state, spiral(4 + 4 * (size_t)i, 0.5 + 0.2 * i), &rng, 0);
    check_outline(*state, star(&rng, 3 + 5 * (size_t)i, 0.9), &rng, 0);
  }
  for (int i = 0; i < 150; i++)
    check_outline(*state, cells_outline(&rng, 2 + (size_t)vxm_rng_below(&rng, 60)), &rng, i % 2 ? 1000 : 0);
}

/** Rims that are cut before they are filled. */
static void long_flat_holes(void **state) {
  vxm_rng rng = {7};
  check_outline(*state, star(&rng, 1500, 0), &rng, 0);
  check_outline(*state, star(&rng, 1200, 0.5), &rng, 0);
  check_outline(*state, comb(200), &rng, 0);
  check_outline(*state, spiral(600, 3), &rng, 0);
  check_outline(*state, cells_outline(&rng, 350), &rng, 0);
}

/** A sheet with holes in it: they are filled in its plane, its own rim is left. */
static void holes_in_a_sheet(void **state) {
  vxm_rng rng = {8};
  for (int i = 0; i < 60; i++) {
    size_t n = 8 + (size_t)vxm_rng_below(&rng, 8);
    vxm_soup *whole = grid_sheet(*state, n), *soup = new_soup(*state), *apart;
    for (size_t v = 0; v < whole->vertex_count; v++) {
      const double *p = vxm_position(whole, v);
      add_vertex(soup, p[0], p[1], p[2]);
    }
    for (size_t f = 0; f < whole->face_count; f++) {
      size_t count, column = f / 2 % n, row = f / 2 / n;
      const uint32_t *face = vxm_face(whole, f, &count);
      bool inside = column > 0 && row > 0 && column + 1 < n && row + 1 < n;
      if (!inside || vxm_rng_unit(&rng) > 0.25)
        add_face(soup, face, count);
    }
    int64_t split, stitched;
    assert_int_equal(vxm_separate(&apart, &split, &stitched, soup, NULL), VXM_OK);
    outcome out = fill(apart, 0);
    double sum, of_sum;
    areas_from(out.soup, 0, &sum, &of_sum);
    if (inspected(apart).components == 1)
      assert_true(fabs(sum - (double)(n * n)) < 1e-9);
    assert_true(fabs(sum - of_sum) < 1e-9);
    drop(apart, out);
    vxm_soup_destroy(apart);
    vxm_soup_destroy(soup);
    vxm_soup_destroy(whole);
  }
}

/** A sphere with faces missing is closed again, with nearly its volume. */
static void holes_in_a_sphere(void **state) {
  vxm_rng rng = {9};
  for (int i = 0; i < 60; i++) {
    enum { RINGS = 24, AROUND = 48 };
    vxm_soup *soup = new_soup(*state), *apart;
    add_vertex(soup, 0, 0, 1);
    for (int j = 1; j < RINGS; j++)
      for (int k = 0; k < AROUND; k++)
        add_vertex(soup, sin(M_PI * j / RINGS) * cos(2 * M_PI * k / AROUND),
                   sin(M_PI * j / RINGS) * sin(2 * M_PI * k / AROUND), cos(M_PI * j / RINGS));
    add_vertex(soup, 0, 0, -1);
    double missing = 0.15 * vxm_rng_unit(&rng);
    for (uint32_t j = 0; j < RINGS; j++)
      for (uint32_t k = 0; k < AROUND; k++) {
        uint32_t next = (k + 1) % AROUND, up = 1 + (j - 1) * AROUND, down = 1 + j * AROUND;
        uint32_t quad[4] = {up + k, down + k, down + next, up + next};
        if (vxm_rng_unit(&rng) < missing)
          continue;
        if (j == 0)
          add_triangle(soup, 0, down + k, down + next);
        else if (j == RINGS - 1)
          add_triangle(soup, up + k, (RINGS - 1) * AROUND + 1, up + next);
        else
          add_face(soup, quad, 4);
      }
    int64_t split, stitched;
    assert_int_equal(vxm_separate(&apart, &split, &stitched, soup, NULL), VXM_OK);
    outcome out = fill(apart, 0);
    if (inspected(apart).components == 1) {
      assert_int_equal(out.left, 0);
      assert_true(fabs(volume_of(out.soup) / (4 * M_PI / 3) - 1) < 0.05);
    }
    drop(apart, out);
    vxm_soup_destroy(apart);
    vxm_soup_destroy(soup);
  }
}

/** Tubes: both ends are filled, however short the tube and however wavy and long its ends. */
static void ends_of_tubes(void **state) {
  for (int i = 0; i < 6; i++) {
    uint32_t n = i < 4 ? 40 : 700;
    double height = i % 2 ? 0.05 : 5, waves = i < 2 ? 0 : 0.4;
    vxm_soup *soup = new_soup(*state);
    for (uint32_t k = 0; k < 2 * n; k++) {
      double angle = 2 * M_PI * k / n;
      add_vertex(soup, cos(angle), sin(angle), (k < n ? 0 : height) + waves * sin(5 * angle));
    }
    for (uint32_t k = 0; k < n; k++) {
      uint32_t next = (k + 1) % n, wall[4] = {k, next, n + next, n + k};
      add_face(soup, wall, 4);
    }
    outcome out = fill(soup, 0);
    assert_int_equal(out.filled, 2);
    /* a wavy end has fillings above and below its middle */
    assert_true(fabs(volume_of(out.soup) - M_PI * height) < 0.02 * M_PI * height + 6 * waves);
    drop(soup, out);
    vxm_soup_destroy(soup);
  }
}

/* ---- What is not filled, and how ---- */

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
    assert_int_equal(vxm_separate(&apart, &split, &stitched, soup, NULL), VXM_OK);
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
  options.fill = VXM_FILL_MINIMAL;
  vxm_repair_report report;
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

/* ---- Failures ---- */

static void must_be_manifold(void **state) {
  static const uint8_t full[8] = {1, 0, 0, 1, 0, 0, 0, 1};
  vxm_soup *soup = cell_surface(*state, 2, full), *out;
  uint64_t *origin;
  int64_t filled, left;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(openmesh->fill(&out, &origin, &filled, &left, soup, 0, &error), VXM_ERROR_ARGUMENT);
  assert_null(out);
  assert_null(origin);
  assert_non_null(strstr(error.text, "separate"));
  vxm_soup_destroy(soup);
}

static int cancel_at(const char *phase, double fraction, void *payload) {
  (void)phase, (void)fraction;
  return --*(int *)payload < 0;
}

static void failures(void **state) {
  (void)state;
  int done = 0, refused = 0, cancelled = 0;
  for (int round = 0; round < 48; round++) {
    int steps = round / 2;
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = 1;
    if (round % 2) {
      options.progress = cancel_at;
      options.payload = &steps;
    } else
      options.memory_limit = 50000 + 60000 * (uint64_t)round;
    vxm_context *context;
    assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
    vxm_soup *soup = new_soup(context), *out;
    uint32_t n = 510;
    vxm_status status = vxm_soup_reserve(soup, 2 * n, n, 4 * n, NULL);
    for (uint32_t k = 0; k < 2 * n && status == VXM_OK; k++)
      add_vertex(soup, cos(2 * M_PI * k / n), sin(2 * M_PI * k / n), k < n ? 0 : 3);
    for (uint32_t k = 0; k < n && status == VXM_OK; k++) {
      uint32_t wall[4] = {k, (k + 1) % n, n + (k + 1) % n, n + k};
      add_face(soup, wall, 4);
    }
    if (status == VXM_OK) {
      uint64_t *origin;
      int64_t filled, left;
      vxm_halfedge_report report;
      vxm_error error = VXM_ERROR_INIT;
      status = openmesh->inspect(&report, soup, &error);
      if (status == VXM_OK)
        status = openmesh->fill(&out, &origin, &filled, &left, soup, 0, &error);
      else
        out = NULL, origin = NULL;
      assert_true(status == VXM_OK || status == (round % 2 ? VXM_ERROR_CANCELLED : VXM_ERROR_MEMORY_LIMIT));
      assert_int_equal(out == NULL, status != VXM_OK);
      assert_int_equal(origin == NULL, status != VXM_OK);
      assert_true(status == VXM_OK || error.text[0] != '\0');
      done += status == VXM_OK;
      cancelled += status == VXM_ERROR_CANCELLED;
      refused += status == VXM_ERROR_MEMORY_LIMIT;
      vxm_free(context, origin);
      vxm_soup_destroy(out);
    }
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
  }
  assert_true(done > 0 && refused > 0 && cancelled > 0);
}

/* ---- Real meshes ---- */

static void shared_mesh_is_filled(const shared_mesh *mesh, void *payload) {
  vxm_soup *soup = read_soup(payload, mesh->path), *clean = NULL, *apart = NULL;
  vxm_error error = VXM_ERROR_INIT;
  if (soup->face_count < 8000) {
    int64_t split, stitched;
    if (vxm_repair_run(&clean, NULL, soup, NULL, &error) != VXM_OK ||
        vxm_separate(&apart, &split, &stitched, clean, &error) != VXM_OK)
      fail_msg("%s: %s", mesh->path, error.text);
    drop(apart, fill(apart, 100));
    vxm_soup_destroy(apart);
    vxm_soup_destroy(clean);
  }
  vxm_soup_destroy(soup);
}

static void shared_meshes(void **state) {
  if (for_each_shared_mesh(shared_mesh_is_filled, *state) == 0)
    skip();
}

static int make_context(void **state) {
  *state = context_of_threads(2);
  return 0;
}

static int drop_context(void **state) {
  vxm_context_destroy(*state);
  return 0;
}

int main(void) {
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_openmesh_open(&openmesh, "this test", &error) != VXM_OK) {
    fprintf(stderr, "%s\n", error.text);
    return 77;
  }
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(opinions_agree),        cmocka_unit_test(blocks_are_closed),
      cmocka_unit_test(any_soup_is_inspected), cmocka_unit_test(nothing_is_printed),
      cmocka_unit_test(from_many_threads),     cmocka_unit_test(flat_holes),
      cmocka_unit_test(long_flat_holes),       cmocka_unit_test(holes_in_a_sheet),
      cmocka_unit_test(holes_in_a_sphere),     cmocka_unit_test(ends_of_tubes),
      cmocka_unit_test(edges_that_exist),      cmocka_unit_test(kept_open),
      cmocka_unit_test(sizes_of_holes),        cmocka_unit_test(four_edges),
      cmocka_unit_test(four_edges_bent_alike), cmocka_unit_test(holes_in_tangles),
      cmocka_unit_test(tags_of_new_faces),     cmocka_unit_test(sheets_beside_a_hole),
      cmocka_unit_test(must_be_manifold),      cmocka_unit_test(failures),
      cmocka_unit_test(shared_meshes),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}

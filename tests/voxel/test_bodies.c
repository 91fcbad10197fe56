/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Bodies that are doubled, share faces, touch, nest or are turned over: the solid after the repair is the
 * union of the bodies, cell by cell. Bodies are sets of unit cells, so faces that lie on each other are
 * equal, and which cells are inside is known without any geometry. Two more have holes, and are not of cells.
 */
#include "cells.h"

#include "base/context_struct.h"

enum { BODIES_MAX = 5 };

static bool overlaps(const bool *others, const body *b) {
  for (size_t c = 0; c < CELLS; c++)
    if (others[c] && b->cells[c])
      return true;
  return false;
}

/**
 * Random bodies; `wanted` becomes their union. Those turned over overlap no others: of a body that runs into
 * another one with the opposite orientation nobody can tell whether it is cut out of that.
 */
static vxm_soup *random_bodies(vxm_context *context, vxm_rng *rng, const manner *how, body bodies[BODIES_MAX],
                               size_t *count, bool wanted[CELLS]) {
  vxm_soup *soup = new_soup(context);
  *count = 1 + (size_t)vxm_rng_below(rng, BODIES_MAX);
  memset(bodies, 0, BODIES_MAX * sizeof *bodies);
  memset(wanted, 0, CELLS * sizeof *wanted);
  for (size_t i = 0; i < *count; i++) {
    body *b = &bodies[i];
    add_random_box(b, rng);
    if (vxm_rng_below(rng, 4) == 0)
      add_random_box(b, rng);
    b->copies = vxm_rng_below(rng, 3) == 0 ? 2 : 1;
    b->turned = vxm_rng_below(rng, 4) == 0;
    for (size_t c = 0; c < CELLS; c++)
      wanted[c] = wanted[c] || b->cells[c];
  }
  for (size_t i = 0; i < *count; i++) {
    bool others[CELLS] = {false};
    for (size_t j = 0; j < *count; j++)
      for (size_t c = 0; c < CELLS && j != i; c++)
        others[c] = others[c] || bodies[j].cells[c];
    bodies[i].turned = bodies[i].turned && !overlaps(others, &bodies[i]);
    for (int copy = 0; copy < bodies[i].copies; copy++)
      add_body(soup, &bodies[i], how, rng);
  }
  return soup;
}

static void describe(const body *bodies, size_t count) {
  for (size_t i = 0; i < count; i++) {
    fprintf(stderr, "body %zu: %d copies%s:", i, bodies[i].copies, bodies[i].turned ? ", turned over" : "");
    for (size_t c = 0; c < CELLS; c++)
      if (bodies[i].cells[c])
        fprintf(stderr, " %zu%zu%zu", c % SIDE, c / SIDE % SIDE, c / SIDE / SIDE);
    fputc('\n', stderr);
  }
}

/** @param by_file the mesh is cleaned before, as a file that was repaired is read again */
static void assert_union(vxm_context *context, uint64_t seed, const manner *how, bool by_file) {
  vxm_rng rng = {seed};
  body bodies[BODIES_MAX];
  size_t count;
  bool wanted[CELLS];
  vxm_soup *soup = random_bodies(context, &rng, how, bodies, &count, wanted), *prepared;
  if (by_file) {
    vxm_soup *clean;
    vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
    assert_int_equal(vxm_repair_run(&clean, &report, soup, NULL, NULL), VXM_OK);
    assert_int_equal(report.lost_parts, 0);

    vxm_soup_destroy(soup);
    soup = clean;
  }
  assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
  int wrong = count_wrong(prepared, how, wanted);
  if (wrong > 0) {
    describe(bodies, count);
    fail_msg("seed %llu: %d voxels are wrong", (unsigned long long)seed, wrong);
  }
  vxm_soup_destroy(prepared);
  vxm_soup_destroy(soup);
}

static void solids_stay(void **state) {
  for (uint64_t seed = 1; seed <= rounds_of(800); seed++)
    assert_union(*state, seed, &squares, seed % 3 == 0);
}

/** Skins that lie on each other are triangulated in different ways. */
static void solids_stay_in_triangles(void **state) {
  manner how = squares;
  how.triangles = true;
  for (uint64_t seed = 1; seed <= rounds_of(800); seed++)
    assert_union(*state, seed, &how, seed % 3 == 0);
}

static void solids_stay_in_any_direction(void **state) {
  for (uint64_t seed = 1; seed <= rounds_of(120); seed++) {
    vxm_rng rng = {~seed};
    double angle[2] = {7 * vxm_rng_unit(&rng), 7 * vxm_rng_unit(&rng)};
    double c = cos(angle[0]), s = sin(angle[0]), d = cos(angle[1]), t = sin(angle[1]);
    manner how = {.turn = {{c, -s * d, s * t}, {s, c * d, -c * t}, {0, t, d}}, .unit = 1};
    assert_union(*state, seed, &how, seed % 3 == 0);
  }
}

/* ---- Boxes of six large faces ---- */

/** Adds a box as it is: its faces lie on those of others in part, and share corners with some. */
static void add_whole_box(vxm_soup *soup, const int low[3], const int high[3], bool triangles, vxm_rng *rng) {
  for (int side = 0; side < 6; side++) {
    int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    uint32_t first = (uint32_t)soup->vertex_count, face[4];
    for (int c = 0; c < 4; c++) {
      int p[3];
      p[axis] = side % 2 ? high[axis] : low[axis];
      p[u] = c == 1 || c == 2 ? high[u] : low[u];
      p[v] = c >= 2 ? high[v] : low[v];
      add_vertex(soup, p[0], p[1], p[2]);
      face[side % 2 ? c : 3 - c] = first + (uint32_t)c;
    }
    size_t cut = (size_t)vxm_rng_below(rng, 2);
    if (!triangles) {
      add_face(soup, face, 4);
      continue;
    }
    add_triangle(soup, face[cut], face[cut + 1], face[cut + 2]);
    add_triangle(soup, face[cut], face[cut + 2], face[(cut + 3) % 4]);
  }
}

/** Boxes in so few cells that most have corners, edges and parts of faces in common, all outward. */
static void assert_boxes(vxm_context *context, uint64_t seed) {
  enum { BOXES_MAX = 8 };
  vxm_rng rng = {seed};
  bool wanted[CELLS] = {false}, triangles = vxm_rng_below(&rng, 2) == 0;
  uint64_t width = 2 + vxm_rng_below(&rng, 4), count = 2 + vxm_rng_below(&rng, BOXES_MAX - 1);
  vxm_soup *soup = new_soup(context), *prepared;
  for (uint64_t i = 0; i < count; i++) {
    int low[3], high[3];
    for (int a = 0; a < 3; a++) {
      low[a] = (int)vxm_rng_below(&rng, width);
      high[a] = low[a] + 1 + (int)vxm_rng_below(&rng, width - (uint64_t)low[a]);
    }
    add_whole_box(soup, low, high, triangles, &rng);
    for (int z = low[2]; z < high[2]; z++)
      for (int y = low[1]; y < high[1]; y++)
        for (int x = low[0]; x < high[0]; x++)
          wanted[cell_at(x, y, z)] = true;
  }
  assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
  int wrong = count_wrong(prepared, &squares, wanted);
  if (wrong > 0)
    fail_msg("seed %llu: %d voxels are wrong", (unsigned long long)seed, wrong);
  vxm_soup_destroy(prepared);
  vxm_soup_destroy(soup);
}

static void boxes_stay(void **state) {
  for (uint64_t seed = 1; seed <= rounds_of(2000); seed++)
    assert_boxes(*state, seed);
}

/* ---- Many bodies ---- */

static int count_question(const char *phase, double fraction, void *payload) {
  (void)phase, (void)fraction;
  ++*(int *)payload;
  return 0;
}

/** A column of boxes, each second one turned over: every ray along it meets all of them, which takes a while.
 */
static void rays_ask_whether_to_go_on(void **state) {
  (void)state;
  enum { BOXES = 600 };
  int asked = 0;
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.progress = count_question;
  options.payload = &asked;
  options.threads = 1;
  vxm_context *context = NULL;
  assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
  context->ask_ms = 0;
  vxm_soup *soup = new_soup(context), *prepared;
  vxm_rng rng = {1};
  for (int z = 0; z < BOXES; z++)
    for (int side = 0; side < 6; side++) {
      int corner[3] = {0, 0, z}, axis = side / 2, up = side % 2;
      corner[axis] += up;
      add_square(soup, &squares, corner, axis, (up == 1) != (z % 2 == 1), &rng);
    }
  assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
  assert_true(asked > 500);
  vxm_soup_destroy(prepared);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

/* ---- Bodies with holes ---- */

/** A cube of side 4 without one of its squares. */
static void add_open_cube(vxm_soup *soup) {
  static const uint32_t square[][4] = {{2, 6, 7, 3}, {4, 5, 7, 6}, {0, 2, 3, 1}, {0, 1, 5, 4}, {1, 3, 7, 5}};
  uint32_t first = (uint32_t)soup->vertex_count;
  for (int i = 0; i < 8; i++)
    add_vertex(soup, i & 1 ? 4 : 0, i & 2 ? 4 : 0, i & 4 ? 4 : 0);
  for (size_t f = 0; f < sizeof square / sizeof *square; f++) {
    uint32_t face[4];
    for (size_t c = 0; c < 4; c++)
      face[c] = first + square[f][c];
    add_face(soup, face, 4);
  }
}

/** An octahedron of radius 2 without one of its triangles; its top is a corner of that cube. */
static void add_open_octahedron(vxm_soup *soup) {
  uint32_t first = (uint32_t)soup->vertex_count, bottom = first + 4, top = first + 5;
  static const double ring[4][2] = {{2, 0}, {0, 2}, {-2, 0}, {0, -2}};
  for (int i = 0; i < 4; i++)
    add_vertex(soup, 4 + ring[i][0], 4 + ring[i][1], 2);
  add_vertex(soup, 4, 4, 0);
  add_vertex(soup, 4, 4, 4);
  for (uint32_t i = 0; i < 4; i++) {
    uint32_t a = first + i, b = first + (i + 1) % 4;
    add_triangle(soup, a, b, top);
    if (i > 0)
      add_triangle(soup, b, a, bottom);
  }
}

/** Both have holes elsewhere, so neither is closed; together they are what either covers all the same. */
static void bodies_with_holes_touch(void **state) {
  enum { FINE = 25 };
  vxm_soup *soup = new_soup(*state);
  add_open_cube(soup);
  add_open_octahedron(soup);
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.thin = VXM_THIN_DROP;
  vxm_space space = {
      .dims = {FINE, FINE, FINE}, .voxel_size = {0.27, 0.27, 0.27}, .origin = {-0.123, -0.127, -0.131}};
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.like = &space;
  vxm_soup *prepared;
  assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
  vxm_grid *grid;
  assert_int_equal(vxm_voxelize(&grid, NULL, prepared, &space_options, &options, NULL), VXM_OK);
  for (int64_t z = 0; z < FINE; z++)
    for (int64_t y = 0; y < FINE; y++)
      for (int64_t x = 0; x < FINE; x++) {
        const int64_t at[3] = {x, y, z};
        double p[3];
        bool in_cube = true;
        for (int a = 0; a < 3; a++) {
          p[a] = space.origin[a] + ((double)at[a] + 0.5) * space.voxel_size[a];
          in_cube = in_cube && p[a] > 0 && p[a] < 4;
        }
        double beyond = fabs(p[0] - 4) + fabs(p[1] - 4) + fabs(p[2] - 2) - 2;
        if (fabs(beyond) > 1e-9 && vxm_grid_get(grid, x, y, z) != (in_cube || beyond < 0))
          fail_msg("the voxel at %g %g %g is wrong", p[0], p[1], p[2]);
      }
  vxm_grid_destroy(grid);
  vxm_soup_destroy(prepared);
  vxm_soup_destroy(soup);
}

/** Patches that meet with their rims at a vertex may be one surface with slits. */
static void patches_stay_together(void **state) {
  vxm_soup *soup = new_soup(*state);
  for (int i = 0; i < 5; i++)
    add_vertex(soup, i == 0 ? 0 : i < 3 ? 1 : -1, i % 2, i > 2);
  add_triangle(soup, 0, 1, 2);
  add_triangle(soup, 0, 3, 4);
  vxm_soup *prepared;
  assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
  assert_int_equal(prepared->vertex_count, 5);
  vxm_soup_destroy(prepared);
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(solids_stay),
                                     cmocka_unit_test(solids_stay_in_triangles),
                                     cmocka_unit_test(solids_stay_in_any_direction),
                                     cmocka_unit_test(boxes_stay),
                                     cmocka_unit_test(bodies_with_holes_touch),
                                     cmocka_unit_test(patches_stay_together),
                                     cmocka_unit_test(rays_ask_whether_to_go_on)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}

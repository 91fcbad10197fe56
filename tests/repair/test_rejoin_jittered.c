/* SPDX-License-Identifier: BSD-3-Clause */
/** Soups of which every triangle was moved by itself, farther than rounding moves it. */
#include "repair_test.h"

#include "../mesh/shared.h"

#include <math.h>

/** Every triangle on its own vertices, each moved by `distance` in a random direction. */
static vxm_soup *torn(const vxm_soup *soup, double distance, double removed, double doubled, uint64_t seed) {
  vxm_soup *out = new_soup(soup->context);
  vxm_rng rng = {seed};
  for (size_t f = 0; f < soup->face_count; f++) {
    if (vxm_rng_unit(&rng) < removed)
      continue;
    int copies = vxm_rng_unit(&rng) < doubled ? 2 : 1;
    for (int copy = 0; copy < copies; copy++) {
      uint32_t corners[3];
      for (int i = 0; i < 3; i++) {
        const double *p = vxm_position(soup, soup->indices[3 * f + (size_t)(copy ? 2 - i : i)]);
        double d[3], length;
        do {
          length = 0;
          for (int a = 0; a < 3; a++) {
            d[a] = 2 * vxm_rng_unit(&rng) - 1;
            length += d[a] * d[a];
          }
        } while (length > 1 || length < 1e-6);
        corners[i] = (uint32_t)out->vertex_count;
        for (int a = 0; a < 3; a++)
          d[a] = p[a] + d[a] / sqrt(length) * distance;
        add_vertex(out, d[0], d[1], d[2]);
      }
      add_face(out, corners, 3);
    }
  }
  return out;
}

static double diagonal_of(const vxm_census *census) {
  double sum = 0;
  for (int a = 0; a < 3; a++)
    sum += (census->bounds[a + 3] - census->bounds[a]) * (census->bounds[a + 3] - census->bounds[a]);
  return sqrt(sum);
}

/** A torus of triangles with edges of some 3 % of the diagonal. */
static vxm_soup *torus(vxm_context *context, uint32_t around, uint32_t across) {
  vxm_soup *soup = new_soup(context);
  for (uint32_t i = 0; i < around; i++)
    for (uint32_t j = 0; j < across; j++) {
      double u = 2 * M_PI * i / around, v = 2 * M_PI * j / across;
      add_vertex(soup, (2 + cos(v)) * cos(u), (2 + cos(v)) * sin(u), sin(v));
    }
  for (uint32_t i = 0; i < around; i++)
    for (uint32_t j = 0; j < across; j++) {
      uint32_t a = i * across + j, b = (i + 1) % around * across + j;
      uint32_t c = (i + 1) % around * across + (j + 1) % across, d = i * across + (j + 1) % across;
      add_triangle(soup, a, b, c);
      add_triangle(soup, a, c, d);
    }
  return soup;
}

/** Each vertex of the result stands for vertices of a box no wider than the bound, and no face is lost. */
static void check_groups(const vxm_soup *in, const vxm_soup *out, double bound) {
  assert_int_equal(in->face_count, out->face_count);
  for (size_t f = 0; f < out->face_count; f++) {
    size_t count;
    const uint32_t *to = vxm_face(out, f, &count), *from = vxm_face(in, f, &count);
    assert_true(to[0] != to[1] && to[1] != to[2] && to[2] != to[0]);
    for (size_t i = 0; i < count; i++)
      assert_true(distance_between(vxm_position(in, from[i]), vxm_position(out, to[i])) <= bound);
  }
}

static void torn_torus_closes(void **state) {
  vxm_soup *whole = torus(*state, 60, 30);
  static const double parts[] = {1e-5, 3e-5, 1e-4, 1.4e-4};
  for (int i = 0; i < 4; i++) {
    vxm_soup *soup = torn(whole, parts[i] * sqrt(76), 0, 0, 5);
    REPAIR_REPORT(report);
    vxm_soup *out = repaired(soup, NULL, &report);
    assert_int_equal(report.before->boundary_edges, 3 * whole->face_count);
    assert_true(report.after->watertight);
    assert_int_equal(report.after->inconsistent_edges, 0);
    assert_int_equal(out->vertex_count, whole->vertex_count);
    check_groups(soup, out, 5e-4 * diagonal_of(report.before));
    assert_repair_is_done(out, NULL);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
  vxm_soup_destroy(whole);
}

/** With faces doubled and removed, what is left open is the rims of the holes. */
static void doubled_and_removed(void **state) {
  vxm_soup *whole = torus(*state, 60, 30);
  vxm_soup *soup = torn(whole, 1e-4 * sqrt(76), 0.01, 0.2, 3);
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(soup, NULL, &report);
  int64_t holes = (int64_t)whole->face_count - (int64_t)out->face_count;
  assert_true(holes > 0 && holes < 60);
  assert_true(report.after->boundary_edges <= 3 * holes);
  assert_int_equal(report.after->nonmanifold_edges, 0);
  assert_repair_is_done(out, NULL);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
  vxm_soup_destroy(whole);
}

static void expect_untouched(vxm_soup *soup) {
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(soup, NULL, &report);
  assert_int_equal(count_of(&report, "tolerant_weld"), 0);
  assert_int_equal(out->face_count, soup->face_count);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

/** Two faces, or sheets, closer than torn edges are: each is meant. */
static void thin_pairs_of_sheets_stay_two(void **state) {
  static const double positions[8][3] = {{0, 0, 0},    {1, 0, 0},    {1, 1, 0},    {0, 1, 0},
                                         {0, 0, 1e-4}, {1, 0, 1e-4}, {1, 1, 1e-4}, {0, 1, 1e-4}};
  static const int faces[] = {0, 1, 2, 3, -1, 4, 5, 6, 7, -1};
  expect_untouched(soup_of(*state, positions, 8, faces, 2));
  /* many loose sheets of paper, stacked */
  vxm_soup *stack = new_soup(*state);
  for (uint32_t i = 0; i < 100; i++) {
    double z = 1e-4 * i;
    add_vertex(stack, 0, 0, z);
    add_vertex(stack, 1, 0, z);
    add_vertex(stack, 1, 1.4, z);
    add_vertex(stack, 0, 1.4, z);
    add_face(stack, (uint32_t[]){4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3}, 4);
  }
  expect_untouched(stack);
  /* two grids of triangles above each other have too few boundary edges */
  vxm_soup *grid = grid_sheet(*state, 12);
  uint32_t first = (uint32_t)grid->vertex_count;
  size_t count = grid->face_count;
  for (uint32_t v = 0; v < first; v++)
    add_vertex(grid, vxm_position(grid, v)[0], vxm_position(grid, v)[1], 1e-3);
  for (size_t f = 0; f < count; f++)
    add_triangle(grid, grid->indices[3 * f] + first, grid->indices[3 * f + 1] + first,
                 grid->indices[3 * f + 2] + first);
  expect_untouched(grid);
}

/** Panels with a gap between them: most of their edges have no mate. */
static void tiles_with_gaps_stay_apart(void **state) {
  vxm_soup *soup = new_soup(*state);
  for (uint32_t i = 0; i < 6; i++) {
    double x = i * (1 + 1e-4);
    add_vertex(soup, x, 0, 0);
    add_vertex(soup, x + 1, 0, 0);
    add_vertex(soup, x + 1, 5, 0);
    add_vertex(soup, x, 5, 0);
    add_face(soup, (uint32_t[]){4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3}, 4);
  }
  expect_untouched(soup);
}

/** Everything within reach of everything: quick, and no face is lost. */
static void crowds(void **state) {
  vxm_rng rng = {1};
  for (int round = 0; round < 6; round++) {
    vxm_soup *soup = new_soup(*state);
    double size = round < 3 ? 1e-4 : 1e-3;
    for (uint32_t f = 0; f < 20000; f++) {
      for (int i = 0; i < 3; i++)
        add_vertex(soup, size * vxm_rng_unit(&rng), size * vxm_rng_unit(&rng), size * vxm_rng_unit(&rng));
      add_triangle(soup, 3 * f, 3 * f + 1, 3 * f + 2);
    }
    uint32_t far = (uint32_t)soup->vertex_count;
    add_vertex(soup, 1, 0, 0);
    add_vertex(soup, 0, 1, 0);
    add_vertex(soup, 0, 0, 1);
    add_triangle(soup, far, far + 1, far + 2);
    vxm_soup *out = repaired(soup, NULL, NULL);
    assert_true(out->face_count <= soup->face_count);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

static void same_for_any_threads(void **state) {
  (void)state;
  vxm_soup *first = NULL;
  for (int threads = 1; threads <= 5; threads += 2) {
    vxm_context *context = context_of_threads(threads);
    vxm_soup *whole = torus(context, 80, 40), *soup = torn(whole, 1.2e-4 * sqrt(76), 0.02, 0.1, 8);
    vxm_soup *out = repaired(soup, NULL, NULL);
    if (first)
      assert_same_soup(first, out);
    else
      assert_int_equal(vxm_soup_copy(&first, out, NULL), VXM_OK);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
    vxm_soup_destroy(whole);
    vxm_context_destroy(context);
  }
  vxm_soup_destroy(first);
}

static void tear_real_mesh(const shared_mesh *mesh, void *payload) {
  static const char *const names[] = {"classic/cgal-armadillo.off", "classic/common3d-cow.obj",
                                      "classic/libigl-fertility.off", "cad/cgal-rotor_small.off"};
  bool listed = false;
  for (int i = 0; i < 4; i++)
    listed |= strcmp(mesh->values[0], names[i]) == 0;
  if (!listed)
    return;
  vxm_soup *soup = read_soup(payload, mesh->path);
  REPAIR_REPORT(report);
  vxm_soup *clean = repaired(soup, NULL, &report);
  assert_true(report.after->watertight);
  for (size_t f = 0; f < clean->face_count; f++)
    assert_int_equal(clean->offsets[f], 3 * f);
  vxm_soup *apart = torn(clean, 1e-4 * diagonal_of(report.after), 0, 0, 1);
  vxm_soup *out = repaired(apart, NULL, &report);
  print_message("%s: %lld of %lld boundary edges are left\n", mesh->values[0],
                (long long)report.after->boundary_edges, (long long)report.before->boundary_edges);
  assert_true(1000 * report.after->boundary_edges <= report.before->boundary_edges);
  assert_int_equal(out->face_count, clean->face_count);
  assert_repair_is_done(out, NULL);
  vxm_soup_destroy(out);
  vxm_soup_destroy(apart);
  vxm_soup_destroy(clean);
  vxm_soup_destroy(soup);
}

static void torn_real_meshes(void **state) {
  if (for_each_shared_mesh(tear_real_mesh, *state) == 0)
    skip();
}

static void memory_may_run_out(void **state) {
  vxm_soup *whole = torus(*state, 20, 10), *soup = torn(whole, 1e-4 * sqrt(76), 0, 0, 1);
  bool passed = false;
  for (uint64_t limit = 200000; !passed; limit += 4000) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = 1;
    options.memory_limit = limit;
    vxm_context *context;
    assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
    vxm_soup *copy = new_soup(context), *out;
    for (size_t v = 0; v < soup->vertex_count; v++)
      add_vertex(copy, vxm_position(soup, v)[0], vxm_position(soup, v)[1], vxm_position(soup, v)[2]);
    for (size_t f = 0; f < soup->face_count; f++)
      add_face(copy, soup->indices + 3 * f, 3);
    vxm_status status = vxm_repair_run(&out, NULL, copy, NULL, NULL);
    passed = status == VXM_OK;
    assert_true(passed || status == VXM_ERROR_MEMORY_LIMIT);
    if (passed)
      assert_int_equal(out->vertex_count, whole->vertex_count);
    vxm_soup_destroy(out);
    vxm_soup_destroy(copy);
    vxm_context_destroy(context);
  }
  vxm_soup_destroy(soup);
  vxm_soup_destroy(whole);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(torn_torus_closes),
      cmocka_unit_test(doubled_and_removed),
      cmocka_unit_test(thin_pairs_of_sheets_stay_two),
      cmocka_unit_test(tiles_with_gaps_stay_apart),
      cmocka_unit_test(crowds),
      cmocka_unit_test(same_for_any_threads),
      cmocka_unit_test(torn_real_meshes),
      cmocka_unit_test(memory_may_run_out),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The solid as an octree against the dense solid, bit for bit: closed, capped and open soups, many parts, all
 * methods and modes, all numbers of threads, transforms, memory limits, and real meshes.
 * VOXMEND_TEST_RESOLUTIONS="64 200" chooses other resolutions for these.
 */
#include "../base/rounds.h"
#include "shapes.h"

#include "grid/octree.h"
#include "voxel/sparse/sparse.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void check_way(vxm_model *model, const vxm_space *space, const double *transform, const char *name) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_voxelize_report dense = VXM_VOXELIZE_REPORT_INIT, sparse = VXM_VOXELIZE_REPORT_INIT;
  vxm_grid *grid, *back;
  vxm_sparse *octree = NULL, *expected = NULL;
  assert_int_equal(vxm_grid_create(&grid, context, space, NULL), VXM_OK);
  if (vxm_model_voxelize(grid, &dense, model, transform, &error) != VXM_OK ||
      vxm_model_sparse(&octree, &sparse, model, space, transform, &error) != VXM_OK)
    fail_msg("%s: %s", name, error.text);
  assert_int_equal(vxm_sparse_to_grid(&back, octree, NULL), VXM_OK);
  if (memcmp(back->words, grid->words, grid->word_count * sizeof *grid->words) != 0)
    fail_msg("%s differs", name);
  assert_true(dense.hash == sparse.hash && dense.voxels == sparse.voxels);
  assert_true(dense.contested == sparse.contested && dense.empty_parts == sparse.empty_parts);
  assert_true(dense.parts == sparse.parts && dense.winding_decided == sparse.winding_decided);
  assert_int_equal(vxm_sparse_from_grid(&expected, grid, NULL), VXM_OK);
  assert_int_equal(octree->brick_count, expected->brick_count);
  if (octree->brick_count > 0)
    assert_memory_equal(octree->bricks, expected->bricks, octree->brick_count * sizeof *octree->bricks);
  assert_int_equal(vxm_sparse_nodes(octree), vxm_sparse_nodes(expected));
  vxm_sparse_destroy(expected);
  vxm_sparse_destroy(octree);
  vxm_grid_destroy(back);
  vxm_grid_destroy(grid);
}

/** Octrees made from the triangles and by way of a grid. */
static void check_model(vxm_model *model, const vxm_space *space, const double *transform, const char *name) {
  for (int direct = 0; direct < 2; direct++) {
    vxm_sparse_force_direct(direct);
    check_way(model, space, transform, name);
  }
  vxm_sparse_force_direct(false);
}

static void check(const vxm_soup *soup, const vxm_space *space, const vxm_voxelize_options *options) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_model *model;
  vxm_status status = vxm_model_create(&model, soup, options, &error);
  if (status == VXM_ERROR_EMPTY)
    return;
  if (status != VXM_OK)
    fail_msg("%s", error.text);
  static const double turned[12] = {0.8, -0.6, 0, 1.5, 0.6, 0.8, 0, -2.25, 0, 0, -1, 9.5};
  char name[64];
  snprintf(name, sizeof name, "method %d, mode %d, parts %d", options->method, options->mode,
           options->split_mode);
  check_model(model, space, NULL, name);
  check_model(model, space, turned, name);
  vxm_model_destroy(model);
}

static vxm_space random_space(vxm_rng *rng) {
  static const int64_t sides[] = {1, 2, 4, 5, 16, 17, 33, 48, 64, 65, 130};
  vxm_space space = {{0, 0, 0}, {0, 0, 0}, {1, 1, 1}};
  for (int a = 0; a < 3; a++)
    space.dims[a] = sides[vxm_rng_below(rng, sizeof sides / sizeof *sides)];
  if (space.dims[0] * space.dims[1] * space.dims[2] > 130 * 65 * 17)
    space.dims[vxm_rng_below(rng, 3)] = 16;
  return space;
}

/** Triangles of random corners: open, and cutting through each other; rows may have an odd number. */
static void add_open(vxm_soup *soup, vxm_rng *rng, int low, int high, int faces) {
  uint32_t first = (uint32_t)soup->vertex_count;
  for (int v = 0; v < faces + 2; v++) {
    double x = shape_quarter(rng, low, high), y = shape_quarter(rng, low, high);
    shape_vertex(soup, x, y, shape_quarter(rng, low, high));
  }
  for (int f = 0; f < faces; f++)
    shape_triangle(soup, first + (uint32_t)f, first + (uint32_t)f + 1, first + (uint32_t)f + 2);
}

static vxm_soup *random_soup(vxm_context *owner, vxm_rng *rng, const vxm_space *space, int round) {
  vxm_soup *soup = shape_empty(owner);
  int most = 0;
  for (int a = 0; a < 3; a++)
    most = space->dims[a] > most ? (int)space->dims[a] : most;
  /* Some of them lie partly before the grid or behind it. */
  int low = round % 4 == 0 ? -6 * most : -8, high = round % 4 == 1 ? 8 * most : 4 * most + 8;
  int parts = round % 5 == 0 ? 40 : 1 + (int)vxm_rng_below(rng, 4);
  for (int p = 0; p < parts; p++) {
    if (round % 3 == 2 && p % 2 == 0)
      add_open(soup, rng, low, high, 1 + (int)vxm_rng_below(rng, 5));
    else if (p % 3 == 1) { /* nested: boxes one in the other, of which some are cavities */
      double from[3] = {1 + p % 7, 2, 1}, to[3] = {3 + p % 7 + most / 2, 2 + most / 2, most - 1};
      shape_box(soup, from, to);
    } else
      shape_random_octahedron(soup, rng, low, high);
  }
  return soup;
}

static void test_random_soups(void **state) {
  (void)state;
  static const int threads[3] = {1, 2, 7};
  vxm_context *shared = context;
  vxm_rng rng = {71};
  for (int t = 0; t < 3; t++) {
    vxm_context_options limits = VXM_CONTEXT_OPTIONS_INIT;
    limits.threads = threads[t];
    assert_int_equal(vxm_context_create(&context, &limits, NULL), VXM_OK);
    for (int round = 0; round < ROUNDS(60); round++) {
      vxm_space space = random_space(&rng);
      vxm_soup *soup = random_soup(context, &rng, &space, round);
      vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
      options.split_mode = (vxm_split_mode)vxm_rng_below(&rng, 3);
      check(soup, &space, &options);
      options.method = (vxm_method)(VXM_METHOD_X + (int)vxm_rng_below(&rng, 4));
      check(soup, &space, &options);
      if (round % 8 == 0) {
        options.method = VXM_METHOD_VOTE;
        options.vote = (vxm_vote)vxm_rng_below(&rng, 4);
        options.mode = (vxm_mode)vxm_rng_below(&rng, 3);
        check(soup, &space, &options);
      }
      vxm_soup_destroy(soup);
    }
    vxm_context_destroy(context);
  }
  context = shared;
}

/**
 * Surfaces, alone and with the solid, in grids of long rows: small facets, and long ones across many words of
 * few rows; some with corners far beyond the grid, and so far that coordinates do not fit 32 bits.
 */
static void test_surfaces(void **state) {
  (void)state;
  static const int64_t dims[][3] = {{1300, 40, 33}, {700, 130, 17}, {65, 200, 130}, {4100, 17, 20}};
  static const int threads[3] = {1, 2, 7};
  vxm_context *shared = context;
  vxm_rng rng = {83};
  for (int round = 0; round < ROUNDS(24); round++) {
    vxm_context_options limits = VXM_CONTEXT_OPTIONS_INIT;
    limits.threads = threads[round % 3];
    assert_int_equal(vxm_context_create(&context, &limits, NULL), VXM_OK);
    const int64_t *n = dims[round % 4];
    vxm_space space = {{n[0], n[1], n[2]}, {0, 0, 0}, {1, 1, 1}};
    vxm_soup *soup = shape_empty(context);
    int reach = round % 6 == 5 ? 1 << 24 : round % 6 == 4 ? 20000 : 1300;
    for (int f = 0; f < 6; f++)
      add_open(soup, &rng, f % 2 ? -8 : -reach, f % 2 ? 140 : reach, 2);
    for (int o = 0; o < 4; o++)
      shape_random_octahedron(soup, &rng, 0, (int)n[o % 3]);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.mode = round % 2 ? VXM_MODE_SURFACE : VXM_MODE_BOTH;
    options.surface = round / 2 % 2 ? VXM_SURFACE_THIN : VXM_SURFACE_CONSERVATIVE;
    options.method = VXM_METHOD_X;
    check(soup, &space, &options);
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
  }
  context = shared;
}

/** Large enough for several windows of slabs; a smooth part, alone and united with others. */
static void test_many_slabs(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_torus(soup, 90, 60, 400, 150, (double[3]){600.3, 610.7, 170.1});
  vxm_space space = {{1203, 1230, 341}, {0, 0, 0}, {1, 1, 1}};
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  check(soup, &space, &options);
  shape_torus(soup, 70, 50, 300, 160, (double[3]){500.3, 700.7, 150.1});
  shape_box(soup, (double[3]){10, 20, 30}, (double[3]){1200, 320, 330});
  check(soup, &space, &options);
  vxm_soup_destroy(soup);
}

/** A column with dents, closed, of many triangles in any order: so many, and so large, that they are put in
 * order first. Dents reach the middle here and there, so that some of it is thin. */
static vxm_soup *dented_column(vxm_rng *rng, double height) {
  enum { AROUND = 48, RINGS = 48, SIDES = 2 * AROUND * (RINGS - 1), TRIANGLES = SIDES + 2 * AROUND };
  static uint32_t corners[TRIANGLES][3];
  vxm_soup *soup = shape_empty(context);
  for (int r = 0; r < RINGS; r++)
    for (int a = 0; a < AROUND; a++) {
      double turn = 2 * 3.14159265358979 * a / AROUND, out = vxm_rng_below(rng, 6) ? 140 : 0.2;
      out += (double)vxm_rng_below(rng, 1000) / 50;
      shape_vertex(soup, 170 + out * cos(turn), 170 + out * sin(turn), 5 + (height - 10) * r / (RINGS - 1));
    }
  uint32_t low = shape_vertex(soup, 170, 170, 5), high = shape_vertex(soup, 170, 170, height - 5);
  size_t count = 0;
  for (uint32_t a = 0; a < AROUND; a++) {
    uint32_t b = (a + 1) % AROUND, top = AROUND * (RINGS - 1);
    memcpy(corners[count++], (uint32_t[]){low, b, a}, sizeof *corners);
    memcpy(corners[count++], (uint32_t[]){high, top + a, top + b}, sizeof *corners);
    for (uint32_t r = 0; r < top; r += AROUND) {
      memcpy(corners[count++], (uint32_t[]){r + a, r + b, r + AROUND + b}, sizeof *corners);
      memcpy(corners[count++], (uint32_t[]){r + a, r + AROUND + b, r + AROUND + a}, sizeof *corners);
    }
  }
  for (; count > 0; count--) {
    size_t next = vxm_rng_below(rng, count);
    shape_triangle(soup, corners[next][0], corners[next][1], corners[next][2]);
    memcpy(corners[next], corners[count - 1], sizeof *corners);
  }
  return soup;
}

static void test_triangles_in_order(void **state) {
  (void)state;
  vxm_context *shared = context;
  vxm_rng rng = {47};
  const vxm_space space = {{340, 340, 1500}, {0, 0, 0}, {1, 1, 1}};
  for (int threads = 1; threads < 4; threads += 2) {
    vxm_context_options limits = VXM_CONTEXT_OPTIONS_INIT;
    limits.threads = threads;
    assert_int_equal(vxm_context_create(&context, &limits, NULL), VXM_OK);
    vxm_soup *soup = dented_column(&rng, 1500);
    vxm_model *model;
    assert_int_equal(vxm_model_create(&model, soup, NULL, NULL), VXM_OK);
    check_model(model, &space, NULL, "dented column");
    vxm_model_destroy(model);
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
  }
  context = shared;
}

/** A thin plate from corner to corner, one of whose sides passes through voxel centres in every so many
 * columns; `turn` says along which axes it lies. */
static void add_plate(vxm_soup *soup, vxm_rng *rng, int turn) {
  static const uint32_t quad[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                      {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  uint32_t first = (uint32_t)soup->vertex_count;
  double wide = 3 * (40 + (double)vxm_rng_below(rng, 50)), deep = 7 * (5 + (double)vxm_rng_below(rng, 8)),
         rise = (double)vxm_rng_below(rng, 60), back = (double)vxm_rng_below(rng, 40),
         thick = vxm_rng_below(rng, 2) ? 0.25 : -0.25;
  for (int v = 0; v < 8; v++) {
    double along[3] = {v & 1 ? wide : 0, v & 2 ? deep : 0, (v & 1 ? rise : 0) + (v & 2 ? back : 0)}, at[3];
    along[2] += v & 4 ? thick : 0;
    for (int a = 0; a < 3; a++)
      at[(a + turn) % 3] = 4.5 + along[a];
    shape_vertex(soup, at[0], at[1], at[2]);
  }
  for (int f = 0; f < 6; f++) {
    const uint32_t *q = quad[f];
    shape_triangle(soup, first + q[0], first + q[1], first + q[2]);
    shape_triangle(soup, first + q[0], first + q[2], first + q[3]);
  }
}

static void test_plates_through_centres(void **state) {
  (void)state;
  vxm_rng rng = {73};
  vxm_space space = {{280, 280, 280}, {0, 0, 0}, {1, 1, 1}};
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  for (int round = 0; round < 12; round++) {
    vxm_soup *soup = shape_empty(context);
    add_plate(soup, &rng, round);
    check(soup, &space, &options);
    vxm_soup_destroy(soup);
  }
}

/** Rounds: under a small limit the parts do not fit the bins together. */
static void test_rounds_and_limits(void **state) {
  (void)state;
  vxm_context *shared = context;
  int failures = 0, successes = 0;
  uint64_t expected = 0;
  for (uint64_t limit = UINT64_C(1) << 36; limit > 1 << 18;
       limit = limit > 1 << 30 ? 1 << 28 : limit / 4 * 3) {
    vxm_context_options limits = VXM_CONTEXT_OPTIONS_INIT;
    limits.threads = 2;
    limits.memory_limit = limit;
    assert_int_equal(vxm_context_create(&context, &limits, NULL), VXM_OK);
    vxm_soup *soup;
    vxm_model *model = NULL;
    vxm_sparse *octree = NULL;
    vxm_error error = VXM_ERROR_INIT;
    assert_int_equal(vxm_soup_create(&soup, context, "test", NULL), VXM_OK);
    for (int p = 0; p < 24; p++)
      shape_box(soup, (double[3]){10 + 7 * p, 3 + p, 2}, (double[3]){150 + 11 * p, 390 - p, 60 - p});
    vxm_space space = {{410, 401, 63}, {0, 0, 0}, {1, 1, 1}};
    vxm_status status = vxm_model_create(&model, soup, NULL, &error);
    if (status == VXM_OK)
      status = vxm_model_sparse(&octree, NULL, model, &space, NULL, &error);
    assert_true(status == VXM_OK || status == VXM_ERROR_MEMORY_LIMIT);
    assert_int_equal(error.code, status);
    assert_int_equal(octree != NULL, status == VXM_OK);
    if (octree) {
      if (expected)
        assert_true(vxm_sparse_hash(octree) == expected);
      expected = vxm_sparse_hash(octree);
    }
    failures += status != VXM_OK;
    successes += status == VXM_OK;
    vxm_sparse_destroy(octree);
    vxm_model_destroy(model);
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
  }
  assert_true(failures > 2 && successes > 2);
  context = shared;
}

static int stop_late(const char *phase, double fraction, void *payload) {
  int *left = payload;
  (void)phase;
  assert_true(fraction >= 0 && fraction <= 1);
  return --*left < 0;
}

static void test_cancelling(void **state) {
  (void)state;
  vxm_context *shared = context;
  bool finished = false;
  for (int calls = 1; !finished && calls < 4000; calls = calls * 3 / 2 + 1) {
    int left = calls;
    vxm_context_options limits = VXM_CONTEXT_OPTIONS_INIT;
    limits.threads = 2;
    limits.progress = stop_late;
    limits.payload = &left;
    assert_int_equal(vxm_context_create(&context, &limits, NULL), VXM_OK);
    vxm_soup *soup = shape_empty(context);
    shape_torus(soup, 60, 40, 60, 25, (double[3]){100, 100, 40});
    vxm_space space = {{200, 200, 80}, {0, 0, 0}, {1, 1, 1}};
    vxm_model *model = NULL;
    vxm_sparse *octree = NULL;
    vxm_status status = vxm_model_create(&model, soup, NULL, NULL);
    if (status == VXM_OK)
      status = vxm_model_sparse(&octree, NULL, model, &space, NULL, NULL);
    assert_true(status == VXM_OK || status == VXM_ERROR_CANCELLED);
    assert_int_equal(octree != NULL, status == VXM_OK);
    finished = status == VXM_OK;
    vxm_sparse_destroy(octree);
    vxm_model_destroy(model);
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
  }
  assert_true(finished);
  context = shared;
}

static void test_refusals(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_box(soup, (double[3]){1, 1, 1}, (double[3]){6, 6, 6});
  vxm_space space = {{8, 8, 8}, {0, 0, 0}, {1, 1, 1}}, none = {{0, 8, 8}, {0, 0, 0}, {1, 1, 1}};
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.confidence = true;
  vxm_model *model;
  vxm_sparse *octree;
  assert_int_equal(vxm_model_create(&model, soup, &options, NULL), VXM_OK);
  assert_int_equal(vxm_model_sparse(&octree, NULL, model, &space, NULL, NULL), VXM_ERROR_ARGUMENT);
  assert_null(octree);
  vxm_model_destroy(model);
  assert_int_equal(vxm_model_create(&model, soup, NULL, NULL), VXM_OK);
  assert_true(vxm_model_sparse(&octree, NULL, model, &none, NULL, NULL) != VXM_OK);
  assert_int_equal(vxm_model_sparse(&octree, NULL, model, &space, (double[12]){0}, NULL), VXM_ERROR_ARGUMENT);
  vxm_model_destroy(model);
  vxm_soup_destroy(soup);
}

static void check_file(const char *path, const char *resolutions) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_mesh *raw, *mesh;
  vxm_model *model;
  if (vxm_mesh_read(&raw, context, path, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_int_equal(vxm_mesh_repair(&mesh, NULL, raw, NULL, &error), VXM_OK);
  vxm_mesh_destroy(raw);
  if (vxm_model_create(&model, mesh, NULL, &error) == VXM_OK) {
    const char *at = resolutions;
    for (char *end; *at; at = end) {
      vxm_space_options fit = VXM_SPACE_OPTIONS_INIT;
      vxm_space space;
      fit.resolution[0] = strtol(at, &end, 10);
      if (end == at)
        break;
      if (vxm_space_fit(&space, mesh, &fit, NULL) == VXM_OK)
        check_model(model, &space, NULL, path);
    }
    vxm_model_destroy(model);
  }
  vxm_mesh_destroy(mesh);
}

static void test_real_meshes(void **state) {
  (void)state;
  static const char *const folders[] = {"cad", "classic", "messy", "modelnet", "paper"};
  const char *source = getenv("SRCDIR"), *resolutions = getenv("VOXMEND_TEST_RESOLUTIONS");
  for (size_t f = 0; f < sizeof folders / sizeof *folders; f++) {
    char folder[2048], path[4096];
    snprintf(folder, sizeof folder, "%s/../shared/meshes/%s", source ? source : ".", folders[f]);
    DIR *listing = opendir(folder);
    if (!listing)
      skip();
    for (struct dirent *entry; (entry = readdir(listing));) {
      if (entry->d_name[0] == '.')
        continue;
      snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
      check_file(path, resolutions ? resolutions : "64");
    }
    closedir(listing);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_random_soups),
      cmocka_unit_test(test_surfaces),
      cmocka_unit_test(test_many_slabs),
      cmocka_unit_test(test_rounds_and_limits),
      cmocka_unit_test(test_cancelling),
      cmocka_unit_test(test_refusals),
      cmocka_unit_test(test_plates_through_centres),
      cmocka_unit_test(test_triangles_in_order),
      cmocka_unit_test(test_real_meshes),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/* Solids by columns have the bits and the report of the CPU: random soups, closed and open, many parts, every
 * method, rule and axis, odd dimensions, tiles and windows, and points far outside the grid; and those of
 * brute force, as the CPU and the shaders share their rules. */
#include "gpu_test.h"

#include "voxel/model/model.h"

/** By both engines, bit for bit. */
static void check(const vxm_soup *soup, const vxm_space *space, vxm_voxelize_options options) {
  vxm_voxelize_report by_cpu = VXM_VOXELIZE_REPORT_INIT, by_gpu = VXM_VOXELIZE_REPORT_INIT;
  options.engine = NULL;
  vxm_grid *expected = engine_solid(soup, space, &options, &by_cpu);
  options.engine = engine;
  vxm_grid *found = engine_solid(soup, space, &options, &by_gpu);
  assert_equal_bits(expected, found);
  assert_equal_reports(&by_cpu, &by_gpu);
  vxm_grid_destroy(expected);
  vxm_grid_destroy(found);
}

static void check_all(const vxm_soup *soup, const vxm_space *space) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  for (int parts = VXM_SPLIT_MODE_AUTO; parts <= VXM_SPLIT_MODE_WHOLE; parts++) {
    options.split_mode = (vxm_split_mode)parts;
    options.vote = VXM_VOTE_AUTO;
    for (int method = VXM_METHOD_VOTE; method <= VXM_METHOD_TETRA; method++) {
      options.method = (vxm_method)method;
      check(soup, space, options);
    }
    options.method = VXM_METHOD_VOTE;
    for (int vote = VXM_VOTE_MAJORITY; vote <= VXM_VOTE_ALL; vote++) {
      options.vote = (vxm_vote)vote;
      check(soup, space, options);
    }
  }
}

/** Octahedra with some faces missing, in and around a grid. */
static void test_random(void **state) {
  (void)state;
  vxm_rng rng = {7};
  for (int round = 0; round < 12; round++) {
    vxm_soup *soup = shape_empty(context);
    vxm_space space = engine_space(1 + (int64_t)vxm_rng_below(&rng, 90), 1 + (int64_t)vxm_rng_below(&rng, 40),
                                   1 + (int64_t)vxm_rng_below(&rng, 40));
    double low[3], high[3];
    for (int a = 0; a < 3; a++) {
      low[a] = -0.2 * (double)space.dims[a];
      high[a] = 1.2 * (double)space.dims[a];
    }
    uint64_t bodies = 1 + vxm_rng_below(&rng, 6);
    for (uint64_t b = 0; b < bodies; b++)
      random_octahedron(soup, &rng, low, high, round % 3 == 0 ? 0 : (uint32_t)vxm_rng_below(&rng, 4));
    check_all(soup, &space);
    vxm_soup_destroy(soup);
  }
}

/** Many small bodies, of which most share a pass, and those that meet do not. */
static void test_many_parts(void **state) {
  (void)state;
  vxm_rng rng = {8};
  vxm_soup *soup = shape_empty(context);
  for (int i = 0; i < 400; i++) {
    double low[3], high[3];
    for (int a = 0; a < 3; a++) {
      low[a] = vxm_rng_unit(&rng) * 60 - 2;
      high[a] = low[a] + vxm_rng_unit(&rng) * (i % 10 == 0 ? 30 : 4);
    }
    if (i % 4 == 0)
      shape_box(soup, low, high);
    else
      random_octahedron(soup, &rng, low, high, i % 5 == 0);
  }
  vxm_space space = engine_space(64, 61, 63);
  check_all(soup, &space);
  vxm_soup_destroy(soup);
}

/** Faces on voxel centres, and edges along columns: the perturbation decides. */
static void test_ties(void **state) {
  (void)state;
  vxm_space space = engine_space(16, 16, 16);
  for (int eighths = 0; eighths <= 8; eighths++) {
    vxm_soup *soup = box_with_ties(eighths / 8.0, 0.5);
    check_all(soup, &space);
    vxm_soup_destroy(soup);
  }
}

/** A fine surface, whose triangles are done by the compute shader, and large ones, which are drawn. */
static void test_sizes(void **state) {
  (void)state;
  for (int64_t n = 32; n <= 128; n *= 2) {
    vxm_soup *soup = shape_empty(context);
    double c = (double)n / 2;
    shape_torus(soup, n == 64 ? 4 : 200, n == 64 ? 3 : 90, 0.7 * c, 0.25 * c, (double[3]){c, c, c + 0.1});
    vxm_space space = engine_space(n, n, n);
    check_all(soup, &space);
    vxm_soup_destroy(soup);
  }
}

/** Points beyond the numbers of the shaders: the CPU tells what their triangles flip. */
static void test_far(void **state) {
  (void)state;
  vxm_rng rng = {9};
  for (int round = 0; round < 6; round++) {
    vxm_soup *soup = shape_empty(context);
    double reach = round % 2 ? 3000 : 40000; /* with 2^16 steps per voxel: beyond 2^20, and beyond 32 bits */
    double low[3] = {-reach, -reach, -reach}, high[3] = {reach, reach, reach};
    random_octahedron(soup, &rng, low, high, round >= 4);
    random_octahedron(soup, &rng, (double[3]){0, 0, 0}, (double[3]){16, 16, 16}, 0);
    vxm_space space = engine_space(16, 16, 16);
    check_all(soup, &space);
    vxm_soup_destroy(soup);
  }
}

/** So many flips in each column that the CPU keeps them as bits. */
static void test_far_flips_are_many(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  for (int i = 0; i < 8; i++)
    shape_box(soup, (double[3]){-3000, -3000, 0.2 + 1.9 * i}, (double[3]){3000, 3000, 1.3 + 1.9 * i});
  vxm_space space = engine_space(16, 16, 16);
  check_all(soup, &space);
  vxm_soup_destroy(soup);
}

/** Brute force, not the CPU: both take their rules from one file. */
static void check_exactly(const vxm_soup *soup, const vxm_space *space) {
  size_t count = (size_t)(space->dims[0] * space->dims[1] * space->dims[2]);
  for (int w = 0; w < 3; w++) {
    uint8_t *want = calloc(count, 1);
    assert_non_null(want);
    exact_unite(want, soup, 0, soup->face_count, space, w);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.method = (vxm_method)(VXM_METHOD_X + w);
    options.split_mode = VXM_SPLIT_MODE_WHOLE;
    options.engine = engine;
    vxm_grid *found = engine_solid(soup, space, &options, NULL);
    assert_grid_is(found, want);
    vxm_grid_destroy(found);
    free(want);
  }
}

static void test_rules(void **state) {
  (void)state;
  vxm_rng rng = {13};
  for (int round = 0; round < 24; round++) {
    vxm_soup *soup = shape_empty(context);
    vxm_space space = engine_space(11, 13, 12);
    double reach = round % 6 == 5 ? 3000 : round % 2 ? 8 : 1; /* beyond the numbers of shaders, too */
    double low[3] = {-reach, -reach, -reach}, high[3] = {11 + reach, 13 + reach, 12 + reach};
    for (int b = 0; b < 2; b++)
      random_octahedron(soup, &rng, low, high, 0);
    check_exactly(soup, &space);
    vxm_soup_destroy(soup);
    double part = (round % 9) / 8.0; /* some faces on centres */
    soup = shape_empty(context);
    triangle_box(soup, (double[3]){2 + part, 3.5, 4 + part}, (double[3]){9.5, 11 + part, 10.5}, 0, false);
    check_exactly(soup, &space);
    vxm_soup_destroy(soup);
  }
}

/** Windows in another layout, whose slices lie apart, and a transform. */
static void test_windows(void **state) {
  (void)state;
  vxm_rng rng = {10};
  vxm_soup *soup = shape_empty(context);
  for (int b = 0; b < 3; b++)
    random_octahedron(soup, &rng, (double[3]){-3, -3, -3}, (double[3]){36, 30, 26}, b == 1);
  vxm_space space = engine_space(33, 27, 24);
  const vxm_layout layouts[3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}};
  const double turn[12] = {0.8, 0.6, 0, 1, -0.6, 0.8, 0, 9, 0, 0, -1, 25};
  for (int l = 0; l < 3; l++)
    for (int vote = VXM_VOTE_AUTO; vote <= VXM_VOTE_ALL; vote++) {
      vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
      options.vote = (vxm_vote)vote;
      vxm_model *by_cpu = engine_model(soup, &options);
      options.engine = engine;
      vxm_model *by_gpu = engine_model(soup, &options);
      vxm_model_pass *cpu_pass, *gpu_pass;
      assert_int_equal(vxm_model_begin(&cpu_pass, by_cpu, &space, turn, NULL, NULL), VXM_OK);
      assert_int_equal(vxm_model_begin(&gpu_pass, by_gpu, &space, turn, NULL, NULL), VXM_OK);
      vxm_window whole = vxm_window_of(&space, layouts[l], 0, space.dims[layouts[l].slow]);
      for (int64_t begin = 0; begin < whole.slow_dim; begin += 7) {
        vxm_window window = vxm_window_of(&space, layouts[l], begin, vxm_min(begin + 7, whole.slow_dim));
        size_t words = window.slice_words * (size_t)(window.end - window.begin);
        uint64_t *a = malloc(words * 8), *b = malloc(words * 8);
        assert_true(a && b);
        window.words = a;
        assert_int_equal(vxm_model_pass_fill(cpu_pass, &window, NULL), VXM_OK);
        window.words = b;
        assert_int_equal(vxm_model_pass_fill(gpu_pass, &window, NULL), VXM_OK);
        assert_memory_equal(a, b, words * 8);
        free(a);
        free(b);
      }
      vxm_model_close(by_cpu, cpu_pass);
      vxm_model_close(by_gpu, gpu_pass);
      vxm_model_destroy(by_cpu);
      vxm_model_destroy(by_gpu);
    }
  vxm_soup_destroy(soup);
}

/** Two models that take turns with one engine, each placed anew again and again. */
static void test_turns(void **state) {
  (void)state;
  vxm_rng rng = {11};
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_soup *soup[2];
  vxm_model *model[2][2];
  vxm_space space = engine_space(40, 40, 40);
  for (int m = 0; m < 2; m++) {
    soup[m] = shape_empty(context);
    random_octahedron(soup[m], &rng, (double[3]){0, 0, 0}, (double[3]){40, 40, 40}, 0);
    for (int e = 0; e < 2; e++) {
      options.engine = e ? engine : NULL;
      model[m][e] = engine_model(soup[m], &options);
    }
  }
  for (int i = 0; i < 8; i++) {
    const double move[12] = {1, 0, 0, i, 0, 1, 0, -i, 0, 0, 1, 0.5 * i};
    vxm_grid *a = engine_grid(context, &space), *b = engine_grid(context, &space);
    assert_int_equal(vxm_model_voxelize(a, NULL, model[i % 2][0], i < 4 ? NULL : move, NULL), VXM_OK);
    assert_int_equal(vxm_model_voxelize(b, NULL, model[i % 2][1], i < 4 ? NULL : move, NULL), VXM_OK);
    assert_equal_bits(a, b);
    vxm_grid_destroy(a);
    vxm_grid_destroy(b);
  }
  for (int m = 0; m < 2; m++) {
    vxm_model_destroy(model[m][0]);
    vxm_model_destroy(model[m][1]);
    vxm_soup_destroy(soup[m]);
  }
}

/** Small limits of the driver: many tiles, many viewports, no buffers in vertex shaders. */
static void test_limits(void **state) {
  (void)state;
  vxm_engine_info *info = &engine->info;
  vxm_engine_info kept = *info;
  vxm_rng rng = {12};
  vxm_soup *soup = shape_empty(context);
  random_octahedron(soup, &rng, (double[3]){-9, -9, -9}, (double[3]){99, 99, 99}, 1);
  random_octahedron(soup, &rng, (double[3]){-9, -9, -9}, (double[3]){99, 99, 99}, 0);
  vxm_space space = engine_space(90, 70, 50);
  info->block_bytes = 16 * 70 * 6; /* three slices beside what else is held */
  info->viewport = 17;
  check_all(soup, &space);
  info->block_bytes = 16 * 70 / 2;
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.like = &space;
  options.engine = engine;
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid;
  assert_int_equal(vxm_voxelize(&grid, NULL, soup, &space_options, &options, &error), VXM_ERROR_RANGE);
  assert_non_null(strstr(error.text, "--engine cpu"));
  *info = kept;
  check_all(soup, &space);
  vxm_soup_destroy(soup);
}

typedef struct told {
  int calls, falls;
  double last;
} told;

static int note(const char *phase, double fraction, void *payload) {
  told *t = payload;
  (void)phase;
  t->calls++;
  t->falls += fraction < t->last;
  t->last = fraction;
  return 0;
}

/** Progress rises over tiles, passes and voters. */
static void test_progress(void **state) {
  (void)state;
  told seen = {0};
  vxm_context_options of_context = VXM_CONTEXT_OPTIONS_INIT;
  of_context.progress = note;
  of_context.payload = &seen;
  of_context.memory_limit = 1200 << 10; /* some tiles */
  vxm_context *own;
  vxm_engine *usual = engine;
  vxm_engine_options of_engine = VXM_ENGINE_OPTIONS_INIT;
#ifdef CL_METHOD
  of_engine.cl_method = CL_METHOD;
#endif
  assert_int_equal(vxm_context_create(&own, &of_context, NULL), VXM_OK);
  assert_int_equal(vxm_engine_create(&engine, own, ENGINE, &of_engine, NULL), VXM_OK);
  vxm_space space = engine_space(128, 128, 128);
  vxm_soup *open = shape_empty(context), *boxes = shape_empty(context);
  shape_torus(open, 30, 20, 40, 20, (double[3]){64, 64, 64});
  open->face_count -= 7;
  for (int b = 0; b < 3; b++)
    shape_box(boxes, (double[3]){3.0 + b, 2, 1}, (double[3]){70 + 9.0 * b, 80, 120});
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.vote = VXM_VOTE_MAJORITY;
  check(open, &space, options);
  assert_true(seen.calls >= 9);
  assert_int_equal(seen.falls, 0);
  seen = (told){0};
  check(boxes, &space, options);
  assert_true(seen.calls >= 3);
  assert_int_equal(seen.falls, 0);
  open->face_count += 7;
  vxm_soup_destroy(open);
  vxm_soup_destroy(boxes);
  vxm_engine_destroy(engine);
  vxm_context_destroy(own);
  engine = usual;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_progress), cmocka_unit_test(test_rules),
      cmocka_unit_test(test_random),   cmocka_unit_test(test_many_parts),
      cmocka_unit_test(test_ties),     cmocka_unit_test(test_sizes),
      cmocka_unit_test(test_far),      cmocka_unit_test(test_far_flips_are_many),
      cmocka_unit_test(test_windows),  cmocka_unit_test(test_turns),
      cmocka_unit_test(test_limits)};
  int status = gpu_test_start(NULL);
  if (status == 0)
    status = cmocka_run_group_tests_name("columns by " ENGINE, tests, setup, teardown);
  vxm_engine_destroy(engine);
  return status;
}

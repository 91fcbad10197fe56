/* SPDX-License-Identifier: BSD-3-Clause */
/* Surfaces by an engine have the bits of the CPU: conservative and thin, small triangles and large ones,
 * slivers, lines and points, ties, other layouts, and triangles that reach far outside the grid; and those of
 * brute force, as the CPU and the shaders share their rules. */
#include "../voxel/surface_oracle.h"
#include "gpu_test.h"

#include "voxel/model/model.h"

static void check(const vxm_soup *soup, const vxm_space *space) {
  for (int mode = VXM_MODE_SURFACE; mode <= VXM_MODE_BOTH; mode++)
    for (int kind = VXM_SURFACE_CONSERVATIVE; kind <= VXM_SURFACE_THIN; kind++) {
      vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
      options.mode = (vxm_mode)mode;
      options.surface = (vxm_surface_kind)kind;
      vxm_grid *expected = engine_solid(soup, space, &options, NULL);
      options.engine = engine;
      vxm_grid *found = engine_solid(soup, space, &options, NULL);
      assert_equal_bits(expected, found);
      vxm_grid_destroy(expected);
      vxm_grid_destroy(found);
    }
}

/** Three points of a box, at random, on the lattice of quarters, or in a line. */
static void random_triangle(vxm_soup *soup, vxm_rng *rng, double low, double high) {
  uint32_t v[3];
  double p[3][3];
  uint64_t shape = vxm_rng_below(rng, 8);
  for (int c = 0; c < 3; c++)
    for (int a = 0; a < 3; a++) {
      p[c][a] = low + vxm_rng_unit(rng) * (high - low);
      if (shape == 0)
        p[c][a] = floor(4 * p[c][a]) / 4;
    }
  for (int a = 0; a < 3; a++) {
    if (shape == 1)
      p[2][a] = p[0][a] + 0.3 * (p[1][a] - p[0][a]) + 0.02 * (vxm_rng_unit(rng) - 0.5);
    if (shape == 2 && a != 1)
      p[2][a] = p[1][a] = p[0][a];
  }
  for (int c = 0; c < 3; c++)
    v[c] = shape_vertex(soup, p[c][0], p[c][1], p[c][2]);
  shape_triangle(soup, v[0], v[1], v[2]);
}

/** Brute force, not the CPU: both take their rules from one file. */
static void check_exactly(const vxm_soup *soup, const vxm_space *space) {
  vxm_lattice lattice = vxm_lattice_of(space);
  for (int kind = VXM_SURFACE_CONSERVATIVE; kind <= VXM_SURFACE_THIN; kind++) {
    bool (*is_on)(const vxm_point[3], const int64_t[3], int64_t) =
        kind == VXM_SURFACE_THIN ? oracle_thin : oracle_touches;
    uint8_t *want = calloc((size_t)(space->dims[0] * space->dims[1] * space->dims[2]), 1), *at = want;
    assert_non_null(want);
    int64_t v[3];
    for (v[2] = 0; v[2] < space->dims[2]; v[2]++)
      for (v[1] = 0; v[1] < space->dims[1]; v[1]++)
        for (v[0] = 0; v[0] < space->dims[0]; v[0]++, at++)
          for (size_t f = 0; f < soup->face_count && !*at; f++) {
            vxm_point t[3];
            for (int c = 0; c < 3; c++)
              assert_true(
                  vxm_lattice_place(&lattice, vxm_position(soup, soup->indices[3 * f + (size_t)c]), &t[c]));
            *at = is_on(t, v, lattice.unit);
          }
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.mode = VXM_MODE_SURFACE;
    options.surface = (vxm_surface_kind)kind;
    options.engine = engine;
    vxm_grid *found = engine_solid(soup, space, &options, NULL);
    assert_grid_is(found, want);
    vxm_grid_destroy(found);
    free(want);
  }
}

static void test_rules(void **state) {
  (void)state;
  vxm_rng rng = {34};
  for (int round = 0; round < 24; round++) {
    vxm_soup *soup = shape_empty(context);
    vxm_space space = engine_space(9, 11, 10);
    double reach = round % 6 == 5 ? 100 : round % 2 ? 6 : 1;
    for (int t = 0; t < 4; t++)
      random_triangle(soup, &rng, -reach, 10 + reach);
    check_exactly(soup, &space);
    vxm_soup_destroy(soup);
  }
}

static void test_random(void **state) {
  (void)state;
  vxm_rng rng = {31};
  for (int round = 0; round < 24; round++) {
    vxm_soup *soup = shape_empty(context);
    vxm_space space = engine_space(1 + (int64_t)vxm_rng_below(&rng, 80), 1 + (int64_t)vxm_rng_below(&rng, 50),
                                   1 + (int64_t)vxm_rng_below(&rng, 50));
    uint64_t count = 1 + vxm_rng_below(&rng, 30);
    double size = round % 3 == 0 ? 4 : 60;
    for (uint64_t t = 0; t < count; t++)
      random_triangle(soup, &rng, round % 2 ? -10 : 3, size + 5);
    random_octahedron(soup, &rng, (double[3]){1, 1, 1}, (double[3]){size, size, size}, 0);
    check(soup, &space);
    vxm_soup_destroy(soup);
  }
}

/** Faces on the sides of voxels. */
static void test_ties(void **state) {
  (void)state;
  vxm_space space = engine_space(16, 16, 16);
  for (int quarters = 0; quarters <= 4; quarters++) {
    vxm_soup *soup = box_with_ties(quarters / 4.0, 0);
    check(soup, &space);
    vxm_soup_destroy(soup);
  }
}

static void test_fine(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_torus(soup, 160, 80, 40, 16, (double[3]){64, 64, 32.2});
  vxm_space space = engine_space(128, 128, 64);
  check(soup, &space);
  vxm_soup_destroy(soup);
}

static void test_far(void **state) {
  (void)state;
  vxm_rng rng = {32};
  for (int round = 0; round < 4; round++) {
    vxm_soup *soup = shape_empty(context);
    double reach = round % 2 ? 100 : 40000; /* with 2^16 steps per voxel */
    for (int t = 0; t < 6; t++)
      random_triangle(soup, &rng, -reach, reach);
    random_triangle(soup, &rng, 0, 16);
    random_octahedron(soup, &rng, (double[3]){0, 0, 0}, (double[3]){16, 16, 16}, 0);
    vxm_space space = engine_space(16, 16, 16);
    check(soup, &space);
    vxm_soup_destroy(soup);
  }
}

/** Windows in another layout, small tiles and viewports, and no buffers in vertex shaders. */
static void test_windows(void **state) {
  (void)state;
  vxm_rng rng = {33};
  vxm_engine_info kept = engine->info;
  vxm_soup *soup = shape_empty(context);
  for (int t = 0; t < 12; t++)
    random_triangle(soup, &rng, -3, 36);
  vxm_space space = engine_space(33, 27, 24);
  engine->info.viewport = 14;
  const vxm_layout layouts[3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}};
  for (int l = 0; l < 3; l++) {
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.mode = VXM_MODE_SURFACE;
    vxm_model *by_cpu = engine_model(soup, &options);
    options.engine = engine;
    vxm_model *by_gpu = engine_model(soup, &options);
    vxm_model_pass *cpu_pass, *gpu_pass;
    assert_int_equal(vxm_model_begin(&cpu_pass, by_cpu, &space, NULL, NULL, NULL), VXM_OK);
    assert_int_equal(vxm_model_begin(&gpu_pass, by_gpu, &space, NULL, NULL, NULL), VXM_OK);
    int64_t depth = space.dims[layouts[l].slow];
    for (int64_t begin = 0; begin < depth; begin += 7) {
      vxm_window window = vxm_window_of(&space, layouts[l], begin, vxm_min(begin + 7, depth));
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
  engine->info.block_bytes = 4096;
  check(soup, &space);
  engine->info = kept;
  vxm_soup_destroy(soup);
}

typedef struct told {
  int count;
  double fraction[16];
} told;

static int note(const char *phase, double fraction, void *payload) {
  told *t = payload;
  if (strcmp(phase, "voxelizing the surface") == 0 && t->count < 16)
    t->fraction[t->count++] = fraction;
  return 0;
}

/** Of slabs of one height each ends at its share. */
static void test_progress(void **state) {
  (void)state;
  enum { SLABS = 4 };
  told seen = {0};
  vxm_context_options of_context = VXM_CONTEXT_OPTIONS_INIT;
  of_context.progress = note;
  of_context.payload = &seen;
  vxm_context *own;
  vxm_engine *usual = engine;
  assert_int_equal(vxm_context_create(&own, &of_context, NULL), VXM_OK);
  assert_int_equal(vxm_engine_create(&engine, own, ENGINE, NULL, NULL), VXM_OK);
  vxm_soup *soup = box_with_ties(0.2, 0.3);
  vxm_space space = engine_space(64, 64, 64);
  engine->info.block_bytes = 64 * 64 * 64 / 8 / SLABS;
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.mode = VXM_MODE_SURFACE;
  options.engine = engine;
  vxm_grid_destroy(engine_solid(soup, &space, &options, NULL));
  assert_int_equal(seen.count, SLABS);
  for (int s = 0; s < SLABS; s++)
    assert_true(fabs(seen.fraction[s] - (s + 1.0) / SLABS) < 1e-9);
  vxm_soup_destroy(soup);
  vxm_engine_destroy(engine);
  vxm_context_destroy(own);
  engine = usual;
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_rules),   cmocka_unit_test(test_random),
                                     cmocka_unit_test(test_ties),    cmocka_unit_test(test_fine),
                                     cmocka_unit_test(test_far),     cmocka_unit_test(test_windows),
                                     cmocka_unit_test(test_progress)};
  int status = gpu_test_start(NULL);
  if (status == 0)
    status = cmocka_run_group_tests_name("surfaces by " ENGINE, tests, setup, teardown);
  vxm_engine_destroy(engine);
  return status;
}

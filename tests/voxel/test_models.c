/* SPDX-License-Identifier: BSD-3-Clause */
/** Models: transforms, and that nothing of one run is left in the next, whatever became of it. */
#include "engine.h"

/* ---- Transforms ---- */

/** A signed permutation times a power of two, and quarters: all of it exact. */
static void random_matrix(double m[12], vxm_rng *rng) {
  static const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
  const int *order = orders[vxm_rng_below(rng, 6)];
  double scale = ldexp(1, (int)vxm_rng_below(rng, 5) - 2);
  memset(m, 0, 12 * sizeof *m);
  for (int r = 0; r < 3; r++) {
    m[4 * r + order[r]] = vxm_rng_below(rng, 2) ? scale : -scale;
    m[4 * r + 3] = shape_quarter(rng, -40, 40);
  }
}

/** The same soup with its vertices moved by the same arithmetic. */
static vxm_soup *transformed(const vxm_soup *soup, const double m[12]) {
  vxm_soup *copy;
  assert_int_equal(vxm_soup_copy(&copy, soup, NULL), VXM_OK);
  for (size_t v = 0; v < soup->vertex_count; v++) {
    const double *p = vxm_position(soup, v);
    for (int r = 0; r < 3; r++)
      copy->positions[3 * v + (size_t)r] =
          m[4 * r] * p[0] + m[4 * r + 1] * p[1] + m[4 * r + 2] * p[2] + m[4 * r + 3];
  }
  return copy;
}

static void check_transform(const vxm_soup *soup, const vxm_voxelize_options *options, int64_t resolution,
                            vxm_rng *rng, int matrices) {
  vxm_model *model = engine_model(soup, options);
  for (int i = 0; i < matrices; i++) {
    double m[12];
    random_matrix(m, rng);
    vxm_soup *moved = transformed(soup, m);
    vxm_space_options wanted = VXM_SPACE_OPTIONS_INIT;
    wanted.resolution[0] = resolution;
    wanted.fit = (vxm_fit)(i % 3);
    vxm_space space;
    assert_int_equal(vxm_space_fit(&space, moved, &wanted, NULL), VXM_OK);
    for (int a = 0; a < 3; a++) /* part of it outside */
      space.origin[a] += (double)(i % 5) * space.voxel_size[a];
    vxm_voxelize_report want_report = VXM_VOXELIZE_REPORT_INIT, report = VXM_VOXELIZE_REPORT_INIT;
    vxm_grid *want = engine_solid(moved, &space, options, &want_report), *grid = engine_grid(context, &space);
    vxm_error error = VXM_ERROR_INIT;
    if (vxm_model_voxelize(grid, &report, model, m, &error) != VXM_OK)
      fail_msg("%s", error.text);
    assert_equal_bits(want, grid);
    assert_equal_reports(&want_report, &report);
    vxm_grid_destroy(want);
    vxm_grid_destroy(grid);
    vxm_soup_destroy(moved);
  }
  vxm_model_destroy(model);
}

static const vxm_space soup_space = {{20, 22, 24}, {0, 0, 0}, {1, 1, 1}};

static void test_a_transform_is_a_transformed_mesh(void **state) {
  (void)state;
  vxm_rng rng = {51};
  for (int round = 0; round < 96; round++) {
    int kind = round % SOUP_KINDS;
    vxm_soup *soup = random_soup(context, 5000 + (uint64_t)round, kind == 2 ? 3 : kind, &soup_space);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.method = (vxm_method)(round / 8 % 5);
    options.vote = (vxm_vote)(VXM_VOTE_MAJORITY + round / 40 % 3);
    options.split_mode = (vxm_split_mode)(round / 3 % 3);
    check_transform(soup, &options, 10 + round, &rng, 6);
    vxm_soup_destroy(soup);
  }
}

/** Caps and winding numbers too: turning the mesh over does not turn it inside out. */
static void test_transforms_of_the_default_and_winding(void **state) {
  (void)state;
  vxm_rng rng = {52};
  for (int round = 0; round < 10; round++) {
    vxm_soup *soup = shape_empty(context);
    for (uint32_t i = 0; i < 3; i++) {
      double low[3], high[3];
      for (int a = 0; a < 3; a++) {
        low[a] = 20 * vxm_rng_unit(&rng);
        high[a] = low[a] + 3 + 10 * vxm_rng_unit(&rng);
      }
      triangle_box(soup, low, high, round % 2 ? i : 0, round % 4 > 1);
    }
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.split_mode = round % 3 ? VXM_SPLIT_MODE_AUTO : VXM_SPLIT_MODE_GROUP;
    check_transform(soup, &options, 24, &rng, 3);
    options.method = VXM_METHOD_WINDING;
    check_transform(soup, &options, 24, &rng, 3);
    vxm_soup_destroy(soup);
  }
}

static void test_identity_and_no_report(void **state) {
  (void)state;
  static const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  for (int kind = 0; kind < SOUP_KINDS; kind++) {
    vxm_soup *soup = random_soup(context, 60, kind, &soup_space);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    vxm_model *model = engine_model(soup, &options);
    vxm_grid *a = engine_grid(context, &soup_space), *b = engine_grid(context, &soup_space);
    memset(b->words, 0, b->word_count * sizeof *b->words);
    for (int64_t k = 0; k < 24; k++) /* all bits are replaced */
      for (int64_t j = 0; j < 22; j++)
        vxm_row_set_span(vxm_grid_row(a, j, k), 0, 20);
    vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
    assert_int_equal(vxm_model_voxelize(a, &report, model, NULL, NULL), VXM_OK);
    assert_int_equal(vxm_model_voxelize(b, NULL, model, identity, NULL), VXM_OK);
    assert_equal_bits(a, b);
    assert_true(report.hash == vxm_grid_hash(b) && report.voxels == vxm_grid_count(b));
    vxm_grid_destroy(a);
    vxm_grid_destroy(b);
    vxm_model_destroy(model);
    vxm_soup_destroy(soup);
  }
}

static void test_bad_matrices_are_refused(void **state) {
  (void)state;
  static const double flat[][12] = {{0},
                                    {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 5},
                                    {1, 2, 3, 0, 2, 4, 6, 0, 0, 0, 1, 0},
                                    {1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}};
  vxm_soup *soup = random_soup(context, 61, 6, &soup_space);
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_model *model = engine_model(soup, &options);
  vxm_grid *want = engine_solid(soup, &soup_space, &options, NULL), *grid = engine_grid(context, &soup_space);
  for (int i = 0; i < 4 + 36; i++) {
    double m[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    if (i < 4)
      memcpy(m, flat[i], sizeof m);
    else
      m[(i - 4) / 3] = (i - 4) % 3 == 0 ? NAN : (i - 4) % 3 == 1 ? INFINITY : -INFINITY;
    vxm_error error = VXM_ERROR_INIT;
    vxm_voxelize_report report = {.voxels = 7};
    assert_int_equal(vxm_model_voxelize(grid, &report, model, m, &error), VXM_ERROR_ARGUMENT);
    assert_int_equal(error.code, VXM_ERROR_ARGUMENT);
    assert_int_equal(report.voxels, 0);
  }
  /* Finite, but it takes the mesh out of reach. */
  double far[12] = {1e200, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  assert_int_equal(vxm_model_voxelize(grid, NULL, model, far, NULL), VXM_ERROR_RANGE);
  assert_int_equal(vxm_model_voxelize(grid, NULL, model, NULL, NULL), VXM_OK);
  assert_equal_bits(want, grid);
  vxm_grid_destroy(want);
  vxm_grid_destroy(grid);
  vxm_model_destroy(model);
  vxm_soup_destroy(soup);
}

/* ---- One model, many grids ---- */

/** All ways a model may work. */
static vxm_voxelize_options options_of(int way) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.method = way < 6 ? (vxm_method)way : VXM_METHOD_VOTE;
  options.vote = way == 6 ? VXM_VOTE_MAJORITY : way == 7 ? VXM_VOTE_ANY : VXM_VOTE_AUTO;
  options.split_mode = way == 7   ? VXM_SPLIT_MODE_GROUP
                       : way == 8 ? VXM_SPLIT_MODE_WHOLE
                                  : VXM_SPLIT_MODE_AUTO;
  options.mode = way == 9 ? VXM_MODE_BOTH : way == 10 ? VXM_MODE_SURFACE : VXM_MODE_SOLID;
  options.confidence = way >= 8;
  return options;
}
enum { WAYS = 11 };

static void assert_same_grid(const vxm_grid *a, const vxm_grid *b) {
  assert_equal_bits(a, b);
  assert_true((a->confidence != NULL) == (b->confidence != NULL));
  if (a->confidence)
    assert_memory_equal(a->confidence, b->confidence,
                        (size_t)(a->space.dims[0] * a->space.dims[1] * a->space.dims[2]));
}

static vxm_space random_space(vxm_rng *rng) {
  vxm_space space = soup_space;
  for (int a = 0; a < 3; a++) {
    space.dims[a] = 1 + (int64_t)vxm_rng_below(rng, vxm_rng_below(rng, 4) ? 30 : 140);
    space.voxel_size[a] = 30.0 / (double)space.dims[a] * (0.5 + vxm_rng_unit(rng));
    space.origin[a] = 20 * (vxm_rng_unit(rng) - 0.5);
  }
  return space;
}

static void test_grids_of_one_model_are_those_of_fresh_models(void **state) {
  (void)state;
  vxm_rng rng = {53};
  for (int round = 0; round < 2 * WAYS; round++) {
    int kind = round % SOUP_KINDS;
    vxm_soup *soup = random_soup(context, 70 + (uint64_t)round, kind == 6 ? 7 : kind, &soup_space);
    vxm_voxelize_options options = options_of(round % WAYS);
    vxm_model *model = engine_model(soup, &options);
    for (int i = 0; i < (options.method == VXM_METHOD_WINDING ? 3 : 6); i++) {
      vxm_space space = random_space(&rng);
      vxm_voxelize_report want_report = VXM_VOXELIZE_REPORT_INIT, report = VXM_VOXELIZE_REPORT_INIT;
      vxm_grid *want = engine_solid(soup, &space, &options, &want_report),
               *grid = engine_grid(context, &space);
      assert_int_equal(vxm_model_voxelize(grid, &report, model, NULL, NULL), VXM_OK);
      assert_same_grid(want, grid);
      assert_equal_reports(&want_report, &report);
      assert_int_equal(vxm_model_warning_count(model), vxm_grid_warning_count(want));
      for (int64_t w = 0; w < vxm_model_warning_count(model); w++)
        assert_string_equal(vxm_model_warning(model, w), vxm_grid_warning(want, w));
      vxm_grid_destroy(want);
      vxm_grid_destroy(grid);
    }
    vxm_model_destroy(model);
    vxm_soup_destroy(soup);
  }
}

/** A model that keeps no confidence, used on a grid that has one. */
static void test_grids_that_bring_a_confidence(void **state) {
  (void)state;
  for (int kind = 0; kind < SOUP_KINDS; kind++)
    for (int way = 0; way < 8; way++) {
      vxm_soup *soup = random_soup(context, 80, kind, &soup_space);
      vxm_voxelize_options options = options_of(way);
      options.confidence = true;
      vxm_grid *want = engine_solid(soup, &soup_space, &options, NULL);
      options.confidence = false;
      vxm_model *model = engine_model(soup, &options);
      vxm_grid *grid = engine_grid(context, &soup_space);
      assert_int_equal(vxm_grid_add_confidence(grid, NULL), VXM_OK);
      assert_int_equal(vxm_model_voxelize(grid, NULL, model, NULL, NULL), VXM_OK);
      assert_same_grid(want, grid);
      vxm_grid_destroy(want);
      vxm_grid_destroy(grid);
      vxm_model_destroy(model);
      vxm_soup_destroy(soup);
    }
}

/* ---- After a failure ---- */

typedef struct countdown {
  int left; /* calls until it asks to stop; negative = never */
} countdown;

static int count_down(const char *phase, double fraction, void *payload) {
  (void)phase;
  (void)fraction;
  countdown *c = payload;
  return c->left >= 0 && c->left-- == 0;
}

static void test_models_survive_cancelling(void **state) {
  (void)state;
  for (int way = 0; way < WAYS; way++)
    for (int threads = 1; threads <= 3; threads += 2) {
      countdown count = {-1};
      vxm_context_options wanted = VXM_CONTEXT_OPTIONS_INIT;
      wanted.threads = threads;
      wanted.progress = count_down;
      wanted.payload = &count;
      vxm_context *own;
      assert_int_equal(vxm_context_create(&own, &wanted, NULL), VXM_OK);
      vxm_soup *soup = random_soup(own, 90, way % 3 ? 7 : 6, &soup_space);
      vxm_voxelize_options options = options_of(way);
      vxm_space space = engine_space(40, 42, 44);
      vxm_grid *want = engine_solid(soup, &space, &options, NULL), *grid = engine_grid(own, &space);
      vxm_model *model = engine_model(soup, &options);
      vxm_status status = VXM_ERROR_CANCELLED;
      int cancelled = 0;
      for (int calls = 0; status != VXM_OK; calls += 1 + calls / 3, cancelled++) {
        count.left = calls;
        vxm_error error = VXM_ERROR_INIT;
        status = vxm_model_voxelize(grid, NULL, model, NULL, &error);
        assert_true(status == VXM_OK || (status == VXM_ERROR_CANCELLED && error.code == status));
        if (calls % 2 && status != VXM_OK) { /* the next one runs through: nothing is left of this one */
          count.left = -1;
          assert_int_equal(vxm_model_voxelize(grid, NULL, model, NULL, NULL), VXM_OK);
          assert_same_grid(want, grid);
        }
      }
      assert_true(cancelled > 1);
      assert_same_grid(want, grid);
      vxm_model_destroy(model);
      vxm_grid_destroy(grid);
      vxm_grid_destroy(want);
      vxm_soup_destroy(soup);
      vxm_context_destroy(own);
    }
}

/** The memory that is left grows from run to run, so that allocations fail one after another. */
static void test_models_survive_a_lack_of_memory(void **state) {
  (void)state;
  for (int way = 0; way < WAYS; way++)
    for (int threads = 1; threads <= 7; threads += 6) {
      vxm_context *own = context_of(threads, 0);
      vxm_soup *soup = random_soup(own, 91, way == 4 ? 1 : way % 2 ? 7 : 6, &soup_space);
      vxm_voxelize_options options = options_of(way);
      vxm_space space = engine_space(40, 42, 44);
      vxm_grid *want = engine_solid(soup, &space, &options, NULL), *grid = engine_grid(own, &space);
      vxm_model *model = engine_model(soup, &options);
      vxm_status status = VXM_ERROR_MEMORY_LIMIT;
      int refused = 0;
      for (size_t left = 0; status != VXM_OK; left += 128 + left / 24) {
        leave_memory(own, left);
        vxm_error error = VXM_ERROR_INIT;
        status = vxm_model_voxelize(grid, NULL, model, NULL, &error);
        assert_true(status == VXM_OK || (status == VXM_ERROR_MEMORY_LIMIT && error.code == status));
        refused += status != VXM_OK;
        leave_memory(own, SIZE_MAX);
        if (status != VXM_OK && refused % 32 == 31) { /* with all the memory a fresh one of them works */
          vxm_model_destroy(model);
          model = engine_model(soup, &options);
        }
      }
      assert_true(refused > 1);
      assert_same_grid(want, grid);
      assert_int_equal(vxm_model_voxelize(grid, NULL, model, NULL, NULL), VXM_OK);
      assert_same_grid(want, grid);
      vxm_model_destroy(model);
      vxm_grid_destroy(grid);
      vxm_grid_destroy(want);
      vxm_soup_destroy(soup);
      assert_int_equal(memory_used(own), 0);
      vxm_context_destroy(own);
    }
}

/** Making models under a lack of memory: refused cleanly, and nothing is kept. */
static void test_making_a_model_under_a_lack_of_memory(void **state) {
  (void)state;
  for (int kind = 0; kind < SOUP_KINDS; kind++) {
    vxm_context *own = context_of(2, 0);
    vxm_soup *soup = random_soup(own, 92, kind, &soup_space);
    size_t before = memory_used(own);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    vxm_status status = VXM_ERROR_MEMORY_LIMIT;
    for (size_t left = 0; status != VXM_OK; left += 128 + left / 32) {
      leave_memory(own, left);
      vxm_error error = VXM_ERROR_INIT;
      vxm_model *model;
      status = vxm_model_create(&model, soup, &options, &error);
      assert_true((status == VXM_OK) == (model != NULL));
      assert_true(status == VXM_OK || (status == VXM_ERROR_MEMORY_LIMIT && error.code == status));
      vxm_model_destroy(model);
      assert_int_equal(memory_used(own), before);
    }
    vxm_soup_destroy(soup);
    vxm_context_destroy(own);
  }
}

/** The second grid of a size costs no memory. */
static void test_later_grids_cost_no_allocation(void **state) {
  (void)state;
  for (int way = 0; way < 8; way++) {
    vxm_context *own = context_of(1, 0);
    vxm_soup *soup = random_soup(own, 93, 5, &soup_space);
    vxm_voxelize_options options = options_of(way);
    vxm_model *model = engine_model(soup, &options);
    vxm_grid *grid = engine_grid(own, &soup_space);
    assert_int_equal(vxm_model_voxelize(grid, NULL, model, NULL, NULL), VXM_OK);
    size_t after_first = memory_used(own);
    for (int i = 0; i < 3; i++)
      assert_int_equal(vxm_model_voxelize(grid, NULL, model, NULL, NULL), VXM_OK);
    assert_int_equal(memory_used(own), after_first);
    vxm_model_destroy(model);
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
    vxm_context_destroy(own);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_a_transform_is_a_transformed_mesh),
      cmocka_unit_test(test_transforms_of_the_default_and_winding),
      cmocka_unit_test(test_identity_and_no_report),
      cmocka_unit_test(test_bad_matrices_are_refused),
      cmocka_unit_test(test_grids_of_one_model_are_those_of_fresh_models),
      cmocka_unit_test(test_grids_that_bring_a_confidence),
      cmocka_unit_test(test_models_survive_cancelling),
      cmocka_unit_test(test_models_survive_a_lack_of_memory),
      cmocka_unit_test(test_making_a_model_under_a_lack_of_memory),
      cmocka_unit_test(test_later_grids_cost_no_allocation),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** Windows made one after another, in any layout, are the grid made as a whole; whatever the threads. */
#include "../base/rounds.h"
#include "engine.h"

#include "base/cpu.h"

#include "grid/count_hash.h"
#include "voxel/model/model_report.h"

static const vxm_layout layouts[6] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
static const int thread_counts[3] = {1, 2, 7};
static vxm_context *contexts[3];

static int setup_contexts(void **state) {
  (void)state;
  for (int t = 0; t < 3; t++)
    contexts[t] = context_of(thread_counts[t], 0);
  return setup(state);
}

static int teardown_contexts(void **state) {
  for (int t = 0; t < 3; t++)
    vxm_context_destroy(contexts[t]);
  return teardown(state);
}

static void assert_window_is(const vxm_window *window, const vxm_grid *grid) {
  int64_t p[3];
  for (int64_t slow = window->begin; slow < window->end; slow++)
    for (int64_t middle = 0; middle < window->middle_dim; middle++) {
      const uint64_t *row = vxm_window_row(window, middle, slow);
      for (int64_t fast = 0; fast < window->fast_dim; fast++) {
        p[window->layout.fast] = fast;
        p[window->layout.middle] = middle;
        p[window->layout.slow] = slow;
        if ((row[fast / 64] >> (fast % 64) & 1) != vxm_grid_get(grid, p[0], p[1], p[2]))
          fail_msg("layout %d %d %d, slices %lld to %lld: voxel %lld %lld %lld differs", window->layout.fast,
                   window->layout.middle, window->layout.slow, (long long)window->begin,
                   (long long)window->end, (long long)p[0], (long long)p[1], (long long)p[2]);
      }
      assert_true((row[window->row_words - 1] & ~vxm_window_tail_mask(window)) == 0);
    }
}

/** Cuts the slices at random and fills window after window, each in a block of its own size. */
static void check_windows(vxm_model *model, const vxm_grid *whole, const vxm_voxelize_report *want,
                          vxm_layout layout, int64_t most, vxm_rng *rng) {
  const vxm_space *space = &whole->space;
  vxm_error error = VXM_ERROR_INIT;
  vxm_model_pass *pass;
  if (vxm_model_begin(&pass, model, space, NULL, NULL, &error) != VXM_OK)
    fail_msg("%s", error.text);
  vxm_count_hash sum = vxm_count_hash_start(space);
  uint64_t *before = NULL;
  for (int64_t begin = 0, end; begin < space->dims[layout.slow]; begin = end) {
    end = vxm_min(begin + 1 + (int64_t)vxm_rng_below(rng, (uint64_t)most), space->dims[layout.slow]);
    vxm_window window = vxm_window_of(space, layout, begin, end);
    size_t count = window.slice_words * (size_t)(end - begin);
    window.words = malloc(count * sizeof *window.words);
    assert_non_null(window.words);
    memset(window.words, 0xa5, count * sizeof *window.words); /* to be replaced */
    if (vxm_model_pass_fill(pass, &window, &error) != VXM_OK)
      fail_msg("%s", error.text);
    assert_window_is(&window, whole);
    vxm_count_hash_add(&sum, model->context, &window, before);
    free(before);
    before = malloc(window.slice_words * sizeof *before);
    assert_non_null(before);
    memcpy(before, window.words + count - window.slice_words, window.slice_words * sizeof *before);
    free(window.words);
  }
  free(before);
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  vxm_model_report(pass, &report, sum.count, sum.hash);
  vxm_model_close(model, pass);
  assert_equal_reports(&report, want);
}

static vxm_space random_space(vxm_rng *rng) {
  static const int64_t sides[] = {1, 5, 12, 31, 63, 64, 65, 70, 130};
  vxm_space space = engine_space(1, 1, 1);
  for (int a = 0; a < 3; a++)
    space.dims[a] = vxm_rng_below(rng, 3) ? 6 + (int64_t)vxm_rng_below(rng, 18)
                                          : sides[vxm_rng_below(rng, a == 0 ? 9 : 8)];
  return space;
}

/** The same soup in contexts of 1, 2 and 7 threads: a whole grid from the first, windows from all. */
static void check_soup(uint64_t seed, int kind, const vxm_space *space, const vxm_voxelize_options *options,
                       int layout_step, vxm_rng *rng) {
  vxm_grid *whole = NULL;
  vxm_voxelize_report want = VXM_VOXELIZE_REPORT_INIT;
  for (int t = 0; t < 3; t++) {
    vxm_soup *soup = random_soup(contexts[t], seed, kind, space);
    if (t == 0)
      whole = engine_solid(soup, space, options, &want);
    vxm_model *model = engine_model(soup, options);
    for (int l = t % layout_step; l < 6; l += layout_step) {
      int64_t slices = space->dims[layouts[l].slow];
      check_windows(model, whole, &want, layouts[l], l % 2 ? 1 + slices / 3 : 1 + slices / 8, rng);
    }
    vxm_model_destroy(model);
    vxm_soup_destroy(soup);
  }
  vxm_grid_destroy(whole);
}

/** Every method of one voter, for every kind of soup. */
static void test_windows_of_one_voter(void **state) {
  (void)state;
  vxm_rng rng = {31};
  for (int round = 0; round < ROUNDS(96); round++) {
    vxm_space space = random_space(&rng);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.method = (vxm_method)(VXM_METHOD_X + round % 3);
    if (round % 8 == 7)
      options.method = VXM_METHOD_TETRA;
    options.split_mode = (vxm_split_mode)(round / 3 % 3);
    options.cavities = (vxm_cavities)(round / 9 % 3);
    check_soup(1000 + (uint64_t)round, round / 3 % SOUP_KINDS, &space, &options, 2, &rng);
  }
}

/** Votes: the voter along slices is carried from window to window. */
static void test_windows_of_votes(void **state) {
  (void)state;
  vxm_rng rng = {32};
  for (int round = 0; round < ROUNDS(96); round++) {
    vxm_space space = random_space(&rng);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.vote = (vxm_vote)(VXM_VOTE_MAJORITY + round % 3);
    options.vote_always = round / 3 % 2;
    options.split_mode = round % 5 ? VXM_SPLIT_MODE_WHOLE : (vxm_split_mode)(round / 5 % 2);
    check_soup(2000 + (uint64_t)round, round / 6 % SOUP_KINDS, &space, &options, 2, &rng);
  }
}

/** The default, with caps and the winding number where voters disagree. */
static void test_windows_of_the_default(void **state) {
  (void)state;
  vxm_rng rng = {33};
  for (int round = 0; round < ROUNDS(24); round++) {
    vxm_space space = random_space(&rng);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.split_mode = round % 4 == 3 ? VXM_SPLIT_MODE_WHOLE : (vxm_split_mode)(round % 2);
    check_soup(3000 + (uint64_t)round, round % SOUP_KINDS, &space, &options, 3, &rng);
  }
}

static void test_windows_of_the_winding_number(void **state) {
  (void)state;
  vxm_rng rng = {34};
  for (int round = 0; round < 8; round++) {
    vxm_space space = random_space(&rng);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.method = VXM_METHOD_WINDING;
    check_soup(4000 + (uint64_t)round, round, &space, &options, 3, &rng);
  }
}

/** One slice at a time, a sheet that is open along the slices: what it opens stays open to the end. */
static void test_sheets_are_carried_to_the_end(void **state) {
  (void)state;
  vxm_rng rng = {35};
  vxm_space space = engine_space(20, 21, 22);
  for (int axis = 0; axis < 3; axis++)
    for (int at = -3; at < 26; at += 4) {
      vxm_soup *soup = shape_empty(context);
      uint32_t v[3];
      for (int k = 0; k < 3; k++) {
        double p[3] = {-50, -50, -50};
        p[(axis + 1) % 3] = k == 1 ? 150 : -50;
        p[(axis + 2) % 3] = k == 2 ? 150 : -50;
        p[axis] = at + 0.25;
        v[k] = shape_vertex(soup, p[0], p[1], p[2]);
      }
      shape_triangle(soup, v[0], v[1], v[2]);
      vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
      options.vote = VXM_VOTE_ANY;
      vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
      vxm_grid *grid = engine_solid(soup, &space, &options, &report);
      int64_t behind = vxm_min(vxm_max(space.dims[axis] - at, 0), space.dims[axis]);
      /* The tetrahedra of one triangle are flat, and the other axes see it edge on. */
      assert_int_equal(report.voxels, 20 * 21 * 22 / space.dims[axis] * behind);
      vxm_model *model = engine_model(soup, &options);
      for (int l = 0; l < 6; l++)
        check_windows(model, grid, &report, layouts[l], 1 + l % 2, &rng);
      vxm_model_destroy(model);
      vxm_grid_destroy(grid);
      vxm_soup_destroy(soup);
    }
}

/** Parts that set no voxel are counted alike, whatever the axis, the layout and the windows. */
static void test_empty_parts_are_counted_alike(void **state) {
  (void)state;
  vxm_rng rng = {36};
  vxm_space space = engine_space(12, 13, 14);
  for (int boxes = 1; boxes < 4; boxes++)
    for (int method = VXM_METHOD_VOTE; method <= VXM_METHOD_TETRA; method++) {
      vxm_soup *soup = shape_empty(context);
      /* Between two layers of centres: all columns are crossed twice before the same voxel. */
      for (int b = 0; b < boxes; b++) {
        double low[3] = {1, 1, 1}, high[3] = {9, 9, 9};
        low[b] = 3.6, high[b] = 4.4;
        triangle_box(soup, low, high, 0, false);
      }
      vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
      options.method = (vxm_method)method;
      options.split_mode = VXM_SPLIT_MODE_GROUP;
      options.thin = VXM_THIN_DROP;
      vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
      vxm_grid *grid = engine_solid(soup, &space, &options, &report);
      assert_int_equal(report.voxels, 0);
      assert_int_equal(report.parts, boxes);
      assert_int_equal(report.empty_parts, boxes);
      vxm_model *model = engine_model(soup, &options);
      for (int l = 0; l < 6; l++)
        check_windows(model, grid, &report, layouts[l], 5, &rng);
      vxm_model_destroy(model);
      vxm_grid_destroy(grid);
      vxm_soup_destroy(soup);
    }
}

/** Parts where the grid is not are told apart from parts that are too thin for it. */
static void test_parts_outside(void **state) {
  (void)state;
  static const struct {
    double low[3], high[3];
    bool outside;
  } parts[] = {
      {{-9, 1, 1}, {-2, 9, 9}, true},        /* before the grid */
      {{20, 20, 20}, {29, 29, 29}, true},    /* behind it */
      {{3, -5, 3}, {9, 0, 9}, true},         /* at its side */
      {{3, 3, 13.75}, {9, 9, 30}, true},     /* reaches in, but not to a layer of centres */
      {{3.6, 1, 1}, {4.4, 9, 9}, false},     /* between two layers */
      {{1, 1, -0.125}, {9, 9, 0.125}, false} /* a sheet at the side of the grid */
  };
  enum { PARTS = sizeof parts / sizeof *parts };
  vxm_space space = engine_space(12, 13, 14);
  for (int with = 0; with < 2; with++)
    for (int method = VXM_METHOD_VOTE; method <= VXM_METHOD_TETRA; method++) {
      vxm_soup *soup = shape_empty(context);
      int64_t outside = 0;
      for (size_t p = 0; p < PARTS; p++) {
        triangle_box(soup, parts[p].low, parts[p].high, 0, false);
        outside += parts[p].outside;
      }
      if (with)
        triangle_box(soup, (double[3]){2, 2, 2}, (double[3]){8, 8, 8}, 0, false);
      vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
      options.method = (vxm_method)method;
      options.split_mode = VXM_SPLIT_MODE_GROUP;
      for (int thin = VXM_THIN_KEEP; thin <= VXM_THIN_DROP; thin++) {
        options.thin = (vxm_thin_parts)thin;
        vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
        vxm_grid *grid = engine_solid(soup, &space, &options, &report);
        assert_int_equal(report.parts, PARTS + with);
        assert_int_equal(report.outside_parts, outside);
        assert_int_equal(report.empty_parts, thin == VXM_THIN_DROP ? PARTS - outside : 0);
        vxm_grid_destroy(grid);
      }
      vxm_soup_destroy(soup);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_windows_of_one_voter),
      cmocka_unit_test(test_windows_of_votes),
      cmocka_unit_test(test_windows_of_the_default),
      cmocka_unit_test(test_windows_of_the_winding_number),
      cmocka_unit_test(test_sheets_are_carried_to_the_end),
      cmocka_unit_test(test_empty_parts_are_counted_alike),
      cmocka_unit_test(test_parts_outside),
  };
  int failed = 0;
  for (int level = VXM_CPU_PLAIN; level <= (int)vxm_cpu_highest(); level++)
    if (vxm_cpu_limit((vxm_cpu_level)level, NULL) == VXM_OK)
      failed |= cmocka_run_group_tests(tests, setup_contexts, teardown_contexts);
  return failed;
}

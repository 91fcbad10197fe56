/* SPDX-License-Identifier: BSD-3-Clause */
/** Where thin parts are kept and where not, and what is said about them. */
#include "thin_meshes.h"

#include "voxel/model/model.h"

static const vxm_space cube16 = {{16, 16, 16}, {0, 0, 0}, {1, 1, 1}};

static bool have_equal_bits(const vxm_grid *a, const vxm_grid *b) {
  return memcmp(a->words, b->words, a->word_count * sizeof *a->words) == 0;
}

static vxm_grid *grid_of(const vxm_soup *soup, vxm_method method, vxm_vote vote, vxm_thin_parts thin,
                         vxm_voxelize_report *report) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.method = method;
  options.vote = vote;
  options.thin = thin;
  return engine_solid(soup, &cube16, &options, report);
}

/** A closed body that is thin here and there. */
static vxm_soup *random_body(vxm_rng *rng, int round) {
  vxm_soup *soup = shape_empty(context);
  thin_add_soup(soup, rng, round % 6, &cube16);
  return soup;
}

/** The voxels whose centre is inside, by brute force. */
static void test_drop_has_centres(void **state) {
  (void)state;
  vxm_rng rng = {701};
  for (int round = 0; round < 60; round++) {
    vxm_soup *soup = random_body(&rng, round);
    uint8_t *want = calloc(16 * 16 * 16, 1);
    assert_non_null(want);
    exact_unite(want, soup, 0, soup->face_count, &cube16, round % 3);
    vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
    vxm_grid *grid = grid_of(soup, VXM_METHOD_VOTE, VXM_VOTE_AUTO, VXM_THIN_DROP, &report);
    assert_grid_is(grid, want);
    assert_int_equal(report.thin_voxels, 0);
    assert_true(report.thin_share == 0);
    vxm_grid_destroy(grid);
    free(want);
    vxm_soup_destroy(soup);
  }
}

/** The default keeps thin parts; who asks for a rule of the papers gets that alone, unless thin parts are
 * asked for, too. */
static void test_automatic_choice(void **state) {
  (void)state;
  static const struct {
    vxm_method method;
    vxm_vote vote;
    bool keeps;
  } cases[] = {{VXM_METHOD_VOTE, VXM_VOTE_AUTO, true},    {VXM_METHOD_VOTE, VXM_VOTE_MAJORITY, false},
               {VXM_METHOD_VOTE, VXM_VOTE_ANY, false},    {VXM_METHOD_VOTE, VXM_VOTE_ALL, false},
               {VXM_METHOD_X, VXM_VOTE_AUTO, false},      {VXM_METHOD_Y, VXM_VOTE_AUTO, false},
               {VXM_METHOD_Z, VXM_VOTE_AUTO, false},      {VXM_METHOD_TETRA, VXM_VOTE_AUTO, false},
               {VXM_METHOD_WINDING, VXM_VOTE_AUTO, false}};
  vxm_rng rng = {702};
  vxm_soup *soup = random_body(&rng, 1);
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    vxm_grid *grid[4];
    vxm_voxelize_report report[4];
    for (int thin = 0; thin < 4; thin++) {
      report[thin] = (vxm_voxelize_report)VXM_VOXELIZE_REPORT_INIT;
      grid[thin] = grid_of(soup, cases[c].method, cases[c].vote, (vxm_thin_parts)thin, &report[thin]);
    }
    assert_false(have_equal_bits(grid[VXM_THIN_KEEP], grid[VXM_THIN_DROP]));
    assert_equal_bits(grid[VXM_THIN_AUTO], grid[cases[c].keeps ? VXM_THIN_KEEP : VXM_THIN_DROP]);
    for (int thin = 0; thin < 4; thin++) {
      assert_int_equal(report[thin].thin_voxels,
                       vxm_grid_count(grid[thin]) - vxm_grid_count(grid[VXM_THIN_DROP]));
      assert_int_equal(report[thin].thin_share > 0, report[thin].thin_voxels > 0);
    }
    for (int thin = 0; thin < 4; thin++)
      vxm_grid_destroy(grid[thin]);
  }
  vxm_soup_destroy(soup);
}

/** Coverage and distances tell of the mesh itself. */
static void test_fields_stay(void **state) {
  (void)state;
  enum { VOXELS = 16 * 16 * 16 };
  vxm_rng rng = {703};
  for (int round = 0; round < 12; round++) {
    vxm_soup *soup = random_body(&rng, round);
    float *values[2][2];
    for (int k = 0; k < 2; k++) {
      vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
      options.thin = k ? VXM_THIN_KEEP26 : VXM_THIN_DROP;
      vxm_model *model = engine_model(soup, &options);
      vxm_coverage_options coverage = VXM_COVERAGE_OPTIONS_INIT;
      vxm_distance_options distance = VXM_DISTANCE_OPTIONS_INIT;
      for (int f = 0; f < 2; f++) {
        values[k][f] = calloc(VOXELS, sizeof **values[k]);
        assert_non_null(values[k][f]);
      }
      vxm_grid *grid = engine_grid(context, &cube16); /* a pass that keeps them comes before */
      assert_int_equal(vxm_model_voxelize(grid, NULL, model, NULL, NULL), VXM_OK);
      assert_int_equal(vxm_model_coverage(values[k][0], NULL, model, &cube16, &coverage, NULL), VXM_OK);
      assert_int_equal(vxm_model_distance(values[k][1], NULL, model, &cube16, &distance, NULL), VXM_OK);
      vxm_grid *again = engine_grid(context, &cube16); /* and one after */
      assert_int_equal(vxm_model_voxelize(again, NULL, model, NULL, NULL), VXM_OK);
      assert_equal_bits(grid, again);
      vxm_grid_destroy(grid);
      vxm_grid_destroy(again);
      vxm_model_destroy(model);
    }
    for (int f = 0; f < 2; f++) {
      assert_memory_equal(values[0][f], values[1][f], VOXELS * sizeof **values[0]);
      free(values[0][f]);
      free(values[1][f]);
    }
    vxm_soup_destroy(soup);
  }
}

/** What is added is sure; the confidence of all others stays. */
static void test_confidence(void **state) {
  (void)state;
  vxm_rng rng = {704};
  int64_t added = 0;
  for (int round = 0; round < 2 * SOUP_KINDS; round++) {
    vxm_soup *soup = random_soup(context, 710 + (uint64_t)round, round % SOUP_KINDS, &cube16);
    thin_add_soup(soup, &rng, round % 2, &cube16);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.confidence = true;
    options.thin = VXM_THIN_DROP;
    vxm_grid *centres = engine_solid(soup, &cube16, &options, NULL);
    options.thin = VXM_THIN_KEEP;
    vxm_grid *grid = engine_solid(soup, &cube16, &options, NULL);
    const uint8_t *before = vxm_grid_confidence(centres), *after = vxm_grid_confidence(grid);
    assert_true(before && after);
    for (int64_t z = 0; z < 16; z++)
      for (int64_t y = 0; y < 16; y++)
        for (int64_t x = 0; x < 16; x++) {
          int64_t i = (z * 16 + y) * 16 + x;
          bool is_new = vxm_grid_get(grid, x, y, z) && !vxm_grid_get(centres, x, y, z);
          assert_int_equal(after[i], is_new ? 255 : before[i]);
          added += is_new;
        }
    vxm_grid_destroy(centres);
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
  }
  assert_true(added > 100);
}

/** A plate over whole voxels: each column of it counts on both sides, and its rim does not. */
static void test_thin_share(void **state) {
  (void)state;
  for (int axis = 0; axis < 3; axis++)
    for (int with = 0; with < 2; with++) {
      vxm_soup *soup = shape_empty(context);
      double low[3] = {1, 1, 1}, high[3] = {11, 11, 11};
      low[axis] = 3.625;
      high[axis] = 3.875; /* 2 * 10 * 10 squares, and 4 * 10 * 1/4 at the rim */
      double thin = 200, all = 210;
      triangle_box(soup, low, high, 0, false);
      if (with) {
        low[axis] = 7;
        high[axis] = 12; /* 2 * 10 * 10 and 4 * 10 * 5 */
        triangle_box(soup, low, high, 0, false);
        all += 400;
      }
      vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
      vxm_grid *grid = thin_grid(soup, &cube16, VXM_THIN_KEEP, &report);
      assert_int_equal(report.thin_voxels, 100);
      assert_true(fabs(report.thin_share - thin / all) < 1e-9);
      assert_int_equal(report.empty_parts, 0);
      vxm_grid_destroy(grid);
      grid = thin_grid(soup, &cube16, VXM_THIN_DROP, &report);
      assert_int_equal(report.thin_voxels, 0);
      assert_true(report.thin_share == 0);
      assert_int_equal(report.empty_parts, 1);
      vxm_grid_destroy(grid);
      vxm_soup_destroy(soup);
    }
}

/** A plate at an angle: nearly all of its area is thin. */
static void test_thin_share_at_an_angle(void **state) {
  (void)state;
  vxm_rng rng = {705};
  vxm_space space = engine_space(60, 60, 60);
  for (int round = 0; round < 6; round++) {
    double frame[3][3];
    thin_frame(&rng, frame);
    vxm_soup *soup = shape_empty(context);
    thin_turned_box(soup, (double[3]){30, 30, 30}, frame, (double[3]){20, 20, 0.05});
    vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
    vxm_grid_destroy(thin_grid(soup, &space, VXM_THIN_KEEP, &report));
    assert_true(report.thin_share > 0.75 && report.thin_share <= 1);
    vxm_soup_destroy(soup);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_drop_has_centres), cmocka_unit_test(test_automatic_choice),
      cmocka_unit_test(test_fields_stay),      cmocka_unit_test(test_confidence),
      cmocka_unit_test(test_thin_share),       cmocka_unit_test(test_thin_share_at_an_angle),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}

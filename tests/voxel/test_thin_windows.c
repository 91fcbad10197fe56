/* SPDX-License-Identifier: BSD-3-Clause */
/** Thin parts are the same whatever the threads, the windows and the form of the grid, and do not depend on
 * how the mesh lies. */
#include "thin_meshes.h"
#include "thin_oracle.h"

#include "grid/octree.h"
#include "voxel/model/model_report.h"
#include "voxel/sparse/sparse.h"

static vxm_context *contexts[3]; /* of 1, 2 and 3 threads */

static int setup_contexts(void **state) {
  for (int t = 0; t < 3; t++)
    contexts[t] = context_of(t + 1, 0);
  return setup(state);
}

static int teardown_contexts(void **state) {
  for (int t = 0; t < 3; t++)
    vxm_context_destroy(contexts[t]);
  return teardown(state);
}

static const vxm_layout layouts[6] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};

/** Windows of `height` slices, one after another. */
static void check_windows(vxm_model *model, const vxm_grid *whole, vxm_layout layout, int64_t height,
                          int64_t thin_voxels, double thin_share) {
  const vxm_space *space = &whole->space;
  vxm_error error = VXM_ERROR_INIT;
  vxm_model_pass *pass;
  if (vxm_model_begin(&pass, model, space, NULL, NULL, &error) != VXM_OK)
    fail_msg("%s", error.text);
  for (int64_t begin = 0, end; begin < space->dims[layout.slow]; begin = end) {
    end = vxm_min(begin + height, space->dims[layout.slow]);
    vxm_window window = vxm_window_of(space, layout, begin, end);
    window.words = calloc(window.slice_words * (size_t)(end - begin), sizeof *window.words);
    assert_non_null(window.words);
    if (vxm_model_pass_fill(pass, &window, &error) != VXM_OK)
      fail_msg("%s", error.text);
    int64_t v[3];
    for (v[layout.slow] = begin; v[layout.slow] < end; v[layout.slow]++)
      for (v[layout.middle] = 0; v[layout.middle] < space->dims[layout.middle]; v[layout.middle]++)
        for (v[layout.fast] = 0; v[layout.fast] < space->dims[layout.fast]; v[layout.fast]++) {
          int64_t fast = v[layout.fast];
          const uint64_t *row = vxm_window_row(&window, v[layout.middle], v[layout.slow]);
          if ((row[fast / 64] >> (fast % 64) & 1) != vxm_grid_get(whole, v[0], v[1], v[2]))
            fail_msg("layout %d %d %d, windows of %d: voxel %d %d %d differs", layout.fast, layout.middle,
                     layout.slow, (int)height, (int)v[0], (int)v[1], (int)v[2]);
        }
    free(window.words);
  }
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  vxm_model_report(pass, &report, 0, 0);
  assert_int_equal(report.thin_voxels, thin_voxels);
  assert_true(fabs(report.thin_share - thin_share) < 1e-9);
  vxm_model_close(model, pass);
}

/** Sheets a voxel apart: each link between two slices is crossed, and which of them are left out is told from
 * the first one on. */
static void test_many_sheets(void **state) {
  (void)state;
  for (int axis = 0; axis < 3; axis++)
    for (int part = 0; part < ROUNDS(4); part++) {
      vxm_space space = engine_space(40, 40, 40);
      vxm_soup *soup = shape_empty(context);
      for (int sheet = 2; sheet < 38; sheet++) {
        uint32_t v[4];
        for (int c = 0; c < 4; c++) {
          double p[3];
          p[axis] = sheet + 0.25 * part + 0.1;
          p[(axis + 1) % 3] = c == 1 || c == 2 ? 38.1 : 2.2;
          p[(axis + 2) % 3] = c >= 2 ? 38.1 : 2.2;
          v[c] = shape_vertex(soup, p[0], p[1], p[2]);
        }
        shape_triangle(soup, v[0], v[1], v[2]);
        shape_triangle(soup, v[0], v[2], v[3]);
      }
      vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
      vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
      vxm_grid *whole = engine_solid(soup, &space, &options, &report);
      vxm_model *model = engine_model(soup, &options);
      for (int height = 1; height < 6; height++)
        check_windows(model, whole, layouts[(axis + 1) % 3], height, report.thin_voxels, report.thin_share);
      vxm_model_destroy(model);
      vxm_grid_destroy(whole);
      vxm_soup_destroy(soup);
    }
}

static void check_sparse_way(vxm_model *model, const vxm_grid *whole, int64_t thin_voxels,
                             double thin_share) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_sparse *octree, *again;
  vxm_grid *grid;
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  if (vxm_model_sparse(&octree, &report, model, &whole->space, NULL, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_int_equal(vxm_sparse_to_grid(&grid, octree, NULL), VXM_OK);
  assert_equal_bits(grid, whole);
  assert_int_equal(vxm_sparse_from_grid(&again, whole, NULL), VXM_OK); /* nodes are no more than are needed */
  assert_int_equal(octree->brick_count, again->brick_count);
  assert_int_equal(vxm_octree_nodes(octree), vxm_octree_nodes(again));
  vxm_sparse_destroy(again);
  assert_int_equal(report.thin_voxels, thin_voxels);
  assert_true(fabs(report.thin_share - thin_share) < 1e-9);
  vxm_grid_destroy(grid);
  vxm_sparse_destroy(octree);
}

/** An octree, made from the triangles and by way of a grid. */
static void check_sparse(vxm_model *model, const vxm_grid *whole, int64_t thin_voxels, double thin_share) {
  for (int direct = 0; direct < 2; direct++) {
    vxm_sparse_force_direct(direct);
    check_sparse_way(model, whole, thin_voxels, thin_share);
  }
  vxm_sparse_force_direct(false);
}

/** A soup in each context: the whole grid of the first is that of the others, in windows and as an octree. */
static void check_soup(const vxm_soup *soup, const vxm_space *space, const vxm_voxelize_options *options,
                       int round) {
  static const int64_t heights[3] = {1, 2, 5};
  vxm_grid *whole = NULL;
  vxm_voxelize_report want = VXM_VOXELIZE_REPORT_INIT;
  for (int t = 0; t < 3; t++) {
    vxm_soup *copy = shape_empty(contexts[t]);
    for (size_t v = 0; v < soup->vertex_count; v++)
      shape_vertex(copy, soup->positions[3 * v], soup->positions[3 * v + 1], soup->positions[3 * v + 2]);
    for (size_t f = 0; f < soup->face_count; f++)
      shape_face(copy, soup->indices + soup->offsets[f], soup->offsets[f + 1] - soup->offsets[f]);
    vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
    vxm_grid *grid = engine_solid(copy, space, options, &report);
    if (whole) {
      assert_equal_bits(grid, whole);
      vxm_grid_destroy(grid);
    } else {
      whole = grid;
      want = report;
    }
    assert_equal_reports(&report, &want);
    assert_int_equal(report.thin_voxels, want.thin_voxels);
    assert_true(fabs(report.thin_share - want.thin_share) < 1e-12);
    vxm_model *model = engine_model(copy, options);
    for (int w = 0; w < 2; w++)
      check_windows(model, whole, layouts[(3 * w + t + round) % 6], heights[(t + w + round / 6) % 3],
                    want.thin_voxels, want.thin_share);
    if (options->mode == VXM_MODE_SOLID)
      check_sparse(model, whole, want.thin_voxels, want.thin_share);
    vxm_model_destroy(model);
    vxm_soup_destroy(copy);
  }
  vxm_grid_destroy(whole);
}

static void test_random_soups(void **state) {
  (void)state;
  vxm_rng rng = {601};
  for (int round = 0; round < ROUNDS(45); round++) {
    vxm_space space = engine_space(1, 1, 1);
    for (int a = 0; a < 3; a++)
      space.dims[a] = 12 + (int64_t)vxm_rng_below(&rng, a == 0 ? 60 : 20);
    vxm_soup *soup = shape_empty(context);
    for (int p = 0; p < 3; p++)
      thin_add_soup(soup, &rng, (int)vxm_rng_below(&rng, THIN_KINDS), &space);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.thin = round % 3 ? VXM_THIN_KEEP : VXM_THIN_KEEP26;
    if (round % 10 == 9) {
      options.mode = round % 20 == 9 ? VXM_MODE_SURFACE : VXM_MODE_BOTH;
      options.surface = (vxm_surface_kind)(round / 10 % 5);
    }
    check_soup(soup, &space, &options, round);
    vxm_soup_destroy(soup);
  }
}

/** Soups of all kinds, part of them outside, and methods. */
static void test_soups_of_all_kinds(void **state) {
  (void)state;
  vxm_space space = engine_space(21, 19, 24);
  for (int round = 0; round < ROUNDS(2 * SOUP_KINDS); round++) {
    vxm_soup *soup = random_soup(context, 700 + (uint64_t)round, round % SOUP_KINDS, &space);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.thin = round % 3 ? VXM_THIN_KEEP : VXM_THIN_KEEP26;
    options.method = round / SOUP_KINDS == 3 ? VXM_METHOD_X : VXM_METHOD_VOTE;
    check_soup(soup, &space, &options, round);
    vxm_soup_destroy(soup);
  }
}

/** More triangles than one thread looks at at a time, and more meetings than are sorted by comparing. */
static void test_many_triangles(void **state) {
  (void)state;
  vxm_rng rng = {602};
  static const uint32_t cuts[] = {12, 40, 110};
  for (int round = 0; round < ROUNDS(6); round++) {
    vxm_space space = engine_space(50, 48, 40);
    vxm_soup *soup = shape_empty(context);
    thin_wave(soup, &rng, &space, cuts[round % 3]);
    thin_wave(soup, &rng, &space, cuts[(round + 1) % 3]);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.thin = round % 2 ? VXM_THIN_KEEP26 : VXM_THIN_KEEP;
    check_soup(soup, &space, &options, round);
    vxm_soup_destroy(soup);
  }
}

/** Scraps all over the grid: what is chosen in one place has consequences in others, which end where windows
 * stop looking; and letters among them, which meet links an even number of times. */
static void test_scraps(void **state) {
  (void)state;
  vxm_rng rng = {606};
  for (int round = 0; round < ROUNDS(12); round++) {
    vxm_space space = engine_space(18, 18, 18);
    vxm_soup *soup = shape_empty(context);
    int scraps = round % 2 ? 800 : 300;
    for (int i = 0; i < scraps; i++) {
      double centre[3], p[3];
      for (int a = 0; a < 3; a++)
        centre[a] = 18 * vxm_rng_unit(&rng);
      if (round % 4 == 3 && i % 4 == 0) {
        int axis = (int)vxm_rng_below(&rng, 3);
        thin_letter(soup, &rng, axis, centre[axis], 0.5 + 3 * vxm_rng_unit(&rng), centre);
        continue;
      }
      for (int k = 0; k < 3; k++) {
        for (int a = 0; a < 3; a++)
          p[a] = centre[a] + 1.6 * vxm_rng_unit(&rng) - 0.8;
        shape_vertex(soup, p[0], p[1], p[2]);
      }
      uint32_t last = (uint32_t)soup->vertex_count;
      shape_triangle(soup, last - 3, last - 2, last - 1);
    }
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.method = VXM_METHOD_TETRA; /* of which a flat part has no voxel: all of them are added */
    options.split_mode = VXM_SPLIT_MODE_GROUP;
    options.thin = round % 3 ? VXM_THIN_KEEP : VXM_THIN_KEEP26;
    vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
    vxm_grid *whole = engine_solid(soup, &space, &options, &report);
    assert_int_equal(report.voxels, report.thin_voxels);
    vxm_model *model = engine_model(soup, &options);
    for (int l = 0; l < 6; l++)
      check_windows(model, whole, layouts[l], 1 + l / 3, report.thin_voxels, report.thin_share);
    check_sparse(model, whole, report.thin_voxels, report.thin_share);
    vxm_model_destroy(model);
    vxm_grid_destroy(whole);
    vxm_soup_destroy(soup);
  }
}

/* ---- How triangles are looked at ---- */

/** A triangle so far away that points need more bits, and that cells of points are not known. */
static void test_far_points(void **state) {
  (void)state;
  vxm_rng rng = {603};
  vxm_space space = engine_space(24, 24, 24);
  for (int round = 0; round < ROUNDS(20); round++) {
    vxm_soup *soup = shape_empty(context);
    switch (round % 4) {
    case 0:
      thin_ball(soup, (double[3]){12.2, 11.7, 12.1}, 0.3 + 9 * vxm_rng_unit(&rng), 4 + (uint32_t)round);
      break;
    case 1:
      thin_wave(soup, &rng, &space, 2 + (uint32_t)vxm_rng_below(&rng, 90));
      break;
    default:
      thin_add_soup(soup, &rng, (int)vxm_rng_below(&rng, THIN_KINDS), &space);
    }
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.method = VXM_METHOD_X; /* which the triangle far away does not change */
    vxm_voxelize_report near_report = VXM_VOXELIZE_REPORT_INIT, far_report = VXM_VOXELIZE_REPORT_INIT;
    vxm_grid *near_centres = engine_solid(soup, &space, &options, NULL);
    options.thin = VXM_THIN_KEEP;
    vxm_grid *near = engine_solid(soup, &space, &options, &near_report);
    uint32_t far[3];
    for (int k = 0; k < 3; k++)
      far[k] = shape_vertex(soup, 20000 + (k == 0), 30000 + (k == 1), 40000 + (k == 2));
    shape_triangle(soup, far[0], far[1], far[2]);
    vxm_grid *whole = engine_solid(soup, &space, &options, &far_report);
    options.thin = VXM_THIN_DROP;
    vxm_grid *far_centres = engine_solid(soup, &space, &options, NULL);
    assert_equal_bits(far_centres, near_centres);
    assert_equal_bits(whole, near);
    assert_int_equal(far_report.thin_voxels, near_report.thin_voxels);
    vxm_grid_destroy(near_centres);
    vxm_grid_destroy(near);
    vxm_grid_destroy(whole);
    vxm_grid_destroy(far_centres);
    vxm_soup_destroy(soup);
  }
}

/** A mesh and its mirror image have voxels that are. */
static void test_mirrors(void **state) {
  (void)state;
  vxm_rng rng = {604};
  for (int round = 0; round < ROUNDS(10 * THIN_KINDS); round++) {
    vxm_space space = engine_space(11, 12, 13);
    int kind = round % THIN_KINDS, axis = round / THIN_KINDS % 3;
    if (kind == 6 || kind == 7)
      continue; /* points on centres, which are told apart by where the axes lead to */
    vxm_soup *soup = thin_soup(context, &rng, kind, &space);
    if (kind == 4)
      for (size_t i = 0; i < 3 * soup->vertex_count; i++)
        soup->positions[i] += 0.01 * vxm_rng_unit(&rng);
    vxm_grid *grid = thin_grid(soup, &space, VXM_THIN_KEEP, NULL);
    for (size_t v = 0; v < soup->vertex_count; v++)
      soup->positions[3 * v + (size_t)axis] =
          (double)space.dims[axis] - soup->positions[3 * v + (size_t)axis];
    vxm_grid *mirror = thin_grid(soup, &space, VXM_THIN_KEEP, NULL);
    int64_t v[3];
    for (v[2] = 0; v[2] < space.dims[2]; v[2]++)
      for (v[1] = 0; v[1] < space.dims[1]; v[1]++)
        for (v[0] = 0; v[0] < space.dims[0]; v[0]++) {
          int64_t w[3] = {v[0], v[1], v[2]};
          w[axis] = space.dims[axis] - 1 - v[axis];
          if (vxm_grid_get(grid, v[0], v[1], v[2]) != vxm_grid_get(mirror, w[0], w[1], w[2]))
            fail_msg("round %d: voxel %d %d %d differs in the mirror", round, (int)v[0], (int)v[1],
                     (int)v[2]);
        }
    vxm_grid_destroy(grid);
    vxm_grid_destroy(mirror);
    vxm_soup_destroy(soup);
  }
}

/** With x, y and z exchanged, x still comes first: a few voxels may be others, and few more or fewer. */
static void test_turned_meshes(void **state) {
  (void)state;
  vxm_rng rng = {605};
  int64_t all = 0, others = 0;
  for (int round = 0; round < ROUNDS(10 * THIN_KINDS); round++) {
    vxm_space space = engine_space(12, 12, 12);
    int kind = round % THIN_KINDS;
    if (kind == 6 || kind == 7)
      continue;
    vxm_soup *soup = thin_soup(context, &rng, kind, &space);
    vxm_grid *grid = thin_grid(soup, &space, VXM_THIN_KEEP, NULL);
    for (size_t v = 0; v < soup->vertex_count; v++) {
      double *p = soup->positions + 3 * v, x = p[0];
      p[0] = p[1];
      p[1] = p[2];
      p[2] = x;
    }
    vxm_grid *turned = thin_grid(soup, &space, VXM_THIN_KEEP, NULL);
    for (int64_t z = 0; z < 12; z++)
      for (int64_t y = 0; y < 12; y++)
        for (int64_t x = 0; x < 12; x++) {
          all += vxm_grid_get(grid, x, y, z);
          others += vxm_grid_get(grid, x, y, z) != vxm_grid_get(turned, y, z, x);
        }
    vxm_grid_destroy(grid);
    vxm_grid_destroy(turned);
    vxm_soup_destroy(soup);
  }
  print_message("%d of %d voxels differ\n", (int)others, (int)all);
  assert_true(20 * others < all);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_many_sheets),
      cmocka_unit_test(test_random_soups),
      cmocka_unit_test(test_soups_of_all_kinds),
      cmocka_unit_test(test_many_triangles),
      cmocka_unit_test(test_scraps),
      cmocka_unit_test(test_far_points),
      cmocka_unit_test(test_mirrors),
      cmocka_unit_test(test_turned_meshes),
  };
  return cmocka_run_group_tests(tests, setup_contexts, teardown_contexts);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/* The solid against a brute-force oracle, and the properties that hold for every closed mesh. */
#include "../base/rounds.h"
#include "shapes.h"

#include "grid/bitgrid.h"
#include "oracle.h"
#include "voxel/model/voxelize.h"

#include <math.h>
#include <string.h>

enum { TINY = 6, TRIANGLES_MAX = 96 };

static vxm_grid *voxelize(const vxm_soup *soup, const vxm_space *space, vxm_method method,
                          vxm_split_mode parts, vxm_voxelize_report *report) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.like = space;
  options.method = method;
  options.split_mode = parts;
  options.thin = VXM_THIN_DROP;
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid;
  if (vxm_voxelize(&grid, report, soup, &space_options, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return grid;
}

static void assert_same_bits(const vxm_grid *a, const vxm_grid *b) {
  assert_memory_equal(a->words, b->words, a->word_count * sizeof *a->words);
}

/** Bits behind the last voxel of a row stay zero, whatever made the grid. */
static void assert_clean_rows(const vxm_grid *grid) {
  for (int64_t k = 0; k < grid->space.dims[2]; k++)
    for (int64_t j = 0; j < grid->space.dims[1]; j++)
      assert_int_equal(vxm_grid_row(grid, j, k)[grid->row_words - 1] & ~vxm_grid_tail_mask(grid), 0);
}

/** All methods agree on a mesh that is closed mod 2. Returns the hash. */
static uint64_t assert_methods_agree(const vxm_soup *soup, const vxm_space *space, vxm_split_mode parts) {
  vxm_grid *x = voxelize(soup, space, VXM_METHOD_X, parts, NULL);
  assert_clean_rows(x);
  for (int method = VXM_METHOD_VOTE; method <= VXM_METHOD_TETRA; method++) {
    vxm_grid *other = voxelize(soup, space, (vxm_method)method, parts, NULL);
    assert_same_bits(x, other);
    vxm_grid_destroy(other);
  }
  uint64_t hash = vxm_grid_hash(x);
  vxm_grid_destroy(x);
  return hash;
}

static vxm_space unit_space(int64_t nx, int64_t ny, int64_t nz) {
  return (vxm_space){{nx, ny, nz}, {0, 0, 0}, {1, 1, 1}};
}

static int oracle_triangles(oracle_triangle *out, const vxm_soup *soup) {
  int count = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n);
    assert_int_equal(n, 3);
    for (int c = 0; c < 3; c++)
      for (int a = 0; a < 3; a++)
        out[count].at[c][a] = (int64_t)(4 * vxm_position(soup, corner[c])[a]);
    count++;
  }
  return count;
}

static void assert_matches_oracle(const vxm_soup *soup, const vxm_space *space) {
  oracle_triangle triangles[TRIANGLES_MAX];
  int count = oracle_triangles(triangles, soup);
  for (int axis = 0; axis < 3; axis++) {
    vxm_grid *grid = voxelize(soup, space, (vxm_method)(VXM_METHOD_X + axis), VXM_SPLIT_MODE_WHOLE, NULL);
    for (int64_t k = 0; k < space->dims[2]; k++)
      for (int64_t j = 0; j < space->dims[1]; j++)
        for (int64_t i = 0; i < space->dims[0]; i++)
          assert_int_equal(vxm_grid_get(grid, i, j, k),
                           oracle_parity(triangles, count, (int64_t[]){i, j, k}, axis));
    assert_clean_rows(grid);
    vxm_grid_destroy(grid);
  }
}

static void test_random_triangles_match_the_oracle(void **state) {
  (void)state;
  vxm_rng rng = {1};
  for (int round = 0; round < ROUNDS(3000); round++) {
    vxm_soup *soup = shape_empty(context);
    int count = 1 + (int)vxm_rng_below(&rng, 6), low = round % 3 ? 0 : -8,
        high = round % 3 ? 4 * TINY : 4 * TINY + 8;
    for (int v = 0; v < count + 3; v++) {
      double x = shape_quarter(&rng, low, high), y = shape_quarter(&rng, low, high);
      shape_vertex(soup, x, y, shape_quarter(&rng, low, high));
    }
    /* Every few rounds all coordinates are voxel centres, so that everything is a tie. */
    if (round % 4 == 0)
      for (size_t i = 0; i < 3 * soup->vertex_count; i++)
        soup->positions[i] = floor(soup->positions[i]) + 0.5;
    for (int f = 0; f < count; f++) {
      uint32_t n = (uint32_t)soup->vertex_count, a = (uint32_t)vxm_rng_below(&rng, n),
               b = (uint32_t)vxm_rng_below(&rng, n);
      uint32_t c = (uint32_t)vxm_rng_below(&rng, n);
      if (a != b && b != c && c != a)
        shape_triangle(soup, a, b, c);
    }
    vxm_space space = unit_space(TINY, TINY - 1, TINY - 2);
    if (soup->face_count > 0)
      assert_matches_oracle(soup, &space);
    vxm_soup_destroy(soup);
  }
}

/** Rows of one, two and three words, and soups that lie partly or wholly before or behind the grid. */
static void test_wide_grids_match_the_oracle(void **state) {
  (void)state;
  static const int64_t widths[] = {1, 63, 64, 65, 128, 130};
  vxm_rng rng = {8};
  for (int round = 0; round < ROUNDS(600); round++) {
    vxm_soup *soup = shape_empty(context);
    int wide = (int)(round % 3);
    int64_t dims[3] = {3, 2, 3};
    dims[wide] = widths[round / 3 % 6];
    int before = vxm_rng_below(&rng, 4) == 0 ? -4 * (int)dims[wide] - 8 : 0;
    for (int v = 0; v < 6; v++) {
      double p[3];
      for (int a = 0; a < 3; a++)
        p[a] = shape_quarter(&rng, (a == wide ? before : 0) - 4,
                             (a == wide ? before : 0) + 4 * (int)dims[a] + 4);
      shape_vertex(soup, p[0], p[1], p[2]);
    }
    shape_triangle(soup, 0, 1, 2);
    shape_triangle(soup, 3, 4, 5);
    if (round % 2)
      shape_triangle(soup, 1, 2, 3);
    vxm_space space = unit_space(dims[0], dims[1], dims[2]);
    assert_matches_oracle(soup, &space);
    vxm_soup_destroy(soup);
  }
}

static void test_random_closed_meshes_agree_on_all_axes(void **state) {
  (void)state;
  vxm_rng rng = {2};
  for (int round = 0; round < ROUNDS(3000); round++) {
    vxm_soup *soup = shape_empty(context);
    int low = round % 3 ? 0 : -8, high = round % 3 ? 4 * TINY : 4 * TINY + 8;
    int count = 1 + (int)vxm_rng_below(&rng, 3);
    for (int i = 0; i < count; i++)
      shape_random_octahedron(soup, &rng, low, high);
    if (round % 4 == 0)
      for (size_t i = 0; i < 3 * soup->vertex_count; i++)
        soup->positions[i] = floor(soup->positions[i]) + 0.5;
    vxm_space space = unit_space(TINY, TINY + 1, TINY - 1);
    assert_methods_agree(soup, &space, VXM_SPLIT_MODE_WHOLE);
    assert_methods_agree(soup, &space, VXM_SPLIT_MODE_GROUP);
    if (round % 8 == 0)
      assert_matches_oracle(soup, &space);
    vxm_soup_destroy(soup);
  }
}

/** The tetrahedra of open soups, drawn as published, equal parity over the soup and its cones. */
static void test_tetrahedra_equal_parity_with_cones(void **state) {
  (void)state;
  vxm_rng rng = {3};
  for (int round = 0; round < ROUNDS(2000); round++) {
    vxm_soup *soup = shape_empty(context);
    uint32_t vertices = 4 + (uint32_t)vxm_rng_below(&rng, 8);
    for (uint32_t v = 0; v < vertices; v++) {
      double x = shape_quarter(&rng, -4, 4 * TINY + 4), y = shape_quarter(&rng, -4, 4 * TINY + 4);
      shape_vertex(soup, x, y, shape_quarter(&rng, -4, 4 * TINY + 4));
    }
    int faces = 1 + (int)vxm_rng_below(&rng, 8);
    for (int f = 0; f < faces; f++) {
      uint32_t corner[5];
      size_t n = 3 + vxm_rng_below(&rng, 3);
      for (size_t c = 0; c < n; c++)
        corner[c] = (uint32_t)vxm_rng_below(&rng, vertices);
      shape_face(soup, corner, n);
    }
    vxm_space space = unit_space(TINY, TINY, TINY);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
    space_options.like = &space;
    options.split_mode = round % 2 ? VXM_SPLIT_MODE_WHOLE : VXM_SPLIT_MODE_GROUP;
    vxm_grid *grids[5];
    vxm_status status = VXM_OK;
    for (int method = VXM_METHOD_X; method <= VXM_METHOD_TETRA && status == VXM_OK; method++) {
      options.method = (vxm_method)method;
      status = vxm_voxelize(&grids[method], NULL, soup, &space_options, &options, NULL);
    }
    if (status == VXM_ERROR_EMPTY) { /* every face repeats a corner */
      vxm_soup_destroy(soup);
      continue;
    }
    assert_int_equal(status, VXM_OK);
    /* `any` and `all` show the tetrahedral voter, which is made with cones there, through the other three. */
    options.method = VXM_METHOD_VOTE;
    for (int rule = VXM_VOTE_MAJORITY; rule <= VXM_VOTE_ALL; rule++) {
      vxm_grid *voted;
      vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
      options.vote = (vxm_vote)rule;
      assert_int_equal(vxm_voxelize(&voted, &report, soup, &space_options, &options, NULL), VXM_OK);
      int64_t contested = 0;
      for (size_t w = 0; w < voted->word_count; w++) {
        uint64_t x = grids[1]->words[w], y = grids[2]->words[w], z = grids[3]->words[w],
                 t = grids[4]->words[w];
        uint64_t any = x | y | z | t, all = x & y & z & t, majority = (x & y) | (y & z) | (z & x);
        assert_true(voted->words[w] == (rule == VXM_VOTE_ANY ? any : rule == VXM_VOTE_ALL ? all : majority));
        contested += vxm_popcount(any & ~all);
      }
      /* A voxel inside a closed part is not contested, so open soups may count fewer. */
      assert_true(report.contested <= contested);
      if (report.closed_parts == 0)
        assert_int_equal(report.contested, contested);
      vxm_grid_destroy(voted);
    }
    for (int method = VXM_METHOD_X; method <= VXM_METHOD_TETRA; method++)
      vxm_grid_destroy(grids[method]);
    vxm_soup_destroy(soup);
  }
}

static void test_unit_cube_fills_the_grid(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_box(soup, (double[]){0, 0, 0}, (double[]){1, 1, 1});
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.resolution[0] = 8;
  vxm_grid *grid;
  assert_int_equal(vxm_voxelize(&grid, NULL, soup, &space_options, &options, NULL), VXM_OK);
  assert_int_equal(vxm_grid_count(grid), 512);
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
}

/** A box of whole voxels covers as many centres wherever it lies, also with its faces on the centres. */
static void test_boxes_at_every_offset(void **state) {
  (void)state;
  for (int dx = 0; dx < 8; dx++)
    for (int dy = 0; dy < 8; dy++)
      for (int dz = 0; dz < 8; dz++) {
        vxm_soup *soup = shape_empty(context);
        double low[3] = {1 + dx / 8.0, 1 + dy / 8.0, 1 + dz / 8.0};
        shape_box(soup, low, (double[]){low[0] + 3, low[1] + 2, low[2] + 4});
        vxm_space space = unit_space(7, 7, 7);
        vxm_grid *grid = voxelize(soup, &space, VXM_METHOD_VOTE, VXM_SPLIT_MODE_AUTO, NULL);
        assert_int_equal(vxm_grid_count(grid), 3 * 2 * 4);
        vxm_grid_destroy(grid);
        vxm_soup_destroy(soup);
      }
}

/** What a closed part fills is not contested, and parts that set nothing are counted. */
static void test_counts_of_the_report(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_box(soup, (double[]){0, 0, 0}, (double[]){4, 4, 4});
  shape_box(soup, (double[]){5.1, 5.1, 5.1}, (double[]){5.2, 5.2, 5.2}); /* between the centres */
  uint32_t v = shape_vertex(soup, 1, 0, 0);
  shape_vertex(soup, 1, 7, 0);
  shape_vertex(soup, 1, 7, 7);
  shape_vertex(soup, 1, 0, 7);
  shape_face(soup, (uint32_t[]){v, v + 1, v + 2, v + 3}, 4); /* a sheet across x: only x sees it */
  vxm_space space = unit_space(7, 7, 7);
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.like = &space;
  options.vote = VXM_VOTE_MAJORITY;
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  vxm_grid *grid;
  assert_int_equal(vxm_voxelize(&grid, &report, soup, &space_options, &options, NULL), VXM_OK);
  assert_int_equal(report.parts, 3);
  assert_int_equal(report.closed_parts, 2);
  assert_int_equal(report.empty_parts, 2);
  assert_int_equal(report.voxels, 64);
  /* x fills from the sheet to the end of the rows; 3 x 4 x 4 of that lies in the box. */
  assert_int_equal(report.contested, 6 * 7 * 7 - 3 * 4 * 4);
  vxm_grid_destroy(grid);
  /* Asking for the confidence changes nothing of that. */
  vxm_voxelize_report with_confidence = VXM_VOXELIZE_REPORT_INIT;
  options.confidence = true;
  assert_int_equal(vxm_voxelize(&grid, &with_confidence, soup, &space_options, &options, NULL), VXM_OK);
  assert_memory_equal(&with_confidence, &report, sizeof report);
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
}

static void test_parts_are_united_and_whole_is_exclusive(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_box(soup, (double[]){0, 0, 0}, (double[]){4, 4, 4});
  shape_box(soup, (double[]){2, 2, 2}, (double[]){6, 6, 6});
  vxm_space space = unit_space(7, 7, 7);
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  vxm_grid *grouped = voxelize(soup, &space, VXM_METHOD_VOTE, VXM_SPLIT_MODE_GROUP, &report);
  assert_int_equal(report.parts, 2);
  assert_int_equal(report.closed_parts, 2);
  assert_int_equal(report.contested, 0);
  assert_int_equal(report.voxels, 64 + 64 - 8);
  vxm_grid *whole = voxelize(soup, &space, VXM_METHOD_VOTE, VXM_SPLIT_MODE_WHOLE, &report);
  assert_int_equal(report.parts, 1);
  assert_int_equal(report.voxels, 64 + 64 - 16);
  vxm_grid_destroy(whole);
  vxm_grid_destroy(grouped);
  vxm_soup_destroy(soup);
}

/** A non-convex prism: its two end polygons wind through an L, a U and a comb. */
static void test_non_convex_polygons(void **state) {
  (void)state;
  static const double comb[][2] = {{0, 0}, {9, 0}, {9, 5}, {7, 5}, {7, 1}, {5, 1},
                                   {5, 5}, {3, 5}, {3, 1}, {1, 1}, {1, 5}, {0, 5}};
  enum { N = sizeof comb / sizeof *comb };
  for (int turn = 0; turn < N; turn++) {
    vxm_soup *soup = shape_empty(context);
    uint32_t lower[N], upper[N];
    for (int i = 0; i < N; i++)
      lower[i] = shape_vertex(soup, comb[(i + turn) % N][0], comb[(i + turn) % N][1], 1);
    for (int i = 0; i < N; i++)
      upper[i] = shape_vertex(soup, comb[(i + turn) % N][0], comb[(i + turn) % N][1], 4);
    shape_face(soup, lower, N);
    shape_face(soup, upper, N);
    for (uint32_t i = 0; i < N; i++)
      shape_face(soup, (uint32_t[]){i, (i + 1) % N, N + (i + 1) % N, N + i}, 4);
    vxm_space space = unit_space(10, 6, 6);
    assert_methods_agree(soup, &space, VXM_SPLIT_MODE_WHOLE);
    vxm_grid *grid = voxelize(soup, &space, VXM_METHOD_VOTE, VXM_SPLIT_MODE_AUTO, NULL);
    assert_int_equal(vxm_grid_count(grid), 3 * (9 * 1 + 1 * 4 + 2 * 4 + 2 * 4));
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
  }
}

/** Triangles far larger than the grid take 128-bit products; scaled down they are the same question in 64
 * bits. */
static void test_huge_triangles(void **state) {
  (void)state;
  vxm_rng rng = {5};
  for (int round = 0; round < ROUNDS(200); round++) {
    vxm_soup *soup = shape_empty(context);
    double far = ldexp(1, 4 + (int)vxm_rng_below(&rng, 16));
    uint32_t v[4];
    for (int i = 0; i < 4; i++) {
      double x = (vxm_rng_unit(&rng) - 0.5) * far, y = (vxm_rng_unit(&rng) - 0.5) * far;
      v[i] = shape_vertex(soup, x, y, (vxm_rng_unit(&rng) - 0.5) * far);
    }
    for (int f = 0; f < 4; f++)
      shape_triangle(soup, v[f], v[(f + 1) % 4], v[(f + 2) % 4]);
    vxm_space space = {{70, 9, 8}, {-3, -4, -5}, {1, 1, 1}};
    assert_methods_agree(soup, &space, VXM_SPLIT_MODE_WHOLE);
    vxm_soup_destroy(soup);
  }
}

static void test_vertices_too_far_away_are_refused(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_vertex(soup, 0, 0, 0);
  shape_vertex(soup, 1, 0, 0);
  shape_vertex(soup, 0, 1e300, 0);
  shape_triangle(soup, 0, 1, 2);
  vxm_space space = unit_space(4, 4, 4);
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.like = &space;
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid;
  assert_int_equal(vxm_voxelize(&grid, NULL, soup, &space_options, &options, &error), VXM_ERROR_RANGE);
  assert_int_equal(error.element, 2);
  assert_null(grid);
  soup->positions[7] = NAN;
  assert_int_equal(vxm_voxelize(&grid, NULL, soup, &space_options, &options, &error), VXM_ERROR_RANGE);
  vxm_soup_destroy(soup);
}

/** The same bits for 1, 2 and 7 threads, for closed and open parts and every method. */
static void test_same_bits_for_any_number_of_threads(void **state) {
  (void)state;
  static const int threads[] = {1, 2, 7};
  uint64_t hash[3][5];
  for (int t = 0; t < 3; t++) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = threads[t];
    vxm_context *own;
    assert_int_equal(vxm_context_create(&own, &options, NULL), VXM_OK);
    vxm_soup *soup = shape_empty(own);
    vxm_rng rng = {7};
    for (int i = 0; i < 20; i++) {
      double centre[3] = {2 * vxm_rng_unit(&rng), 2 * vxm_rng_unit(&rng), 2 * vxm_rng_unit(&rng)};
      shape_torus(soup, 24, 12, 0.5, 0.2, centre);
    }
    /* Every other torus loses its last faces and stays open. */
    for (size_t f = 0; f < soup->face_count; f++)
      if (f / 288 % 2 == 0 && f % 288 > 280)
        for (size_t c = soup->offsets[f]; c < soup->offsets[f + 1]; c++)
          soup->indices[c] = soup->indices[soup->offsets[f]];
    vxm_space space = {{67, 70, 75}, {-0.7, -0.7, -0.7}, {0.05, 0.05, 0.05}};
    for (int m = VXM_METHOD_VOTE; m <= VXM_METHOD_TETRA; m++) {
      vxm_grid *grid = voxelize(soup, &space, (vxm_method)m, VXM_SPLIT_MODE_GROUP, NULL);
      assert_true(vxm_grid_count(grid) > 1000);
      hash[t][m] = vxm_grid_hash(grid);
      vxm_grid_destroy(grid);
    }
    vxm_soup_destroy(soup);
    vxm_context_destroy(own);
  }
  for (int m = 0; m < 5; m++) {
    assert_true(hash[0][m] == hash[1][m]);
    assert_true(hash[0][m] == hash[2][m]);
  }
}

/** Windows of 32 MiB and more are written past the cache, whole lines at a time: the same bits. */
static void test_large_grids(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_torus(soup, 48, 24, 1, 0.4, (double[]){0, 0, 0});
  vxm_space space = {{512, 512, 1025}, {-1.5, -1.5, -0.5}, {3.0 / 512, 3.0 / 512, 1.0 / 1025}};
  uint64_t hash[3];
  vxm_grid *grid;
  assert_int_equal(vxm_grid_create(&grid, context, &space, NULL), VXM_OK);
  memset(grid->words, 0xa5, grid->word_count * sizeof *grid->words);
  for (int way = 0; way < 3; way++) { /* along rows, across rows, and a vote */
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.method = way == 2 ? VXM_METHOD_VOTE : (vxm_method)(VXM_METHOD_X + way);
    options.vote = VXM_VOTE_MAJORITY;
    options.vote_always = true;
    vxm_model *model;
    assert_int_equal(vxm_model_create(&model, soup, &options, NULL), VXM_OK);
    for (int again = 0; again < 2; again++)
      assert_int_equal(vxm_model_voxelize(grid, NULL, model, NULL, NULL), VXM_OK);
    hash[way] = vxm_grid_hash(grid);
    vxm_model_destroy(model);
  }
  assert_true(hash[0] == hash[1] && hash[0] == hash[2]);
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
}

/** The filled volume of a smooth body approaches its volume. */
static void test_torus_volume(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_torus(soup, 96, 48, 1, 0.4, (double[]){0, 0, 0});
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.resolution[0] = 100;
  vxm_grid *grid;
  assert_int_equal(vxm_voxelize(&grid, NULL, soup, &space_options, &options, NULL), VXM_OK);
  double volume = (double)vxm_grid_count(grid) * pow(grid->space.voxel_size[0], 3),
         truth = 2 * M_PI * M_PI * 0.4 * 0.4;
  assert_true(fabs(volume / truth - 1) < 0.01);
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_random_triangles_match_the_oracle),
      cmocka_unit_test(test_wide_grids_match_the_oracle),
      cmocka_unit_test(test_random_closed_meshes_agree_on_all_axes),
      cmocka_unit_test(test_tetrahedra_equal_parity_with_cones),
      cmocka_unit_test(test_unit_cube_fills_the_grid),
      cmocka_unit_test(test_boxes_at_every_offset),
      cmocka_unit_test(test_counts_of_the_report),
      cmocka_unit_test(test_parts_are_united_and_whole_is_exclusive),
      cmocka_unit_test(test_non_convex_polygons),
      cmocka_unit_test(test_huge_triangles),
      cmocka_unit_test(test_vertices_too_far_away_are_refused),
      cmocka_unit_test(test_same_bits_for_any_number_of_threads),
      cmocka_unit_test(test_large_grids),
      cmocka_unit_test(test_torus_volume),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/* Every mode and surface streamed into every format under a memory limit: the file of the whole grid. */
#include "grids.h"

#include "mesh/soup.h"

#include <math.h>

static const char *const formats[] = {"binvox", "npy", "raw", "rle", "nrrd"};

enum { FORMATS = sizeof formats / sizeof formats[0] };

/** A torus of quads, and an open sheet of triangles through it: a closed part and one to be voted on. */
static vxm_soup *make_soup(vxm_context *context) {
  enum { RINGS = 24, SIDES = 12 };
  vxm_soup *soup;
  assert_int_equal(vxm_soup_create(&soup, context, "test", NULL), VXM_OK);
  for (uint32_t r = 0; r < RINGS; r++)
    for (uint32_t s = 0; s < SIDES; s++) {
      double a = 2 * M_PI * r / RINGS, b = 2 * M_PI * s / SIDES, across = 1 + 0.4 * cos(b);
      assert_int_equal(
          vxm_soup_add_vertex(soup, across * cos(a), across * sin(a), 0.4 * sin(b) + 0.1 * cos(a), NULL),
          VXM_OK);
    }
  for (uint32_t r = 0; r < RINGS; r++)
    for (uint32_t s = 0; s < SIDES; s++) {
      uint32_t r1 = (r + 1) % RINGS, s1 = (s + 1) % SIDES;
      uint32_t corner[4] = {r * SIDES + s, r1 * SIDES + s, r1 * SIDES + s1, r * SIDES + s1};
      assert_int_equal(vxm_soup_add_face(soup, corner, 4, NULL), VXM_OK);
    }
  /* Half a box, open on three sides. */
  uint32_t v = (uint32_t)soup->vertex_count;
  for (int i = 0; i < 8; i++)
    assert_int_equal(
        vxm_soup_add_vertex(soup, i & 1 ? 0.5 : -0.45, i & 2 ? 0.5 : -0.4, i & 4 ? 0.6 : -0.7, NULL), VXM_OK);
  static const uint32_t half[6][3] = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}, {0, 4, 6}, {0, 6, 2}};
  for (int f = 0; f < 6; f++)
    assert_int_equal(
        vxm_soup_add_face(soup, (uint32_t[]){v + half[f][0], v + half[f][1], v + half[f][2]}, 3, NULL),
        VXM_OK);
  return soup;
}

/** Small slices, of which a limited context takes some at a time. */
static const vxm_space space = {{150, 150, 150}, {-1.6, -1.55, -1.5}, {0.021, 0.021, 0.021}};

typedef struct result {
  vxm_voxelize_report report;
  int64_t windows;
} result;

static result write_file(const char *path, const vxm_voxelize_options *options, int threads, uint64_t limit) {
  vxm_context *context = context_with(threads, limit, NULL, NULL);
  vxm_soup *soup = make_soup(context);
  vxm_model *model;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_model_create(&model, soup, options, &error), VXM_OK);
  vxm_estimate estimate = {0};
  if (vxm_model_estimate(&estimate, model, &space, path, NULL, &error) != VXM_OK)
    fail_msg("%s", error.text);
  result r = {.windows = estimate.passes};
  if (vxm_model_write(&r.report, model, &space, path, NULL, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_true(limit == 0 || vxm_context_peak_bytes(context) <= limit);
  vxm_model_destroy(model);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
  return r;
}

static void assert_same(const char *a, const char *b) {
  size_t sizes[2];
  unsigned char *data[2] = {load_file(a, &sizes[0]), load_file(b, &sizes[1])};
  assert_int_equal(sizes[0], sizes[1]);
  assert_memory_equal(data[0], data[1], sizes[0]);
  free(data[0]);
  free(data[1]);
}

/** The grid that the library makes at once. */
static vxm_grid *make_whole(vxm_context *context, const vxm_voxelize_options *options,
                            vxm_voxelize_report *report) {
  vxm_soup *soup = make_soup(context);
  vxm_voxelize_options given = *options;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.like = &space;
  vxm_grid *grid;
  assert_int_equal(vxm_voxelize(&grid, report, soup, &space_options, &given, NULL), VXM_OK);
  vxm_soup_destroy(soup);
  return grid;
}

/** A limit under which only some slices fit at once. */
static uint64_t limit_for(const char *path, const vxm_voxelize_options *options, int threads) {
  for (uint64_t limit = UINT64_C(1) << 20;; limit += limit / 16) {
    vxm_context *context = context_with(threads, limit, NULL, NULL);
    vxm_soup *soup = make_soup(context);
    vxm_model *model;
    assert_int_equal(vxm_model_create(&model, soup, options, NULL), VXM_OK);
    vxm_estimate estimate = {0};
    vxm_status status = vxm_model_estimate(&estimate, model, &space, path, NULL, NULL);
    vxm_model_destroy(model);
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
    if (status == VXM_OK)
      return limit;
  }
}

static void check_mode(const vxm_voxelize_options *options, const char *folder) {
  static int turn;
  vxm_context *context = context_with(2, 0, NULL, NULL);
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  vxm_grid *grid = make_whole(context, options, &report);
  assert_true(report.voxels > 1000);
  for (int f = 0; f < FORMATS; f++) {
    char whole[80], pieces[80];
    snprintf(whole, sizeof whole, "%s/whole.%s", folder, formats[f]);
    snprintf(pieces, sizeof pieces, "%s/pieces.%s", folder, formats[f]);
    assert_int_equal(vxm_grid_write(grid, whole, NULL, NULL), VXM_OK);
    int threads = 1 + turn++ % 2; /* an odd number of formats: each meets both in two modes */
    result r = write_file(pieces, options, threads, limit_for(pieces, options, threads));
    assert_true(r.windows > 1);
    assert_same(whole, pieces);
    assert_true(r.report.hash == report.hash);
    assert_int_equal(r.report.voxels, report.voxels);
    assert_int_equal(r.report.contested, report.contested);
    assert_int_equal(r.report.winding_decided, report.winding_decided);
    assert_int_equal(r.report.empty_parts, report.empty_parts);
  }
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  empty_folder(folder);
}

static void test_streams_equal_the_whole(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  check_mode(&options, folder);
  options.mode = VXM_MODE_SURFACE;
  for (int kind = 0; kind <= VXM_SURFACE_SHELL6; kind++) {
    options.surface = (vxm_surface_kind)kind;
    check_mode(&options, folder);
  }
  options.mode = VXM_MODE_BOTH;
  for (int kind = 0; kind <= VXM_SURFACE_SHELL26; kind++) {
    options.surface = (vxm_surface_kind)kind;
    check_mode(&options, folder);
  }
  remove_folder(folder);
}

static vxm_grid *make_mode(vxm_context *context, vxm_mode mode, vxm_surface_kind kind, bool confidence) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.mode = mode;
  options.surface = kind;
  options.confidence = confidence;
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  return make_whole(context, &options, &report);
}

/** A part of the solid; one within the other; with the solid, the solid; and as sure as the solid is. */
static void test_shells_lie_in_the_solid(void **state) {
  (void)state;
  vxm_context *context = context_with(2, 0, NULL, NULL);
  vxm_grid *solid = make_mode(context, VXM_MODE_SOLID, VXM_SURFACE_CONSERVATIVE, true), *last = solid;
  size_t voxels = (size_t)(space.dims[0] * space.dims[1] * space.dims[2]);
  for (int kind = VXM_SURFACE_SHELL26; kind <= VXM_SURFACE_SHELL6; kind++) {
    vxm_grid *shell = make_mode(context, VXM_MODE_SURFACE, (vxm_surface_kind)kind, true),
             *both = make_mode(context, VXM_MODE_BOTH, (vxm_surface_kind)kind, true);
    assert_same_bits(solid, both);
    for (size_t w = 0; w < shell->word_count; w++)
      assert_true((shell->words[w] & ~last->words[w]) == 0);
    assert_true(vxm_grid_count(shell) < vxm_grid_count(last));
    assert_memory_equal(vxm_grid_confidence(shell), vxm_grid_confidence(solid), voxels);
    vxm_grid_destroy(both);
    if (last != solid)
      vxm_grid_destroy(last);
    last = shell;
  }
  vxm_grid_destroy(last);
  vxm_grid_destroy(solid);
  vxm_context_destroy(context);
}

/** A transform moves the surface as it moves the solid. */
static void test_the_surface_is_moved(void **state) {
  (void)state;
  static const double shift[12] = {1, 0, 0, 0.042, 0, 1, 0, 0, 0, 0, 1, 0}; /* two voxels along x */
  vxm_context *context = context_with(2, 0, NULL, NULL);
  vxm_soup *soup = make_soup(context);
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.mode = VXM_MODE_SURFACE;
  options.surface = VXM_SURFACE_THIN;
  vxm_model *model;
  vxm_grid *here = new_grid(context, space), *there = new_grid(context, space);
  assert_int_equal(vxm_model_create(&model, soup, &options, NULL), VXM_OK);
  assert_int_equal(vxm_model_voxelize(here, NULL, model, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_model_voxelize(there, NULL, model, shift, NULL), VXM_OK);
  int64_t unlike = 0, set = vxm_grid_count(here);
  for (int64_t k = 0; k < space.dims[2]; k++)
    for (int64_t j = 0; j < space.dims[1]; j++)
      for (int64_t i = 2; i < space.dims[0]; i++)
        unlike += vxm_grid_get(there, i, j, k) != vxm_grid_get(here, i - 2, j, k);
  assert_true(set > 1000 && unlike < set / 50); /* rounding to the lattice decides a few */
  vxm_grid_destroy(there);
  vxm_grid_destroy(here);
  vxm_model_destroy(model);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_streams_equal_the_whole),
      cmocka_unit_test(test_shells_lie_in_the_solid),
      cmocka_unit_test(test_the_surface_is_moved),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

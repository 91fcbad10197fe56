/* SPDX-License-Identifier: BSD-3-Clause */
/* Colours by OpenGL: the built-in functions are those of the CPU to 1 in 255; a function in GLSL gets what it
 * is promised; one that does not compile is refused with the driver's words. */
#include "gpu_test.h"

static vxm_soup *two_bodies(void) {
  vxm_soup *soup = shape_empty(context);
  shape_box(soup, (double[3]){1, 2, 3}, (double[3]){9, 8, 12});
  shape_torus(soup, 24, 12, 9, 4, (double[3]){22, 20, 12});
  return soup;
}

static uint8_t *colors(const vxm_soup *soup, const vxm_space *space, vxm_engine *by,
                       const vxm_color_options *options, vxm_status expected, vxm_error *error) {
  vxm_voxelize_options voxelize = VXM_VOXELIZE_OPTIONS_INIT;
  voxelize.engine = by;
  vxm_model *model = engine_model(soup, &voxelize);
  uint8_t *values = malloc((size_t)(space->dims[0] * space->dims[1] * space->dims[2]) * 4);
  assert_non_null(values);
  assert_int_equal(vxm_model_colors(values, NULL, model, space, options, error), expected);
  vxm_model_destroy(model);
  return values;
}

static const vxm_space space = {{37, 33, 25}, {0, 0, 0}, {1, 1, 1}};
enum { VOXELS = 37 * 33 * 25 };

static void test_built_in(void **state) {
  (void)state;
  vxm_soup *soup = two_bodies();
  for (int by = VXM_COLOR_NOISE; by <= VXM_COLOR_PART; by++) {
    vxm_color_options options = VXM_COLOR_OPTIONS_INIT;
    options.by = (vxm_color_by)by;
    uint8_t *a = colors(soup, &space, NULL, &options, VXM_OK, NULL);
    uint8_t *b = colors(soup, &space, engine, &options, VXM_OK, NULL);
    int set = 0, different = 0;
    for (size_t i = 0; i < VOXELS; i++) {
      set += a[4 * i + 3] == 255;
      assert_int_equal(a[4 * i + 3], b[4 * i + 3]);
      for (size_t c = 0; c < 3; c++) {
        assert_true(abs(a[4 * i + c] - b[4 * i + c]) <= 1);
        different += a[4 * i + c] != a[c];
      }
    }
    assert_true(set > 1000 && different > 100);
    free(a);
    free(b);
  }
  vxm_soup_destroy(soup);
}

static void test_glsl(void **state) {
  (void)state;
  vxm_soup *soup = two_bodies();
  vxm_color_options options = VXM_COLOR_OPTIONS_INIT;
  options.by = VXM_COLOR_GLSL;
  options.source =
      "vec3 color(vec3 position, vec3 unit, uint part) {\n"
      "  return vec3(floor(position.x) * 5.0, unit.z * 37.0 * 10.0, float(part) * 100.0) / 255.0;\n"
      "}\n";
  vxm_voxelize_options voxelize = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_grid *grid = engine_solid(soup, &space, &voxelize, NULL);
  uint8_t *found = colors(soup, &space, engine, &options, VXM_OK, NULL);
  for (int64_t i = 0, at = 0; i < 37; i++)
    for (int64_t j = 0; j < 33; j++)
      for (int64_t k = 0; k < 25; k++, at += 4) {
        if (!vxm_grid_get(grid, i, j, k)) {
          assert_memory_equal(found + at, "\0\0\0", 4);
          continue;
        }
        assert_int_equal(found[at], 5 * i);
        assert_true(abs(found[at + 1] - (int)(10 * k + 5)) <= 1);
        assert_int_equal(found[at + 2], i < 9 && j < 8 && k < 12 ? 100 : 200);
        assert_int_equal(found[at + 3], 255);
      }
  free(found);
  vxm_error error = VXM_ERROR_INIT;
  options.source = "vec3 color(vec3 position, vec3 unit, uint part) {\n  return nothing;\n}\n";
  free(colors(soup, &space, engine, &options, VXM_ERROR_ARGUMENT, &error));
  assert_non_null(strstr(error.text, "does not compile"));
  assert_non_null(strstr(error.text, "nothing"));
  options.source = "vec3 colour(vec3 position) { return position; }\n";
  free(colors(soup, &space, engine, &options, VXM_ERROR_ARGUMENT, &error));
  options.source = "vec3 color(vec3 p, vec3 u, uint n) { return u; }\n";
  free(colors(soup, &space, NULL, &options, VXM_ERROR_UNAVAILABLE, &error));
  free(colors(soup, &space, engine, &options, VXM_OK, NULL)); /* a failure leaves the engine usable */
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
}

/** An engine that fails when it is asked for anything. */
static vxm_status fail_unite(vxm_engine *by, const vxm_window *window, const vxm_parity_union_job *job,
                             vxm_error *error) {
  (void)by, (void)window, (void)job;
  return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "the context was lost");
}

static void destroy_nothing(vxm_engine *by) {
  (void)by;
}

/** Only an engine that was made to do so gives way to the CPU, and it says so. */
static void test_gives_way(void **state) {
  (void)state;
  static const vxm_engine_ops ops = {.unite = fail_unite, .destroy = destroy_nothing};
  vxm_soup *soup = two_bodies();
  vxm_error error = VXM_ERROR_INIT;
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_grid *expected = engine_solid(soup, &space, &options, NULL), *found;
  vxm_engine broken = {.ops = &ops, .context = context, .info = {.name = "opengl:broken"}};
  options.engine = &broken;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.like = &space;
  assert_int_equal(vxm_voxelize(&found, NULL, soup, &space_options, &options, &error), VXM_ERROR_UNAVAILABLE);
  assert_string_equal(error.text, "the context was lost");
  broken.falls_back = true;
  found = engine_solid(soup, &space, &options, NULL);
  assert_equal_bits(expected, found);
  assert_int_equal(vxm_grid_warning_count(found), 1);
  assert_non_null(strstr(vxm_grid_warning(found, 0), "opengl:broken failed"));
  assert_string_equal(broken.info.name, "cpu");
  vxm_grid_destroy(found);
  vxm_grid_destroy(expected);
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_built_in), cmocka_unit_test(test_glsl),
                                     cmocka_unit_test(test_gives_way)};
  int status = gpu_test_start(NULL);
  if (status == 0)
    status = cmocka_run_group_tests_name("colours by " ENGINE, tests, setup, teardown);
  vxm_engine_destroy(engine);
  return status;
}

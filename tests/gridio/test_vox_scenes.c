/* SPDX-License-Identifier: BSD-3-Clause */
/** .vox of other programs: turned models, scenes of many, and damaged ones. */
#include "vox_file.h"

#include <math.h>

static void assert_color(const vxm_field *field, int x, int y, int z, const uint8_t expected[4]) {
  int64_t at[3] = {x, y, z};
  for (int a = 0; a < 3; a++)
    at[a] -= (int64_t)field->space.origin[a];
  assert_memory_equal(vxm_field_color(field, at[0], at[1], at[2]), expected, 4);
}

static void test_turns(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_field *field;
  vox_bytes file = make_turned();
  assert_int_equal(read_vox(NULL, &field, context, &file, NULL), VXM_OK);
  /* Moved: the middle of 3 is 1, so that x is 99 to 101; y and z are 0. Turned: the voxel centres (-0.5,
   * 0.5, 1.5) - ... become y 19, 20 and 21 - 1/2 lower, and x, whose centre 1/2 becomes -1/2, is 109. */
  static const uint8_t first[4] = {255, 255, 255, 255}, seventh[4] = {255, 204, 255, 255},
                       none[4] = {0, 0, 0, 0};
  static const int size[3] = {11, 22, 31};
  for (int a = 0; a < 3; a++)
    assert_int_equal(field->space.dims[a], size[a]);
  assert_color(field, 99, 0, 0, first);
  assert_color(field, 101, 0, 0, seventh);
  assert_color(field, 109, 19, 30, first);
  assert_color(field, 109, 20, 30, first);
  assert_color(field, 109, 21, 30, seventh);
  assert_color(field, 108, 20, 30, none);
  int64_t voxels = 0;
  for (size_t v = 0; v < vxm_field_count(field); v++)
    voxels += field->values[4 * v + 3] != 0;
  assert_int_equal(voxels, 6);
  vxm_field_destroy(field);
  vxm_context_destroy(context);
}

/** Every turn of a model of three different sides keeps all voxels, in a box of these sides. */
static void test_all_turns(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  unsigned char voxels[2 * 3 * 4][4];
  int count = 0;
  for (int v = 0; v < 24; v++)
    if (v % 5 != 2) {
      const unsigned char voxel[4] = {(unsigned char)(v % 2), (unsigned char)(v / 2 % 3),
                                      (unsigned char)(v / 6), 9};
      memcpy(voxels[count++], voxel, 4);
    }
  for (int turn = 0; turn < 128; turn++) {
    int of[3] = {turn & 3, turn >> 2 & 3, 0}, sign[3];
    char text[16];
    vox_bytes b = {.size = 0};
    vxm_grid *grid;
    snprintf(text, sizeof text, "%d", turn);
    put_model(&b, (const int[3]){2, 3, 4}, voxels, count);
    put_transform(&b, 0, 1, text, NULL);
    put_node(&b, "nSHP", 1, (const int[]){0}, 1);
    vox_bytes file = close_file_of(&b);
    bool is_turn = of[0] < 3 && of[1] < 3 && of[0] != of[1];
    assert_int_equal(read_vox(&grid, NULL, context, &file, NULL), is_turn ? VXM_OK : VXM_ERROR_FORMAT);
    if (!is_turn)
      continue;
    of[2] = 3 - of[0] - of[1];
    for (int a = 0; a < 3; a++)
      sign[a] = turn >> (4 + a) & 1 ? -1 : 1;
    assert_int_equal(vxm_grid_count(grid), count);
    for (int v = 0; v < count; v++) {
      int64_t at[3];
      for (int a = 0; a < 3;
           a++) { /* by doubles: the centre about the middle, rounded down, which is turned */
        double centre = voxels[v][of[a]] + 0.5 - (2 + of[a]) / 2;
        at[a] = (int64_t)floor(sign[a] * centre) - (int64_t)grid->space.origin[a];
      }
      assert_true(vxm_grid_get(grid, at[0], at[1], at[2]));
    }
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
}

static void expect_refused(vxm_context *context, const vox_bytes *chunks, const char *why) {
  vxm_grid *grid;
  vxm_error error = VXM_ERROR_INIT;
  vox_bytes file = close_file_of(chunks);
  vxm_status status = read_vox(&grid, NULL, context, &file, &error);
  if (status == VXM_OK || !strstr(error.text, why))
    fail_msg("\"%s\", not %s", error.text, why);
}

static void test_bad_scenes(void **state) {
  (void)state;
  static const unsigned char one[1][4] = {{0, 0, 0, 1}}, outside[1][4] = {{1, 0, 0, 1}};
  static const int unit[3] = {1, 1, 1};
  vxm_context *context = context_with(1, 64 << 20, NULL, NULL);
  vox_bytes b = {.size = 0};
  expect_refused(context, &b, "no model");
  put_model(&b, unit, outside, 1);
  expect_refused(context, &b, "outside its model");
  b.size = 0;
  put_model(&b, unit, one, 1);
  size_t model = b.size;
  put_transform(&b, 0, 0, NULL, NULL);
  expect_refused(context, &b, "child of two, or of itself");
  b.size = model;
  put_transform(&b, 0, 5, NULL, NULL);
  expect_refused(context, &b, "not there");
  b.size = model;
  put_transform(&b, 0, 1, NULL, "9999999999 0 0");
  put_node(&b, "nSHP", 1, (const int[]){0}, 1);
  expect_refused(context, &b, "too far away");
  b.size = model;
  put_transform(&b, 0, 1, NULL, NULL);
  put_node(&b, "nSHP", 1, (const int[]){3}, 1);
  expect_refused(context, &b, "a model that is not there");
  b.size = model;
  put_node(&b, "nGRP", 0, (const int[]){1, 2}, 2); /* a box of 2^60 voxels for two */
  put_transform(&b, 1, 3, NULL, "-500000 -500000 -500000");
  put_transform(&b, 2, 4, NULL, "500000 500000 500000");
  put_node(&b, "nSHP", 3, (const int[]){0}, 1);
  put_node(&b, "nSHP", 4, (const int[]){0}, 1);
  expect_refused(context, &b, "");
  vxm_context_destroy(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_turns),
      cmocka_unit_test(test_all_turns),
      cmocka_unit_test(test_bad_scenes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

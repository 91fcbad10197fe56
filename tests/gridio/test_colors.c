/* SPDX-License-Identifier: BSD-3-Clause */
/* Colours in files: .npy has the values as they are, .ply the exposed faces, and .vox, read chunk by chunk,
 * every voxel in its place with a colour near its own. */
#include "../voxel/shapes.h"

#include "voxmend.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static vxm_model *model_of(vxm_soup **soup) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_model *model;
  *soup = shape_empty(context);
  shape_box(*soup, (double[3]){1, 2, 3}, (double[3]){9, 8, 12});
  shape_torus(*soup, 24, 12, 9, 4, (double[3]){22, 20, 12});
  shape_box(*soup, (double[3]){250, 3, 5}, (double[3]){262, 9, 9});
  assert_int_equal(vxm_model_create(&model, *soup, &options, NULL), VXM_OK);
  return model;
}

static const vxm_space space = {{270, 33, 25}, {0, 0, 0}, {1, 1, 1}};
enum { VOXELS = 270 * 33 * 25 };

/** The bytes of a file that the model writes. */
static uint8_t *write_as(const char *format, vxm_color_by by, size_t *size, uint8_t *values) {
  char path[] = "/tmp/voxmend-colors.XXXXXX", name[64], beside[80];
  vxm_soup *soup;
  vxm_model *model = model_of(&soup);
  vxm_color_options options = VXM_COLOR_OPTIONS_INIT;
  options.by = by;
  int made = mkstemp(path);
  assert_true(made >= 0);
  close(made);
  unlink(path);
  snprintf(name, sizeof name, "%s.%s", path, format);
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_model_write_colors(NULL, model, &space, name, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_int_equal(vxm_model_colors(values, NULL, model, &space, &options, NULL), VXM_OK);
  FILE *file = fopen(name, "rb");
  assert_non_null(file);
  uint8_t *bytes = malloc(1 << 24);
  assert_non_null(bytes);
  *size = fread(bytes, 1, 1 << 24, file);
  fclose(file);
  unlink(name);
  snprintf(beside, sizeof beside, "%s.json", name);
  assert_int_equal(unlink(beside) == 0, strcmp(format, "npy") == 0);
  vxm_model_destroy(model);
  vxm_soup_destroy(soup);
  return bytes;
}

static uint32_t word_at(const uint8_t *bytes) {
  return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static void test_npy(void **state) {
  (void)state;
  static uint8_t values[4 * VOXELS];
  size_t size;
  uint8_t *bytes = write_as("npy", VXM_COLOR_NOISE, &size, values);
  size_t header = 10 + (size_t)bytes[8] + 256 * (size_t)bytes[9];
  assert_int_equal(header % 64, 0);
  bytes[header - 1] = '\0';
  assert_non_null(
      strstr((char *)bytes + 10, "'descr': '|u1', 'fortran_order': False, 'shape': (270, 33, 25, 4)"));
  assert_int_equal(size, header + sizeof values);
  assert_memory_equal(bytes + header, values, sizeof values);
  free(bytes);
}

static void test_ply(void **state) {
  (void)state;
  static uint8_t values[4 * VOXELS];
  size_t size, faces = 0, stated = 0;
  uint8_t *bytes = write_as("ply", VXM_COLOR_PART, &size, values);
  for (int i = 0; i < 270; i++)
    for (int j = 0; j < 33; j++)
      for (int k = 0; k < 25; k++) {
        static const int steps[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
        for (int s = 0; s < 6 && values[4 * ((i * 33 + j) * 25 + k) + 3]; s++) {
          int x = i + steps[s][0], y = j + steps[s][1], z = k + steps[s][2];
          bool inside = x >= 0 && y >= 0 && z >= 0 && x < 270 && y < 33 && z < 25;
          faces += !inside || !values[4 * ((x * 33 + y) * 25 + z) + 3];
        }
      }
  char *end = strstr((char *)bytes, "end_header\n") + strlen("end_header\n");
  assert_int_equal(sscanf(strstr((char *)bytes, "element face "), "element face %zu", &stated), 1);
  assert_int_equal(stated, faces);
  assert_int_equal(size, (size_t)(end - (char *)bytes) + faces * (4 * 15 + 17));
  vxm_mesh *mesh; /* its faces turn outward, and enclose as much as there are voxels */
  vxm_census census = VXM_CENSUS_INIT;
  assert_int_equal(vxm_mesh_read_memory(&mesh, context, bytes, size, "x.ply", NULL), VXM_OK);
  assert_int_equal(vxm_mesh_census(&census, mesh, NULL), VXM_OK);
  int64_t voxels = 0;
  for (size_t i = 0; i < VOXELS; i++)
    voxels += values[4 * i + 3] != 0;
  assert_true(census.closed);
  assert_int_equal((int64_t)(census.volume + 0.5), voxels);
  vxm_mesh_destroy(mesh);
  free(bytes);
}

/** Reads .vox as its format says: models in order, then the scene with their places, then the palette. */
static void test_vox(void **state) {
  (void)state;
  enum { MODELS = 4 };
  static uint8_t values[4 * VOXELS];
  for (int by = VXM_COLOR_NOISE; by <= VXM_COLOR_PART; by++) {
    const uint8_t *model[MODELS] = {NULL}, *palette = NULL;
    uint32_t size_of[MODELS][3];
    int place_of[MODELS][3] = {{0}}, models = 0, placed = 0, shapes = 0;
    size_t size, voxels = 0, found = 0;
    uint8_t *bytes = write_as("vox", (vxm_color_by)by, &size, values);
    assert_memory_equal(bytes, "VOX ", 4);
    assert_int_equal(word_at(bytes + 4), 150);
    assert_memory_equal(bytes + 8, "MAIN", 4);
    assert_int_equal(word_at(bytes + 12), 0);
    assert_int_equal(word_at(bytes + 16), size - 20);
    for (size_t at = 20; at < size; at += 12 + word_at(bytes + at + 4)) {
      const uint8_t *content = bytes + at + 12;
      assert_int_equal(word_at(bytes + at + 8), 0);
      if (memcmp(bytes + at, "SIZE", 4) == 0)
        for (int a = 0; a < 3; a++)
          size_of[models][a] = word_at(content + 4 * a);
      else if (memcmp(bytes + at, "XYZI", 4) == 0)
        model[models++] = content;
      else if (memcmp(bytes + at, "RGBA", 4) == 0)
        palette = content;
      else if (memcmp(bytes + at, "nSHP", 4) == 0)
        assert_int_equal(word_at(content + 12), shapes++);
      else if (memcmp(bytes + at, "nTRN", 4) == 0 && word_at(content) > 0) {
        char text[64] = "";
        assert_memory_equal(content + 32, "_t", 2);
        memcpy(text, content + 38, word_at(content + 34));
        int *p = place_of[placed++];
        assert_int_equal(sscanf(text, "%d %d %d", &p[0], &p[1], &p[2]), 3);
      }
    }
    assert_true(models == 2 && placed == 2 && shapes == 2 && palette);
    for (int m = 0; m < models; m++)
      for (uint32_t v = 0; v < word_at(model[m]); v++, found++) {
        const uint8_t *voxel = model[m] + 4 + (size_t)4 * v;
        int at[3];
        for (int a = 0; a < 3; a++) {
          assert_true(voxel[a] < size_of[m][a]);
          at[a] = place_of[m][a] - (int)size_of[m][a] / 2 + voxel[a];
        }
        const uint8_t *value = values + 4 * ((at[0] * 33 + at[1]) * 25 + at[2]);
        assert_int_equal(value[3], 255);
        assert_true(voxel[3] >= 1);
        for (int c = 0; c < 3; c++)
          assert_true(abs(palette[4 * (voxel[3] - 1) + c] - value[c]) < (by == VXM_COLOR_PART ? 1 : 40));
      }
    for (size_t i = 0; i < VOXELS; i++)
      voxels += values[4 * i + 3] != 0;
    assert_int_equal(found, voxels);
    free(bytes);
  }
}

static void test_arguments(void **state) {
  (void)state;
  vxm_soup *soup;
  vxm_model *model = model_of(&soup);
  vxm_color_options options = VXM_COLOR_OPTIONS_INIT;
  vxm_error error = VXM_ERROR_INIT;
  static uint8_t values[4 * VOXELS];
  assert_int_equal(vxm_model_colors(NULL, NULL, model, &space, NULL, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_model_write_colors(NULL, model, &space, "x.tga", NULL, &error), VXM_ERROR_ARGUMENT);
  assert_non_null(strstr(error.text, ".vox"));
  options.by = VXM_COLOR_GLSL;
  assert_int_equal(vxm_model_colors(values, NULL, model, &space, &options, NULL), VXM_ERROR_ARGUMENT);
  options.source = "";
  assert_int_equal(vxm_model_colors(values, NULL, model, &space, &options, NULL), VXM_ERROR_UNAVAILABLE);
  options.by = (vxm_color_by)9;
  assert_int_equal(vxm_model_colors(values, NULL, model, &space, &options, NULL), VXM_ERROR_ARGUMENT);
  vxm_model_destroy(model);
  vxm_soup_destroy(soup);
}

/* ---- From a volume ---- */

/** A number along an axis, between what a function gives at the two centres about it. */
static double oracle(const vxm_space *of, const double *numbers, const double at[3], int axis, int64_t i[3]) {
  if (axis == 3)
    return numbers[(i[0] * of->dims[1] + i[1]) * of->dims[2] + i[2]];
  int64_t before = -1;
  double centre = 0, value[2];
  for (int64_t n = 0; n < of->dims[axis]; n++) { /* the last centre that is not behind it */
    double next = of->origin[axis] + ((double)n + 0.5) * of->voxel_size[axis];
    if (next <= at[axis]) {
      before = n;
      centre = next;
    }
  }
  i[axis] = before < 0 ? 0 : before;
  value[0] = oracle(of, numbers, at, axis + 1, i);
  if (before < 0 || before + 1 == of->dims[axis])
    return value[0];
  i[axis] = before + 1;
  value[1] = oracle(of, numbers, at, axis + 1, i);
  return value[0] + (value[1] - value[0]) * (at[axis] - centre) / of->voxel_size[axis];
}

enum { WIDE = 7, DEEP = 5, HIGH = 4, NUMBERS = WIDE * DEEP * HIGH };

/** It covers a part of the model. */
static const vxm_space small = {{WIDE, DEEP, HIGH}, {2.3, 1.7, 1.1}, {3.7, 5.1, 4.3}};
static const vxm_space coarse = {{40, 30, 25}, {0, 0, 0}, {1, 1, 1}};

static uint8_t *colors_of(const vxm_field *volume, vxm_status wanted) {
  vxm_soup *soup;
  vxm_model *model = model_of(&soup);
  vxm_color_options options = VXM_COLOR_OPTIONS_INIT;
  uint8_t *values = malloc((size_t)4 * 40 * 30 * 25);
  vxm_error error = VXM_ERROR_INIT;
  assert_non_null(values);
  options.by = VXM_COLOR_VOLUME;
  options.volume = volume;
  vxm_status status = vxm_model_colors(values, NULL, model, &coarse, &options, &error);
  if (status != wanted)
    fail_msg("%s", error.text);
  vxm_model_destroy(model);
  vxm_soup_destroy(soup);
  return values;
}

/** Each channel is that of its numbers, which lie from 0 to 1; `given` is 0 where nothing counts. */
static void check_sampled(const uint8_t *values, double numbers[3][NUMBERS], const double *given) {
  size_t set = 0;
  for (int64_t i = 0; i < 40; i++)
    for (int64_t j = 0; j < 30; j++)
      for (int64_t k = 0; k < 25; k++) {
        const uint8_t *voxel = values + 4 * ((i * 30 + j) * 25 + k);
        const double at[3] = {(double)i + 0.5, (double)j + 0.5, (double)k + 0.5};
        if (voxel[3] == 0)
          continue;
        int64_t index[3];
        double weight = oracle(&small, given, at, 0, index);
        assert_int_equal(voxel[3], 255);
        set++;
        for (int c = 0; c < 3; c++) {
          double sum = oracle(&small, numbers[c], at, 0, index);
          assert_true(fabs(voxel[c] - (weight > 1e-9 ? 255 * sum / weight : 0)) < 0.51);
        }
      }
  assert_true(set > 500);
}

static void test_volume_of_numbers(void **state) {
  (void)state;
  static double numbers[3][NUMBERS], given[NUMBERS];
  float made[NUMBERS];
  vxm_field *volume;
  for (size_t n = 0; n < NUMBERS; n++) {
    made[n] = -3 + 20 * (float)((n * 37) % 101) / 100;
    given[n] = 1;
  }
  made[50] = NAN;
  made[51] = INFINITY;
  made[0] = -3; /* the least and the greatest */
  made[1] = 17;
  given[50] = given[51] = 0;
  for (size_t n = 0; n < NUMBERS; n++)
    for (int c = 0; c < 3; c++)
      numbers[c][n] = given[n] > 0 ? ((double)made[n] + 3) / 20 : 0;
  assert_int_equal(vxm_field_create(&volume, context, &small, VXM_FIELD_NUMBERS, VXM_FLOAT32, made, NULL),
                   VXM_OK);
  uint8_t *values = colors_of(volume, VXM_OK);
  check_sampled(values, numbers, given);
  vxm_field_destroy(volume);
  free(values);
}

static void test_volume_of_colors(void **state) {
  (void)state;
  static double numbers[3][NUMBERS], given[NUMBERS];
  uint8_t made[NUMBERS][4];
  vxm_field *volume;
  for (size_t n = 0; n < NUMBERS; n++) {
    made[n][3] = n % 9 == 0 ? 0 : 255;
    given[n] = n % 9 != 0;
    for (int c = 0; c < 3; c++) {
      made[n][c] = (uint8_t)(n % 9 == 0 ? 0 : (n * 53 + (size_t)c * 91) % 256);
      numbers[c][n] = made[n][c] / 255.0;
    }
  }
  assert_int_equal(vxm_field_create(&volume, context, &small, VXM_FIELD_COLORS, VXM_UINT8, made, NULL),
                   VXM_OK);
  uint8_t *values = colors_of(volume, VXM_OK);
  check_sampled(values, numbers, given);
  vxm_field_destroy(volume);
  free(values);
}

static void test_volumes_refused(void **state) {
  (void)state;
  static const uint8_t labels[NUMBERS] = {1};
  vxm_space beside = small;
  vxm_field *volume;
  free(colors_of(NULL, VXM_ERROR_ARGUMENT));
  assert_int_equal(vxm_field_create(&volume, context, &small, VXM_FIELD_LABELS, VXM_UINT8, labels, NULL),
                   VXM_OK);
  free(colors_of(volume, VXM_ERROR_ARGUMENT));
  vxm_field_destroy(volume);
  beside.origin[1] = 30;
  assert_int_equal(vxm_field_create(&volume, context, &beside, VXM_FIELD_NUMBERS, VXM_UINT8, labels, NULL),
                   VXM_OK);
  free(colors_of(volume, VXM_ERROR_ARGUMENT));
  vxm_field_destroy(volume);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_npy),
                                     cmocka_unit_test(test_ply),
                                     cmocka_unit_test(test_vox),
                                     cmocka_unit_test(test_arguments),
                                     cmocka_unit_test(test_volume_of_numbers),
                                     cmocka_unit_test(test_volume_of_colors),
                                     cmocka_unit_test(test_volumes_refused)};
  return cmocka_run_group_tests(tests, setup, teardown);
}

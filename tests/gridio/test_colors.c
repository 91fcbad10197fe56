/* SPDX-License-Identifier: BSD-3-Clause */
/* Colours in files: .npy has the values as they are, .ply the exposed faces, and .vox, read chunk by chunk,
 * every voxel in its place with a colour near its own. */
#include "../voxel/shapes.h"

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

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_npy), cmocka_unit_test(test_ply),
                                     cmocka_unit_test(test_vox), cmocka_unit_test(test_arguments)};
  return cmocka_run_group_tests(tests, setup, teardown);
}

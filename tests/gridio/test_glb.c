/* SPDX-License-Identifier: BSD-3-Clause */
/** .glb: the surface of voxels encloses them, and looks as they do. */
#include "grids.h"

#include "base/endian.h"
#include "gridio/common/format.h"

#include <math.h>

static uint32_t word_at(const unsigned char *data) {
  return (uint32_t)data[0] | (uint32_t)data[1] << 8 | (uint32_t)data[2] << 16 | (uint32_t)data[3] << 24;
}

/** The binary chunk: positions, normals, colours, indices. */
typedef struct surface {
  unsigned char *data;
  size_t quads;
  const unsigned char *positions, *normals, *indices;
  const char *text;
} surface;

static surface load_surface(const char *path, bool has_colors) {
  size_t size, each = 4 * (12 + 12 + (has_colors ? 8 : 0)) + 6 * 4;
  surface s = {.data = load_file(path, &size)};
  assert_memory_equal(s.data, "glTF", 4);
  assert_int_equal(word_at(s.data + 4), 2);
  assert_int_equal(word_at(s.data + 8), size);
  size_t text = word_at(s.data + 12);
  assert_int_equal(text % 4, 0);
  s.text = (const char *)s.data + 20;
  if (20 + text < size) {
    size_t length = word_at(s.data + 20 + text);
    assert_int_equal(20 + text + 8 + length, size);
    assert_int_equal(length % each, 0);
    s.quads = length / each;
    s.positions = s.data + 28 + text;
    s.normals = s.positions + s.quads * 4 * 12;
    s.indices = s.positions + length - s.quads * 6 * 4;
  }
  s.data[20 + text - 1] = '\0'; /* behind its last brace, or in place of it */
  return s;
}

/** The triangles of a part enclose as much as it has voxels, and turn as their normals say. */
static double measure(const surface *s, size_t begin, size_t end) {
  double volume = 0;
  for (size_t t = 2 * begin; t < 2 * end; t++) {
    double p[3][3], normal[3];
    for (int c = 0; c < 3; c++) {
      size_t vertex = 4 * begin + word_at(s->indices + 4 * (3 * t + (size_t)c));
      assert_true(vertex < 4 * end);
      for (size_t a = 0; a < 3; a++) {
        p[c][a] = vxm_load_f32(s->positions + 12 * vertex + 4 * a, vxm_must_swap(false));
        normal[a] = vxm_load_f32(s->normals + 12 * vertex + 4 * a, vxm_must_swap(false));
      }
    }
    double cross[3], toward = 0;
    for (int a = 0; a < 3; a++) {
      int b = (a + 1) % 3, c = (a + 2) % 3;
      cross[a] = (p[1][b] - p[0][b]) * (p[2][c] - p[0][c]) - (p[1][c] - p[0][c]) * (p[2][b] - p[0][b]);
      toward += cross[a] * normal[a];
      volume += cross[a] * p[0][a] / 6;
    }
    assert_true(toward > 0);
  }
  return volume;
}

static void test_glb(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_rng rng = {15};
  for (int round = 0; round < 30; round++) {
    vxm_space space = random_space(&rng, 20, false);
    vxm_grid *grid = new_grid(context, space);
    fill_random(grid, &rng, round % KINDS);
    const char *path = path_in(folder, "x.glb");
    write_grid(grid, path);
    surface s = load_surface(path, false);
    assert_int_equal(s.quads == 0, vxm_grid_count(grid) == 0);
    assert_float_equal(measure(&s, 0, s.quads), (double)vxm_grid_count(grid), 1e-6);
    free(s.data);
    vxm_field *field = make_field(context, &space, VXM_FIELD_COLORS, VXM_UINT8);
    for (size_t v = 0; v < vxm_field_count(field); v++) {
      const int64_t *n = space.dims;
      int64_t k = (int64_t)v % n[2], j = (int64_t)v / n[2] % n[1], i = (int64_t)v / n[2] / n[1];
      unsigned char *rgba = field->values + 4 * v;
      memset(rgba, 0, 4);
      if (vxm_grid_get(grid, i, j, k)) {
        rgba[vxm_rng_below(&rng, 3)] = 200;
        rgba[3] = 255;
      }
    }
    write_field(field, path);
    s = load_surface(path, true);
    assert_float_equal(measure(&s, 0, s.quads), (double)vxm_grid_count(grid), 1e-6);
    free(s.data);
    vxm_field_destroy(field);
    vxm_grid_destroy(grid);
  }
  remove_folder(folder);
  vxm_context_destroy(context);
}

/** The root's matrix has size, place and turn; labels are objects by name. */
static void test_glb_text(void **state) {
  (void)state;
  static const char *const matrices[] = {
      "[2.0,0.0,0.0,0.0,0.0,0.0,-4.0,0.0,0.0,8.0,0.0,0.0,10.0,30.0,-20.0,1.0]",
      "[0.0,2.0,0.0,0.0,0.0,0.0,4.0,0.0,8.0,0.0,0.0,0.0,30.0,10.0,20.0,1.0]",
      "[2.0,0.0,0.0,0.0,0.0,4.0,0.0,0.0,0.0,0.0,8.0,0.0,10.0,20.0,30.0,1.0]",
  };
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  const vxm_space space = {{3, 1, 1}, {10, 20, 30}, {2, 4, 8}};
  vxm_field *field = make_field(context, &space, VXM_FIELD_LABELS, VXM_UINT8);
  const unsigned char labels[3] = {2, 0, 1};
  memcpy(field->values, labels, sizeof labels);
  assert_true(vxm_label_table_add(&field->about.table, context, "the \"first\"", 0));
  for (int up = 0; up < 3; up++) {
    const char *path = path_in(folder, "x.glb");
    field->style.up = up;
    write_field(field, path);
    surface s = load_surface(path, false);
    assert_non_null(strstr(s.text, matrices[up]));
    assert_non_null(strstr(s.text, "\"name\":\"the \\\"first\\\"\""));
    assert_non_null(strstr(s.text, "\"name\":\"label 2\""));
    assert_int_equal(s.quads, 12);
    for (size_t part = 0; part < 2; part++)
      assert_float_equal(measure(&s, 6 * part, 6 * part + 6), 1, 1e-9);
    free(s.data);
  }
  vxm_field_destroy(field);
  remove_folder(folder);
  vxm_context_destroy(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_glb),
      cmocka_unit_test(test_glb_text),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** Formats of images that hold bits and fields (NIfTI, VTK, TIFF): what is written comes back; damage ends in
 * an error, or in what was there. */
#include "grids.h"

#include "gridio/common/format.h"
#include "gridio/gridio.h"

#include <math.h>

static const vxm_grid_format *const formats[] = {&vxm_format_nii, &vxm_format_nii_gz, &vxm_format_vti,
                                                 &vxm_format_vtk, &vxm_format_tif};

enum { FORMATS = sizeof formats / sizeof formats[0] };

static const char *file_in(const char *folder, const char *format) {
  static char path[96];
  snprintf(path, sizeof path, "%s/a.%s", folder, format);
  return path;
}

/** Without zlib there is no .nii.gz. */
static bool is_there(const vxm_grid_format *format) {
  const vxm_space space = {{1, 1, 1}, {0, 0, 0}, {1, 1, 1}};
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_grid *grid = new_grid(context, space);
  vxm_error error = VXM_ERROR_INIT;
  char folder[64];
  make_folder(folder);
  vxm_status status = vxm_gridio_write(grid, file_in(folder, format->name), NULL, &error);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  remove_folder(folder);
  assert_true(status == VXM_OK || status == VXM_ERROR_UNAVAILABLE);
  return status == VXM_OK;
}

static void assert_same_space(const vxm_space *a, const vxm_space *b) {
  assert_memory_equal(a->dims, b->dims, sizeof a->dims);
  assert_memory_equal(a->origin, b->origin, sizeof a->origin);
  assert_memory_equal(a->voxel_size, b->voxel_size, sizeof a->voxel_size);
}

static void test_bits_come_back(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {11};
  for (int f = 0; f < FORMATS; f++)
    for (int round = 0; round < 40 && is_there(formats[f]); round++) {
      vxm_context *context = context_with(1 + round % 3, 0, NULL, NULL);
      vxm_grid *back, *grid = new_grid(context, random_space(&rng, 70, false));
      fill_random(grid, &rng, round % KINDS);
      const char *path = file_in(folder, formats[f]->name);
      assert_int_equal(vxm_gridio_write(grid, path, NULL, NULL), VXM_OK);
      assert_int_equal(vxm_gridio_read(&back, context, path, NULL), VXM_OK);
      assert_same_space(&grid->space, &back->space);
      assert_memory_equal(grid->words, back->words, grid->word_count * sizeof *grid->words);
      assert_int_equal(back->warnings.count, 0);
      vxm_grid_destroy(back);
      assert_int_equal(vxm_gridio_read_space(&back, context, path, NULL), VXM_OK);
      assert_same_space(&grid->space, &back->space);
      vxm_grid_destroy(back);
      vxm_grid_destroy(grid);
      vxm_context_destroy(context);
      empty_folder(folder);
    }
  remove_folder(folder);
}

/* ---- Fields ---- */

static vxm_field *new_field(vxm_context *context, vxm_rng *rng, vxm_field_kind kind, vxm_scalar scalar) {
  vxm_space space = random_space(rng, 30, false);
  vxm_field *field;
  assert_int_equal(vxm_field_make(&field, context, &space, kind, scalar, NULL), VXM_OK);
  field->about.is_declared = kind != VXM_FIELD_NUMBERS;
  size_t bytes = vxm_field_count(field) * vxm_field_voxel_bytes(field);
  for (size_t b = 0; b < bytes; b++)
    field->values[b] = (unsigned char)vxm_rng_below(rng, 256);
  /* Floats that are numbers. */
  for (size_t v = 0; v < vxm_field_count(field); v++)
    if (scalar == VXM_FLOAT32)
      ((float *)(void *)field->values)[v] = (float)vxm_rng_below(rng, 1000) / 8 - 50;
    else if (scalar == VXM_FLOAT64)
      ((double *)(void *)field->values)[v] = (double)vxm_rng_below(rng, 1000) / 7 - 50;
  return field;
}

static void check_field(const vxm_field *field, const char *path, bool has_label) {
  vxm_field *back;
  vxm_grid *grid;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_gridio_write_field(field, path, NULL, &error) != VXM_OK)
    fail_msg("%s", error.text);
  if (vxm_gridio_read_either(&grid, &back, field->context, path, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_null(grid);
  assert_same_space(&field->space, &back->space);
  assert_int_equal(back->scalar, field->scalar);
  assert_int_equal(back->channels, field->channels);
  assert_int_equal(back->about.kind, field->about.kind);
  assert_int_equal(back->about.is_declared, field->about.is_declared);
  assert_memory_equal(field->values, back->values, vxm_field_count(field) * vxm_field_voxel_bytes(field));
  assert_int_equal(back->about.table.count, has_label);
  if (has_label)
    assert_string_equal(vxm_label_table_name(&back->about.table, 1), "wing");
  vxm_field_destroy(back);
}

static void test_fields_come_back(void **state) {
  (void)state;
  static const vxm_scalar scalars[] = {VXM_FLOAT64, VXM_FLOAT32, VXM_UINT8, VXM_INT8,   VXM_UINT16,
                                       VXM_INT16,   VXM_UINT32,  VXM_INT32, VXM_UINT64, VXM_INT64};
  static const vxm_field_kind kinds[] = {VXM_FIELD_NUMBERS, VXM_FIELD_DISTANCE, VXM_FIELD_COVERAGE,
                                         VXM_FIELD_LABELS, VXM_FIELD_CONFIDENCE};
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {12};
  vxm_context *context = context_with(2, 0, NULL, NULL);
  for (int f = 0; f < FORMATS; f++)
    for (int s = 0; s < 10 && is_there(formats[f]); s++)
      for (int k = 0; k < 6; k++) {
        vxm_field *field =
            new_field(context, &rng, k < 5 ? kinds[k] : VXM_FIELD_COLORS, k < 5 ? scalars[s] : VXM_UINT8);
        bool has_label = k == 3;
        if (has_label)
          assert_true(vxm_label_table_add(&field->about.table, context, "wing", 3));
        check_field(field, file_in(folder, formats[f]->name), has_label);
        vxm_field_destroy(field);
        empty_folder(folder);
      }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/** Floats of 16 bits become those of 32, and keep their values. */
static void test_halves(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {13};
  vxm_context *context = context_with(1, 0, NULL, NULL);
  for (int f = 0; f < FORMATS; f++) {
    if (!is_there(formats[f]))
      continue;
    vxm_field *back, *field = new_field(context, &rng, VXM_FIELD_COVERAGE, VXM_FLOAT16);
    vxm_grid *grid;
    for (size_t v = 0; v < vxm_field_count(field); v++)
      ((uint16_t *)(void *)field->values)[v] = (uint16_t)(0x3000 + vxm_rng_below(&rng, 0x0c00));
    const char *path = file_in(folder, formats[f]->name);
    assert_int_equal(vxm_gridio_write_field(field, path, NULL, NULL), VXM_OK);
    assert_int_equal(vxm_gridio_read_either(&grid, &back, context, path, NULL), VXM_OK);
    assert_int_equal(back->scalar, VXM_FLOAT32);
    for (size_t v = 0; v < vxm_field_count(field); v++) {
      double a, b;
      vxm_field_doubles(&a, field, v, 1);
      vxm_field_doubles(&b, back, v, 1);
      assert_true(a == b);
    }
    vxm_field_destroy(back);
    vxm_field_destroy(field);
    empty_folder(folder);
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/* ---- Damage ---- */

static vxm_status read_bytes(vxm_field **field, const vxm_grid_format *format, vxm_context *context,
                             const unsigned char *data, size_t size, vxm_error *error) {
  unsigned char *copy = malloc(size ? size : 1);
  assert_non_null(copy);
  memcpy(copy, data, size);
  vxm_input input = {.data = copy, .size = size, .name = "damaged", .context = context};
  *field = NULL;
  vxm_status status = format->read_field(field, &input, error);
  free(copy);
  assert_int_equal(*field != NULL, status == VXM_OK);
  if (status != VXM_OK)
    assert_true(error->text[0] != '\0' && !strchr(error->text, '\n'));
  return status;
}

/** Whether a field is that of a file that is whole. */
static bool is_same(const vxm_field *a, const vxm_field *b) {
  return memcmp(a->space.dims, b->space.dims, sizeof a->space.dims) == 0 && a->scalar == b->scalar &&
         memcmp(a->values, b->values, vxm_field_count(a) * vxm_field_voxel_bytes(a)) == 0;
}

/** What is behind the values may be missing; else a file that is cut is refused. */
static void check_cuts(const vxm_grid_format *format, const vxm_field *field, const unsigned char *data,
                       size_t size) {
  size_t taken = 0;
  for (size_t cut = 0; cut < size; cut++) {
    vxm_field *back;
    vxm_error error = VXM_ERROR_INIT;
    if (read_bytes(&back, format, field->context, data, cut, &error) != VXM_OK) {
      assert_int_equal(error.code, VXM_ERROR_FORMAT);
      continue;
    }
    assert_true(is_same(field, back));
    taken++;
    vxm_field_destroy(back);
  }
  assert_true(taken < 64);
}

static void check_mutations(const vxm_grid_format *format, const unsigned char *data, size_t size,
                            vxm_rng *rng) {
  enum { ROUNDS = 4000 };
  vxm_context *context = context_with(1, 8 << 20, NULL, NULL);
  unsigned char *copy = malloc(size);
  int read = 0;
  assert_non_null(copy);
  for (int round = 0; round < ROUNDS; round++) {
    memcpy(copy, data, size);
    /* Most headers are short. */
    for (uint64_t t = 0, times = 1 + vxm_rng_below(rng, 4); t < times; t++)
      copy[vxm_rng_below(rng, t % 2 && size > 700 ? 700 : size)] = (unsigned char)vxm_rng_below(rng, 256);
    vxm_field *back;
    vxm_error error = VXM_ERROR_INIT;
    vxm_status status = read_bytes(&back, format, context, copy, size, &error);
    if (status == VXM_OK)
      assert_int_equal(vxm_space_check(&back->space, NULL), VXM_OK);
    else
      assert_true(status == VXM_ERROR_FORMAT || status == VXM_ERROR_RANGE ||
                  status == VXM_ERROR_MEMORY_LIMIT);
    read += status == VXM_OK;
    vxm_field_destroy(back);
  }
  assert_true(read > 0 && read < ROUNDS);
  free(copy);
  vxm_context_destroy(context);
}

static void test_damage(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {14};
  vxm_context *context = context_with(1, 0, NULL, NULL);
  const vxm_space space = {{11, 9, 7}, {1, 2, 3}, {0.5, 0.25, 2}};
  for (int f = 0; f < FORMATS; f++) {
    vxm_field *field;
    size_t size;
    if (!is_there(formats[f]))
      continue;
    assert_int_equal(vxm_field_make(&field, context, &space, VXM_FIELD_NUMBERS, VXM_UINT16, NULL), VXM_OK);
    for (size_t b = 0; b < 2 * vxm_field_count(field); b++)
      field->values[b] = (unsigned char)vxm_rng_below(&rng, 256);
    const char *path = file_in(folder, formats[f]->name);
    assert_int_equal(vxm_gridio_write_field(field, path, NULL, NULL), VXM_OK);
    unsigned char *data = load_file(path, &size);
    check_cuts(formats[f], field, data, size);
    check_mutations(formats[f], data, size, &rng);
    free(data);
    vxm_field_destroy(field);
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/** Sizes beyond 32767, and places beyond 32-bit floats, are those of NIfTI-2. */
static void test_nifti_2(void **state) {
  (void)state;
  static const vxm_space spaces[] = {{{40000, 1, 2}, {0.1, 0.2, 0.3}, {0.7, 0.7, 0.9}},
                                     {{3, 4, 5}, {0, 0, 0}, {1e150, 1e150, 1e150}},
                                     {{3, 4, 5}, {0, 0, 0}, {1, 1e-60, 1}},
                                     {{3, 4, 5}, {0, -1e99, 0}, {1, 1e90, 1}}};
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_rng rng = {15};
  for (size_t s = 0; s < sizeof spaces / sizeof *spaces; s++) {
    char folder[64];
    make_folder(folder);
    vxm_grid *back, *grid = new_grid(context, spaces[s]);
    fill_random(grid, &rng, 1);
    const char *path = file_in(folder, "nii");
    assert_int_equal(vxm_gridio_write(grid, path, NULL, NULL), VXM_OK);
    assert_int_equal(vxm_gridio_read(&back, context, path, NULL), VXM_OK);
    assert_same_space(&grid->space, &back->space);
    assert_memory_equal(grid->words, back->words, grid->word_count * sizeof *grid->words);
    vxm_grid_destroy(back);
    vxm_grid_destroy(grid);
    remove_folder(folder);
  }
  vxm_context_destroy(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_bits_come_back), cmocka_unit_test(test_fields_come_back),
      cmocka_unit_test(test_halves),         cmocka_unit_test(test_damage),
      cmocka_unit_test(test_nifti_2),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** Slices as pictures: what is written comes back; no slice appears without all; damage ends in an error. */
#include "grids.h"

#include "gridio/common/format.h"
#include "gridio/formats/slices.h"

#include <sys/stat.h>

static char folder[64], pattern[96];

static int set_up(void **state) {
  (void)state;
  make_folder(folder);
  snprintf(pattern, sizeof pattern, "%s/a%%03d.png", folder);
  return 0;
}

static int tear_down(void **state) {
  (void)state;
  remove_folder(folder);
  return 0;
}

static const char *slice_name(int number) {
  static char path[96];
  snprintf(path, sizeof path, "%s/a%03d.png", folder, number);
  return path;
}

/** Whether this build has libpng, and can so write and read slices. */
static bool has_png(void) {
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_grid *grid = new_grid(context, unit_space(1, 1, 1));
  vxm_status status = vxm_gridio_write(grid, pattern, NULL, NULL);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  empty_folder(folder);
  assert_true(status == VXM_OK || status == VXM_ERROR_UNAVAILABLE);
  return status == VXM_OK;
}

static void test_patterns(void **state) {
  (void)state;
  static const char *const good[] = {"a%d.png", "a%d.tif", "%04d.PNG", "x%/b_%09d_c.png"},
                           *const bad[] = {"a.png",      "%d/a.png",  "a%d.gif",  "a%s.png",  "a%4d.png",
                                           "a%012d.png", "a%d%d.png", "a%%d.png", "a%0d.png", "-"};
  char name[PATH_MAX];
  for (size_t g = 0; g < sizeof good / sizeof *good; g++)
    assert_true(vxm_slices_is_pattern(good[g]));
  for (size_t b = 0; b < sizeof bad / sizeof *bad; b++)
    assert_false(vxm_slices_is_pattern(bad[b]));
  assert_true(vxm_slices_name(name, good[3], 12));
  assert_string_equal(name, "x%/b_000000012_c.png");
  assert_true(vxm_slices_name(name, good[0], 12));
  assert_string_equal(name, "a12.png");
}

static void test_bits_come_back(void **state) {
  (void)state;
  vxm_rng rng = {31};
  for (int round = 0; round < 6 && has_png(); round++) {
    vxm_context *context = context_with(1 + round % 3, 0, NULL, NULL);
    vxm_grid *back, *grid = new_grid(context, random_space(&rng, 30, false));
    fill_random(grid, &rng, round % KINDS);
    assert_int_equal(vxm_gridio_write(grid, pattern, NULL, NULL), VXM_OK);
    assert_int_equal(vxm_gridio_read(&back, context, pattern, NULL), VXM_OK);
    assert_memory_equal(&grid->space, &back->space, sizeof grid->space);
    assert_memory_equal(grid->words, back->words, grid->word_count * sizeof *grid->words);
    assert_int_equal(back->warnings.count, 0);
    vxm_grid_destroy(back);
    vxm_grid_destroy(grid);
    vxm_context_destroy(context);
    empty_folder(folder);
  }
}

static vxm_field *new_field(vxm_context *context, vxm_field_kind kind, vxm_scalar scalar, int64_t slices) {
  vxm_space space = {{7, 5, slices}, {0.1, -2, 3e5}, {0.25, 0.5, 1.0 / 3}};
  vxm_rng rng = {32};
  vxm_field *field;
  assert_int_equal(vxm_field_make(&field, context, &space, kind, scalar, NULL), VXM_OK);
  field->about.is_declared = kind != VXM_FIELD_NUMBERS;
  for (size_t b = 0; b < vxm_field_count(field) * vxm_field_voxel_bytes(field); b++)
    field->values[b] = (unsigned char)vxm_rng_below(&rng, 256);
  return field;
}

static void test_fields_come_back(void **state) {
  (void)state;
  static const struct {
    vxm_field_kind kind;
    vxm_scalar scalar;
  } cases[] = {{VXM_FIELD_COVERAGE, VXM_UINT8}, {VXM_FIELD_LABELS, VXM_UINT8},
               {VXM_FIELD_LABELS, VXM_UINT16},  {VXM_FIELD_COLORS, VXM_UINT8},
               {VXM_FIELD_NUMBERS, VXM_UINT16}, {VXM_FIELD_NUMBERS, VXM_UINT8}};
  for (size_t c = 0; c < sizeof cases / sizeof *cases && has_png(); c++) {
    vxm_context *context = context_with(2, 0, NULL, NULL);
    vxm_field *back = NULL, *field = new_field(context, cases[c].kind, cases[c].scalar, 4);
    vxm_grid *grid = NULL;
    vxm_error error = VXM_ERROR_INIT;
    if (cases[c].kind == VXM_FIELD_LABELS)
      assert_true(vxm_label_table_add(&field->about.table, context, "wing", 3));
    if (vxm_gridio_write_field(field, pattern, NULL, &error) != VXM_OK ||
        vxm_gridio_read_either(&grid, &back, context, pattern, &error) != VXM_OK)
      fail_msg("%s", error.text);
    assert_null(grid);
    assert_memory_equal(&field->space, &back->space, sizeof field->space);
    assert_int_equal(back->scalar, field->scalar);
    assert_int_equal(back->about.kind, field->about.kind);
    assert_int_equal(back->about.table.count, field->about.table.count);
    assert_memory_equal(field->values, back->values, vxm_field_count(field) * vxm_field_voxel_bytes(field));
    vxm_field_destroy(back);
    vxm_field_destroy(field);
    vxm_context_destroy(context);
    empty_folder(folder);
  }
}

/** A slice that cannot be replaced: no other is, and what was there stays. */
static void test_all_or_none(void **state) {
  (void)state;
  struct stat info;
  if (!has_png())
    return;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_field *field = new_field(context, VXM_FIELD_COVERAGE, VXM_UINT8, 4);
  assert_int_equal(mkdir(slice_name(2), 0700), 0);
  assert_int_equal(vxm_gridio_write_field(field, pattern, NULL, NULL), VXM_ERROR_IO);
  assert_int_equal(rmdir(slice_name(2)), 0);
  for (int z = 0; z < 4; z++)
    assert_int_not_equal(stat(slice_name(z), &info), 0);
  vxm_field_destroy(field);
  field = new_field(context, VXM_FIELD_DISTANCE, VXM_FLOAT32, 2);
  assert_int_equal(vxm_gridio_write_field(field, pattern, NULL, NULL), VXM_ERROR_ARGUMENT);
  vxm_field_destroy(field);
  vxm_context_destroy(context);
}

static void expect_failure(vxm_context *context, const char *words) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid = NULL;
  vxm_field *field = NULL;
  vxm_status status = vxm_gridio_read_either(&grid, &field, context, pattern, &error);
  assert_null(grid);
  assert_null(field);
  assert_int_not_equal(status, VXM_OK);
  if (!strstr(error.text, words))
    fail_msg("\"%s\" is not in: %s", words, error.text);
}

static size_t load(unsigned char bytes[4096], const char *path) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  size_t size = fread(bytes, 1, 4096, file);
  fclose(file);
  return size;
}

static void store(const char *path, const unsigned char *bytes, size_t size) {
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes, 1, size, file), size);
  fclose(file);
}

/** Each slice is checked against the first, and the JSON against all. */
static void test_gaps_and_sizes(void **state) {
  (void)state;
  unsigned char bytes[4096];
  char json[112];
  if (!has_png())
    return;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_field *back, *field = new_field(context, VXM_FIELD_COVERAGE, VXM_UINT8, 4);
  vxm_grid *grid;
  expect_failure(context, "there is no slice 0 or 1");
  assert_int_equal(vxm_gridio_write_field(field, pattern, NULL, NULL), VXM_OK);
  store(slice_name(4), bytes, load(bytes, slice_name(1)));
  assert_int_equal(vxm_gridio_read_either(&grid, &back, context, pattern, NULL), VXM_OK);
  assert_int_equal(back->warnings.count, 1);
  assert_memory_equal(field->values, back->values, vxm_field_count(field));
  vxm_field_destroy(back);
  assert_int_equal(unlink(slice_name(4)), 0);
  assert_int_equal(unlink(slice_name(2)), 0);
  expect_failure(context, "7 x 5 x 2 voxels without a gap");
  snprintf(json, sizeof json, "%s.json", pattern);
  assert_int_equal(unlink(json), 0);
  assert_int_equal(unlink(slice_name(0)), 0);
  assert_int_equal(vxm_gridio_read_either(&grid, &back, context, pattern, NULL), VXM_OK);
  assert_int_equal(back->space.dims[2], 1); /* slice 1 alone */
  assert_int_equal(back->warnings.count, 1);
  for (int64_t i = 0; i < 35; i++)
    assert_int_equal(back->values[i], field->values[4 * i + 1]);
  vxm_field_destroy(back);
  size_t size = load(bytes, slice_name(1));
  bytes[19]++;
  store(slice_name(2), bytes, size);
  expect_failure(context, "that of the first slice");
  vxm_field_destroy(field);
  vxm_context_destroy(context);
}

/** Bytes changed, and the end cut off: an error, or a picture of that size. */
static void test_damage(void **state) {
  (void)state;
  unsigned char bytes[4096], damaged[4096];
  if (!has_png())
    return;
  vxm_rng rng = {33};
  vxm_context *context = context_with(1, 0, NULL, NULL);
  for (int round = 0; round < 3; round++) {
    vxm_field *field = new_field(context, round == 2 ? VXM_FIELD_COLORS : VXM_FIELD_LABELS,
                                 round == 1 ? VXM_UINT16 : VXM_UINT8, 1);
    assert_int_equal(vxm_gridio_write_field(field, pattern, NULL, NULL), VXM_OK);
    vxm_field_destroy(field);
    size_t size = load(bytes, slice_name(0));
    store(slice_name(0), bytes, size - 20);
    expect_failure(context, "a000.png");
    store(slice_name(0), bytes, 20);
    expect_failure(context, "not a PNG");
    for (int n = 0; n < 40; n++) {
      vxm_grid *grid = NULL;
      vxm_field *back = NULL;
      memcpy(damaged, bytes, size);
      damaged[vxm_rng_below(&rng, size)] = (unsigned char)vxm_rng_below(&rng, 256);
      store(slice_name(0), damaged, size);
      vxm_status status = vxm_gridio_read_either(&grid, &back, context, pattern, NULL);
      assert_int_equal(status == VXM_OK, grid || back);
      vxm_grid_destroy(grid);
      vxm_field_destroy(back);
    }
    empty_folder(folder);
  }
  vxm_context_destroy(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_patterns),
      cmocka_unit_test_setup_teardown(test_bits_come_back, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_fields_come_back, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_all_or_none, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_gaps_and_sizes, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_damage, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

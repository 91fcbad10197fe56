/* SPDX-License-Identifier: BSD-3-Clause */
/* Files of a number per voxel against the arrays that the library makes, under limits and with failures. */
#include "grids.h"

#include "base/context_struct.h"
#include "mesh/soup.h"

#include <math.h>

static vxm_soup *make_soup(vxm_context *context) {
  enum { SIDES = 30 };
  vxm_soup *soup;
  assert_int_equal(vxm_soup_create(&soup, context, "test", NULL), VXM_OK);
  for (int s = 0; s < SIDES; s++)
    for (int end = 0; end < 2; end++)
      assert_int_equal(vxm_soup_add_vertex(soup, cos(2 * M_PI * s / SIDES), sin(2 * M_PI * s / SIDES) - 0.02,
                                           end + 0.1, NULL),
                       VXM_OK);
  uint32_t rim[2][SIDES];
  for (uint32_t s = 0; s < SIDES; s++) {
    uint32_t next = (s + 1) % SIDES, side[4] = {2 * s, 2 * next, 2 * next + 1, 2 * s + 1};
    assert_int_equal(vxm_soup_add_face(soup, side, 4, NULL), VXM_OK);
    rim[0][SIDES - 1 - s] = 2 * s;
    rim[1][s] = 2 * s + 1;
  }
  assert_int_equal(vxm_soup_add_face(soup, rim[0], SIDES, NULL), VXM_OK);
  assert_int_equal(vxm_soup_add_face(soup, rim[1], SIDES, NULL), VXM_OK);
  return soup;
}

static const vxm_space space = {{200, 190, 181}, {-1.2, -1.2, -0.3}, {0.013, 0.0125, 0.01}};

enum { KINDS_OF_FIELD = 3 };

static size_t size_of(int kind) {
  return kind == 0 ? 1 : 4;
}

/** Coverage in bytes and in floats, and distance; into `values`, or a file. */
static vxm_status make(int kind, vxm_model *model, void *values, const char *path, vxm_error *error) {
  vxm_coverage_options coverage = VXM_COVERAGE_OPTIONS_INIT;
  coverage.scalar = kind == 0 ? VXM_UINT8 : VXM_FLOAT32;
  coverage.subdivision = 2;
  if (kind < 2 && path)
    return vxm_model_write_coverage(NULL, model, &space, path, &coverage, error);
  if (kind < 2)
    return vxm_model_coverage(values, NULL, model, &space, &coverage, error);
  return path ? vxm_model_write_distance(NULL, model, &space, path, NULL, error)
              : vxm_model_distance(values, NULL, model, &space, NULL, error);
}

static vxm_status tell(vxm_estimate *out, int kind, const vxm_model *model, const char *path) {
  vxm_coverage_options coverage = VXM_COVERAGE_OPTIONS_INIT;
  coverage.scalar = kind == 0 ? VXM_UINT8 : VXM_FLOAT32;
  coverage.subdivision = 2;
  return kind < 2 ? vxm_model_estimate_coverage(out, model, &space, path, &coverage, NULL)
                  : vxm_model_estimate_distance(out, model, &space, path, NULL, NULL);
}

/** The file takes no more than was told, and what was told is not all that there is. */
static void check_estimate(const vxm_estimate *told, int kind, vxm_context *context, uint64_t held,
                           uint64_t limit) {
  assert_int_equal(told->grid_bytes,
                   (uint64_t)(space.dims[0] * space.dims[1] * space.dims[2]) * size_of(kind));
  assert_int_equal(told->passes > 1, limit > 0);
  uint64_t taken = vxm_context_peak_bytes(context) - held;
  if (taken > told->memory_bytes || (limit > 0 && told->memory_bytes > limit))
    fail_msg("kind %d took %llu bytes, and %llu were told", kind, (unsigned long long)taken,
             (unsigned long long)told->memory_bytes);
}

static void check_file(const char *path, const unsigned char *values, size_t size, bool is_nrrd) {
  size_t length, count = (size_t)(space.dims[0] * space.dims[1] * space.dims[2]);
  unsigned char *data = load_file(path, &length);
  assert_true(length > count * size);
  const unsigned char *from = data + (length - count * size);
  if (!is_nrrd)
    assert_memory_equal(from, values, count * size);
  const int64_t *n = space.dims;
  for (int64_t k = 0; is_nrrd && k < n[2]; k++)
    for (int64_t j = 0; j < n[1]; j++)
      for (int64_t i = 0; i < n[0]; i++, from += size) {
        const unsigned char *value = values + (size_t)((i * n[1] + j) * n[2] + k) * size;
        float a, b;
        memcpy(&a, size == 4 ? from : (const unsigned char *)"\0\0\0", 4);
        memcpy(&b, size == 4 ? value : (const unsigned char *)"\0\0\0", 4);
        assert_true(size == 1 ? *from == *value : fabsf(a - b) < 1e-7f);
      }
  free(data);
}

static void test_files_equal_arrays(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  for (int kind = 0; kind < KINDS_OF_FIELD; kind++) {
    unsigned char *values = malloc((size_t)(space.dims[0] * space.dims[1] * space.dims[2]) * size_of(kind));
    for (int round = 0; round < 4; round++) {
      /* 27 MiB of floats; 7 MiB of sub-voxels */
      uint64_t limit = round == 0 ? 0 : UINT64_C(17) << 20;
      vxm_context *context = context_with(1 + round % 2, limit, NULL, NULL);
      vxm_soup *soup = make_soup(context);
      vxm_model *model;
      vxm_error error = VXM_ERROR_INIT;
      assert_int_equal(vxm_model_create(&model, soup, NULL, &error), VXM_OK);
      bool is_nrrd = round % 2;
      const char *path = path_in(folder, is_nrrd ? "x.nrrd" : "x.npy");
      if (round == 0)
        assert_int_equal(make(kind, model, values, NULL, &error), VXM_OK);
      vxm_estimate told = VXM_ESTIMATE_INIT;
      assert_int_equal(tell(&told, kind, model, path), VXM_OK);
      assert_int_equal(count_files(folder), 0);
      uint64_t held = atomic_load(&context->used);
      atomic_store(&context->peak, held);
      if (make(kind, model, NULL, path, &error) != VXM_OK)
        fail_msg("%s", error.text);
      check_estimate(&told, kind, context, held, limit);
      check_file(path, values, size_of(kind), is_nrrd);
      assert_true(limit == 0 || vxm_context_peak_bytes(context) <= limit);
      assert_int_equal(count_files(folder), is_nrrd ? 1 : 2);
      empty_folder(folder);
      vxm_model_destroy(model);
      vxm_soup_destroy(soup);
      vxm_context_destroy(context);
    }
    free(values);
  }
  remove_folder(folder);
}

static int stop_at(const char *phase, double fraction, void *payload) {
  (void)phase;
  (void)fraction;
  int *left = payload;
  return --*left == 0;
}

static void test_failures_leave_nothing(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  for (int kind = 0; kind < KINDS_OF_FIELD; kind++) {
    bool is_done = false;
    for (int at = 2; !is_done; at += 1 + at / 2) {
      int left = at;
      vxm_context *context = context_with(2, 0, stop_at, &left);
      vxm_soup *soup = make_soup(context);
      vxm_model *model;
      vxm_error error = VXM_ERROR_INIT;
      if (vxm_model_create(&model, soup, NULL, &error) == VXM_OK) {
        vxm_status status = make(kind, model, NULL, path_in(folder, "x.npy"), &error);
        is_done = status == VXM_OK;
        assert_true(is_done || status == VXM_ERROR_CANCELLED);
        assert_int_equal(count_files(folder), is_done ? 2 : 0);
        if (is_done) {
          vxm_coverage_options full = VXM_COVERAGE_OPTIONS_INIT;
          full.format = "nrrd";
          left = 1 << 30;
          assert_int_equal(vxm_model_write_coverage(NULL, model, &space, "/dev/full", &full, &error),
                           VXM_ERROR_IO);
        }
        vxm_model_destroy(model);
      }
      vxm_soup_destroy(soup);
      vxm_context_destroy(context);
    }
    empty_folder(folder);
  }
  remove_folder(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_files_equal_arrays),
      cmocka_unit_test(test_failures_leave_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/* Prefix sums and sorting on an OpenCL device are those of the CPU: every size about a block, large ones, few
 * and many different keys, groups of several sizes; equal keys keep their order. */
#include "config.h"
#ifdef HAVE_OPENCL
#include "gpu/opencl/cl_sort.h" /* before the test's own `engine` */
#endif

#include "gpu_test.h"

#ifdef HAVE_OPENCL
static vxm_opencl *device(void) {
  return vxm_opencl_of(engine);
}

static void check_scan(vxm_rng *rng, size_t count) {
  uint32_t *numbers = malloc((count + 1) * sizeof *numbers), *sums = malloc((count + 1) * sizeof *sums);
  assert_true(numbers && sums);
  for (size_t i = 0; i <= count; i++)
    numbers[i] = (uint32_t)vxm_rng_below(rng, i % 7 == 0 ? 1000 : 3);
  assert_int_equal(vxm_cl_upload(device(), VXM_CL_COUNTS, numbers, (count + 1) * sizeof *numbers, NULL),
                   VXM_OK);
  assert_int_equal(vxm_cl_scan(device(), VXM_CL_COUNTS, count, NULL), VXM_OK);
  assert_int_equal(vxm_cl_download(device(), VXM_CL_COUNTS, 0, sums, (count + 1) * sizeof *sums, NULL),
                   VXM_OK);
  uint32_t sum = 0;
  for (size_t i = 0; i <= count; sum += numbers[i], i++)
    assert_int_equal(sums[i], sum);
  free(numbers);
  free(sums);
}

static void check_sort(vxm_rng *rng, size_t count, int bits, uint64_t kinds) {
  uint64_t *keys = malloc((count + 1) * sizeof *keys), *found = malloc((count + 1) * sizeof *found);
  uint32_t *places = malloc((count + 1) * sizeof *places);
  assert_true(keys && found && places);
  for (size_t i = 0; i < count; i++) {
    keys[i] = vxm_mix(1 + vxm_rng_below(rng, kinds)) & vxm_low_bits((unsigned)bits);
    places[i] = (uint32_t)i;
  }
  assert_int_equal(vxm_cl_upload(device(), VXM_CL_TILE_KEYS, keys, count * sizeof *keys, NULL), VXM_OK);
  assert_int_equal(vxm_cl_upload(device(), VXM_CL_TILE_TRIANGLES, places, count * sizeof *places, NULL),
                   VXM_OK);
  assert_int_equal(vxm_cl_sort(device(), VXM_CL_TILE_KEYS, VXM_CL_TILE_TRIANGLES, count, bits, NULL), VXM_OK);
  assert_int_equal(vxm_cl_download(device(), VXM_CL_TILE_KEYS, 0, found, count * sizeof *found, NULL),
                   VXM_OK);
  assert_int_equal(vxm_cl_download(device(), VXM_CL_TILE_TRIANGLES, 0, places, count * sizeof *places, NULL),
                   VXM_OK);
  for (size_t i = 0; i < count; i++) {
    assert_true(found[i] == keys[places[i]]); /* a permutation: values are different, and none is lost */
    if (i > 0)
      assert_true(found[i - 1] < found[i] || (found[i - 1] == found[i] && places[i - 1] < places[i]));
  }
  free(keys);
  free(found);
  free(places);
}

static void test_sizes(void **state) {
  (void)state;
  vxm_rng rng = {5};
  size_t whole = device()->group;
  for (size_t group = whole; group >= 8; group /= 2) {
    vxm_cl_programs_release(device());
    device()->group = group;
    for (size_t count = 0; count < 40; count++)
      check_scan(&rng, count);
    for (size_t near = 8 * group; near <= 64 * group * group; near *= 8 * group)
      for (size_t count = near - 2; count <= near + 2; count++)
        check_scan(&rng, count);
    for (size_t count = 0; count < 20; count++)
      check_sort(&rng, count, 8, 30);
    for (size_t count = 16 * group - 2; count <= 16 * group + 2; count++)
      check_sort(&rng, count, 64, 1000000);
    check_sort(&rng, 5000, 13, 3);
  }
  vxm_cl_programs_release(device());
  device()->group = whole;
}

static void test_large(void **state) {
  (void)state;
  vxm_rng rng = {6};
  check_scan(&rng, 3000001);
  check_sort(&rng, 300007, 30, 1000000);
  check_sort(&rng, 100000, 61, UINT64_C(1) << 60);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_sizes), cmocka_unit_test(test_large)};
  int status = gpu_test_start(NULL);
  if (status == 0)
    status = cmocka_run_group_tests_name("sorting by " ENGINE, tests, setup, teardown);
  vxm_engine_destroy(engine);
  return status;
}
#else
int main(void) {
  return gpu_test_start(NULL);
}
#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Labels with any number of threads, within any limit of memory, cancelled anywhere, and in any layout. */
#include "../base/rounds.h"
#include "label_test.h"

#include <pthread.h>
#include <string.h>

static const vxm_layout layouts[] = {{2, 1, 0}, {1, 2, 0}, {0, 1, 2}};

static vxm_soup *crowd(vxm_context *owner, int bodies) {
  vxm_rng rng = {33};
  vxm_soup *soup = shape_empty(owner);
  for (int b = 0; b < bodies; b++) {
    double low[3], high[3];
    for (int a = 0; a < 3; a++) {
      low[a] = 100 * vxm_rng_unit(&rng);
      high[a] = low[a] + 0.5 + 6 * vxm_rng_unit(&rng) * vxm_rng_unit(&rng);
    }
    char name[16] = "/many 0";
    name[6] = (char)('0' + b % 7);
    tagged_box(soup, low, high, name);
    size_t first = soup->face_count;
    if (b == 5) { /* one large body among them */
      shape_torus(soup, 40, 20, 40, 10, (double[]){50, 50, 50});
      tag_faces(soup, first, name);
    }
  }
  return soup;
}

/** Thousands of parts, or scattered bodies under a few labels; any number of threads, with and without a
 * limit, in all layouts. */
static void test_threads_and_limits(void **state) {
  (void)state;
  vxm_space space = {{90, 80, 70}, {-1, -1, -1}, {1.2, 1.3, 1.5}};
  uint16_t *first = malloc(voxels_of(&space) * sizeof *first),
           *next = malloc(voxels_of(&space) * sizeof *next);
  for (int round = 0; round < 8; round++) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = 1 + round / 2;
    options.memory_limit = round >= 6 ? UINT64_C(60) << 20 : 0;
    vxm_context *own;
    assert_int_equal(vxm_context_create(&own, &options, NULL), VXM_OK);
    vxm_soup *soup = crowd(own, 3000);
    vxm_voxelize_report voxelize = VXM_VOXELIZE_REPORT_INIT;
    vxm_label_report report = VXM_LABEL_REPORT_INIT;
    report.voxelize = &voxelize;
    uint16_t *values = labels_of(soup, &space, round % 2 ? VXM_LABEL_MATERIAL : VXM_LABEL_PART, &report);
    assert_int_equal(report.labels, round % 2 ? 7 : 3001);
    assert_true(report.contested > 100);
    uint16_t **kept = round % 2 ? &next : &first;
    if (round < 2)
      memcpy(*kept, values, voxels_of(&space) * sizeof *values);
    assert_memory_equal(*kept, values, voxels_of(&space) * sizeof *values);
    free(values);
    vxm_soup_destroy(soup);
    assert_true(options.memory_limit == 0 || vxm_context_peak_bytes(own) <= options.memory_limit);
    vxm_context_destroy(own);
  }
  free(next);
  free(first);
}

/** The layout of the values makes no difference. */
static void test_layouts(void **state) {
  (void)state;
  vxm_space space = {{70, 33, 41}, {-1, -1, -1}, {1.5, 3.2, 2.6}};
  vxm_soup *soup = crowd(context, 300);
  vxm_model *model;
  assert_int_equal(vxm_model_create(&model, soup, NULL, NULL), VXM_OK);
  uint16_t *values[3];
  for (int i = 0; i < 3; i++) {
    vxm_face_labels labelling;
    vxm_voxelize_report voxelize = VXM_VOXELIZE_REPORT_INIT;
    vxm_label_report report = VXM_LABEL_REPORT_INIT;
    report.voxelize = &voxelize;
    values[i] = malloc(voxels_of(&space) * sizeof *values[i]);
    assert_int_equal(vxm_face_labels_create(&labelling, soup, VXM_LABEL_MATERIAL, NULL), VXM_OK);
    assert_int_equal(vxm_labels_run(values[i], layouts[i], &report, model, &space, &labelling, NULL), VXM_OK);
    vxm_face_labels_destroy(&labelling);
  }
  for (int64_t x = 0; x < space.dims[0]; x++)
    for (int64_t y = 0; y < space.dims[1]; y++)
      for (int64_t z = 0; z < space.dims[2]; z++) {
        uint16_t right = at(values[0], &space, x, y, z);
        assert_int_equal(values[1][(x * space.dims[2] + z) * space.dims[1] + y], right);
        assert_int_equal(values[2][(z * space.dims[1] + y) * space.dims[0] + x], right);
      }
  for (int i = 0; i < 3; i++)
    free(values[i]);
  vxm_model_destroy(model);
  vxm_soup_destroy(soup);
}

typedef struct stopper {
  pthread_t caller;
  int calls, last;
  bool is_elsewhere;
} stopper;

static int count_calls(const char *phase, double fraction, void *payload) {
  stopper *s = payload;
  s->is_elsewhere = s->is_elsewhere || !pthread_equal(s->caller, pthread_self());
  return ++s->calls >= s->last || phase == NULL || fraction < 0;
}

/** It can be cancelled at every call, and reports from the caller's thread alone. */
static void test_cancelling(void **state) {
  (void)state;
  vxm_space space = {{30, 30, 30}, {0, 0, 0}, {3.5, 3.5, 3.5}};
  vxm_status status = VXM_ERROR_CANCELLED;
  int cancelled = 0;
  for (int last = 1; status != VXM_OK; last += 1 + last / 8) {
    stopper s = {pthread_self(), 0, last, false};
    vxm_context_options options = {sizeof(vxm_context_options), 3, 0, count_calls, &s};
    vxm_context *own;
    vxm_model *model = NULL;
    assert_int_equal(vxm_context_create(&own, &options, NULL), VXM_OK);
    vxm_soup *soup = crowd(own, 400);
    uint16_t *values = malloc(voxels_of(&space) * sizeof *values);
    status = vxm_model_create(&model, soup, NULL, NULL);
    if (status == VXM_OK)
      status = vxm_model_labels(values, NULL, model, &space, NULL, NULL);
    assert_true(status == VXM_OK || status == VXM_ERROR_CANCELLED);
    assert_false(s.is_elsewhere);
    cancelled += status != VXM_OK;
    free(values);
    vxm_model_destroy(model);
    vxm_soup_destroy(soup);
    vxm_context_destroy(own);
  }
  assert_true(cancelled > 4);
}

/** Whatever the limit, it is kept: there is an error, or the same labels. */
static void test_any_limit(void **state) {
  (void)state;
  vxm_space space = {{64, 64, 64}, {0, 0, 0}, {1.6, 1.6, 1.6}};
  uint16_t *first = NULL, *values = malloc(voxels_of(&space) * sizeof *values);
  int refused = 0, done = 0;
  for (uint64_t limit = 0; done < 4; limit = limit ? limit + limit / 4 : 1 << 18) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = 2;
    options.memory_limit = limit;
    vxm_context *own;
    assert_int_equal(vxm_context_create(&own, &options, NULL), VXM_OK);
    vxm_soup *soup = crowd(context, 300), *copy = NULL;
    vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
    int64_t *offsets = malloc((soup->face_count + 1) * sizeof *offsets),
            *indices = malloc(soup->corner_count * sizeof *indices);
    for (size_t f = 0; f <= soup->face_count; f++)
      offsets[f] = (int64_t)soup->offsets[f];
    for (size_t c = 0; c < soup->corner_count; c++)
      indices[c] = soup->indices[c];
    arrays.vertices = soup->positions;
    arrays.vertex_count = (int64_t)soup->vertex_count;
    arrays.offsets = offsets;
    arrays.indices = indices;
    arrays.index_count = (int64_t)soup->corner_count;
    arrays.face_count = (int64_t)soup->face_count;
    vxm_model *model = NULL;
    vxm_error error = VXM_ERROR_INIT;
    vxm_status status = vxm_mesh_create(&copy, own, &arrays, &error);
    if (status == VXM_OK)
      status = vxm_model_create(&model, copy, NULL, &error);
    if (status == VXM_OK)
      status = vxm_model_labels(values, NULL, model, &space, NULL, &error);
    if (status != VXM_OK) {
      assert_int_equal(status, VXM_ERROR_MEMORY_LIMIT);
      assert_int_equal(error.code, VXM_ERROR_MEMORY_LIMIT);
      refused++;
      assert_true(!model || vxm_model_label_count(model) == 0);
    } else {
      done++;
      if (!first)
        first = memcpy(malloc(voxels_of(&space) * sizeof *first), values, voxels_of(&space) * sizeof *first);
      assert_memory_equal(values, first, voxels_of(&space) * sizeof *first);
    }
    assert_true(limit == 0 || vxm_context_peak_bytes(own) <= limit);
    vxm_model_destroy(model);
    vxm_mesh_destroy(copy);
    free(indices);
    free(offsets);
    vxm_soup_destroy(soup);
    vxm_context_destroy(own);
  }
  assert_true(refused > 3);
  free(first);
  free(values);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_layouts),
      cmocka_unit_test(test_threads_and_limits),
      cmocka_unit_test(test_any_limit),
      cmocka_unit_test(test_cancelling),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}

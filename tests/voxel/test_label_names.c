/* SPDX-License-Identifier: BSD-3-Clause */
/** What labels are called, and what is refused. */
#include "../base/rounds.h"
#include "label_test.h"

#include <string.h>

static void check_names(const vxm_soup *soup, vxm_label_by by, const char *const *names) {
  vxm_face_labels l;
  assert_int_equal(vxm_face_labels_create(&l, soup, by, NULL), VXM_OK);
  for (size_t label = 1; label <= l.table.count; label++) {
    assert_non_null(names[label - 1]);
    assert_string_equal(vxm_label_table_name(&l.table, label), names[label - 1]);
  }
  assert_null(names[l.table.count]);
  vxm_face_labels_destroy(&l);
}

static void test_names(void **state) {
  (void)state;
  static const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1}, low2[3] = {2, 2, 2}, high2[3] = {3, 3, 3},
                      low3[3] = {4, 4, 4}, high3[3] = {5, 5, 5};
  vxm_soup *soup = shape_empty(context);
  shape_box(soup, low, high);
  shape_box(soup, low2, high2);
  check_names(soup, VXM_LABEL_PART, (const char *[]){"part 1", "part 2", NULL});
  check_names(soup, VXM_LABEL_GROUP, (const char *[]){"unnamed", NULL});
  check_names(soup, VXM_LABEL_MATERIAL, (const char *[]){"unnamed", NULL});
  tag_faces(soup, 0, "seat/wood");
  tag_faces(soup, 4, "seat/wood/oak");
  tagged_box(soup, low3, high3, "leg");
  tag_faces(soup, soup->face_count - 1, "/iron");
  check_names(soup, VXM_LABEL_PART, (const char *[]){"seat", "seat/wood/oak", "part 3", NULL});
  check_names(soup, VXM_LABEL_GROUP, (const char *[]){"seat", "leg", "unnamed", NULL});
  check_names(soup, VXM_LABEL_MATERIAL, (const char *[]){"wood", "wood/oak", "unnamed", "iron", NULL});
  vxm_soup_destroy(soup);
}

/** A soup of triangles that share no vertices, as of an STL file, has parts all the same. */
static void test_parts_of_unwelded_soups(void **state) {
  (void)state;
  static const double low[3] = {0, 0, 0}, high[3] = {4, 4, 4}, low2[3] = {5, 5, 5}, high2[3] = {8, 8, 8};
  vxm_soup *welded = shape_empty(context), *soup = shape_empty(context);
  shape_box(welded, low, high);
  shape_box(welded, low2, high2);
  for (size_t f = 0; f < welded->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(welded, f, &n);
    for (size_t c = 2; c < n; c++) {
      const uint32_t three[3] = {corner[0], corner[c - 1], corner[c]};
      uint32_t v = (uint32_t)soup->vertex_count;
      for (int k = 0; k < 3; k++) {
        const double *p = vxm_position(welded, three[k]);
        shape_vertex(soup, p[0], p[1], p[2]);
      }
      shape_triangle(soup, v, v + 1, v + 2);
    }
  }
  vxm_space space = {{8, 8, 8}, {0, 0, 0}, {1, 1, 1}};
  vxm_voxelize_report voxelize = VXM_VOXELIZE_REPORT_INIT;
  vxm_label_report report = VXM_LABEL_REPORT_INIT;
  report.voxelize = &voxelize;
  uint16_t *values = labels_of(soup, &space, VXM_LABEL_PART, &report);
  assert_int_equal(report.labels, 2);
  assert_int_equal(report.voxelize->voxels, 64 + 27);
  assert_int_equal(at(values, &space, 1, 2, 3), 1);
  assert_int_equal(at(values, &space, 6, 6, 6), 2);
  free(values);
  vxm_soup_destroy(soup);
  vxm_soup_destroy(welded);
}

static void test_too_many(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  for (uint32_t t = 0; t < 65537; t++) {
    shape_vertex(soup, t, 0, 0);
    shape_vertex(soup, t, 0, 1);
    shape_vertex(soup, t, 1, 0);
    shape_triangle(soup, 3 * t, 3 * t + 1, 3 * t + 2);
  }
  vxm_face_labels l;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_face_labels_create(&l, soup, VXM_LABEL_PART, &error), VXM_ERROR_RANGE);
  vxm_face_labels_destroy(&l);
  assert_non_null(strstr(error.text, "65537 parts"));
  assert_non_null(strstr(error.text, "label by group"));
  for (int less = 0; less < 2; less++) { /* the last face, then its part with it */
    soup->face_count--;
    soup->corner_count -= 3;
    assert_int_equal(vxm_face_labels_create(&l, soup, VXM_LABEL_PART, &error),
                     less == 0 ? VXM_ERROR_RANGE : VXM_OK);
    assert_int_equal(l.table.count, less == 0 ? 0 : 65535);
    vxm_face_labels_destroy(&l);
  }
  vxm_soup_destroy(soup);
}

static void test_what_is_refused(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_box(soup, (double[]){0, 0, 0}, (double[]){1, 1, 1});
  vxm_model *model;
  assert_int_equal(vxm_model_create(&model, soup, NULL, NULL), VXM_OK);
  vxm_space space = {{1, 1, 1}, {0, 0, 0}, {1, 1, 1}};
  vxm_label_options options = VXM_LABEL_OPTIONS_INIT;
  uint16_t value = 7;
  assert_int_equal(vxm_model_label_count(model), 0);
  assert_int_equal(vxm_model_labels(&value, NULL, model, &space, NULL, NULL), VXM_OK);
  assert_int_equal(value, 1);
  assert_int_equal(vxm_model_label_count(model), 1);
  assert_string_equal(vxm_model_label_name(model, 1), "part 1");
  assert_string_equal(vxm_model_label_name(model, 0), "");
  assert_string_equal(vxm_model_label_name(model, 2), "");
  assert_int_equal(vxm_model_label_voxels(model, 1), 1);
  assert_int_equal(vxm_model_label_voxels(model, 2), 0);
  assert_int_equal(vxm_model_labels(NULL, NULL, model, &space, NULL, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_model_labels(&value, NULL, NULL, &space, NULL, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_model_labels(&value, NULL, model, NULL, NULL, NULL), VXM_ERROR_ARGUMENT);
  options.by = (vxm_label_by)3;
  assert_int_equal(vxm_model_labels(&value, NULL, model, &space, &options, NULL), VXM_ERROR_ARGUMENT);
  options.by = VXM_LABEL_GROUP;
  options.size = 2;
  assert_int_equal(vxm_model_labels(&value, NULL, model, &space, &options, NULL), VXM_ERROR_ARGUMENT);
  options.size = sizeof options;
  assert_int_equal(vxm_model_write_labels(NULL, model, &space, "x.rle", &options, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_model_write_labels(NULL, model, &space, NULL, &options, NULL), VXM_ERROR_ARGUMENT);
  space.dims[1] = 0;
  assert_int_equal(vxm_model_labels(&value, NULL, model, &space, NULL, NULL), VXM_ERROR_ARGUMENT);
  vxm_model_destroy(model);
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_names),
      cmocka_unit_test(test_too_many),
      cmocka_unit_test(test_what_is_refused),
      cmocka_unit_test(test_parts_of_unwelded_soups),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** What the tests of repair share. */
#ifndef VXM_TESTS_REPAIRING_H
#define VXM_TESTS_REPAIRING_H

#include "../mesh/soups.h"

#include "mesh/weld.h"
#include "repair/repair.h"

static inline int64_t count_of(const vxm_repair_report *report, const char *pass) {
  for (int i = 0; i < report->pass_count; i++)
    if (strcmp(report->passes[i].pass, pass) == 0)
      return report->passes[i].count;
  fail_msg("no pass %s", pass);
  return -1;
}

static inline int64_t count_all(const vxm_repair_report *report) {
  int64_t sum = 0;
  for (int i = 0; i < report->pass_count; i++)
    sum += report->passes[i].count;
  return sum;
}

static inline vxm_soup *repaired(const vxm_soup *soup, const vxm_repair_options *options,
                                 vxm_repair_report *report) {
  vxm_soup *out;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_repair_run(&out, report, soup, options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return out;
}

static inline void assert_same_soup(const vxm_soup *a, const vxm_soup *b) {
  assert_int_equal(a->vertex_count, b->vertex_count);
  assert_int_equal(a->face_count, b->face_count);
  assert_int_equal(a->corner_count, b->corner_count);
  assert_memory_equal(a->positions, b->positions, 3 * a->vertex_count * sizeof *a->positions);
  assert_memory_equal(a->offsets, b->offsets, (a->face_count + 1) * sizeof *a->offsets);
  assert_memory_equal(a->indices, b->indices, a->corner_count * sizeof *a->indices);
  assert_int_equal(a->face_tags != NULL, b->face_tags != NULL);
  if (a->face_tags)
    assert_memory_equal(a->face_tags, b->face_tags, a->face_count * sizeof *a->face_tags);
}

/** A report, and room for the censuses of both meshes. */
#define REPAIR_REPORT(name)                                                   \
  vxm_census name##_before = VXM_CENSUS_INIT, name##_after = VXM_CENSUS_INIT; \
  vxm_repair_report name = VXM_REPAIR_REPORT_INIT;                            \
  name.before = &name##_before;                                               \
  name.after = &name##_after

/** Repairing the result again must find nothing and give the same arrays. */
static inline void assert_repair_is_done(const vxm_soup *soup, const vxm_repair_options *options) {
  vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
  vxm_soup *again = repaired(soup, options, &report);
  for (int i = 0; i < report.pass_count; i++)
    if (report.passes[i].count != 0)
      fail_msg("the second repair counts %lld in %s", (long long)report.passes[i].count,
               report.passes[i].pass);
  assert_same_soup(soup, again);
  vxm_soup_destroy(again);
}

/** Gives every face its own tag, so that it can be told where a face of the result came from. */
static inline void tag_faces(vxm_soup *soup) {
  soup->face_tags = vxm_alloc(soup->context, soup->face_count, sizeof *soup->face_tags, NULL);
  assert_non_null(soup->face_tags);
  for (size_t f = 0; f < soup->face_count; f++) {
    char name[16];
    int length = snprintf(name, sizeof name, "f%zu", f);
    assert_int_equal(vxm_soup_add_tag(soup, name, (size_t)length, &soup->face_tags[f], NULL), VXM_OK);
  }
}

static inline double distance_between(const double *p, const double *q) {
  double sum = 0;
  for (int axis = 0; axis < 3; axis++)
    sum += (p[axis] - q[axis]) * (p[axis] - q[axis]);
  return sum > 0 ? __builtin_sqrt(sum) : 0;
}

#endif

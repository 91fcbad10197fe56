/* SPDX-License-Identifier: BSD-3-Clause */
/** What the tests of the module for OpenMesh share. */
#ifndef VXM_TESTS_HALFEDGES_H
#define VXM_TESTS_HALFEDGES_H

#include "manifold.h"
#include "repair_test.h"

#include "repair/external/openmesh.h"

#include <math.h>

static const vxm_openmesh *openmesh;

static inline vxm_halfedge_report inspected(const vxm_soup *soup) {
  vxm_halfedge_report report;
  vxm_error error = VXM_ERROR_INIT;
  if (openmesh->inspect(&report, soup, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return report;
}

/** Closed walks along the boundary of a manifold. */
static inline int64_t count_holes(const vxm_soup *soup) {
  brute_side *sides = list_brute_sides(soup);
  uint32_t *next = malloc((soup->vertex_count + 1) * sizeof *next);
  assert_non_null(next);
  for (size_t v = 0; v < soup->vertex_count; v++)
    next[v] = UINT32_MAX;
  for (size_t i = 0; i < soup->corner_count; i++) {
    bool before = i > 0 && sides[i - 1].from == sides[i].to && sides[i - 1].to == sides[i].from;
    bool after =
        i + 1 < soup->corner_count && sides[i + 1].from == sides[i].to && sides[i + 1].to == sides[i].from;
    if (!before && !after)
      next[sides[i].to] = sides[i].from;
  }
  int64_t count = 0;
  for (size_t v = 0; v < soup->vertex_count; v++) {
    count += next[v] != UINT32_MAX;
    for (uint32_t at = (uint32_t)v; next[at] != UINT32_MAX;) {
      uint32_t to = next[at];
      next[at] = UINT32_MAX;
      at = to;
    }
  }
  free(next);
  free(sides);
  return count;
}

static inline void check_inspection(const vxm_soup *soup) {
  vxm_halfedge_report report = inspected(soup);
  brute_report brute = look_brute(soup);
  assert_int_equal(report.manifold, brute.manifold);
  assert_int_equal(report.faces + report.rejected, soup->face_count);
  assert_true(brute.complex_edges == 0 || report.rejected > 0);
  if (!brute.manifold)
    return;
  assert_int_equal(report.rejected, 0);
  assert_int_equal(report.boundary_edges, brute.boundary_edges);
  assert_int_equal(report.components, count_components_brute(soup));
  assert_int_equal(report.holes, count_holes(soup));
}

typedef struct outcome {
  vxm_soup *soup;
  uint64_t *origin;
  int64_t filled, left;
} outcome;

/** Fills, and checks what has to hold of any manifold. */
static inline outcome fill(const vxm_soup *soup, size_t max_edges) {
  outcome out;
  vxm_error error = VXM_ERROR_INIT;
  vxm_halfedge_report before = inspected(soup);
  if (openmesh->fill(&out.soup, &out.origin, &out.filled, &out.left, soup, max_edges, &error) != VXM_OK)
    fail_msg("%s", error.text);
  vxm_halfedge_report after = inspected(out.soup);
  assert_true(look_brute(out.soup).manifold && after.manifold);
  assert_true(max_edges > 0 || out.left >= after.holes);
  assert_int_equal(after.components, before.components);
  /* what was there is there as it was, at most on another vertex at the same position */
  assert_int_equal(out.soup->vertex_count, soup->vertex_count);
  assert_memory_equal(out.soup->positions, soup->positions, 24 * soup->vertex_count);
  assert_memory_equal(out.soup->offsets, soup->offsets, 8 * (soup->face_count + 1));
  for (size_t c = 0; c < soup->corner_count; c++)
    for (int a = 0; a < 3; a++)
      assert_true(vxm_position(soup, soup->indices[c])[a] == vxm_position(out.soup, out.soup->indices[c])[a]);
  for (size_t f = 0; f < out.soup->face_count; f++)
    assert_true(f < soup->face_count ? out.origin[f] == f : out.origin[f] < soup->face_count);
  /* a hole of n edges takes n - 2 triangles */
  size_t made = out.soup->face_count - soup->face_count;
  assert_int_equal(made, before.boundary_edges - after.boundary_edges - 2 * out.filled);
  assert_int_equal(out.soup->corner_count, soup->corner_count + 3 * made);
  return out;
}

static inline void drop(const vxm_soup *soup, outcome out) {
  vxm_free(soup->context, out.origin);
  vxm_soup_destroy(out.soup);
}

/** The areas of faces from a number on: of each its size, and all together as vectors. */
static inline void areas_from(const vxm_soup *soup, size_t first, double *sum, double *of_sum) {
  double total[3] = {0, 0, 0};
  *sum = 0;
  for (size_t f = first; f < soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n);
    const double *a = vxm_position(soup, corner[0]), *b = vxm_position(soup, corner[1]);
    const double *c = vxm_position(soup, corner[2]);
    double area[3];
    for (int i = 0; i < 3; i++) {
      int j = (i + 1) % 3, k = (i + 2) % 3;
      area[i] = ((b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j])) / 2;
      total[i] += area[i];
    }
    *sum += sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
  }
  *of_sum = sqrt(total[0] * total[0] + total[1] * total[1] + total[2] * total[2]);
}

/** Opens the module; where it is missing, 77, which is that a test was skipped, and else 0. */
static inline int open_openmesh(void) {
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_openmesh_open(&openmesh, "this test", &error) == VXM_OK)
    return 0;
  fprintf(stderr, "%s\n", error.text);
  return 77;
}

#endif

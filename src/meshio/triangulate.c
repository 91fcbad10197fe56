/* SPDX-License-Identifier: BSD-3-Clause */
#include "meshio/triangulate.h"

#include <math.h>

void vxm_triangulator_open(vxm_triangulator *tri, vxm_context *context) {
  *tri = (vxm_triangulator){.context = context, .tests_left = (size_t)1 << 31};
}

void vxm_triangulator_close(vxm_triangulator *tri) {
  vxm_free(tri->context, tri->plane);
  vxm_free(tri->context, tri->before);
  vxm_free(tri->context, tri->after);
  vxm_free(tri->context, tri->triangles);
}

static vxm_status reserve(vxm_triangulator *tri, size_t n, vxm_error *error) {
  if (n <= tri->capacity)
    return VXM_OK;
  size_t capacities[4] = {tri->capacity, tri->capacity, tri->capacity, tri->capacity};
  vxm_context *context = tri->context;
  vxm_status status = vxm_grow(context, (void **)&tri->plane, &capacities[0], n, 2 * sizeof(double), error);
  if (status == VXM_OK)
    status = vxm_grow(context, (void **)&tri->before, &capacities[1], n, sizeof(uint32_t), error);
  if (status == VXM_OK)
    status = vxm_grow(context, (void **)&tri->after, &capacities[2], n, sizeof(uint32_t), error);
  if (status == VXM_OK)
    status = vxm_grow(context, (void **)&tri->triangles, &capacities[3], n, 3 * sizeof(uint32_t), error);
  if (status == VXM_OK)
    tri->capacity = capacities[0];
  return status;
}

/** Drops the coordinate on which the vector area (Newell's sum) is largest; the polygon turns left after. */
static void project(vxm_triangulator *tri, const double *positions, const uint32_t *corners, size_t n) {
  double area[3] = {0.0, 0.0, 0.0};
  const double *o = positions + 3 * (size_t)corners[0];
  for (size_t i = 1; i + 1 < n; i++) {
    const double *a = positions + 3 * (size_t)corners[i], *b = positions + 3 * (size_t)corners[i + 1];
    for (size_t c = 0; c < 3; c++) {
      size_t u = (c + 1) % 3, v = (c + 2) % 3;
      area[c] += (a[u] - o[u]) * (b[v] - o[v]) - (a[v] - o[v]) * (b[u] - o[u]);
    }
  }
  size_t axis = 0;
  for (size_t c = 1; c < 3; c++)
    if (fabs(area[c]) > fabs(area[axis]))
      axis = c;
  size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (area[axis] < 0.0) {
    size_t swapped = u;
    u = v;
    v = swapped;
  }
  for (size_t i = 0; i < n; i++) {
    const double *p = positions + 3 * (size_t)corners[i];
    tri->plane[2 * i] = p[u];
    tri->plane[2 * i + 1] = p[v];
  }
}

/** Twice the signed area of a b c: positive where they turn left. */
static double turn(const vxm_triangulator *tri, size_t a, size_t b, size_t c) {
  const double *p = tri->plane + 2 * a, *q = tri->plane + 2 * b, *r = tri->plane + 2 * c;
  return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

static bool same_place(const vxm_triangulator *tri, size_t a, size_t b) {
  return tri->plane[2 * a] == tri->plane[2 * b] && tri->plane[2 * a + 1] == tri->plane[2 * b + 1];
}

/** Whether no corner of the ring but those at its own places lies in the triangle before-i-after. */
static bool is_ear(const vxm_triangulator *tri, size_t i, size_t *tests) {
  size_t a = tri->before[i], c = tri->after[i];
  if (!(turn(tri, a, i, c) > 0.0))
    return false;
  for (size_t k = tri->after[c]; k != a; k = tri->after[k]) {
    ++*tests;
    if (same_place(tri, k, a) || same_place(tri, k, i) || same_place(tri, k, c))
      continue;
    if (turn(tri, a, i, k) >= 0.0 && turn(tri, i, c, k) >= 0.0 && turn(tri, c, a, k) >= 0.0)
      return false;
  }
  return true;
}

static bool is_convex(const vxm_triangulator *tri, size_t n) {
  /* Only left turns, and once round: x changes its direction just twice. */
  size_t changes = 0;
  for (size_t i = 0; i < n; i++) {
    size_t j = (i + 1) % n, k = (i + 2) % n;
    if (!(turn(tri, i, j, k) > 0.0))
      return false;
    double first = tri->plane[2 * j] - tri->plane[2 * i], second = tri->plane[2 * k] - tri->plane[2 * j];
    changes += (first > 0.0) != (second > 0.0);
  }
  return changes <= 2;
}

static void put(vxm_triangulator *tri, size_t *count, uint32_t a, uint32_t b, uint32_t c) {
  uint32_t *triangle = tri->triangles + 3 * (*count)++;
  triangle[0] = a;
  triangle[1] = b;
  triangle[2] = c;
}

/** Clips ears; what is left when none is found, or when the work grows too large, becomes a fan. */
static void clip(vxm_triangulator *tri, const uint32_t *corners, size_t n) {
  for (size_t i = 0; i < n; i++) {
    tri->before[i] = (uint32_t)(i > 0 ? i - 1 : n - 1);
    tri->after[i] = (uint32_t)(i + 1 < n ? i + 1 : 0);
  }
  /* Enough for any simple polygon, as long as the budget for all of them lasts. */
  const size_t share = n < 16384 ? 8 * n * n : tri->tests_left;
  const size_t tests_max = 64 * n + (share < tri->tests_left ? share : tri->tests_left);
  size_t count = 0, tests = 0, i = 0, since = 0, remaining = n;
  while (remaining > 3 && since < remaining && tests < tests_max) {
    if (!is_ear(tri, i, &tests)) {
      i = tri->after[i];
      since++;
      continue;
    }
    uint32_t a = tri->before[i], c = tri->after[i];
    put(tri, &count, corners[a], corners[i], corners[c]);
    tri->after[a] = c;
    tri->before[c] = a;
    remaining--;
    since = 0;
    i = tri->after[c]; /* one further, so that the pieces do not all fan out from one corner */
  }
  tri->tests_left -= tests < tri->tests_left ? tests : tri->tests_left;
  for (size_t b = tri->after[i], c = tri->after[b]; c != i; b = c, c = tri->after[c])
    put(tri, &count, corners[i], corners[b], corners[c]);
}

vxm_status vxm_triangulate(vxm_triangulator *tri, const double *positions, const uint32_t *corners, size_t n,
                           const uint32_t **triangles, vxm_error *error) {
  vxm_status status = reserve(tri, n, error);
  if (status != VXM_OK)
    return status;
  *triangles = tri->triangles;
  project(tri, positions, corners, n);
  if (n > 3 && !is_convex(tri, n)) {
    clip(tri, corners, n);
    return VXM_OK;
  }
  size_t count = 0;
  for (size_t i = 1; i + 1 < n; i++)
    put(tri, &count, corners[0], corners[i], corners[i + 1]);
  return VXM_OK;
}

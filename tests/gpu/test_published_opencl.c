/* SPDX-License-Identifier: BSD-3-Clause */
/* The published OpenCL program (Faieghi et al.): both approaches set the voxels of an oracle that evaluates
 * their equations one by one in floats, and count as many tests; on coordinates with which floats are exact
 * these are the voxels that exact integers find; read and mapped voxels are the same; what cannot be done is
 * refused. */
#include "gpu_test.h"
#include "voxmend/experimental.h"

#include "../voxel/surface_oracle.h"

#include <float.h>

/* ---- Oracles ---- */

/** What one approach makes of a mesh. */
typedef struct made {
  vxm_space space;
  uint8_t *voxels;
  size_t count;
  vxm_published_report report;
} made;

typedef struct corner {
  float at[3];
} corner;

static float dot(const float a[3], const float b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** Equations 3.6 to 3.8 on the plane of axes u and v; n is the normal along the third axis. */
static bool oracle_meets_flat(const corner t[3], const float p[3], float size, float n, int u, int v) {
  for (int i = 0; i < 3; i++) {
    const float *from = t[i].at, *to = t[(i + 1) % 3].at;
    float e[2] = {to[u] - from[u], to[v] - from[v]};
    float ne[2] = {n >= 0 ? -e[1] : e[1], n >= 0 ? e[0] : -e[0]};
    float a = -(ne[0] * from[u] + ne[1] * from[v]);
    a = a + (size * ne[0] > 0 ? size * ne[0] : 0) + (size * ne[1] > 0 ? size * ne[1] : 0);
    if (!(ne[0] * p[u] + ne[1] * p[v] + a >= 0))
      return false;
  }
  return true;
}

/** Equations 3.4 to 3.8. */
static bool oracle_overlaps(const corner t[3], const float p[3], float size) {
  float e[2][3], n[3], near[3], far[3];
  for (int i = 0; i < 2; i++)
    for (int a = 0; a < 3; a++)
      e[i][a] = t[i + 1].at[a] - t[i].at[a];
  for (int a = 0; a < 3; a++)
    n[a] = e[0][(a + 1) % 3] * e[1][(a + 2) % 3] - e[0][(a + 2) % 3] * e[1][(a + 1) % 3];
  for (int a = 0; a < 3; a++) {
    near[a] = (n[a] > 0 ? size : 0) - t[0].at[a];
    far[a] = (n[a] > 0 ? 0 : size) - t[0].at[a];
  }
  if ((dot(n, p) + dot(n, near)) * (dot(n, p) + dot(n, far)) > 0)
    return false;
  return oracle_meets_flat(t, p, size, n[2], 0, 1) && oracle_meets_flat(t, p, size, n[1], 2, 0) &&
         oracle_meets_flat(t, p, size, n[0], 1, 2);
}

/** Whether voxel number i along an axis meets the box of a triangle. */
static bool oracle_in_box(const corner t[3], const vxm_space *space, int axis, int64_t i) {
  float low = fminf(fminf(t[0].at[axis], t[1].at[axis]), t[2].at[axis]) - (float)space->origin[axis];
  float high = fmaxf(fmaxf(t[0].at[axis], t[1].at[axis]), t[2].at[axis]) - (float)space->origin[axis];
  float per_unit = 1 / (float)space->voxel_size[axis], last = (float)(space->dims[axis] - 1);
  return (float)i >= fminf(ceilf(low * per_unit) - 1, last) && (float)i <= floorf(high * per_unit);
}

static corner corner_of(const vxm_soup *soup, uint32_t vertex) {
  const double *p = vxm_position(soup, vertex);
  return (corner){{(float)p[0], (float)p[1], (float)p[2]}};
}

/** All triangles against all voxels; how many tests each approach needs is counted along the way. */
static void oracle_fill(made *out, int64_t tests[2], const vxm_soup *soup) {
  const vxm_space *space = &out->space;
  out->count = (size_t)(space->dims[0] * space->dims[1] * space->dims[2]);
  out->voxels = calloc(out->count, 1);
  assert_non_null(out->voxels);
  tests[0] = tests[1] = 0;
  for (size_t i = 0; i < out->count; i++) {
    int64_t at[3] = {(int64_t)i % space->dims[0], (int64_t)i / space->dims[0] % space->dims[1],
                     (int64_t)i / space->dims[0] / space->dims[1]};
    float p[3], size = (float)space->voxel_size[0];
    for (int a = 0; a < 3; a++)
      p[a] = (float)space->origin[a] + size * (float)at[a];
    for (size_t f = 0; f < soup->face_count; f++) {
      size_t n;
      const uint32_t *v = vxm_face(soup, f, &n);
      corner t[3] = {corner_of(soup, v[0]), corner_of(soup, v[1]), corner_of(soup, v[2])};
      bool in_box = oracle_in_box(t, space, 0, at[0]) && oracle_in_box(t, space, 1, at[1]) &&
                    oracle_in_box(t, space, 2, at[2]);
      tests[0] += in_box;
      tests[1] += !out->voxels[i];
      if (in_box && oracle_overlaps(t, p, size))
        out->voxels[i] = 1;
    }
  }
}

/** The same on whole quarters of a voxel, where the grid has voxels of size 1, in exact integers. */
static void exact_fill(made *out, const vxm_soup *soup) {
  const vxm_space *space = &out->space;
  out->count = (size_t)(space->dims[0] * space->dims[1] * space->dims[2]);
  out->voxels = calloc(out->count, 1);
  assert_non_null(out->voxels);
  for (size_t i = 0; i < out->count; i++) {
    int64_t at[3] = {(int64_t)i % space->dims[0], (int64_t)i / space->dims[0] % space->dims[1],
                     (int64_t)i / space->dims[0] / space->dims[1]};
    for (size_t f = 0; f < soup->face_count && !out->voxels[i]; f++) {
      size_t n;
      const uint32_t *v = vxm_face(soup, f, &n);
      vxm_point t[3];
      for (int c = 0; c < 3; c++)
        for (int a = 0; a < 3; a++)
          t[c].at[a] = (int64_t)(4 * (vxm_position(soup, v[c])[a] - space->origin[a]));
      out->voxels[i] = oracle_touches(t, at, 4);
    }
  }
}

/* ---- Running it ---- */

static made run(const vxm_soup *soup, double voxel_size, bool by_voxel, vxm_transfer how) {
  vxm_published_options options = VXM_PUBLISHED_OPTIONS_INIT;
  vxm_error error = VXM_ERROR_INIT;
  vxm_published *published;
  made out = {.count = 0};
  double ms = -1;
  options.voxel_size = voxel_size;
  options.by_voxel = by_voxel;
  options.count_tests = true;
  options.material = by_voxel ? 0 : 1; /* the same */
  if (vxm_published_create(&published, &out.space, engine, soup, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  out.count = (size_t)(out.space.dims[0] * out.space.dims[1] * out.space.dims[2]);
  out.voxels = malloc(out.count + 1);
  assert_non_null(out.voxels);
  out.voxels[out.count] = 77;
  for (int again = 0; again < 2; again++) { /* the second time over what the first one has left */
    if (vxm_published_voxelize(&out.report, published, &error) != VXM_OK)
      fail_msg("%s", error.text);
    memset(out.voxels, 99, out.count);
    if (vxm_published_read(out.voxels, &ms, published, how, &error) != VXM_OK)
      fail_msg("%s", error.text);
    assert_true(ms >= 0 && out.report.kernel_ms > 0 && out.report.work_group > 0);
    assert_int_equal(out.report.triangles, soup->face_count);
    assert_int_equal(out.voxels[out.count], 77);
  }
  vxm_published_destroy(published);
  return out;
}

static void assert_equal_voxels(const made *a, const made *b, const char *what) {
  assert_memory_equal(&a->space, &b->space, sizeof a->space);
  for (size_t i = 0; i < a->count; i++)
    if (a->voxels[i] != b->voxels[i])
      fail_msg("%s: voxel %zu of %zu is %d and %d", what, i, a->count, a->voxels[i], b->voxels[i]);
}

/** A soup of triangles about the origin: needles, slivers and points among them. */
static vxm_soup *random_triangles(vxm_rng *rng, double size, double offset, size_t count) {
  vxm_soup *soup = shape_empty(context);
  for (size_t f = 0; f < count; f++) {
    double first[3], reach = size * (vxm_rng_below(rng, 3) ? 0.2 : 1);
    uint32_t v[3];
    for (int a = 0; a < 3; a++)
      first[a] = offset + size * vxm_rng_unit(rng);
    for (int c = 0; c < 3; c++)
      v[c] = shape_vertex(soup, first[0] + reach * vxm_rng_unit(rng), first[1] + reach * vxm_rng_unit(rng),
                          first[2] + (vxm_rng_below(rng, 2) ? reach * vxm_rng_unit(rng) : 0));
    shape_triangle(soup, v[0], v[1], vxm_rng_below(rng, 8) ? v[2] : v[1]);
  }
  return soup;
}

static void check(const vxm_soup *soup, double voxel_size) {
  int64_t tests[2];
  made facets = run(soup, voxel_size, false, VXM_TRANSFER_MAP);
  made voxels = run(soup, voxel_size, true, VXM_TRANSFER_READ);
  made right = {.space = facets.space};
  oracle_fill(&right, tests, soup);
  assert_equal_voxels(&facets, &right, "by facets");
  assert_equal_voxels(&voxels, &right, "by voxels");
  assert_int_equal(facets.report.tests, tests[0]);
  assert_int_equal(voxels.report.tests, tests[1]);
  free(facets.voxels);
  free(voxels.voxels);
  free(right.voxels);
}

/* ---- Tests ---- */

static void test_oracle(void **state) {
  (void)state;
  vxm_rng rng = {3};
  for (int i = 0; i < 60; i++) {
    static const double offsets[] = {0, -0.5, 3, 1000, -1e5};
    vxm_soup *soup =
        random_triangles(&rng, i % 3 ? 1 : 12.7, offsets[i % 5], 1 + (size_t)vxm_rng_below(&rng, 30));
    check(soup, (i % 3 ? 1 : 12.7) / (1 + (double)vxm_rng_below(&rng, 20)));
    vxm_soup_destroy(soup);
  }
}

static void test_exact(void **state) {
  (void)state;
  vxm_rng rng = {4};
  for (int i = 0; i < 60; i++) {
    vxm_soup *soup = shape_empty(context);
    for (uint64_t n = 1 + vxm_rng_below(&rng, 3); n > 0; n--)
      shape_random_octahedron(soup, &rng, -30, 30);
    made facets = run(soup, 1, false, VXM_TRANSFER_READ);
    made right = {.space = facets.space};
    exact_fill(&right, soup);
    assert_equal_voxels(&facets, &right, "exactly");
    free(facets.voxels);
    free(right.voxels);
    vxm_soup_destroy(soup);
  }
}

/** Rounding decides only where it is close: what differs from the exact surface touches it within a
 * thousandth of a voxel, or would not touch it any more if it were so much smaller. */
static void test_rounding(void **state) {
  (void)state;
  enum { FINE = 4096 }; /* lattice steps of a voxel */
  vxm_rng rng = {7};
  vxm_soup *soup = random_triangles(&rng, 20, 100, 40);
  made facets = run(soup, 1, false, VXM_TRANSFER_MAP);
  const vxm_space *space = &facets.space;
  for (size_t i = 0; i < facets.count; i++) {
    bool inner = false, outer = false; /* a voxel without its rim, and with a rim about it */
    for (size_t f = 0; f < soup->face_count; f++) {
      size_t n;
      const uint32_t *v = vxm_face(soup, f, &n);
      int64_t at[3] = {(int64_t)i % space->dims[0], (int64_t)i / space->dims[0] % space->dims[1],
                       (int64_t)i / space->dims[0] / space->dims[1]};
      for (int rim = -4; rim <= 4; rim += 8) { /* its minimum corner is moved to the origin, so that its size
                                                  may be any */
        vxm_point t[3];
        for (int c = 0; c < 3; c++)
          for (int a = 0; a < 3; a++)
            t[c].at[a] = (int64_t)llround(FINE * (vxm_position(soup, v[c])[a] - space->origin[a])) -
                         at[a] * FINE + rim;
        bool touches = oracle_touches(t, (int64_t[3]){0, 0, 0}, FINE + 2 * rim);
        inner = inner || (rim < 0 && touches);
        outer = outer || (rim > 0 && touches);
      }
    }
    assert_true(facets.voxels[i] ? outer : !inner);
  }
  free(facets.voxels);
  vxm_soup_destroy(soup);
}

static void test_material(void **state) {
  (void)state;
  vxm_rng rng = {5};
  vxm_soup *soup = random_triangles(&rng, 1, 0, 50);
  vxm_published_options options = VXM_PUBLISHED_OPTIONS_INIT;
  options.voxel_size = 0.09;
  options.material = 200;
  made plain = run(soup, options.voxel_size, false, VXM_TRANSFER_MAP);
  vxm_published *published;
  vxm_published_report report = VXM_PUBLISHED_REPORT_INIT;
  assert_int_equal(vxm_published_create(&published, NULL, engine, soup, &options, NULL), VXM_OK);
  uint8_t *voxels = malloc(plain.count), zero = 0;
  assert_non_null(voxels);
  assert_int_equal(vxm_published_read(voxels, NULL, published, VXM_TRANSFER_READ, NULL), VXM_OK);
  for (size_t i = 0; i < plain.count; i++)
    zero |= voxels[i];
  assert_int_equal(zero, 0); /* none is set before it is voxelized */
  assert_int_equal(vxm_published_voxelize(&report, published, NULL), VXM_OK);
  assert_int_equal(report.tests, 0);
  assert_int_equal(vxm_published_read(NULL, NULL, published, VXM_TRANSFER_MAP, NULL), VXM_OK);
  assert_int_equal(vxm_published_read(voxels, NULL, published, VXM_TRANSFER_MAP, NULL), VXM_OK);
  for (size_t i = 0; i < plain.count; i++)
    assert_int_equal(voxels[i], plain.voxels[i] ? 200 : 0);
  vxm_published_destroy(published);
  free(voxels);
  free(plain.voxels);
  vxm_soup_destroy(soup);
}

/** Polygons that are not convex are cut into triangles inside them; a box is divided without a voxel too
 * many. */
static void test_polygons(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context), *whole = shape_empty(context);
  static const double outline[6][2] = {{0, 0}, {6, 0}, {6, 2}, {2, 2}, {2, 6}, {0, 6}};
  uint32_t v[6];
  for (int i = 0; i < 6; i++)
    v[i] = shape_vertex(soup, outline[i][0], outline[i][1], 0.5);
  shape_face(soup, v, 6);
  vxm_published_options options = VXM_PUBLISHED_OPTIONS_INIT;
  options.voxel_size = 0.6;
  vxm_space space;
  vxm_published *published;
  uint8_t voxels[100];
  assert_int_equal(vxm_published_create(&published, &space, engine, soup, &options, NULL), VXM_OK);
  assert_true(space.dims[0] == 10 && space.dims[1] == 10 && space.dims[2] == 1);
  assert_true(space.origin[0] == 0 && space.origin[2] == 0.5 && space.voxel_size[1] == (double)0.6F);
  assert_int_equal(vxm_published_voxelize(NULL, published, NULL), VXM_OK);
  assert_int_equal(vxm_published_read(voxels, NULL, published, VXM_TRANSFER_MAP, NULL), VXM_OK);
  for (int i = 0; i < 100; i++)
    assert_int_equal(voxels[i], i % 10 < 4 || i / 10 < 4);
  vxm_published_destroy(published);
  shape_box(whole, (double[3]){0, 0, 0}, (double[3]){0.3, 0.7, 0.1});
  options.voxel_size = 0.1;
  assert_int_equal(vxm_published_create(&published, &space, engine, whole, &options, NULL), VXM_OK);
  assert_true(space.dims[0] == 3 && space.dims[1] == 7 && space.dims[2] == 1);
  vxm_published_destroy(published);
  vxm_soup_destroy(whole);
  vxm_soup_destroy(soup);
}

static void refuse(vxm_status expected, const vxm_soup *soup, vxm_engine *by,
                   const vxm_published_options *options) {
  vxm_published *published = (vxm_published *)&expected;
  vxm_error error = VXM_ERROR_INIT;
  vxm_space space;
  vxm_status status = vxm_published_create(&published, &space, by, soup, options, &error);
  if (status != expected)
    fail_msg("%d in place of %d: %s", (int)status, (int)expected, error.text);
  assert_null(published);
  assert_true(error.code == expected && *error.text && space.dims[0] == 0);
}

static void test_refused(void **state) {
  (void)state;
  static const double sizes[] = {0, -1, NAN, INFINITY, 1e-300, 1e300};
  vxm_published_options options = VXM_PUBLISHED_OPTIONS_INIT;
  vxm_soup *soup = shape_empty(context), *empty = shape_empty(context), *broken = shape_empty(context);
  shape_box(soup, (double[3]){0, 0, 0}, (double[3]){3, 2, 1});
  shape_box(broken, (double[3]){0, 0, 0}, (double[3]){3, 2, (double)FLT_MAX * 2});
  for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
    options.voxel_size = sizes[i];
    refuse(VXM_ERROR_ARGUMENT, soup, engine, &options);
  }
  refuse(VXM_ERROR_ARGUMENT, soup, engine, NULL);
  options.voxel_size = 1;
  refuse(VXM_ERROR_EMPTY, empty, engine, &options);
  refuse(VXM_ERROR_RANGE, broken, engine, &options);
  refuse(VXM_ERROR_ARGUMENT, soup, NULL, &options);
  options.voxel_size = 1e-7; /* too many along an axis */
  refuse(VXM_ERROR_RANGE, soup, engine, &options);
  options.voxel_size = 2e-5; /* and in all: more than 2^49 */
  refuse(VXM_ERROR_RANGE, soup, engine, &options);
  options.size = 2;
  refuse(VXM_ERROR_ARGUMENT, soup, engine, &options);
  options.size = sizeof options;
  options.voxel_size = 1;
  vxm_engine *cpu;
  assert_int_equal(vxm_engine_create(&cpu, context, "cpu", NULL, NULL), VXM_OK);
  refuse(VXM_ERROR_UNAVAILABLE, soup, cpu, &options);
  vxm_engine_destroy(cpu);
  vxm_published *published;
  assert_int_equal(vxm_published_create(&published, NULL, engine, soup, &options, NULL), VXM_OK);
  assert_int_equal(vxm_published_read(NULL, NULL, published, VXM_TRANSFER_READ, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_published_read(NULL, NULL, published, (vxm_transfer)2, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_published_read(NULL, NULL, NULL, VXM_TRANSFER_MAP, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_published_voxelize(NULL, NULL, NULL), VXM_ERROR_ARGUMENT);
  vxm_published_destroy(published);
  vxm_published_destroy(NULL);
  vxm_soup_destroy(broken);
  vxm_soup_destroy(empty);
  vxm_soup_destroy(soup);
}

static int stop(const char *phase, double fraction, void *payload) {
  (void)phase, (void)fraction, (void)payload;
  return 1;
}

/** Memory on the device counts; whatever is left, nothing is kept after a failure; and work can be stopped.
 */
static void test_limits(void **state) {
  (void)state;
  vxm_rng rng = {9};
  vxm_context *owner = context_of(1, 0);
  vxm_soup *soup = random_triangles(&rng, 1, 0, 200);
  vxm_engine *limited;
  vxm_published *published;
  vxm_published_options options = VXM_PUBLISHED_OPTIONS_INIT;
  options.voxel_size = 0.02;
  options.count_tests = options.by_voxel = true;
  assert_int_equal(vxm_engine_create(&limited, owner, ENGINE, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_published_create(&published, NULL, limited, soup, &options, NULL), VXM_OK);
  vxm_published_destroy(published);
  size_t used = memory_used(owner);
  for (size_t left = 0;; left += 30000) {
    vxm_error error = VXM_ERROR_INIT;
    leave_memory(owner, left);
    vxm_status status = vxm_published_create(&published, NULL, limited, soup, &options, &error);
    if (status == VXM_OK)
      break;
    assert_int_equal(status, VXM_ERROR_MEMORY_LIMIT);
    assert_null(published);
    assert_int_equal(memory_used(owner), used);
  }
  assert_true(memory_used(owner) > used + 5 * 80 * 80 * 50);
  assert_int_equal(vxm_published_voxelize(NULL, published, NULL),
                   VXM_ERROR_MEMORY_LIMIT); /* to add up counts */
  leave_memory(owner, SIZE_MAX);
  owner->progress = stop;
  assert_int_equal(vxm_published_voxelize(NULL, published, NULL), VXM_ERROR_CANCELLED);
  owner->progress = NULL;
  assert_int_equal(vxm_published_voxelize(NULL, published, NULL), VXM_OK);
  vxm_published_destroy(published);
  assert_int_equal(memory_used(owner), used);
  vxm_engine_destroy(limited);
  vxm_soup_destroy(soup);
  vxm_context_destroy(owner);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_oracle),   cmocka_unit_test(test_exact),
                                     cmocka_unit_test(test_rounding), cmocka_unit_test(test_material),
                                     cmocka_unit_test(test_polygons), cmocka_unit_test(test_refused),
                                     cmocka_unit_test(test_limits)};
  int status = gpu_test_start(NULL);
  if (status == 0)
    status = cmocka_run_group_tests_name("the published program by " ENGINE, tests, setup, teardown);
  vxm_engine_destroy(engine);
  return status;
}

/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Octrees made on an OpenCL device have the words and the report of the CPU's: closed bodies, capped ones,
 * many parts over each other, odd dimensions, thin and long grids, ties, bodies beyond the grid on all sides,
 * points far away, and meshes of the test collection. VOXMEND_TEST_RESOLUTIONS="64 200" chooses other
 * resolutions for these, VOXMEND_TEST_MESH one mesh instead, and VOXMEND_TEST_VERBOSE tells how long each
 * stage takes.
 */
#include "config.h"
#ifdef HAVE_OPENCL
#include "gpu/opencl/opencl.h" /* before the test's own `engine` */
#endif

#include "gpu_test.h"

#include "../voxel/meshes.h"

#ifdef HAVE_OPENCL
#include "base/clock.h"
#include "grid/octree.h"

static vxm_cl_stages stages;
static int made_here; /* octrees by the device, and not left to the CPU */

static vxm_sparse *make(vxm_model *model, const vxm_space *space, const double *transform,
                        vxm_voxelize_report *report) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_sparse *octree;
  if (vxm_model_sparse(&octree, report, model, space, transform, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return octree;
}

static void assert_equal_octrees(const vxm_sparse *a, const vxm_sparse *b, const char *name) {
  assert_int_equal(a->levels, b->levels);
  for (int l = a->levels - 1; l >= 0; l--) {
    if (a->node_count[l] != b->node_count[l])
      fail_msg("%s: %zu and %zu nodes at level %d", name, a->node_count[l], b->node_count[l], l);
    for (size_t n = 0; n < a->node_count[l]; n++) {
      const vxm_octree_node *p = &a->nodes[l][n], *q = &b->nodes[l][n];
      if (p->mixed != q->mixed || p->full != q->full || p->first != q->first)
        fail_msg("%s: node %zu of level %d is %llx %llx %llu, not %llx %llx %llu", name, n, l,
                 (unsigned long long)q->mixed, (unsigned long long)q->full, (unsigned long long)q->first,
                 (unsigned long long)p->mixed, (unsigned long long)p->full, (unsigned long long)p->first);
    }
  }
  assert_int_equal(a->brick_count, b->brick_count);
  for (size_t i = 0; i < a->brick_count; i++)
    if (a->bricks[i] != b->bricks[i])
      fail_msg("%s: brick %zu differs", name, i);
}

/** One mesh by both; the models have the same options. */
static void check_models(vxm_model *by_cpu, vxm_model *by_gpu, const vxm_space *space,
                         const double *transform, const char *name) {
  vxm_voxelize_report cpu_report = VXM_VOXELIZE_REPORT_INIT, gpu_report = VXM_VOXELIZE_REPORT_INIT;
  vxm_sparse *expected = make(by_cpu, space, transform, &cpu_report);
  stages = (vxm_cl_stages){0};
  vxm_sparse *found = make(by_gpu, space, transform, &gpu_report);
  made_here += stages.prune > 0;
  assert_equal_octrees(expected, found, name);
  assert_equal_reports(&cpu_report, &gpu_report);
  vxm_sparse_destroy(expected);
  vxm_sparse_destroy(found);
}

static void check(const vxm_soup *soup, const vxm_space *space, vxm_voxelize_options options) {
  static const double turned[12] = {0.8, -0.6, 0, 1.5, 0.6, 0.8, 0, -2.25, 0, 0, -1, 9.5};
  char name[96];
  snprintf(name, sizeof name, "%lld x %lld x %lld, method %d, parts %d", (long long)space->dims[0],
           (long long)space->dims[1], (long long)space->dims[2], options.method, options.split_mode);
  options.engine = NULL;
  vxm_model *by_cpu = engine_model(soup, &options);
  options.engine = engine;
  vxm_model *by_gpu = engine_model(soup, &options);
  check_models(by_cpu, by_gpu, space, NULL, name);
  check_models(by_cpu, by_gpu, space, turned, name);
  vxm_model_destroy(by_cpu);
  vxm_model_destroy(by_gpu);
}

static void check_parts(const vxm_soup *soup, const vxm_space *space) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  for (int parts = VXM_SPLIT_MODE_AUTO; parts <= VXM_SPLIT_MODE_WHOLE; parts++) {
    options.split_mode = (vxm_split_mode)parts;
    options.method = VXM_METHOD_VOTE;
    check(soup, space, options);
    options.method = VXM_METHOD_X;
    check(soup, space, options);
  }
}

/** Surfaces alone, and with the solid. */
static void check_faces(const vxm_soup *soup, const vxm_space *space) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  for (int mode = VXM_MODE_SURFACE; mode <= VXM_MODE_BOTH; mode++)
    for (int thin = 0; thin < 2; thin++) {
      options.mode = (vxm_mode)mode;
      options.surface = thin ? VXM_SURFACE_THIN : VXM_SURFACE_CONSERVATIVE;
      check(soup, space, options);
    }
}

static int64_t random_side(vxm_rng *rng) {
  static const int64_t sides[] = {1, 4, 5, 16, 17, 33, 64, 65, 80, 130};
  return sides[vxm_rng_below(rng, sizeof sides / sizeof *sides)];
}

static void test_surfaces(void **state) {
  (void)state;
  vxm_rng rng = {35};
  made_here = 0;
  for (int round = 0; round < 20; round++) {
    vxm_space space = engine_space(random_side(&rng), random_side(&rng), random_side(&rng));
    vxm_soup *soup = random_soup(context, 300 + (uint64_t)round, round % SOUP_KINDS, &space);
    check_faces(soup, &space);
    vxm_soup_destroy(soup);
  }
  assert_true(made_here > 80);
}

/** Every kind of soup; those that are open go another way. */
static void test_random(void **state) {
  (void)state;
  vxm_rng rng = {31};
  made_here = 0;
  for (int round = 0; round < 40; round++) {
    vxm_space space = engine_space(random_side(&rng), random_side(&rng), random_side(&rng));
    vxm_soup *soup = random_soup(context, 100 + (uint64_t)round, round % SOUP_KINDS, &space);
    check_parts(soup, &space);
    vxm_soup_destroy(soup);
  }
  assert_true(made_here > 120);
}

/** Fine bodies that the grid cuts off on all sides; what is inside reaches over its border in large blocks.
 */
static void test_cut(void **state) {
  (void)state;
  vxm_rng rng = {32};
  made_here = 0;
  for (int round = 0; round < 12; round++) {
    vxm_soup *soup = shape_empty(context);
    vxm_space space =
        engine_space(70 + (int64_t)vxm_rng_below(&rng, 200), 70 + (int64_t)vxm_rng_below(&rng, 100),
                     70 + (int64_t)vxm_rng_below(&rng, 100));
    double centre[3];
    for (int a = 0; a < 3; a++)
      centre[a] = (vxm_rng_unit(&rng) * 1.2 - 0.1) * (double)space.dims[a];
    double radius = 60 + 100 * vxm_rng_unit(&rng);
    shape_torus(soup, 40, 30, radius, 0.9 * radius, centre);
    if (round % 2)
      shape_torus(soup, 40, 30, 50, 40, (double[3]){0, 0, 0});
    check_parts(soup, &space);
    vxm_soup_destroy(soup);
  }
  assert_int_equal(made_here, 12 * 3 * 4);
}

/** Parts over each other, in many passes, and parts that set no voxel. */
static void test_many_parts(void **state) {
  (void)state;
  vxm_rng rng = {33};
  vxm_soup *soup = shape_empty(context);
  for (int i = 0; i < 100; i++) {
    double low[3], high[3];
    for (int a = 0; a < 3; a++) {
      low[a] = vxm_rng_unit(&rng) * 60 - 2;
      high[a] = low[a] + vxm_rng_unit(&rng) * (i % 10 == 0 ? 30 : 4);
    }
    if (i % 6 == 0) /* between two layers of centres */
      high[0] = (low[0] = floor(low[0]) + 0.6) + 0.3;
    shape_box(soup, low, high);
  }
  vxm_space space = engine_space(64, 61, 63);
  check_parts(soup, &space);
  space = engine_space(40, 200, 30);
  check_parts(soup, &space);
  vxm_soup_destroy(soup);
}

/** Faces on voxel centres and on the borders of cells and nodes: the perturbation decides. */
static void test_ties(void **state) {
  (void)state;
  vxm_space space = engine_space(80, 80, 80);
  for (int eighths = 0; eighths <= 8; eighths++) {
    double part = eighths / 8.0;
    vxm_soup *soup = box_with_ties(part, 0.5);
    shape_box(soup, (double[3]){16 - part, 15.5, 16 + part}, (double[3]){48 + part, 64 - part, 31.5 + part});
    shape_box(soup, (double[3]){63 + part, 15 + part, 1}, (double[3]){79.5, 79.5, 80 - part});
    check_parts(soup, &space);
    vxm_soup_destroy(soup);
  }
}

/** Long and thin, with few cells across, of few large triangles and of many small ones. */
static void test_shapes(void **state) {
  (void)state;
  for (int axis = 0; axis < 3; axis++)
    for (int wide = 3; wide < 90; wide *= 5) {
      vxm_space space = engine_space(wide, wide, wide);
      space.dims[axis] = 3000;
      vxm_soup *soup = shape_empty(context);
      double low[3], high[3], mid[3];
      for (int a = 0; a < 3; a++) {
        low[a] = 0.1 * (double)space.dims[a];
        high[a] = 0.93 * (double)space.dims[a];
        mid[a] = 0.5 * (double)space.dims[a];
      }
      shape_box(soup, low, high);
      shape_torus(soup, 60, 40, 0.3 * wide, 0.2 * wide, mid);
      check_parts(soup, &space);
      vxm_soup_destroy(soup);
    }
}

/** Points beyond the numbers of the kernels: the CPU makes the octree. */
static void test_far(void **state) {
  (void)state;
  vxm_rng rng = {34};
  made_here = 0;
  for (int round = 0; round < 4; round++) {
    vxm_soup *soup = shape_empty(context);
    double reach = round % 2 ? 3000 : 40000;
    random_octahedron(soup, &rng, (double[3]){-reach, -reach, -reach}, (double[3]){reach, reach, reach}, 0);
    random_octahedron(soup, &rng, (double[3]){0, 0, 0}, (double[3]){16, 16, 16}, 0);
    vxm_space space = engine_space(16, 16, 16);
    check_parts(soup, &space);
    vxm_soup_destroy(soup);
  }
  assert_int_equal(made_here, 0);
}

/** Nothing in the grid, and a grid that is all inside. */
static void test_empty_and_full(void **state) {
  (void)state;
  static const int64_t sides[] = {1, 16, 17, 64, 100, 256};
  for (size_t s = 0; s < sizeof sides / sizeof *sides; s++) {
    double n = (double)sides[s];
    vxm_space space = engine_space(sides[s], sides[s], sides[s]);
    vxm_soup *soup = shape_empty(context);
    triangle_box(soup, (double[3]){n + 2, 1, 1}, (double[3]){n + 4, 3, 3}, 0, false);
    check_parts(soup, &space);
    triangle_box(soup, (double[3]){-2, -3, -4}, (double[3]){n + 1, n + 2, n + 3}, 0, false);
    check_parts(soup, &space);
    vxm_soup_destroy(soup);
  }
}

/** A part that lies before the grid, where it flips first voxels twice, over one that reaches into it. */
static void test_before(void **state) {
  (void)state;
  vxm_space space = engine_space(40, 20, 20);
  vxm_soup *soup = shape_empty(context);
  triangle_box(soup, (double[3]){-6, 2, 2}, (double[3]){-3.2, 9, 9}, 0, false);
  triangle_box(soup, (double[3]){-1, 3, 3}, (double[3]){5, 12, 12}, 0, false);
  check_parts(soup, &space);
  vxm_soup_destroy(soup);
}

/** Four levels: walls deep in what is inside, so that it is handed down from node to node. */
static void test_deep(void **state) {
  (void)state;
  vxm_space space = engine_space(1100, 300, 290);
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.split_mode = VXM_SPLIT_MODE_WHOLE;
  vxm_soup *soup = shape_empty(context);
  shape_torus(soup, 5, 4, 120, 100, (double[3]){500, 200, 150});
  triangle_box(soup, (double[3]){3, 3, 3}, (double[3]){1090, 290, 280}, 0, false);
  triangle_box(soup, (double[3]){300, 90, 90}, (double[3]){330, 110, 111}, 0, false);
  triangle_box(soup, (double[3]){700, 140, 90}, (double[3]){702, 240, 200}, 0, false);
  check(soup, &space, options);
  vxm_soup_destroy(soup);
}

/** Limits of the memory and of the device: one of the known failures, with a text, and no leak. */
static void test_limits(void **state) {
  (void)state;
  vxm_soup *soup = shape_empty(context);
  shape_torus(soup, 60, 40, 60, 25, (double[3]){100, 100, 40});
  vxm_space space = engine_space(200, 200, 80);
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.engine = engine;
  vxm_model *model = engine_model(soup, &options);
  vxm_context *owner = engine->context;
  vxm_sparse_destroy(make(model, &space, NULL, NULL));
  size_t used = memory_used(owner);
  int failures = 0, successes = 0;
  for (size_t left = 1 << 12; left < (size_t)1 << 26; left += left / 3) {
    vxm_error error = VXM_ERROR_INIT;
    vxm_sparse *octree;
    leave_memory(owner, left);
    vxm_status status = vxm_model_sparse(&octree, NULL, model, &space, NULL, &error);
    leave_memory(owner, SIZE_MAX);
    assert_true(status == VXM_OK || status == VXM_ERROR_MEMORY_LIMIT);
    assert_int_equal(octree != NULL, status == VXM_OK);
    failures += status != VXM_OK;
    successes += status == VXM_OK;
    vxm_sparse_destroy(octree);
    assert_true(memory_used(owner) <=
                used + (1 << 16)); /* what is kept from one grid to the next may have grown */
  }
  assert_true(failures > 2 && successes > 2);

  vxm_engine_info kept = engine->info;
  vxm_error error = VXM_ERROR_INIT;
  vxm_sparse *octree;
  engine->info.block_bytes = 100000;
  assert_int_equal(vxm_model_sparse(&octree, NULL, model, &space, NULL, &error), VXM_ERROR_RANGE);
  assert_non_null(strstr(error.text, "--engine cpu"));
  assert_null(octree);
  engine->info = kept;
  vxm_model_destroy(model);
  vxm_soup_destroy(soup);
}

/* ---- Real meshes ---- */

static void tell(const char *path, const vxm_space *space, double cpu, double gpu) {
  if (getenv("VOXMEND_TEST_VERBOSE"))
    fprintf(
        stderr,
        "%s %lld: CPU %.1f ms; device %.1f ms: cells %.1f, construct %.1f, voxelize %.1f, propagate %.1f, "
        "prune %.1f; %zu of %zu nodes are cells\n",
        path, (long long)space->dims[0], cpu, gpu, stages.cells, stages.construct, stages.voxelize,
        stages.propagate, stages.prune, stages.cells_active, stages.nodes);
}

static void check_mesh(vxm_model *by_cpu, vxm_model *by_gpu, const vxm_space *space, const char *path) {
  check_models(by_cpu, by_gpu, space, NULL, path);
  if (!getenv("VOXMEND_TEST_VERBOSE"))
    return;
  double start = vxm_clock_ms();
  vxm_sparse_destroy(make(by_cpu, space, NULL, NULL));
  double middle = vxm_clock_ms();
  stages = (vxm_cl_stages){0};
  vxm_sparse_destroy(make(by_gpu, space, NULL, NULL));
  tell(path, space, middle - start, vxm_clock_ms() - middle);
}

static void check_file(const char *path, const char *resolutions) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_mesh *raw, *mesh;
  vxm_model *by_cpu, *by_gpu;
  if (vxm_mesh_read(&raw, context, path, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_int_equal(vxm_mesh_repair(&mesh, NULL, raw, NULL, &error), VXM_OK);
  vxm_mesh_destroy(raw);
  if (vxm_model_create(&by_cpu, mesh, &options, &error) == VXM_OK) {
    options.engine = engine;
    by_gpu = engine_model(mesh, &options);
    const char *at = resolutions;
    for (char *end; *at; at = end) {
      vxm_space_options fit = VXM_SPACE_OPTIONS_INIT;
      vxm_space space;
      fit.resolution[0] = strtol(at, &end, 10);
      if (end == at)
        break;
      if (vxm_space_fit(&space, mesh, &fit, NULL) == VXM_OK)
        check_mesh(by_cpu, by_gpu, &space, path);
    }
    vxm_model_destroy(by_cpu);
    vxm_model_destroy(by_gpu);
  }
  vxm_mesh_destroy(mesh);
}

static void check_named(const char *path, const char *name, void *payload) {
  (void)name;
  check_file(path, payload);
}

static void test_real_meshes(void **state) {
  (void)state;
  const char *given = getenv("VOXMEND_TEST_RESOLUTIONS"), *one = getenv("VOXMEND_TEST_MESH");
  char resolutions[64];
  snprintf(resolutions, sizeof resolutions, "%s", given ? given : "100");
  if (one)
    check_file(one, resolutions);
  else if (each_mesh_file(given ? SIZE_MAX : 2, check_named, resolutions) == 0)
    skip();
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_surfaces), cmocka_unit_test(test_random),
                                     cmocka_unit_test(test_cut),      cmocka_unit_test(test_many_parts),
                                     cmocka_unit_test(test_ties),     cmocka_unit_test(test_shapes),
                                     cmocka_unit_test(test_far),      cmocka_unit_test(test_empty_and_full),
                                     cmocka_unit_test(test_before),   cmocka_unit_test(test_deep),
                                     cmocka_unit_test(test_limits),   cmocka_unit_test(test_real_meshes)};
  int status = gpu_test_start(NULL);
  if (status == 0) {
    vxm_opencl_of(engine)->stages = &stages;
    status = cmocka_run_group_tests_name("octrees by " ENGINE, tests, setup, teardown);
  }
  vxm_engine_destroy(engine);
  return status;
}
#else
int main(void) {
  return gpu_test_start(NULL);
}
#endif

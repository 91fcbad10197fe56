/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * All meshes of the shared collection, closed or not, as they come out of the repair: an OpenCL device makes
 * the bits of the CPU for solids (by triangles, by tiles, by votes of all axes), both surfaces, octrees and
 * coverage. VOXMEND_TEST_RESOLUTIONS="64 200" chooses resolutions; VOXMEND_TEST_VERBOSE=1 tells of each mesh.
 */
#include "gpu_test.h"

#include "../voxel/meshes.h"

static vxm_engine *by_triangles, *by_tiles;
static long long meshes, grids;

static void check_grid(const vxm_mesh *mesh, const char *name, const char *what, vxm_voxelize_options options,
                       vxm_engine *by, const vxm_space *space) {
  vxm_voxelize_report by_cpu = VXM_VOXELIZE_REPORT_INIT, by_gpu = VXM_VOXELIZE_REPORT_INIT;
  options.engine = NULL;
  vxm_grid *expected = engine_solid(mesh, space, &options, &by_cpu);
  options.engine = by;
  vxm_grid *found = engine_solid(mesh, space, &options, &by_gpu);
  if (memcmp(expected->words, found->words, expected->word_count * sizeof *found->words) != 0)
    fail_msg("%s at %lld: the %s differs", name, (long long)space->dims[0], what);
  assert_equal_reports(&by_cpu, &by_gpu);
  vxm_grid_destroy(expected);
  vxm_grid_destroy(found);
  grids++;
}

static void check_surfaces(const vxm_mesh *mesh, const char *name, const vxm_space *space) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.mode = VXM_MODE_SURFACE;
  options.surface = VXM_SURFACE_CONSERVATIVE;
  check_grid(mesh, name, "conservative surface", options, by_triangles, space);
  options.surface = VXM_SURFACE_THIN;
  check_grid(mesh, name, "thin surface", options, by_triangles, space);
}

static void check_octree(const vxm_mesh *mesh, const char *name, const vxm_space *space) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_voxelize_report report[2] = {VXM_VOXELIZE_REPORT_INIT, VXM_VOXELIZE_REPORT_INIT};
  for (int e = 0; e < 2; e++) {
    vxm_sparse *sparse;
    options.engine = e ? by_triangles : NULL;
    vxm_model *model = engine_model(mesh, &options);
    assert_int_equal(vxm_model_sparse(&sparse, &report[e], model, space, NULL, NULL), VXM_OK);
    vxm_sparse_destroy(sparse);
    vxm_model_destroy(model);
  }
  if (report[0].hash != report[1].hash)
    fail_msg("%s at %lld: the octree differs", name, (long long)space->dims[0]);
  assert_equal_reports(&report[0], &report[1]);
  grids++;
}

static void check_coverage(const vxm_mesh *mesh, const char *name, const vxm_space *space) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_coverage_options how = VXM_COVERAGE_OPTIONS_INIT;
  size_t bytes = (size_t)(space->dims[0] * space->dims[1] * space->dims[2]) * sizeof(float);
  float *values[2] = {malloc(bytes), malloc(bytes)};
  assert_true(values[0] && values[1]);
  how.subdivision = 2;
  for (int e = 0; e < 2; e++) {
    options.engine = e ? by_triangles : NULL;
    vxm_model *model = engine_model(mesh, &options);
    assert_int_equal(vxm_model_coverage(values[e], NULL, model, space, &how, NULL), VXM_OK);
    vxm_model_destroy(model);
  }
  if (memcmp(values[0], values[1], bytes) != 0)
    fail_msg("%s at %lld: the coverage differs", name, (long long)space->dims[0]);
  free(values[0]);
  free(values[1]);
  grids++;
}

static void check_at(const vxm_mesh *mesh, const char *name, int64_t resolution) {
  vxm_space_options fit = VXM_SPACE_OPTIONS_INIT;
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space space;
  fit.resolution[0] = resolution;
  assert_int_equal(vxm_space_fit(&space, mesh, &fit, NULL), VXM_OK);
  check_grid(mesh, name, "solid by triangles", options, by_triangles, &space);
  check_grid(mesh, name, "solid by tiles", options, by_tiles, &space);
  options.vote = VXM_VOTE_MAJORITY;
  options.vote_always = true;
  check_grid(mesh, name, "solid by majority", options, by_triangles, &space);
  check_surfaces(mesh, name, &space);
  check_octree(mesh, name, &space);
  check_coverage(mesh, name, &space);
}

static void check_file(const char *path, const char *name, void *payload) {
  (void)payload;
  const char *at = getenv("VOXMEND_TEST_RESOLUTIONS");
  vxm_mesh *raw, *mesh;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_mesh_read(&raw, context, path, &error) != VXM_OK) {
    assert_int_equal(error.code, VXM_ERROR_UNAVAILABLE); /* a format of a module that is not here */
    return;
  }
  assert_int_equal(vxm_mesh_repair(&mesh, NULL, raw, NULL, NULL), VXM_OK);
  vxm_mesh_destroy(raw);
  if (getenv("VOXMEND_TEST_VERBOSE"))
    print_message("%s\n", name);
  at = at ? at : "64";
  for (char *end; *at; at = end) {
    int64_t resolution = strtol(at, &end, 10);
    if (end == at)
      break;
    check_at(mesh, name, resolution);
  }
  vxm_mesh_destroy(mesh);
  meshes++;
}

static vxm_engine *engine_of(vxm_cl_method method) {
  vxm_engine_options options = VXM_ENGINE_OPTIONS_INIT;
  vxm_engine *made;
  options.cl_method = method;
  assert_int_equal(vxm_engine_create(&made, context, ENGINE, &options, NULL), VXM_OK);
  return made;
}

static void test_all_meshes(void **state) {
  (void)state;
  by_triangles = engine_of(VXM_CL_TRIANGLES);
  by_tiles = engine_of(VXM_CL_TILES);
  int files = each_mesh_file(SIZE_MAX, check_file, NULL);
  print_message("%lld meshes, %lld grids, octrees and coverages: none differs\n", meshes, grids);
  vxm_engine_destroy(by_triangles);
  vxm_engine_destroy(by_tiles);
  if (files == 0)
    skip();
  assert_true(meshes > 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_all_meshes)};
  int status = gpu_test_start(NULL);
  vxm_engine_destroy(engine);
  return status ? status : cmocka_run_group_tests_name("meshes by " ENGINE, tests, setup, teardown);
}

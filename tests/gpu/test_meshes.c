/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The closed meshes of the shared collection: columns have the bits of the CPU; slices differ in voxels
 * within 1/128 of the surface, fewer than 1 in 100000 of those at the surface of all meshes together.
 * VOXMEND_TEST_RESOLUTIONS="64 128" chooses resolutions, VOXMEND_TEST_METHODS="slices tetra-vertex" methods;
 * VOXMEND_TEST_VERBOSE=1 tells of each mesh.
 */
#include "gpu_test.h"

#include "../voxel/meshes.h"
#include "tolerance.h"

static const char *const methods[] = {"columns", "slices", "tetra-vertex"};

static vxm_engine *engines[3];

typedef struct tally {
  int64_t meshes, grids, differing, surface;
} tally;

static int64_t surface_of(const vxm_mesh *mesh, const vxm_space *space) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.mode = VXM_MODE_SURFACE;
  vxm_grid *grid = engine_solid(mesh, space, &options, NULL);
  int64_t count = vxm_grid_count(grid);
  vxm_grid_destroy(grid);
  return count;
}

static void check_at(const vxm_mesh *mesh, const char *name, int64_t resolution, const char *chosen,
                     tally *sum) {
  vxm_space_options fit = VXM_SPACE_OPTIONS_INIT;
  fit.resolution[0] = resolution;
  vxm_space space;
  assert_int_equal(vxm_space_fit(&space, mesh, &fit, NULL), VXM_OK);
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_grid *expected = engine_solid(mesh, &space, &options, NULL);
  int64_t surface = surface_of(mesh, &space);
  for (int m = 0; m < 3; m++) {
    if (!strstr(chosen, methods[m]))
      continue;
    options.engine = engines[m];
    vxm_grid *found = engine_solid(mesh, &space, &options, NULL);
    difference d = differ(expected, found, mesh);
    if (getenv("VOXMEND_TEST_VERBOSE"))
      print_message("%-40s %4lld %-12s %lld of %lld surface voxels differ\n", name, (long long)resolution,
                    methods[m], (long long)d.count, (long long)surface);
    if (d.farthest > 1.0 / 128 || (m == 0 && d.count > 0))
      fail_msg("%s at %lld by %s: %lld voxels differ, %g from the surface", name, (long long)resolution,
               methods[m], (long long)d.count, d.farthest);
    sum->grids++;
    sum->surface += surface;
    sum->differing += d.count;
    vxm_grid_destroy(found);
  }
  vxm_grid_destroy(expected);
}

static void check_file(const char *path, const char *name, void *payload) {
  tally *sum = payload;
  const char *resolutions = getenv("VOXMEND_TEST_RESOLUTIONS"), *chosen = getenv("VOXMEND_TEST_METHODS");
  vxm_mesh *raw, *mesh;
  vxm_census census = VXM_CENSUS_INIT;
  assert_int_equal(vxm_mesh_read(&raw, context, path, NULL), VXM_OK);
  assert_int_equal(vxm_mesh_repair(&mesh, NULL, raw, NULL, NULL), VXM_OK);
  vxm_mesh_destroy(raw);
  assert_int_equal(vxm_mesh_census(&census, mesh, NULL), VXM_OK);
  if (census.closed) {
    const char *at = resolutions ? resolutions : "64 128";
    for (char *end; *at; at = end) {
      int64_t resolution = strtol(at, &end, 10);
      if (end == at)
        break;
      check_at(mesh, name, resolution, chosen ? chosen : "columns", sum);
    }
    if (!chosen && census.faces < 1000) /* drawing all tetrahedra is slow in software */
      check_at(mesh, name, 32, "slices", sum);
    sum->meshes++;
  }
  vxm_mesh_destroy(mesh);
}

static void test_closed_meshes(void **state) {
  (void)state;
  tally sum = {0, 0, 0, 0};
  for (int m = 0; m < 3; m++) {
    vxm_engine_options options = VXM_ENGINE_OPTIONS_INIT;
    options.gl_method = (vxm_gl_method)m;
    assert_int_equal(vxm_engine_create(&engines[m], context, ENGINE, &options, NULL), VXM_OK);
  }
  int files = each_mesh_file(SIZE_MAX, check_file, &sum);
  print_message("%lld closed meshes, %lld grids: %lld of %lld surface voxels differ\n", (long long)sum.meshes,
                (long long)sum.grids, (long long)sum.differing, (long long)sum.surface);
  for (int m = 0; m < 3; m++)
    vxm_engine_destroy(engines[m]);
  if (files == 0)
    skip();
  assert_true(sum.meshes > 0 && sum.differing * 100000 <= sum.surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_closed_meshes)};
  int status = gpu_test_start(NULL);
  vxm_engine_destroy(engine);
  return status ? status : cmocka_run_group_tests_name("meshes by " ENGINE, tests, setup, teardown);
}

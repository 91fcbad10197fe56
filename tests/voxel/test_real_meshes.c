/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Every closed mesh of the shared collection, at several resolutions and at random sub-voxel offsets: parity
 * along x, y and z, the votes and (at the lowest resolution) the tetrahedra agree bit for bit.
 * VOXMEND_TEST_RESOLUTIONS="17 64 200" chooses other resolutions, VOXMEND_TEST_TETRA=200 draws the tetrahedra
 * up to that one.
 */
#include "base/rng.h"
#include "grid/bitgrid.h"
#include "mesh/soup.h"
#include "voxmend/voxelize.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "meshes.h"

static vxm_rng rng = {11};
static int closed;

static uint64_t hash_of(const vxm_mesh *mesh, const vxm_space_options *space,
                        const vxm_voxelize_options *options, const char *path) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid;
  if (vxm_voxelize(&grid, NULL, mesh, space, options, &error) != VXM_OK)
    fail_msg("%s: %s", path, error.text);
  uint64_t hash = vxm_grid_hash(grid);
  vxm_grid_destroy(grid);
  return hash;
}

/** Whether parts run through themselves, which the default fills, and parity leaves hollow. */
static bool is_overlapping(const vxm_mesh *mesh, const vxm_space_options *space) {
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  vxm_grid *grid;
  assert_int_equal(vxm_voxelize(&grid, &report, mesh, space, NULL, NULL), VXM_OK);
  vxm_grid_destroy(grid);
  return report.self_overlapping_parts > 0;
}

static void check_mesh(const vxm_mesh *mesh, const char *path, int64_t resolution, bool tetra) {
  vxm_space_options fit = VXM_SPACE_OPTIONS_INIT;
  fit.resolution[0] = resolution;
  vxm_space space;
  assert_int_equal(vxm_space_fit(&space, mesh, &fit, NULL), VXM_OK);
  for (int a = 0; a < 3; a++)
    space.origin[a] += vxm_rng_unit(&rng) * space.voxel_size[a];
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.thin = VXM_THIN_DROP;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.like = &space;
  for (int parts = VXM_SPLIT_MODE_GROUP; parts <= VXM_SPLIT_MODE_WHOLE; parts++) {
    options.split_mode = (vxm_split_mode)parts;
    options.method = VXM_METHOD_VOTE;
    options.vote = is_overlapping(mesh, &space_options) ? VXM_VOTE_MAJORITY : VXM_VOTE_AUTO;
    uint64_t expected = hash_of(mesh, &space_options, &options, path);
    for (int method = VXM_METHOD_X; method <= (tetra ? VXM_METHOD_TETRA : VXM_METHOD_Z); method++) {
      options.method = (vxm_method)method;
      if (hash_of(mesh, &space_options, &options, path) != expected)
        fail_msg("%s at %d: method %d differs", path, (int)resolution, method);
    }
  }
}

/** Checks the mesh if it is closed after repair. */
static void check_file(const char *path, const char *name, void *payload) {
  const char *resolutions = getenv("VOXMEND_TEST_RESOLUTIONS"), *tetra = getenv("VOXMEND_TEST_TETRA");
  int64_t tetra_max = tetra ? strtol(tetra, NULL, 10) : 17;
  (void)name, (void)payload;
  vxm_error error = VXM_ERROR_INIT;
  vxm_mesh *raw, *mesh;
  vxm_census census = VXM_CENSUS_INIT;
  if (vxm_mesh_read(&raw, NULL, path, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_int_equal(vxm_mesh_repair(&mesh, NULL, raw, NULL, &error), VXM_OK);
  vxm_mesh_destroy(raw);
  assert_int_equal(vxm_mesh_census(&census, mesh, &error), VXM_OK);
  if (census.closed) {
    const char *at = resolutions ? resolutions : "17 64";
    for (char *end; *at; at = end) {
      int64_t resolution = strtol(at, &end, 10);
      if (end == at)
        break;
      check_mesh(mesh, path, resolution, resolution <= tetra_max);
    }
  }
  vxm_mesh_destroy(mesh);
  closed += census.closed;
}

static void test_closed_meshes_agree(void **state) {
  (void)state;
  int all = each_mesh_file(SIZE_MAX, check_file, NULL);
  if (all == 0)
    skip();
  print_message("%d of %d meshes are closed\n", closed, all);
  assert_true(closed > 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_closed_meshes_agree)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

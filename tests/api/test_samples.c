/* SPDX-License-Identifier: BSD-3-Clause */
/** The library against the known truth of every sample model: census, repair, volume and bits of the grid. */
#include "api_support.h"

#include <math.h>
#include <stdio.h>

enum { RESOLUTION = 64 };

/* ---- Census ---- */

static void expect_count(const model *entry, const char *what, int64_t found, int64_t expected) {
  if (found != expected)
    fail_msg("%s: %s is %lld, expected %lld", entry->name, what, (long long)found, (long long)expected);
}

#define EXPECT_COUNT(field) expect_count(entry, #field, census.field, entry->counts.field)

static void test_census(void **state) {
  (void)state;
  for (size_t i = 0; i < model_count; i++) {
    const model *entry = &models[i];
    vxm_mesh *mesh = mesh_of_model(NULL, entry->name);
    vxm_census census = VXM_CENSUS_INIT;
    assert_int_equal(vxm_mesh_census(&census, mesh, NULL), VXM_OK);
    EXPECT_COUNT(vertices);
    EXPECT_COUNT(faces);
    EXPECT_COUNT(triangles);
    EXPECT_COUNT(components);
    EXPECT_COUNT(components_raw);
    EXPECT_COUNT(duplicate_faces);
    EXPECT_COUNT(opposite_duplicate_faces);
    EXPECT_COUNT(degenerate_faces);
    EXPECT_COUNT(boundary_edges);
    EXPECT_COUNT(nonmanifold_edges);
    EXPECT_COUNT(inconsistent_edges);
    EXPECT_COUNT(nonfinite_vertices);
    EXPECT_COUNT(unused_vertices);
    EXPECT_COUNT(watertight);
    EXPECT_COUNT(closed);
    vxm_mesh_destroy(mesh);
  }
}

/** Bodies that are closed, simple and wound outward enclose their volume. */
static void test_volume_of_clean_models(void **state) {
  (void)state;
  static const char *const names[] = {"cube",       "sphere",     "torus",        "l_prism",
                                      "star_prism", "edge_cubes", "vertex_cubes", "cavity"};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    const model *entry = find_model(names[i]);
    vxm_mesh *mesh = mesh_of_model(NULL, names[i]);
    vxm_census census = VXM_CENSUS_INIT;
    assert_int_equal(vxm_mesh_census(&census, mesh, NULL), VXM_OK);
    if (!(fabs(census.volume - entry->volume) < 1e-8 * entry->volume))
      fail_msg("%s: volume %.12g, expected %.12g", names[i], census.volume, entry->volume);
    vxm_mesh_destroy(mesh);
  }
}

/* ---- Repair ---- */

static vxm_mesh *repaired_model(const model *entry) {
  vxm_mesh *mesh = mesh_of_model(NULL, entry->name), *repaired = NULL;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_mesh_repair(&repaired, NULL, mesh, NULL, &error) != VXM_OK)
    fail_msg("%s: %s", entry->name, error.text);
  vxm_mesh_destroy(mesh);
  return repaired;
}

/** What voxelization is sure of is closed after a repair, and a second repair finds nothing to do. */
static void test_repair(void **state) {
  (void)state;
  for (size_t i = 0; i < model_count; i++) {
    vxm_mesh *mesh = repaired_model(&models[i]), *again = NULL;
    vxm_census before = VXM_CENSUS_INIT;
    const vxm_census *census = &before;
    vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
    report.before = &before;
    assert_int_equal(vxm_mesh_repair(&again, &report, mesh, NULL, NULL), VXM_OK);
    if (models[i].parts && !census->closed)
      fail_msg("%s: not closed after repair", models[i].name);
    if (census->duplicate_faces || census->opposite_duplicate_faces || census->degenerate_faces ||
        census->nonfinite_vertices || census->unused_vertices)
      fail_msg("%s: faults are left after repair", models[i].name);
    for (int p = 0; p < report.pass_count; p++)
      if (report.passes[p].count != 0)
        fail_msg("%s: pass %s changes its own result", models[i].name, report.passes[p].pass);
    vxm_mesh_destroy(again);
    vxm_mesh_destroy(mesh);
  }
}

/* ---- Voxels ---- */

static vxm_grid *grid_of(const vxm_mesh *mesh, const model *entry, vxm_method method, const vxm_space *like) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.resolution[0] = RESOLUTION;
  space_options.like = like;
  options.method = method;
  options.split_mode =
      entry->parts && strcmp(entry->parts, "whole") == 0 ? VXM_SPLIT_MODE_WHOLE : VXM_SPLIT_MODE_AUTO;
  vxm_grid *grid = NULL;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_voxelize(&grid, NULL, mesh, &space_options, &options, &error) != VXM_OK)
    fail_msg("%s: %s", entry->name, error.text);
  return grid;
}

/** The voxels' volume is the solid's, but for a quarter of a voxel along its surface. */
static void test_volume_of_voxels(void **state) {
  (void)state;
  for (size_t i = 0; i < model_count; i++) {
    const model *entry = &models[i];
    if (!entry->parts)
      continue;
    vxm_mesh *mesh = repaired_model(entry);
    vxm_census census = VXM_CENSUS_INIT;
    assert_int_equal(vxm_mesh_census(&census, mesh, NULL), VXM_OK);
    vxm_grid *grid = grid_of(mesh, entry, VXM_METHOD_VOTE, NULL);
    double h = vxm_grid_space(grid)->voxel_size[0];
    double volume = (double)vxm_grid_count(grid) * h * h * h;
    if (!(fabs(volume - entry->volume) <= 0.25 * census.area * h))
      fail_msg("%s: voxels of volume %g, expected %g", entry->name, volume, entry->volume);
    vxm_grid_destroy(grid);
    vxm_mesh_destroy(mesh);
  }
}

/** What was broken has the very bits of what it was made from, by every method. */
static void test_bits_of_broken_models(void **state) {
  (void)state;
  for (size_t i = 0; i < model_count; i++) {
    const model *entry = &models[i];
    if (!entry->same_as)
      continue;
    vxm_mesh *mesh = repaired_model(entry), *clean = mesh_of_model(NULL, entry->same_as);
    for (int method = VXM_METHOD_VOTE; method <= VXM_METHOD_TETRA; method++) {
      vxm_grid *b = grid_of(clean, entry, (vxm_method)method, NULL);
      vxm_grid *a = grid_of(mesh, entry, (vxm_method)method, vxm_grid_space(b));
      if (vxm_grid_hash(a) != vxm_grid_hash(b))
        fail_msg("%s: not the voxels of %s with method %d", entry->name, entry->same_as, method);
      vxm_grid_destroy(a);
      vxm_grid_destroy(b);
    }
    vxm_mesh_destroy(clean);
    vxm_mesh_destroy(mesh);
  }
}

/** Overlapping parts are united: the grid is the union of those of the two cubes. */
static void test_union_of_parts(void **state) {
  (void)state;
  const model *entry = find_model("overlapping");
  vxm_mesh *both = mesh_of_model(NULL, "overlapping"), *one[2];
  vxm_grid *grid = grid_of(both, entry, VXM_METHOD_VOTE, NULL), *single[2];
  const vxm_space *space = vxm_grid_space(grid);
  for (int i = 0; i < 2; i++) {
    shape cube = shape_box(0.5 * i, 0.5 * i, 0.5 * i, 1 + 0.5 * i, 1 + 0.5 * i, 1 + 0.5 * i);
    one[i] = mesh_of_shape(NULL, &cube);
    single[i] = grid_of(one[i], entry, VXM_METHOD_VOTE, space);
    shape_free(&cube);
  }
  for (int64_t k = 0; k < space->dims[2]; k++)
    for (int64_t j = 0; j < space->dims[1]; j++)
      for (int64_t i = 0; i < space->dims[0]; i++)
        assert_int_equal(vxm_grid_get(grid, i, j, k),
                         vxm_grid_get(single[0], i, j, k) || vxm_grid_get(single[1], i, j, k));
  for (int i = 0; i < 2; i++) {
    vxm_grid_destroy(single[i]);
    vxm_mesh_destroy(one[i]);
  }
  vxm_grid_destroy(grid);
  vxm_mesh_destroy(both);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_census),
      cmocka_unit_test(test_volume_of_clean_models),
      cmocka_unit_test(test_repair),
      cmocka_unit_test(test_volume_of_voxels),
      cmocka_unit_test(test_bits_of_broken_models),
      cmocka_unit_test(test_union_of_parts),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** Variants as shares of each voxel that are filled: counted from finer voxels, and the coverage of meshes.
 */
#include "sampler_test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/** Shares are counted from a sampler of as many voxels as there are sub-voxels, whose variants lie alike. */
static void shares_are_those_of_finer_voxels(void **state) {
  (void)state;
  static const int64_t resolutions[] = {19, 32, 12};
  static const int subdivisions[] = {2, 4, 8};
  vxm_mesh *mesh = mesh_of_model(NULL, "torus");
  for (int r = 0; r < 3; r++) {
    const int64_t dim = resolutions[r], n = subdivisions[r], fine_dim = dim * n;
    vxm_sampler_options options = all_options(), fine = options;
    vxm_voxelize_options centres = VXM_VOXELIZE_OPTIONS_INIT;
    vxm_context *context = context_of(1 + r);
    centres.thin = VXM_THIN_DROP;
    options.resolution = dim;
    options.coverage = (int)n;
    fine.resolution = fine_dim;
    fine.pad *= n;
    fine.voxelize = &centres;
    vxm_sampler *sampler = sampler_of(context, &options, mesh), *finer = sampler_of(context, &fine, mesh);
    uint8_t *bytes = make(sampler, 7, 2, VXM_VOXEL_FORMAT_UINT8),
            *set = make(finer, 7, 2, VXM_VOXEL_FORMAT_UINT8);
    float *floats = (float *)(void *)make(sampler, 7, 2, VXM_VOXEL_FORMAT_FLOAT32);
    int partial = 0;
    for (int64_t i = 0; i < 2 * dim * dim * dim; i++) {
      int64_t z = i % dim, y = i / dim % dim, x = i / dim / dim, count = 0;
      for (int64_t s = 0; s < n * n * n; s++) /* the second variant goes on where the first ended */
        count += set[((x * n + s / n / n) * fine_dim + y * n + s / n % n) * fine_dim + z * n + s % n];
      double share = (double)count / (double)(n * n * n);
      assert_int_equal(bytes[i], (int)floor(255 * share + 0.5));
      assert_true(floats[i] == (float)share);
      partial += count > 0 && share < 1;
    }
    assert_true(partial > 100);
    free(bytes), free(set), free(floats);
    vxm_sampler_destroy(sampler);
    vxm_sampler_destroy(finer);
    vxm_context_destroy(context);
  }
  vxm_mesh_destroy(mesh);
}

/** Without displacement they are the coverage of a mesh that lies as the pose says; but for a few sub-voxels,
 * as polygons that are moved, and rounded, may be split along other diagonals. */
static void shares_are_the_coverage(void **state) {
  (void)state;
  enum { DIM = 32 };
  static float values[DIM * DIM * DIM];
  int unlike = 0;
  vxm_mesh *mesh = mesh_of_model(NULL, "star_prism");
  vxm_sampler_options options = all_options();
  options.displace = 0;
  options.resolution = DIM;
  options.coverage = 4;
  vxm_sampler *sampler = sampler_of(NULL, &options, mesh);
  const vxm_space voxels = {{DIM, DIM, DIM}, {0, 0, 0}, {1, 1, 1}};
  for (uint32_t i = 0; i < 5; i++) {
    vxm_pose pose = VXM_POSE_INIT;
    assert_int_equal(vxm_sampler_pose(&pose, sampler, &(vxm_variant){0, 2, i}, NULL), VXM_OK);
    shape moved = find_model("star_prism")->make();
    for (size_t v = 0; v < moved.vertex_count; v++) {
      double *at = moved.positions + 3 * v, from[3] = {at[0], at[1], at[2]};
      for (int a = 0; a < 3; a++) {
        const double *row = pose.transform + (ptrdiff_t)4 * a;
        at[a] = row[0] * from[0] + row[1] * from[1] + row[2] * from[2] + row[3];
      }
    }
    vxm_mesh *there = mesh_of_shape(NULL, &moved);
    vxm_model *model_there = NULL;
    assert_int_equal(vxm_model_create(&model_there, there, NULL, NULL), VXM_OK);
    assert_int_equal(vxm_model_coverage(values, NULL, model_there, &voxels, NULL, NULL), VXM_OK);
    float *floats = (float *)(void *)make(sampler, i, 1, VXM_VOXEL_FORMAT_FLOAT32);
    for (int v = 0; v < DIM * DIM * DIM; v++) {
      unlike += floats[v] != values[v];
      assert_true(fabs((double)floats[v] - (double)values[v]) <= 1.0 / 64);
    }
    free(floats);
    vxm_model_destroy(model_there);
    vxm_mesh_destroy(there);
    shape_free(&moved);
  }
  assert_true(unlike < 10);
  vxm_sampler_destroy(sampler);
  vxm_mesh_destroy(mesh);
}

/** Bits cannot hold shares. */
static void shares_are_no_bits(void **state) {
  (void)state;
  vxm_mesh *mesh = mesh_of_model(NULL, "cube");
  vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT;
  options.resolution = 4;
  options.coverage = 2;
  vxm_sampler *sampler = sampler_of(NULL, &options, mesh);
  const vxm_variant variant = {0, 0, 0};
  const char *const path = "shares.npy";
  const vxm_space space = vxm_sampler_space(sampler);
  uint8_t out[64];
  vxm_grid *grid = NULL;
  assert_int_equal(vxm_grid_create(&grid, NULL, &space, NULL), VXM_OK);
  assert_int_equal(vxm_sampler_batch(out, sampler, &variant, 1, VXM_VOXEL_FORMAT_PACKED, NULL),
                   VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_sampler_grid(grid, sampler, &variant, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_sampler_files(&path, sampler, &variant, 1, NULL, NULL, NULL), VXM_ERROR_ARGUMENT);
  vxm_grid_destroy(grid);
  vxm_sampler_destroy(sampler);
  vxm_mesh_destroy(mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(shares_are_those_of_finer_voxels),
      cmocka_unit_test(shares_are_the_coverage),
      cmocka_unit_test(shares_are_no_bits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

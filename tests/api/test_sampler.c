/* SPDX-License-Identifier: BSD-3-Clause */
/** Variants as a caller sees them: the same bits always, what is closed stays closed, and nothing lies
 * outside. */
#include "sampler_test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- The same bits ---- */

enum { MANY = 24 };

/** On any machine: this is what the first one gave, of voxel centres alone and with thin parts.
 * tests/python and tests/cli/augment.sh know it too. */
static const uint64_t known_hash[] = {
    [VXM_THIN_KEEP] = UINT64_C(0xfcdffbb6393ef3c2), [VXM_THIN_DROP] = UINT64_C(0x0c71fe46723e2b98)};

static void check_bits_for_any_threads_and_order(vxm_thin_parts thin) {
  vxm_sampler_options options = all_options();
  vxm_voxelize_options voxelize = VXM_VOXELIZE_OPTIONS_INIT;
  voxelize.thin = thin;
  options.voxelize = &voxelize;
  uint8_t *first = NULL;
  for (int threads = 1; threads <= 3; threads++) {
    vxm_context *context = context_of(threads);
    vxm_mesh *mesh = mesh_of_model(context, "l_prism");
    vxm_sampler *sampler = sampler_of(context, &options, mesh);
    size_t bytes = vxm_sampler_bytes(sampler, VXM_VOXEL_FORMAT_PACKED);
    assert_int_equal(bytes, 32 * 32 * 4);
    for (int twice = 0; twice < 2; twice++) {
      uint8_t *made = make(sampler, 0, MANY, VXM_VOXEL_FORMAT_PACKED);
      if (!first) {
        first = made;
        continue;
      }
      assert_memory_equal(made, first, MANY * bytes);
      free(made);
    }
    for (uint32_t i = MANY; i-- > 0;) { /* one by one, from the last on: made by all threads together */
      uint8_t *made = make(sampler, i, 1, VXM_VOXEL_FORMAT_PACKED);
      assert_memory_equal(made, first + i * bytes, bytes);
      free(made);
    }
    vxm_sampler_destroy(sampler);
    vxm_mesh_destroy(mesh);
    vxm_context_destroy(context);
  }
  uint64_t hash = hash_of(first, (size_t)MANY * 32 * 32 * 4);
  if (hash != known_hash[thin])
    fail_msg("the variants have hash %016llx, not %016llx", (unsigned long long)hash,
             (unsigned long long)known_hash[thin]);
  free(first);
}

static void same_bits_for_any_threads_and_order(void **state) {
  (void)state;
  check_bits_for_any_threads_and_order(VXM_THIN_KEEP);
  check_bits_for_any_threads_and_order(VXM_THIN_DROP);
}

/** Model, epoch, index and seed all matter, and what is not asked for changes nothing. */
static void each_part_of_the_name_matters(void **state) {
  (void)state;
  vxm_sampler_options options = all_options();
  vxm_mesh *mesh = mesh_of_model(NULL, "star_prism");
  vxm_sampler *sampler = sampler_of(NULL, &options, mesh);
  assert_int_equal(vxm_sampler_put(sampler, 9, mesh, NULL), VXM_OK);
  const vxm_variant variants[] = {{0, 0, 0}, {9, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
  size_t bytes = vxm_sampler_bytes(sampler, VXM_VOXEL_FORMAT_UINT8);
  uint8_t *out = malloc(5 * bytes), *other = malloc(bytes);
  assert_int_equal(vxm_sampler_batch(out, sampler, variants, 5, VXM_VOXEL_FORMAT_UINT8, NULL), VXM_OK);
  for (size_t i = 0; i < 5; i++)
    for (size_t k = 0; k < i; k++)
      assert_int_equal(memcmp(out + i * bytes, out + k * bytes, bytes) == 0, i == 4 && k == 0);
  vxm_sampler_destroy(sampler);
  options.seed++;
  sampler = sampler_of(NULL, &options, mesh);
  assert_int_equal(vxm_sampler_batch(other, sampler, variants, 1, VXM_VOXEL_FORMAT_UINT8, NULL), VXM_OK);
  assert_int_not_equal(memcmp(out, other, bytes), 0);
  vxm_sampler_destroy(sampler);
  free(out);
  free(other);
  /* The rotation is the same with and without displacement, scaling and mirrors. */
  vxm_pose pose[2] = {VXM_POSE_INIT, VXM_POSE_INIT};
  for (int k = 0; k < 2; k++) {
    if (k == 1)
      options.displace = options.scale = 0, options.mirror = 0;
    sampler = sampler_of(NULL, &options, mesh);
    assert_int_equal(vxm_sampler_pose(&pose[k], sampler, &variants[3], NULL), VXM_OK);
    vxm_sampler_destroy(sampler);
  }
  assert_memory_equal(pose[0].rotation, pose[1].rotation, sizeof pose[0].rotation);
  vxm_mesh_destroy(mesh);
}

/* ---- What the voxels are ---- */

/** Bytes, floats, bits and grids say the same, also where rows are not whole bytes or words. */
static void forms_agree(void **state) {
  (void)state;
  static const int64_t resolutions[] = {20, 64, 67, 128};
  vxm_mesh *mesh = mesh_of_model(NULL, "cube");
  vxm_context *context = context_of(2);
  for (size_t r = 0; r < sizeof resolutions / sizeof *resolutions; r++) {
    int64_t n = resolutions[r];
    vxm_sampler_options options = all_options();
    options.resolution = n;
    vxm_sampler *sampler = sampler_of(context, &options, mesh);
    uint8_t *bytes = make(sampler, 5, 2, VXM_VOXEL_FORMAT_UINT8),
            *bits = make(sampler, 5, 2, VXM_VOXEL_FORMAT_PACKED);
    float *floats = (float *)(void *)make(sampler, 5, 2, VXM_VOXEL_FORMAT_FLOAT32);
    vxm_grid *grid;
    vxm_space space = vxm_sampler_space(sampler);
    assert_int_equal(vxm_grid_create(&grid, context, &space, NULL), VXM_OK);
    size_t row = ((size_t)n + 7) / 8, i = 0;
    for (uint32_t v = 0; v < 2; v++) {
      assert_int_equal(vxm_sampler_grid(grid, sampler, &(vxm_variant){0, 2, 5 + v}, NULL), VXM_OK);
      assert_true(vxm_grid_count(grid) > n);
      for (int64_t x = 0; x < n; x++)
        for (int64_t y = 0; y < n; y++)
          for (int64_t z = 0; z < n; z++, i++) {
            const uint8_t *packed =
                bits + (((size_t)v * (size_t)n + (size_t)x) * (size_t)n + (size_t)y) * row;
            bool set = vxm_grid_get(grid, x, y, z);
            if (bytes[i] != set || floats[i] != (float)set || (packed[z / 8] >> (z % 8) & 1) != set)
              fail_msg("voxel %d %d %d of %d differs", (int)x, (int)y, (int)z, (int)n);
          }
    }
    free(bytes), free(bits), free(floats);
    vxm_grid_destroy(grid);
    vxm_sampler_destroy(sampler);
  }
  vxm_mesh_destroy(mesh);
  vxm_context_destroy(context);
}

/** Without displacement a variant is what its pose says, voxelized as any model. */
static void poses_tell_where_variants_lie(void **state) {
  (void)state;
  vxm_context *context = context_of(2);
  vxm_mesh *mesh = mesh_of_model(context, "star_prism");
  vxm_sampler_options options = all_options();
  options.displace = 0;
  options.resolution = 32; /* a power of two, so that both are rounded alike */
  vxm_sampler *sampler = sampler_of(context, &options, mesh);
  vxm_model *made;
  vxm_grid *grid, *direct;
  vxm_space space = vxm_sampler_space(sampler), voxels = {{32, 32, 32}, {0, 0, 0}, {1, 1, 1}};
  assert_int_equal(vxm_model_create(&made, mesh, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_grid_create(&grid, context, &space, NULL), VXM_OK);
  assert_int_equal(vxm_grid_create(&direct, context, &voxels, NULL), VXM_OK);
  for (uint32_t i = 0; i < 20; i++) {
    vxm_pose pose = VXM_POSE_INIT;
    vxm_comparison compared = VXM_COMPARISON_INIT;
    vxm_variant variant = {0, 0, i};
    assert_int_equal(vxm_sampler_pose(&pose, sampler, &variant, NULL), VXM_OK);
    assert_int_equal(vxm_sampler_grid(grid, sampler, &variant, NULL), VXM_OK);
    assert_int_equal(vxm_model_voxelize(direct, NULL, made, pose.transform, NULL), VXM_OK);
    assert_int_equal(vxm_grid_compare(&compared, grid, direct, NULL), VXM_OK);
    assert_true(compared.only_a + compared.only_b == 0 && compared.both > 100);
    for (int row = 0; row < 3; row++)
      for (int c = 0; c < 3; c++)
        assert_true(fabs(pose.transform[4 * row + c] - pose.rotation[3 * row + c] * pose.scale[c]) < 1e-12);
  }
  vxm_grid_destroy(grid);
  vxm_grid_destroy(direct);
  vxm_model_destroy(made);
  vxm_sampler_destroy(sampler);
  vxm_mesh_destroy(mesh);
  vxm_context_destroy(context);
}

/* ---- What is closed stays closed ---- */

/** Each augmentation alone, and all together. */
enum { CASES = 9 };

static vxm_sampler_options options_of_case(int which) {
  static const double turns[18] = {0, -1, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, -1, 0, 1, 0};
  vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT, all = all_options();
  options.resolution = 32;
  options.seed = 77;
  bool any = which == 8;
  if (any || which == 0)
    options.rotation = VXM_ROTATION_ANY;
  if (which == 1) {
    options.rotation = VXM_ROTATION_AXIS;
    options.axis[0] = 1, options.axis[1] = -3, options.axis[2] = 0.5;
  }
  if (which == 2) {
    options.rotation = VXM_ROTATION_LIST;
    options.rotations = turns;
    options.rotation_count = 2;
  }
  if (any || which == 3)
    options.scale = all.scale;
  if (any || which == 4 || which == 5)
    options.displace = 0.05;
  if (which == 5)
    options.displacement = VXM_DISPLACEMENT_NORMAL, options.noise = 100;
  if (any || which == 6)
    options.mirror = 7;
  if (any || which == 7)
    options.translate = 1, options.pad = 3;
  return options;
}

/** x, y and z parity agree wherever no crack lets one of them through. Triangles with vertices of their own
 * show whether displacements depend on the place alone. */
static void closed_stays_closed(void **state) {
  (void)state;
  static const char *const names[] = {"torus", "star_prism", "cavity", "soup"};
  vxm_context *context = context_of(2);
  for (size_t m = 0; m < sizeof names / sizeof *names; m++) {
    vxm_mesh *mesh = mesh_of_model(context, names[m]);
    for (int which = 0; which < CASES; which++) {
      uint8_t *made[3];
      size_t bytes = 0;
      for (int axis = 0; axis < 3; axis++) {
        vxm_sampler_options options = options_of_case(which);
        vxm_voxelize_options how = VXM_VOXELIZE_OPTIONS_INIT;
        options.voxelize = &how;
        how.method = (vxm_method)(VXM_METHOD_X + axis);
        how.split_mode = VXM_SPLIT_MODE_WHOLE;
        vxm_sampler *sampler = sampler_of(context, &options, mesh);
        bytes = 12 * vxm_sampler_bytes(sampler, VXM_VOXEL_FORMAT_UINT8);
        made[axis] = make(sampler, 0, 12, VXM_VOXEL_FORMAT_UINT8);
        vxm_sampler_destroy(sampler);
      }
      if (memcmp(made[0], made[1], bytes) != 0 || memcmp(made[0], made[2], bytes) != 0)
        fail_msg("%s, case %d: x, y and z differ", names[m], which);
      assert_non_null(memchr(made[0], 1, bytes));
      for (int axis = 0; axis < 3; axis++)
        free(made[axis]);
    }
    vxm_mesh_destroy(mesh);
  }
  vxm_context_destroy(context);
}

/* ---- Nothing lies outside ---- */

/** The box, displaced as far as can be, stays within the pad; moved, within the grid. */
static void variants_fit_their_grid(void **state) {
  (void)state;
  vxm_mesh *mesh = mesh_of_model(NULL, "l_prism");
  vxm_census census = VXM_CENSUS_INIT;
  assert_int_equal(vxm_mesh_census(&census, mesh, NULL), VXM_OK);
  for (int moved = 0; moved < 2; moved++) {
    vxm_sampler_options options = all_options();
    options.pad = 3;
    options.translate = moved;
    vxm_sampler *sampler = sampler_of(NULL, &options, mesh);
    double low = moved ? 0 : 3, reach = options.displace * 32, least = 32;
    for (uint32_t i = 0; i < 500; i++) {
      vxm_pose pose = VXM_POSE_INIT;
      assert_int_equal(vxm_sampler_pose(&pose, sampler, &(vxm_variant){0, 0, i}, NULL), VXM_OK);
      for (int corner = 0; corner < 8; corner++)
        for (int row = 0; row < 3; row++) {
          const double *m = pose.transform + (ptrdiff_t)4 * row;
          double at = m[3];
          for (int a = 0; a < 3; a++)
            at += m[a] * census.bounds[a + 3 * (corner >> a & 1)];
          assert_true(at - reach > low - 1e-9 && at + reach < 32 - low + 1e-9);
          least = fmin(least, at - reach);
        }
    }
    assert_true(least < low + 1); /* the room is used */
    uint8_t *made = make(sampler, 0, 40, VXM_VOXEL_FORMAT_UINT8);
    for (size_t v = 0; v < 40 && !moved; v++)
      for (int x = 0; x < 32; x++)
        for (int y = 0; y < 32; y++)
          for (int z = 0; z < 32; z++)
            if (x < 3 || x > 28 || y < 3 || y > 28 || z < 3 || z > 28)
              assert_int_equal(made[((v * 32 + (size_t)x) * 32 + (size_t)y) * 32 + (size_t)z], 0);
    free(made);
    vxm_sampler_destroy(sampler);
  }
  /* The longest side fills the grid where that is asked for. */
  vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT;
  options.fill = true;
  vxm_sampler *sampler = sampler_of(NULL, &options, mesh);
  vxm_pose pose = VXM_POSE_INIT;
  double longest = 0;
  assert_int_equal(vxm_sampler_pose(&pose, sampler, &(vxm_variant){0, 0, 0}, NULL), VXM_OK);
  for (int a = 0; a < 3; a++)
    longest = fmax(longest, (census.bounds[a + 3] - census.bounds[a]) * pose.scale[a]);
  assert_true(fabs(longest - 64) < 1e-9);
  vxm_sampler_destroy(sampler);
  vxm_mesh_destroy(mesh);
}

/** Half of all variants are mirrored along each axis that is named, and none along others. */
static void mirrors_are_fair(void **state) {
  (void)state;
  vxm_mesh *mesh = mesh_of_model(NULL, "cube");
  vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT;
  options.mirror = 5;
  options.scale = 0.25;
  vxm_sampler *sampler = sampler_of(NULL, &options, mesh);
  int mirrored[3] = {0}, wide = 0;
  for (uint32_t i = 0; i < 1000; i++) {
    vxm_pose pose = VXM_POSE_INIT;
    assert_int_equal(vxm_sampler_pose(&pose, sampler, &(vxm_variant){0, 0, i}, NULL), VXM_OK);
    for (int a = 0; a < 3; a++)
      mirrored[a] += pose.scale[a] < 0;
    double ratio = fabs(pose.scale[0] / pose.scale[1]);
    assert_true(ratio > 0.75 / 1.25 && ratio < 1.25 / 0.75);
    wide += ratio > 1;
  }
  assert_true(mirrored[0] > 440 && mirrored[0] < 560 && mirrored[2] > 440 && mirrored[2] < 560);
  assert_int_equal(mirrored[1], 0);
  assert_true(wide > 440 && wide < 560);
  vxm_sampler_destroy(sampler);
  vxm_mesh_destroy(mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(same_bits_for_any_threads_and_order),
      cmocka_unit_test(each_part_of_the_name_matters),
      cmocka_unit_test(forms_agree),
      cmocka_unit_test(poses_tell_where_variants_lie),
      cmocka_unit_test(closed_stays_closed),
      cmocka_unit_test(variants_fit_their_grid),
      cmocka_unit_test(mirrors_are_fair),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

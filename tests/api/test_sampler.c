/* SPDX-License-Identifier: BSD-3-Clause */
/** Variants as a caller sees them: the same bits always, what is closed stays closed, and nothing lies
 * outside. */
#include "api_support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static vxm_context *context_of(int threads) {
  vxm_context_options limits = VXM_CONTEXT_OPTIONS_INIT;
  limits.threads = threads;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, &limits, NULL), VXM_OK);
  return context;
}

/** Everything at once. */
static vxm_sampler_options all_options(void) {
  vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT;
  options.resolution = 32;
  options.pad = 1;
  options.seed = UINT64_C(0x123456789abcdef0);
  options.rotation = VXM_ROTATION_ANY;
  options.scale = 0.5;
  options.displace = 0.03;
  options.mirror = 7;
  options.translate = 1;
  return options;
}

static vxm_sampler *sampler_of(vxm_context *context, const vxm_sampler_options *options,
                               const vxm_mesh *mesh) {
  vxm_sampler *sampler = NULL;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_sampler_create(&sampler, context, options, &error) != VXM_OK ||
      vxm_sampler_put(sampler, 0, mesh, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return sampler;
}

/** Variants first to first + count - 1 of model 0; to be freed. */
static uint8_t *make(vxm_sampler *sampler, uint32_t first, size_t count, vxm_voxel_format voxels) {
  vxm_variant *variants = calloc(count, sizeof *variants);
  uint8_t *out = malloc(count * vxm_sampler_bytes(sampler, voxels));
  assert_true(variants && out);
  for (size_t i = 0; i < count; i++)
    variants[i] = (vxm_variant){0, 2, first + (uint32_t)i};
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_sampler_batch(out, sampler, variants, count, voxels, &error) != VXM_OK)
    fail_msg("%s", error.text);
  free(variants);
  return out;
}

/** FNV-1a, which other languages can easily do too. */
static uint64_t hash_of(const uint8_t *bytes, size_t count) {
  uint64_t hash = UINT64_C(0xcbf29ce484222325);
  for (size_t i = 0; i < count; i++)
    hash = (hash ^ bytes[i]) * UINT64_C(0x100000001b3);
  return hash;
}

/* ---- The same bits ---- */

enum { MANY = 24 };

/** On any machine: this is what the first one gave, of voxel centres alone and with thin parts.
 * tests/python and tests/cli/augment.sh know it too. */
static const uint64_t known_hash[] = {
    [VXM_THIN_KEEP] = UINT64_C(0x0339e904b2c4b42a), [VXM_THIN_DROP] = UINT64_C(0x935f9fe6b0a47cde)};

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
  vxm_pose pose[2];
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

/* ---- Models come and go; what is refused ---- */

static void models_come_and_go(void **state) {
  (void)state;
  vxm_context *context = context_of(2);
  vxm_mesh *torus = mesh_of_model(context, "torus"), *cube = mesh_of_model(context, "cube");
  vxm_sampler_options options = all_options();
  vxm_sampler *sampler = sampler_of(context, &options, torus);
  uint8_t *of_torus = make(sampler, 0, 4, VXM_VOXEL_FORMAT_UINT8);
  size_t bytes = vxm_sampler_bytes(sampler, VXM_VOXEL_FORMAT_UINT8);
  assert_int_equal(vxm_sampler_put(sampler, 0, cube, NULL), VXM_OK);
  uint8_t *of_cube = make(sampler, 0, 4, VXM_VOXEL_FORMAT_UINT8);
  assert_int_not_equal(memcmp(of_torus, of_cube, 4 * bytes), 0);
  /* Beside others, in whatever order, a model of the same number gives the same. */
  for (uint32_t number = 12; number > 0; number -= 3)
    assert_int_equal(vxm_sampler_put(sampler, number, cube, NULL), VXM_OK);
  assert_int_equal(vxm_sampler_put(sampler, 0, torus, NULL), VXM_OK);
  const vxm_variant mixed[] = {{3, 2, 0}, {0, 2, 1}, {12, 2, 0}, {0, 2, 3}};
  uint8_t *out = malloc(4 * bytes);
  assert_int_equal(vxm_sampler_batch(out, sampler, mixed, 4, VXM_VOXEL_FORMAT_UINT8, NULL), VXM_OK);
  assert_memory_equal(out + bytes, of_torus + bytes, bytes);
  assert_memory_equal(out + 3 * bytes, of_torus + 3 * bytes, bytes);
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_sampler_put(sampler, 12, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_sampler_batch(out, sampler, mixed, 4, VXM_VOXEL_FORMAT_UINT8, &error),
                   VXM_ERROR_ARGUMENT);
  assert_non_null(strstr(error.text, "no model 12"));
  free(of_torus), free(of_cube), free(out);
  vxm_sampler_destroy(sampler);
  vxm_mesh_destroy(torus);
  vxm_mesh_destroy(cube);
  vxm_context_destroy(context);
}

static void refuse(const vxm_sampler_options *options, vxm_status status) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_sampler *sampler = (vxm_sampler *)&error;
  assert_int_equal(vxm_sampler_create(&sampler, NULL, options, &error), status);
  assert_null(sampler);
  assert_true(strncmp(error.text, "sampler: ", 9) == 0 || strncmp(error.text, "voxelize: ", 10) == 0);
}

#define REFUSE(field, value, status)                        \
  do {                                                      \
    vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT; \
    options.field = value;                                  \
    refuse(&options, status);                               \
  } while (0)

static void wrong_arguments_are_refused(void **state) {
  (void)state;
  static const double shear[9] = {1, 0.1, 0, 0, 1, 0, 0, 0, 1};
  REFUSE(size, 2, VXM_ERROR_ARGUMENT);
  REFUSE(resolution, -1, VXM_ERROR_ARGUMENT);
  REFUSE(resolution, 4097, VXM_ERROR_RANGE);
  REFUSE(coverage, 3, VXM_ERROR_ARGUMENT);
  REFUSE(pad, -1, VXM_ERROR_ARGUMENT);
  REFUSE(pad, 32, VXM_ERROR_ARGUMENT);
  REFUSE(rotation, (vxm_rotation)4, VXM_ERROR_ARGUMENT);
  REFUSE(rotation, VXM_ROTATION_LIST, VXM_ERROR_ARGUMENT);
  REFUSE(axis[1], NAN, VXM_ERROR_ARGUMENT);
  REFUSE(scale, 1.0, VXM_ERROR_ARGUMENT);
  REFUSE(scale, -0.1, VXM_ERROR_ARGUMENT);
  REFUSE(scale, NAN, VXM_ERROR_ARGUMENT);
  REFUSE(displacement, (vxm_displacement)2, VXM_ERROR_ARGUMENT);
  REFUSE(displace, 0.5, VXM_ERROR_ARGUMENT);
  REFUSE(displace, NAN, VXM_ERROR_ARGUMENT);
  REFUSE(noise, (1 << 24) + 1, VXM_ERROR_ARGUMENT);
  REFUSE(mirror, 8, VXM_ERROR_ARGUMENT);
  REFUSE(translate, 1.5, VXM_ERROR_ARGUMENT);
  vxm_voxelize_options unknown = VXM_VOXELIZE_OPTIONS_INIT, sure = VXM_VOXELIZE_OPTIONS_INIT;
  unknown.method = (vxm_method)99;
  sure.confidence = true;
  REFUSE(voxelize, &unknown, VXM_ERROR_ARGUMENT);
  REFUSE(voxelize, &sure, VXM_ERROR_ARGUMENT);
  vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT;
  options.coverage = 8;
  options.resolution = 513;
  refuse(&options, VXM_ERROR_RANGE);
  vxm_voxelize_options surface = VXM_VOXELIZE_OPTIONS_INIT;
  surface.mode = VXM_MODE_SURFACE;
  options.resolution = 64;
  options.voxelize = &surface;
  refuse(&options, VXM_ERROR_ARGUMENT);
  options = (vxm_sampler_options)VXM_SAMPLER_OPTIONS_INIT;
  options.fill = true;
  options.rotation = VXM_ROTATION_ANY;
  refuse(&options, VXM_ERROR_ARGUMENT);
  options.fill = false;
  options.rotation = VXM_ROTATION_LIST;
  options.rotations = shear;
  options.rotation_count = 1;
  refuse(&options, VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_sampler_create(NULL, NULL, NULL, NULL), VXM_ERROR_ARGUMENT);

  vxm_mesh *mesh = mesh_of_model(NULL, "cube"), *empty;
  vxm_sampler *sampler = sampler_of(NULL, NULL, mesh);
  vxm_variant variant = {0, 0, 0}, absent = {1, 0, 0};
  uint8_t out[8];
  vxm_pose pose = VXM_POSE_INIT;
  assert_int_equal(vxm_sampler_bytes(sampler, (vxm_voxel_format)3), 0);
  assert_int_equal(vxm_sampler_batch(NULL, sampler, &variant, 1, VXM_VOXEL_FORMAT_PACKED, NULL),
                   VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_sampler_batch(out, NULL, &variant, 1, VXM_VOXEL_FORMAT_PACKED, NULL),
                   VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_sampler_batch(out, sampler, NULL, 1, VXM_VOXEL_FORMAT_PACKED, NULL),
                   VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_sampler_batch(out, sampler, &variant, 1, (vxm_voxel_format)7, NULL),
                   VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_sampler_batch(out, sampler, &absent, 1, VXM_VOXEL_FORMAT_PACKED, NULL),
                   VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_sampler_batch(out, sampler, &variant, 0, VXM_VOXEL_FORMAT_PACKED, NULL), VXM_OK);
  assert_int_equal(vxm_sampler_pose(&pose, sampler, &absent, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_sampler_pose(NULL, sampler, &variant, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_sampler_put(NULL, 0, mesh, NULL), VXM_ERROR_ARGUMENT);
  vxm_grid *grid;
  vxm_space space = {{64, 64, 63}, {0, 0, 0}, {1, 1, 1}};
  assert_int_equal(vxm_grid_create(&grid, NULL, &space, NULL), VXM_OK);
  assert_int_equal(vxm_sampler_grid(grid, sampler, &variant, NULL), VXM_ERROR_ARGUMENT);
  vxm_grid_destroy(grid);
  vxm_mesh_arrays nothing = VXM_MESH_ARRAYS_INIT;
  assert_int_equal(vxm_mesh_create(&empty, NULL, &nothing, NULL), VXM_OK);
  assert_int_equal(vxm_sampler_put(sampler, 0, empty, NULL), VXM_ERROR_EMPTY);
  assert_int_equal(vxm_sampler_pose(&pose, sampler, &variant, NULL), VXM_ERROR_ARGUMENT); /* it is gone */
  vxm_mesh_destroy(empty);
  empty = mesh_of_model(NULL, "nonfinite");
  assert_int_equal(vxm_sampler_put(sampler, 0, empty, NULL), VXM_ERROR_RANGE);
  vxm_sampler_destroy(sampler);
  vxm_sampler_destroy(NULL);
  vxm_mesh_destroy(empty);
  vxm_mesh_destroy(mesh);
}

/** Open meshes, surfaces and the winding number: the same for any number of threads, and not empty. */
static void all_ways_to_voxelize_work(void **state) {
  (void)state;
  static const char *const names[] = {"missing", "open_box", "inner_sheet", "overlapping"};
  for (size_t m = 0; m < sizeof names / sizeof *names; m++)
    for (int way = 0; way < 6; way++) {
      uint8_t *made[2];
      size_t bytes = 0;
      for (int threads = 1; threads <= 2; threads++) {
        vxm_context *context = context_of(threads);
        vxm_mesh *mesh = mesh_of_model(context, names[m]);
        vxm_sampler_options options = all_options();
        vxm_voxelize_options how = VXM_VOXELIZE_OPTIONS_INIT;
        options.voxelize = &how;
        options.resolution = 24;
        how.mode = way < 3 ? (vxm_mode)way : VXM_MODE_SOLID;
        how.method = way == 3 ? VXM_METHOD_WINDING : way == 4 ? VXM_METHOD_TETRA : VXM_METHOD_VOTE;
        how.vote = way == 5 ? VXM_VOTE_MAJORITY : VXM_VOTE_AUTO;
        vxm_sampler *sampler = sampler_of(context, &options, mesh);
        bytes = 6 * vxm_sampler_bytes(sampler, VXM_VOXEL_FORMAT_UINT8);
        made[threads - 1] = make(sampler, 0, 6, VXM_VOXEL_FORMAT_UINT8);
        vxm_sampler_destroy(sampler);
        vxm_mesh_destroy(mesh);
        vxm_context_destroy(context);
      }
      if (memcmp(made[0], made[1], bytes) != 0 || !memchr(made[0], 1, bytes))
        fail_msg("%s, way %d: threads matter, or nothing is set", names[m], way);
      free(made[0]), free(made[1]);
    }
}

static int stop_at_once(const char *phase, double fraction, void *payload) {
  (void)phase, (void)fraction, (void)payload;
  return 1;
}

static void batches_can_be_cancelled(void **state) {
  (void)state;
  vxm_mesh *mesh = mesh_of_model(NULL, "torus");
  vxm_context_options limits = VXM_CONTEXT_OPTIONS_INIT;
  limits.threads = 2;
  limits.progress = stop_at_once;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, &limits, NULL), VXM_OK);
  vxm_sampler *sampler = sampler_of(context, NULL, mesh);
  uint8_t *out = malloc(4 * vxm_sampler_bytes(sampler, VXM_VOXEL_FORMAT_PACKED));
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(
      vxm_sampler_batch(out, sampler, (const vxm_variant[4]){{0, 0, 0}}, 4, VXM_VOXEL_FORMAT_PACKED, &error),
      VXM_ERROR_CANCELLED);
  free(out);
  vxm_sampler_destroy(sampler);
  vxm_context_destroy(context);
  vxm_mesh_destroy(mesh);
}

/** The bits of files are those in memory, whoever makes them; and what fails is told. */
static void files_hold_the_same(void **state) {
  (void)state;
  enum { FILES = 9 };
  vxm_sampler_options options = all_options();
  vxm_voxelize_options how = VXM_VOXELIZE_OPTIONS_INIT;
  options.voxelize = &how;
  vxm_engine *cpu;
  assert_int_equal(vxm_engine_create(&cpu, NULL, "cpu", NULL, NULL), VXM_OK);
  char folder[] = "/tmp/vxm-sampler.XXXXXX", names[FILES][64];
  const char *paths[FILES];
  vxm_variant variants[FILES];
  bool written[FILES];
  assert_non_null(mkdtemp(folder));
  for (int i = 0; i < FILES; i++) {
    snprintf(names[i], sizeof names[i], "%s/%d.rle", folder, i);
    paths[i] = names[i];
    variants[i] = (vxm_variant){0, 2, (uint32_t)i};
  }
  for (int threads = 1; threads <= 2; threads++) {
    vxm_context *context = context_of(threads);
    vxm_mesh *mesh = mesh_of_model(context, "l_prism");
    how.engine = threads == 1 ? cpu : NULL;
    vxm_sampler *sampler = sampler_of(context, &options, mesh);
    uint8_t *expected = make(sampler, 0, FILES, VXM_VOXEL_FORMAT_UINT8);
    assert_int_equal(vxm_sampler_files(paths, sampler, variants, FILES, NULL, written, NULL), VXM_OK);
    for (int i = 0; i < FILES; i++) {
      vxm_grid *grid;
      assert_true(written[i]);
      assert_int_equal(vxm_grid_read(&grid, context, paths[i], NULL), VXM_OK);
      const uint8_t *voxel = expected + (size_t)i * 32 * 32 * 32;
      for (int64_t x = 0; x < 32; x++)
        for (int64_t y = 0; y < 32; y++)
          for (int64_t z = 0; z < 32; z++)
            assert_int_equal(vxm_grid_get(grid, x, y, z), *voxel++);
      vxm_grid_destroy(grid);
      unlink(paths[i]);
    }
    paths[4] = "/no/such/folder/4.rle";
    assert_int_equal(vxm_sampler_files(paths, sampler, variants, FILES, NULL, written, NULL), VXM_ERROR_IO);
    assert_false(written[4]);
    paths[4] = names[4];
    for (int i = 0; i < FILES; i++)
      assert_int_equal(unlink(paths[i]) == 0, written[i]);
    vxm_grid_write_options wrong = VXM_GRID_WRITE_OPTIONS_INIT;
    wrong.size = 2;
    assert_int_equal(vxm_sampler_files(paths, sampler, variants, 1, &wrong, NULL, NULL), VXM_ERROR_ARGUMENT);
    assert_int_equal(vxm_sampler_files(NULL, sampler, variants, 1, NULL, NULL, NULL), VXM_ERROR_ARGUMENT);
    assert_int_equal(vxm_sampler_files((const char *[]){NULL}, sampler, variants, 1, NULL, NULL, NULL),
                     VXM_ERROR_ARGUMENT);
    free(expected);
    vxm_sampler_destroy(sampler);
    vxm_mesh_destroy(mesh);
    vxm_context_destroy(context);
  }
  assert_int_equal(rmdir(folder), 0);
  vxm_engine_destroy(cpu);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(same_bits_for_any_threads_and_order),
      cmocka_unit_test(each_part_of_the_name_matters),
      cmocka_unit_test(forms_agree),
      cmocka_unit_test(poses_tell_where_variants_lie),
      cmocka_unit_test(shares_are_those_of_finer_voxels),
      cmocka_unit_test(shares_are_the_coverage),
      cmocka_unit_test(shares_are_no_bits),
      cmocka_unit_test(closed_stays_closed),
      cmocka_unit_test(variants_fit_their_grid),
      cmocka_unit_test(mirrors_are_fair),
      cmocka_unit_test(models_come_and_go),
      cmocka_unit_test(wrong_arguments_are_refused),
      cmocka_unit_test(all_ways_to_voxelize_work),
      cmocka_unit_test(batches_can_be_cancelled),
      cmocka_unit_test(files_hold_the_same),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

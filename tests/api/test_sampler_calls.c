/* SPDX-License-Identifier: BSD-3-Clause */
/** Samplers as they are used: models come and go, what is refused, cancelling, and files. */
#include "sampler_test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

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
  static const double mirrored[18] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, 1};
  options.rotations = mirrored;
  options.rotation_count = 2;
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
      cmocka_unit_test(models_come_and_go),        cmocka_unit_test(wrong_arguments_are_refused),
      cmocka_unit_test(all_ways_to_voxelize_work), cmocka_unit_test(batches_can_be_cancelled),
      cmocka_unit_test(files_hold_the_same),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

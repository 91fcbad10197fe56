/* SPDX-License-Identifier: BSD-3-Clause */
/** Once a sampler has warmed up, no variant takes memory from the system. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "voxmend.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

static atomic_size_t taken;

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *block, size_t size);

void *__wrap_malloc(size_t size) {
  atomic_fetch_add(&taken, 1);
  return __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size) {
  atomic_fetch_add(&taken, 1);
  return __real_calloc(count, size);
}

void *__wrap_realloc(void *block, size_t size) {
  atomic_fetch_add(&taken, 1);
  return __real_realloc(block, size);
}

enum { AROUND = 32, ACROSS = 16, VERTICES = AROUND * ACROSS };

/** A torus, with its last `missing` quadrilaterals left out, and of the others every one of a `sieve`. */
static vxm_mesh *make_torus(vxm_context *context, int missing, int sieve) {
  static double at[VERTICES][3];
  static int64_t offsets[VERTICES + 1], corners[4 * VERTICES];
  int faces = 0;
  for (int u = 0; u < AROUND; u++)
    for (int v = 0; v < ACROSS; v++) {
      double a = u * 6.283185307179586 / AROUND, b = v * 6.283185307179586 / ACROSS, r = 2 + cos(b);
      int i = u * ACROSS + v, next_u = (u + 1) % AROUND, next_v = (v + 1) % ACROSS;
      at[i][0] = r * cos(a), at[i][1] = r * sin(a), at[i][2] = sin(b);
      if (i >= VERTICES - missing || (sieve > 0 && i % sieve == 0))
        continue;
      int64_t *corner = corners + (ptrdiff_t)4 * faces;
      corner[0] = i, corner[1] = next_u * ACROSS + v;
      corner[2] = next_u * ACROSS + next_v, corner[3] = u * ACROSS + next_v;
      faces++;
      offsets[faces] = 4 * (int64_t)faces;
    }
  vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
  arrays.vertices = at;
  arrays.vertex_count = VERTICES;
  arrays.offsets = offsets;
  arrays.indices = corners;
  arrays.index_count = offsets[faces];
  arrays.face_count = faces;
  vxm_mesh *mesh;
  assert_int_equal(vxm_mesh_create(&mesh, context, &arrays, NULL), VXM_OK);
  return mesh;
}

enum { BATCH = 8, RESOLUTION = 16 };

static void run(vxm_sampler *sampler, void *out, uint32_t first, vxm_voxel_format voxels) {
  vxm_variant variants[BATCH];
  for (uint32_t i = 0; i < BATCH; i++)
    variants[i] = (vxm_variant){i % 2, 3, first + i};
  assert_int_equal(vxm_sampler_batch(out, sampler, variants, BATCH, voxels, NULL), VXM_OK);
}

/** One variant of each model at a time, by all threads. */
static void run_together(vxm_sampler *sampler, vxm_grid *grid, uint32_t epoch) {
  for (uint32_t i = 0; i < 4; i++)
    assert_int_equal(vxm_sampler_grid(grid, sampler, &(vxm_variant){i % 2, epoch, i}, NULL), VXM_OK);
}

/** What the models by turns are, and how they are voxelized. */
typedef struct load {
  int threads;
  vxm_mode mode;
  vxm_surface_kind surface;
  vxm_method method;
  int missing, sieve; /**< of the second model; the first is closed */
  int warm;           /**< batches before memory is counted */
} load;

/** Whether the voters of a mesh disagree. */
static bool is_contested(const vxm_mesh *mesh) {
  vxm_grid *grid;
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  for (int a = 0; a < 3; a++)
    space_options.resolution[a] = RESOLUTION;
  assert_int_equal(vxm_voxelize(&grid, &report, mesh, &space_options, &options, NULL), VXM_OK);
  vxm_grid_destroy(grid);
  return report.contested > 0;
}

static bool takes_none_now(vxm_context *context, vxm_sampler *sampler, vxm_grid *grid, void *out) {
  size_t before = atomic_load(&taken);
  uint64_t peak = vxm_context_peak_bytes(context);
  for (uint32_t epoch = 100; epoch < 104; epoch++)
    for (int voxels = VXM_VOXEL_FORMAT_PACKED; voxels <= VXM_VOXEL_FORMAT_FLOAT32; voxels++)
      run(sampler, out, epoch * BATCH, (vxm_voxel_format)voxels);
  for (uint32_t epoch = 100; epoch < 104; epoch++)
    run_together(sampler, grid, epoch);
  return atomic_load(&taken) == before && vxm_context_peak_bytes(context) == peak;
}

static void takes_none(const load *given) {
  vxm_context_options limits = VXM_CONTEXT_OPTIONS_INIT;
  limits.threads = given->threads;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, &limits, NULL), VXM_OK);
  vxm_mesh *closed = make_torus(context, 0, 0), *holed = make_torus(context, given->missing, given->sieve);
  assert_int_equal(is_contested(holed), given->sieve > 0);
  vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT;
  vxm_voxelize_options how = VXM_VOXELIZE_OPTIONS_INIT;
  options.voxelize = &how;
  options.resolution = RESOLUTION;
  options.rotation = VXM_ROTATION_ANY;
  options.scale = 0.5;
  options.mirror = 7;
  options.translate = 1;
  options.displace = 0.02;
  options.displacement = VXM_DISPLACEMENT_NORMAL;
  how.mode = given->mode;
  how.surface = given->surface;
  how.method = given->method;
  vxm_sampler *sampler;
  assert_int_equal(vxm_sampler_create(&sampler, context, &options, NULL), VXM_OK);
  assert_int_equal(vxm_sampler_put(sampler, 0, closed, NULL), VXM_OK);
  assert_int_equal(vxm_sampler_put(sampler, 1, holed, NULL), VXM_OK);
  void *out = malloc(BATCH * vxm_sampler_bytes(sampler, VXM_VOXEL_FORMAT_FLOAT32));
  assert_non_null(out);
  vxm_grid *grid;
  vxm_space space = vxm_sampler_space(sampler);
  assert_int_equal(vxm_grid_create(&grid, context, &space, NULL), VXM_OK);
  for (uint32_t epoch = 0; epoch < (uint32_t)given->warm; epoch++) {
    run(sampler, out, epoch * BATCH, VXM_VOXEL_FORMAT_FLOAT32);
    run_together(sampler, grid, epoch);
  }
  bool none = false;
  for (int tries = given->threads == 1 ? 1 : 8; tries > 0 && !none; tries--)
    none = takes_none_now(context, sampler, grid, out);
  assert_true(none);
  free(out);
  vxm_grid_destroy(grid);
  vxm_sampler_destroy(sampler);
  vxm_mesh_destroy(closed);
  vxm_mesh_destroy(holed);
  vxm_context_destroy(context);
}

static void solids_take_no_memory(void **state) {
  (void)state;
  takes_none(&(load){.threads = 1, .missing = 1, .warm = 24});
  /* which thread has what is a matter of chance, more so where other work goes on: each must have seen
     enough, sooner or later */
  takes_none(&(load){.threads = 2, .missing = 1, .warm = 24});
}

static void contested_solids_take_no_memory(void **state) {
  (void)state;
  takes_none(&(load){.threads = 1, .missing = 100, .sieve = 2, .warm = 24});
  takes_none(&(load){.threads = 2, .missing = 100, .sieve = 2, .warm = 40});
}

static void surfaces_take_no_memory(void **state) {
  (void)state;
  takes_none(&(load){
      .threads = 1, .mode = VXM_MODE_SURFACE, .surface = VXM_SURFACE_SHELL6, .missing = 1, .warm = 24});
  /* how many rows triangles meet, and where they are thin, is a matter of how they lie */
  takes_none(&(load){.threads = 1, .mode = VXM_MODE_BOTH, .missing = 1, .warm = 24});
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(solids_take_no_memory),
      cmocka_unit_test(contested_solids_take_no_memory),
      cmocka_unit_test(surfaces_take_no_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

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

enum { AROUND = 48, ACROSS = 24, VERTICES = AROUND * ACROSS };

/** A torus, with its last `missing` quadrilaterals left out. */
static vxm_mesh *make_torus(vxm_context *context, int missing) {
  static double at[VERTICES][3];
  static int64_t offsets[VERTICES + 1], corners[4 * VERTICES];
  for (int u = 0; u < AROUND; u++)
    for (int v = 0; v < ACROSS; v++) {
      double a = u * 6.283185307179586 / AROUND, b = v * 6.283185307179586 / ACROSS, r = 2 + cos(b);
      int i = u * ACROSS + v, next_u = (u + 1) % AROUND, next_v = (v + 1) % ACROSS;
      at[i][0] = r * cos(a), at[i][1] = r * sin(a), at[i][2] = sin(b);
      offsets[i] = 4 * (int64_t)i;
      corners[4 * i] = i, corners[4 * i + 1] = next_u * ACROSS + v;
      corners[4 * i + 2] = next_u * ACROSS + next_v, corners[4 * i + 3] = u * ACROSS + next_v;
    }
  offsets[VERTICES] = 4 * VERTICES;
  vxm_mesh_arrays arrays = VXM_MESH_ARRAYS_INIT;
  arrays.vertices = at;
  arrays.vertex_count = VERTICES;
  arrays.offsets = offsets;
  arrays.indices = corners;
  arrays.face_count = VERTICES - missing;
  vxm_mesh *mesh;
  assert_int_equal(vxm_mesh_create(&mesh, context, &arrays, NULL), VXM_OK);
  return mesh;
}

enum { BATCH = 24, RESOLUTION = 40 };

static void run(vxm_sampler *sampler, void *out, uint32_t first, vxm_voxels voxels) {
  vxm_variant variants[BATCH];
  for (uint32_t i = 0; i < BATCH; i++)
    variants[i] = (vxm_variant){i % 2, 3, first + i};
  assert_int_equal(vxm_sampler_batch(out, sampler, variants, BATCH, voxels, NULL), VXM_OK);
}

/** Two models by turns: one closed, one closed by a cap. */
static void takes_none(int threads, vxm_mode mode, vxm_surface_kind surface, bool warm_only_once) {
  vxm_context_options limits = VXM_CONTEXT_OPTIONS_INIT;
  limits.threads = threads;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, &limits, NULL), VXM_OK);
  vxm_mesh *closed = make_torus(context, 0), *holed = make_torus(context, 1);
  vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT;
  options.resolution = RESOLUTION;
  options.rotation = VXM_ROTATION_ANY;
  options.scale = 0.5;
  options.mirror = 7;
  options.translate = 1;
  options.displace = 0.02;
  options.displacement = VXM_DISPLACEMENT_NORMAL;
  options.voxelize.mode = mode;
  options.voxelize.surface = surface;
  vxm_sampler *sampler;
  assert_int_equal(vxm_sampler_create(&sampler, context, &options, NULL), VXM_OK);
  assert_int_equal(vxm_sampler_put(sampler, 0, closed, NULL), VXM_OK);
  assert_int_equal(vxm_sampler_put(sampler, 1, holed, NULL), VXM_OK);
  void *out = malloc(BATCH * vxm_sampler_bytes(sampler, VXM_VOXELS_FLOAT32));
  assert_non_null(out);
  for (uint32_t epoch = 0; epoch < (warm_only_once ? 2 : 8); epoch++)
    run(sampler, out, epoch * BATCH, VXM_VOXELS_FLOAT32);
  size_t before = atomic_load(&taken);
  uint64_t peak = vxm_context_peak_bytes(context);
  for (uint32_t epoch = 100; epoch < 110; epoch++)
    for (int voxels = VXM_VOXELS_PACKED; voxels <= VXM_VOXELS_FLOAT32; voxels++)
      run(sampler, out, epoch * BATCH, (vxm_voxels)voxels);
  assert_int_equal(atomic_load(&taken), before);
  assert_int_equal(vxm_context_peak_bytes(context), peak);
  free(out);
  vxm_sampler_destroy(sampler);
  vxm_mesh_destroy(closed);
  vxm_mesh_destroy(holed);
  vxm_context_destroy(context);
}

static void solids_take_no_memory(void **state) {
  (void)state;
  takes_none(1, VXM_MODE_SOLID, VXM_SURFACE_CONSERVATIVE, true);
  /* which thread has what is a matter of chance: each must have seen enough */
  takes_none(2, VXM_MODE_SOLID, VXM_SURFACE_CONSERVATIVE, false);
}

static void shells_take_no_memory(void **state) {
  (void)state;
  takes_none(1, VXM_MODE_SURFACE, VXM_SURFACE_SHELL6, true);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(solids_take_no_memory),
      cmocka_unit_test(shells_take_no_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

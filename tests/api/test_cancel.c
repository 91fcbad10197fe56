/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Long work ended at each of its questions whether to go on: nothing is left over, nothing is made, and what
 * was at work makes the same afterwards as if nothing had been. The contexts ask at every question rather
 * than now and then.
 */
#include "api_support.h"

#include "base/context_struct.h"

#include <stdio.h>
#include <stdlib.h>

/* Sanitizers take ten times as long. */
#ifdef __SANITIZE_ADDRESS__
enum { FEWER = 6 };
#else
enum { FEWER = 1 };
#endif

typedef struct countdown {
  long calls, stop_at; /**< 0 = never */
} countdown;

static int count_down(const char *phase, double fraction, void *payload) {
  (void)phase, (void)fraction;
  countdown *c = payload;
  c->calls++;
  return c->stop_at > 0 && c->calls >= c->stop_at;
}

static vxm_context *new_context(int threads, countdown *c) {
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.threads = threads;
  options.progress = count_down;
  options.payload = c;
  vxm_context *context = NULL;
  assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
  context->ask_ms = 0;
  return context;
}

/** A call that is made again and again; its result as a number. */
typedef vxm_status (*call_fn)(void *payload, uint64_t *result, vxm_error *error);

/** Ends the call at each of its questions, of many at some (with VOXMEND_LONG at more of them), and makes it
 * whole now and then in between. */
static void end_everywhere(countdown *c, call_fn call, void *payload, const char *name) {
  uint64_t whole = 0, result = 0;
  vxm_error error = VXM_ERROR_INIT;
  *c = (countdown){0};
  if (call(payload, &whole, &error) != VXM_OK)
    fail_msg("%s: %s", name, error.text);
  long all = c->calls;
  assert_true(all > 0);
  for (long at = 1; at <= all; at += 1 + (getenv("VOXMEND_LONG") ? at / 64 : at / 2 * FEWER)) {
    *c = (countdown){.stop_at = at};
    error = (vxm_error)VXM_ERROR_INIT;
    vxm_status status = call(payload, &result, &error);
    if (status == VXM_OK && c->calls < at)
      continue; /* with several threads questions are not always as many */
    if (status != VXM_ERROR_CANCELLED || error.code != status)
      fail_msg("%s: question %ld of %ld is not heard: %s", name, at, all, vxm_status_name(status));
    if (c->calls > at + 2)
      fail_msg("%s: asked %ld times more after question %ld of %ld", name, c->calls - at, at, all);
    *c = (countdown){0};
    assert_int_equal(call(payload, &result, &error), VXM_OK);
    if (result != whole)
      fail_msg("%s: another result after it was ended at question %ld of %ld", name, at, all);
  }
}

/* ---- Meshes ---- */

typedef struct mesh_calls {
  vxm_context *context;
  vxm_mesh *mesh;
  vxm_repair_options options;
} mesh_calls;

static uint64_t sum_of(const vxm_mesh *mesh) {
  uint64_t sum = (uint64_t)vxm_mesh_vertex_count(mesh);
  const uint64_t *offsets = vxm_mesh_offsets(mesh);
  for (uint64_t c = 0; c < offsets[vxm_mesh_face_count(mesh)]; c++)
    sum = sum * 31 + vxm_mesh_indices(mesh)[c];
  return sum;
}

static vxm_status census(void *payload, uint64_t *result, vxm_error *error) {
  vxm_census found = VXM_CENSUS_INIT;
  vxm_status status = vxm_mesh_census(&found, ((mesh_calls *)payload)->mesh, error);
  *result = (uint64_t)found.boundary_edges * 1000 + (uint64_t)found.components;
  return status;
}

static vxm_status defects(void *payload, uint64_t *result, vxm_error *error) {
  vxm_defects *found = NULL;
  vxm_status status = vxm_mesh_defects(&found, ((mesh_calls *)payload)->mesh, 0, false, error);
  assert_true((status == VXM_OK) == (found != NULL));
  *result = found ? (uint64_t)vxm_defects_count(found) : 0;
  vxm_defects_destroy(found);
  return status;
}

static vxm_status repair(void *payload, uint64_t *result, vxm_error *error) {
  const mesh_calls *calls = payload;
  vxm_mesh *made = NULL;
  vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
  vxm_status status = vxm_mesh_prepare(&made, &report, calls->mesh, &calls->options, error);
  assert_true((status == VXM_OK) == (made != NULL));
  *result = made ? sum_of(made) : 0;
  vxm_mesh_destroy(made);
  return status;
}

static vxm_status verify(void *payload, uint64_t *result, vxm_error *error) {
  const mesh_calls *calls = payload;
  vxm_verification found = VXM_VERIFICATION_INIT;
  vxm_status status = vxm_mesh_verify(&found, calls->mesh, &calls->options, error);
  *result = (uint64_t)found.reached * 100 + (uint64_t)found.count;
  return status;
}

static vxm_status write_stl(void *payload, uint64_t *result, vxm_error *error) {
  vxm_mesh_write_options options = VXM_MESH_WRITE_OPTIONS_INIT;
  options.format = "stl";
  *result = 0;
  return vxm_mesh_write(((mesh_calls *)payload)->mesh, "/dev/null", &options, error);
}

static void test_meshes(void **state) {
  (void)state;
  static const char *const names[] = {"missing", "doubled", "cracks", "inner_sheet", "vertex_cubes"};
  for (int threads = 1; threads <= 3; threads += 2)
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
      countdown c = {0};
      vxm_context *context = new_context(threads, &c);
      mesh_calls calls = {context, mesh_of_model(context, names[i]), VXM_REPAIR_OPTIONS_INIT};
      end_everywhere(&c, census, &calls, "census");
      end_everywhere(&c, defects, &calls, "defects");
      end_everywhere(&c, repair, &calls, "repair");
      calls.options.level = VXM_LEVEL_CLOSED;
      calls.options.part_changes = true;
      end_everywhere(&c, repair, &calls, "repair to closed");
      end_everywhere(&c, verify, &calls, "verify");
      end_everywhere(&c, write_stl, &calls, "write");
      vxm_mesh_destroy(calls.mesh);
      assert_int_equal(atomic_load(&context->used), 0);
      vxm_context_destroy(context);
    }
}

/* ---- Models: what they hold is used again ---- */

typedef struct model_calls {
  vxm_model *model;
  vxm_grid *grid;
  float *values;
} model_calls;

static vxm_status fill_grid(void *payload, uint64_t *result, vxm_error *error) {
  const model_calls *calls = payload;
  vxm_status status = vxm_model_voxelize(calls->grid, NULL, calls->model, NULL, error);
  *result = vxm_grid_hash(calls->grid);
  return status;
}

static uint64_t sum_values(const model_calls *calls) {
  const int64_t *dims = vxm_grid_space(calls->grid)->dims;
  uint64_t sum = 0;
  for (int64_t v = 0; v < dims[0] * dims[1] * dims[2]; v++)
    sum = sum * 31 + (uint64_t)(int64_t)(calls->values[v] * 1e6f);
  return sum;
}

static vxm_status distance(void *payload, uint64_t *result, vxm_error *error) {
  const model_calls *calls = payload;
  vxm_status status =
      vxm_model_distance(calls->values, NULL, calls->model, vxm_grid_space(calls->grid), NULL, error);
  *result = sum_values(calls);
  return status;
}

static vxm_status coverage(void *payload, uint64_t *result, vxm_error *error) {
  const model_calls *calls = payload;
  vxm_status status =
      vxm_model_coverage(calls->values, NULL, calls->model, vxm_grid_space(calls->grid), NULL, error);
  *result = sum_values(calls);
  return status;
}

static vxm_status octree(void *payload, uint64_t *result, vxm_error *error) {
  const model_calls *calls = payload;
  vxm_sparse *made = NULL;
  vxm_status status = vxm_model_sparse(&made, NULL, calls->model, vxm_grid_space(calls->grid), NULL, error);
  assert_true((status == VXM_OK) == (made != NULL));
  *result = made ? vxm_sparse_hash(made) : 0;
  vxm_sparse_destroy(made);
  return status;
}

static vxm_status unpack(void *payload, uint64_t *result, vxm_error *error) {
  const model_calls *calls = payload;
  *result = 0;
  return vxm_grid_unpack_range(calls->grid, 0, vxm_grid_space(calls->grid)->dims[0], (uint8_t *)calls->values,
                               error);
}

static void end_calls_of_model(countdown *c, const vxm_mesh *mesh, const vxm_voxelize_options *options,
                               const vxm_space *space, vxm_context *context) {
  size_t voxels = (size_t)(space->dims[0] * space->dims[1] * space->dims[2]);
  model_calls calls = {.values = malloc(voxels * sizeof *calls.values)};
  *c = (countdown){0};
  assert_int_equal(vxm_grid_create(&calls.grid, context, space, NULL), VXM_OK);
  assert_int_equal(vxm_model_create(&calls.model, mesh, options, NULL), VXM_OK);
  end_everywhere(c, fill_grid, &calls, "voxelize");
  end_everywhere(c, unpack, &calls, "unpack");
  if (!options->confidence)
    end_everywhere(c, octree, &calls, "octree");
  end_everywhere(c, coverage, &calls, "coverage");
  if (options->mode == VXM_MODE_SOLID)
    end_everywhere(c, distance, &calls, "distance");
  vxm_model_destroy(calls.model);
  vxm_grid_destroy(calls.grid);
  free(calls.values);
}

static void test_models(void **state) {
  (void)state;
  static const vxm_voxelize_options initial = VXM_VOXELIZE_OPTIONS_INIT;
  static const char *const names[] = {"missing", "cavity"};
  for (int threads = 1; threads <= 3; threads += 2)
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
      for (int way = 0; way < 5; way++) {
        countdown c = {0};
        vxm_context *context = new_context(threads, &c);
        vxm_mesh *mesh = mesh_of_model(context, names[i]);
        vxm_voxelize_options options = initial;
        vxm_space space;
        vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
        space_options.resolution[0] = 24;
        assert_int_equal(vxm_space_fit(&space, mesh, &space_options, NULL), VXM_OK);
        options.method = way == 1 ? VXM_METHOD_TETRA : way == 2 ? VXM_METHOD_WINDING : VXM_METHOD_VOTE;
        options.mode = way == 3 ? VXM_MODE_BOTH : VXM_MODE_SOLID;
        options.confidence = way == 4;
        end_calls_of_model(&c, mesh, &options, &space, context);
        vxm_mesh_destroy(mesh);
        assert_int_equal(atomic_load(&context->used), 0);
        vxm_context_destroy(context);
      }
}

/* ---- Samplers ---- */

static vxm_status batch(void *payload, uint64_t *result, vxm_error *error) {
  vxm_sampler *sampler = payload;
  vxm_variant variants[6];
  for (uint32_t i = 0; i < 6; i++)
    variants[i] = (vxm_variant){0, 0, i};
  size_t size = 6 * vxm_sampler_bytes(sampler, VXM_VOXEL_FORMAT_PACKED);
  uint8_t *made = malloc(size);
  vxm_status status = vxm_sampler_batch(made, sampler, variants, 6, VXM_VOXEL_FORMAT_PACKED, error);
  *result = 0;
  for (size_t i = 0; status == VXM_OK && i < size; i++)
    *result = *result * 31 + made[i];
  free(made);
  return status;
}

static void test_samplers(void **state) {
  (void)state;
  for (int threads = 1; threads <= 3; threads += 2) {
    countdown c = {0};
    vxm_context *context = new_context(threads, &c);
    vxm_mesh *mesh = mesh_of_model(context, "missing");
    vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT;
    options.resolution = 24;
    options.rotation = VXM_ROTATION_ANY;
    options.displace = 0.02;
    vxm_sampler *sampler = NULL;
    assert_int_equal(vxm_sampler_create(&sampler, context, &options, NULL), VXM_OK);
    assert_int_equal(vxm_sampler_put(sampler, 0, mesh, NULL), VXM_OK);
    end_everywhere(&c, batch, sampler, "batch");
    vxm_sampler_destroy(sampler);
    vxm_mesh_destroy(mesh);
    vxm_context_destroy(context);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_meshes),
      cmocka_unit_test(test_models),
      cmocka_unit_test(test_samplers),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

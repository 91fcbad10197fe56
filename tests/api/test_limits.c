/* SPDX-License-Identifier: BSD-3-Clause */
/** Contexts: memory limits that hold, cancelling at every point, lifetimes, and two threads in one context.
 */
#include "api_support.h"

#include <ftw.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* ---- A run through everything ---- */

/** The soup as OFF text, to be read from memory. */
static char *off_text(size_t *size) {
  shape made = find_model("missing")->make();
  char *text = NULL;
  FILE *file = open_memstream(&text, size);
  assert_non_null(file);
  fprintf(file, "OFF\n%zu %zu 0\n", made.vertex_count, made.face_count);
  for (size_t v = 0; v < made.vertex_count; v++)
    fprintf(file, "%.17g %.17g %.17g\n", made.positions[3 * v], made.positions[3 * v + 1],
            made.positions[3 * v + 2]);
  for (size_t f = 0; f < made.face_count; f++) {
    const int64_t *c = made.indices + made.offsets[f];
    fprintf(file, "3 %lld %lld %lld\n", (long long)c[0], (long long)c[1], (long long)c[2]);
  }
  assert_int_equal(fclose(file), 0);
  shape_free(&made);
  return text;
}

static vxm_status write_all(const vxm_grid *grid, vxm_error *error) {
  static const char *const formats[] = {"binvox", "npy", "rle", "obj", "ply", "stl", "off"};
  vxm_status status = VXM_OK;
  for (size_t i = 0; i < sizeof formats / sizeof formats[0] && status == VXM_OK; i++) {
    vxm_grid_write_options options = VXM_GRID_WRITE_OPTIONS_INIT;
    options.format = formats[i];
    status = vxm_grid_write(grid, "/dev/null", &options, error);
  }
  if (status == VXM_OK) {
    vxm_picture_options picture = VXM_PICTURE_OPTIONS_INIT;
    picture.width = picture.height = 64;
    status = vxm_grid_picture(grid, "/dev/null", &picture, error);
  }
  return status == VXM_ERROR_UNAVAILABLE ? VXM_OK : status;
}

/** Reads, counts, repairs, voxelizes and writes; nothing is left but the status. */
static vxm_status run_everything(vxm_context *context, const char *text, size_t size, uint64_t *hash,
                                 vxm_error *error) {
  vxm_mesh *mesh = NULL, *repaired = NULL;
  vxm_grid *grid = NULL;
  vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
  vxm_mesh_write_options mesh_options = VXM_MESH_WRITE_OPTIONS_INIT;
  mesh_options.format = "ply";
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.resolution[0] = 48;
  vxm_status status = vxm_mesh_read_memory(&mesh, context, text, size, "memory.off", error);
  assert_true((status == VXM_OK) == (mesh != NULL));
  if (status == VXM_OK)
    status = vxm_mesh_repair(&repaired, &report, mesh, NULL, error);
  assert_true((status == VXM_OK) == (repaired != NULL));
  if (status == VXM_OK)
    status = vxm_mesh_write(repaired, "/dev/null", &mesh_options, error);
  if (status == VXM_OK)
    status = vxm_voxelize(&grid, NULL, repaired, &space_options, &options, error);
  if (status == VXM_OK) {
    *hash = vxm_grid_hash(grid);
    status = write_all(grid, error);
  } else
    assert_null(grid);
  vxm_grid_destroy(grid);
  vxm_mesh_destroy(repaired);
  vxm_mesh_destroy(mesh);
  return status;
}

/* ---- Memory ---- */

static void test_memory_limit(void **state) {
  (void)state;
  size_t size;
  char *text = off_text(&size);
  uint64_t hash = 0, free_hash = 0;
  assert_int_equal(run_everything(NULL, text, size, &free_hash, NULL), VXM_OK);
  vxm_status status = VXM_ERROR_MEMORY_LIMIT;
  int refused = 0;
  for (uint64_t limit = 4096; status != VXM_OK; limit += limit / 4) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.memory_limit = limit;
    options.threads = 2;
    vxm_context *context;
    vxm_error error = VXM_ERROR_INIT;
    assert_int_equal(vxm_context_create(&context, &options, &error), VXM_OK);
    status = run_everything(context, text, size, &hash, &error);
    if (status != VXM_OK) {
      assert_int_equal(status, VXM_ERROR_MEMORY_LIMIT);
      assert_int_equal(error.code, VXM_ERROR_MEMORY_LIMIT);
      refused++;
    }
    assert_true(vxm_context_peak_bytes(context) <= limit);
    vxm_context_destroy(context);
  }
  assert_true(refused > 5);
  assert_true(hash == free_hash);
  free(text);
}

static int remove_entry(const char *path, const struct stat *info, int type, struct FTW *where) {
  (void)info;
  (void)type;
  (void)where;
  return remove(path);
}

/** Writes labels within a limit; what is returned is what the error has. */
static vxm_status write_within(uint64_t limit, const char *path) {
  static const uint16_t values[64] = {1, 0, 2, 0, 3, 1};
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.memory_limit = limit;
  options.threads = 1;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
  vxm_space space = {.dims = {4, 4, 4}, .voxel_size = {1, 1, 1}};
  vxm_field *field = NULL;
  vxm_error error = VXM_ERROR_INIT;
  vxm_status status = vxm_field_create(&field, context, &space, VXM_FIELD_LABELS, VXM_UINT16, values, &error);
  if (status == VXM_OK)
    status = vxm_field_write(field, path, NULL, &error);
  if (status != VXM_OK)
    assert_int_equal(error.code, status);
  vxm_field_destroy(field);
  vxm_context_destroy(context);
  return status;
}

/** Whatever allocation of a format is the one that does not fit any more. */
static void test_limits_of_formats(void **state) {
  (void)state;
  static const char *const names[] = {"x.nrrd", "x.npy",    "x.zarr",   "x.h5",    "x.nii",   "x.nii.gz",
                                      "x.tif",  "x.vti",    "x.vtk",    "x.vox",   "x.schem", "x.litematic",
                                      "x.glb",  "x.binvox", "x.octree", "x_%d.png"};
  enum { STEP = 128 /* as the least block takes */ };
  char folder[] = "limits-test-XXXXXX", path[64];
  assert_non_null(mkdtemp(folder));
  for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
    snprintf(path, sizeof path, "%s/%s", folder, names[n]);
    vxm_status status = VXM_ERROR_MEMORY_LIMIT;
    for (uint64_t limit = 1024; status == VXM_ERROR_MEMORY_LIMIT; limit += STEP)
      status = write_within(limit, path);
    if (status != VXM_OK && status != VXM_ERROR_UNAVAILABLE)
      fail_msg("%s: %s", names[n], vxm_status_name(status));
  }
  assert_int_equal(nftw(folder, remove_entry, 8, FTW_DEPTH | FTW_PHYS), 0);
}

/** A grid that cannot fit is refused before anything is allocated for it. */
static void test_huge_grid(void **state) {
  (void)state;
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.memory_limit = 1 << 20;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
  vxm_mesh *mesh = mesh_of_model(context, "cube");
  uint64_t before = vxm_context_peak_bytes(context);
  vxm_voxelize_options huge = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.resolution[0] = 4096;
  vxm_grid *grid = NULL;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_voxelize(&grid, NULL, mesh, &space_options, &huge, &error), VXM_ERROR_MEMORY_LIMIT);
  assert_null(grid);
  assert_true(vxm_context_peak_bytes(context) < before + (1 << 16));
  vxm_mesh_destroy(mesh);
  vxm_context_destroy(context);
}

/* ---- Cancelling ---- */

typedef struct countdown {
  long calls, cancel_at;
  pthread_t thread;
  bool foreign;   /**< called from another thread */
  bool bad_value; /**< a fraction outside 0..1, or no phase */
} countdown;

static int count_down(const char *phase, double fraction, void *payload) {
  countdown *seen = payload;
  seen->calls++;
  seen->foreign |= !pthread_equal(seen->thread, pthread_self());
  seen->bad_value |= !phase || !*phase || !(fraction >= 0 && fraction <= 1);
  return seen->calls == seen->cancel_at;
}

static void test_cancelling(void **state) {
  (void)state;
  size_t size;
  char *text = off_text(&size);
  vxm_status status = VXM_ERROR_CANCELLED;
  long tries = 0;
  for (long at = 1; status != VXM_OK; at += 1 + at / 16) {
    countdown seen = {.cancel_at = at, .thread = pthread_self()};
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = 2;
    options.progress = count_down;
    options.payload = &seen;
    vxm_context *context;
    vxm_error error = VXM_ERROR_INIT;
    uint64_t hash;
    assert_int_equal(vxm_context_create(&context, &options, &error), VXM_OK);
    status = run_everything(context, text, size, &hash, &error);
    vxm_context_destroy(context);
    assert_false(seen.foreign);
    assert_false(seen.bad_value);
    if (status != VXM_OK) {
      assert_int_equal(status, VXM_ERROR_CANCELLED);
      assert_int_equal(error.code, VXM_ERROR_CANCELLED);
      assert_int_equal(seen.calls, at); /* not asked again */
    }
    tries++;
  }
  assert_true(tries > 5);
  free(text);
}

/* ---- Lifetimes and threads ---- */

/** Objects keep what they need: the context may go first, and the mesh before its grid. */
static void test_lifetimes(void **state) {
  (void)state;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, NULL, NULL), VXM_OK);
  vxm_mesh *mesh = mesh_of_model(context, "torus"), *repaired = NULL, *surface = NULL;
  vxm_context_destroy(context);
  assert_int_equal(vxm_mesh_repair(&repaired, NULL, mesh, NULL, NULL), VXM_OK);
  vxm_mesh_destroy(mesh);
  vxm_grid *grid = NULL;
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.resolution[0] = 16;
  assert_int_equal(vxm_voxelize(&grid, NULL, repaired, &space_options, &options, NULL), VXM_OK);
  vxm_mesh_destroy(repaired);
  assert_int_equal(vxm_grid_surface_mesh(&surface, grid, NULL), VXM_OK);
  vxm_grid_destroy(grid);
  vxm_census census = VXM_CENSUS_INIT;
  assert_int_equal(vxm_mesh_census(&census, surface, NULL), VXM_OK);
  assert_true(census.closed);
  vxm_mesh_destroy(surface);
}

typedef struct job {
  vxm_context *context;
  const char *model;
  uint64_t hash;
} job;

static void *voxelize_job(void *argument) {
  job *work = argument;
  vxm_mesh *mesh = mesh_of_model(work->context, work->model);
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.resolution[0] = 48;
  vxm_grid *grid = NULL;
  if (vxm_voxelize(&grid, NULL, mesh, &space_options, &options, NULL) == VXM_OK)
    work->hash = vxm_grid_hash(grid);
  vxm_grid_destroy(grid);
  vxm_mesh_destroy(mesh);
  return NULL;
}

static void test_two_threads(void **state) {
  (void)state;
  job alone[2] = {{NULL, "sphere", 0}, {NULL, "overlapping", 0}};
  for (int i = 0; i < 2; i++)
    voxelize_job(&alone[i]);
  for (int round = 0; round < 20; round++) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = 1 + round % 3;
    vxm_context *context;
    assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
    job together[2] = {{context, "sphere", 0}, {context, "overlapping", 0}};
    pthread_t threads[2];
    for (int i = 0; i < 2; i++)
      assert_int_equal(pthread_create(&threads[i], NULL, voxelize_job, &together[i]), 0);
    for (int i = 0; i < 2; i++) {
      pthread_join(threads[i], NULL);
      assert_true(together[i].hash == alone[i].hash);
    }
    vxm_context_destroy(context);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_memory_limit), cmocka_unit_test(test_limits_of_formats),
      cmocka_unit_test(test_huge_grid),    cmocka_unit_test(test_cancelling),
      cmocka_unit_test(test_lifetimes),    cmocka_unit_test(test_two_threads),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

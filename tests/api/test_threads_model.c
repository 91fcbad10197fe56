/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Several threads at once make grids, octrees, fields, labels and colours of one model: other resolutions,
 * transforms and outputs at the same time. Each finds what one thread alone finds, to the bit, and reads
 * warnings and labels of its own. Worth most in a build with -fsanitize=thread.
 */
#include "api_support.h"

#include <pthread.h>
#include <stdlib.h>

enum { THREADS = 4, RESOLUTIONS = 3 };
static const int64_t resolutions[RESOLUTIONS] = {9, 14, 20};

typedef enum task { GRID, TURNED_GRID, OCTREE, COVERAGE, DISTANCE, LABELS, COLORS, ESTIMATE, TASKS } task;
enum { JOBS = TASKS * RESOLUTIONS };

/** What a job comes to: numbers that differ if anything does. */
typedef struct outcome {
  vxm_status status;
  uint64_t content;
  int64_t voxels, contested, winding_decided, empty_parts, warnings;
} outcome;

static uint64_t hash_bytes(uint64_t hash, const void *bytes, size_t count) {
  const unsigned char *b = bytes;
  for (size_t i = 0; i < count; i++)
    hash = (hash ^ b[i]) * UINT64_C(1099511628211);
  return hash;
}

static void take_report(outcome *out, const vxm_voxelize_report *report) {
  out->voxels = report->voxels;
  out->contested = report->contested;
  out->winding_decided = report->winding_decided;
  out->empty_parts = report->empty_parts;
  out->content = hash_bytes(out->content, &report->hash, sizeof report->hash);
}

static void take_warnings(outcome *out, const vxm_model *of) {
  out->warnings = vxm_model_warning_count(of);
  for (int64_t i = 0; i < out->warnings; i++) {
    const char *text = vxm_model_warning(of, i);
    out->content = hash_bytes(out->content, text, strlen(text));
  }
}

static void take_labels(outcome *out, const vxm_model *of) {
  for (int64_t l = 1; l <= vxm_model_label_count(of); l++) {
    const char *name = vxm_model_label_name(of, l);
    int64_t voxels = vxm_model_label_voxels(of, l);
    out->content = hash_bytes(out->content, name, strlen(name));
    out->content = hash_bytes(out->content, &voxels, sizeof voxels);
  }
}

/* ---- Jobs ---- */

static vxm_space space_of(int64_t resolution) {
  double size = 3.0 / (double)resolution;
  return (vxm_space){{resolution, resolution - 1, resolution + 2}, {-1.5, -1.5, -1.5}, {size, size, size}};
}

static void do_grid(outcome *out, vxm_model *of, const vxm_space *space, const double transform[12]) {
  vxm_grid *grid = NULL;
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  out->status = vxm_grid_create(&grid, NULL, space, NULL);
  if (out->status == VXM_OK)
    out->status = vxm_model_voxelize(grid, &report, of, transform, NULL);
  if (out->status == VXM_OK) {
    take_report(out, &report);
    out->content += vxm_grid_hash(grid);
  }
  vxm_grid_destroy(grid);
}

static void do_octree(outcome *out, vxm_model *of, const vxm_space *space) {
  vxm_sparse *sparse = NULL;
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  out->status = vxm_model_sparse(&sparse, &report, of, space, NULL, NULL);
  if (out->status == VXM_OK) {
    take_report(out, &report);
    out->content += vxm_sparse_hash(sparse);
  }
  vxm_sparse_destroy(sparse);
}

/** Into an array of four bytes a voxel, or less. */
static void do_values(outcome *out, task what, vxm_model *of, const vxm_space *space) {
  size_t voxels = (size_t)(space->dims[0] * space->dims[1] * space->dims[2]);
  void *values = calloc(voxels, 4);
  vxm_coverage_options halves = VXM_COVERAGE_OPTIONS_INIT;
  halves.subdivision = 2;
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  vxm_coverage_report coverage = {.voxelize = &report};
  vxm_distance_options distances = VXM_DISTANCE_OPTIONS_INIT;
  vxm_distance_report distance = {.voxelize = &report};
  vxm_label_report labels = {.voxelize = &report};
  if (what == COVERAGE)
    out->status = vxm_model_coverage(values, &coverage, of, space, &halves, NULL);
  else if (what == DISTANCE)
    out->status = vxm_model_distance(values, &distance, of, space, &distances, NULL);
  else if (what == LABELS)
    out->status = vxm_model_labels(values, &labels, of, space, NULL, NULL);
  else
    out->status = vxm_model_colors(values, &report, of, space, NULL, NULL);
  if (out->status == VXM_OK) {
    take_report(out, &report);
    out->content = hash_bytes(out->content, values, 4 * voxels);
  }
  if (out->status == VXM_OK && what == LABELS)
    take_labels(out, of);
  free(values);
}

static outcome do_job(int job, vxm_model *of) {
  static const double turn[12] = {0.6, -0.8, 0, 0.1, 0.8, 0.6, 0, -0.05, 0, 0, -1.1, 0.02};
  outcome out = {.content = UINT64_C(14695981039346656037)};
  vxm_space space = space_of(resolutions[job % RESOLUTIONS]);
  task what = (task)(job / RESOLUTIONS);
  vxm_estimate estimate = VXM_ESTIMATE_INIT;
  switch (what) {
  case GRID:
  case TURNED_GRID:
    do_grid(&out, of, &space, what == GRID ? NULL : turn);
    break;
  case OCTREE:
    do_octree(&out, of, &space);
    break;
  case ESTIMATE:
    out.status = vxm_model_estimate(&estimate, of, &space, "x.rle", NULL, NULL);
    out.voxels = out.status == VXM_OK ? estimate.passes : 0;
    return out;
  default:
    do_values(&out, what, of, &space);
  }
  if (out.status == VXM_OK) /* else they are of the job before */
    take_warnings(&out, of);
  return out;
}

/* ---- Threads ---- */

typedef struct worker {
  pthread_t thread;
  pthread_barrier_t *start;
  vxm_model *of;
  int first; /**< job */
  outcome outcomes[JOBS];
} worker;

/** cmocka can only fail in the thread that runs the test: this one only notes. */
static void *work(void *payload) {
  worker *w = payload;
  pthread_barrier_wait(w->start);
  for (int i = 0; i < JOBS; i++) {
    int job = (w->first + i) % JOBS;
    w->outcomes[job] = do_job(job, w->of);
  }
  return NULL;
}

static void assert_same(const outcome *a, const outcome *b, int job, int thread) {
  if (a->status != b->status || a->content != b->content || a->voxels != b->voxels ||
      a->contested != b->contested || a->winding_decided != b->winding_decided ||
      a->empty_parts != b->empty_parts || a->warnings != b->warnings)
    fail_msg(
        "job %d of thread %d: status %d, %d; voxels %lld, %lld; contested %lld, %lld; warnings %lld, %lld",
        job, thread, a->status, b->status, (long long)a->voxels, (long long)b->voxels,
        (long long)a->contested, (long long)b->contested, (long long)a->warnings, (long long)b->warnings);
}

static vxm_model *model_of(const vxm_mesh *mesh, const vxm_voxelize_options *options) {
  vxm_model *of = NULL;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_model_create(&of, mesh, options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return of;
}

/** Makes all jobs alone, then by all threads of a new model, which has nothing found out yet. */
static void check(const vxm_mesh *mesh, const vxm_voxelize_options *options, outcome expected[JOBS]) {
  static worker workers[THREADS];
  vxm_model *alone = model_of(mesh, options), *shared = model_of(mesh, options);
  for (int job = 0; job < JOBS; job++)
    expected[job] = do_job(job, alone);
  pthread_barrier_t start;
  assert_int_equal(pthread_barrier_init(&start, NULL, THREADS), 0);
  for (int t = 0; t < THREADS; t++) {
    workers[t] = (worker){.start = &start, .of = shared, .first = t < 2 ? 0 : t * JOBS / THREADS};
    assert_int_equal(pthread_create(&workers[t].thread, NULL, work, &workers[t]), 0);
  }
  for (int t = 0; t < THREADS; t++)
    assert_int_equal(pthread_join(workers[t].thread, NULL), 0);
  pthread_barrier_destroy(&start);
  for (int t = 0; t < THREADS; t++)
    for (int job = 0; job < JOBS; job++)
      assert_same(&workers[t].outcomes[job], &expected[job], job, t);
  /* This thread made nothing of the shared model, and sees what some other left. */
  assert_true(vxm_model_label_count(shared) > 0);
  vxm_model_destroy(alone);
  vxm_model_destroy(shared);
}

/* ---- Meshes ---- */

static double draw(uint64_t *state) {
  *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (double)(*state >> 11) / 9007199254740992.0 * 2 - 1;
}

/** A ball that is closed, one with an opening, and loose triangles on which the voters disagree. */
static vxm_mesh *messy(vxm_context *context) {
  shape made = find_model("sphere")->make(), open = find_model("sphere")->make();
  shape_scale(&made, 0.6, 0.6, 0.6);
  shape_scale(&open, 0.9, 0.9, 0.9);
  shape_move(&open, 0.2, 0.1, 0.3);
  open.face_count -= 20;
  shape_append(&made, &open);
  uint64_t state = 5;
  for (int t = 0; t < 10; t++) {
    int64_t v[3];
    double at[3] = {draw(&state), draw(&state), draw(&state)};
    for (int c = 0; c < 3; c++)
      v[c] = shape_add_vertex(&made, at[0] + 0.3 * draw(&state), at[1] + 0.3 * draw(&state),
                              at[2] + 0.3 * draw(&state));
    shape_add_face(&made, 3, v);
  }
  vxm_mesh *mesh = mesh_of_shape(context, &made);
  shape_free(&open);
  shape_free(&made);
  return mesh;
}

static void with_context(int threads, void (*test)(vxm_context *context)) {
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.threads = threads;
  vxm_context *context = NULL;
  assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
  test(context);
  vxm_context_destroy(context);
}

/* ---- Tests ---- */

static void check_method(vxm_context *context, vxm_method method, bool asks_winding) {
  vxm_mesh *mesh = messy(context);
  outcome expected[JOBS];
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.method = method;
  check(mesh, &options, expected);
  for (int job = 0; job < JOBS; job++)
    assert_int_equal(expected[job].status, VXM_OK);
  /* Else the orientation, which is found once, would not be asked for. */
  assert_int_equal(expected[GRID * RESOLUTIONS + 2].winding_decided > 0, asks_winding);
  vxm_mesh_destroy(mesh);
}

static void run_vote(vxm_context *context) {
  check_method(context, VXM_METHOD_VOTE, true);
}

static void run_winding_and_tetra(vxm_context *context) {
  check_method(context, VXM_METHOD_WINDING, true);
  check_method(context, VXM_METHOD_TETRA, false);
}

static void test_methods(void **state) {
  (void)state;
  with_context(2, run_vote);
  with_context(1, run_winding_and_tetra);
}

static void run_modes(vxm_context *context) {
  vxm_mesh *mesh = messy(context);
  outcome expected[JOBS];
  for (int kind = VXM_SURFACE_CONSERVATIVE; kind <= VXM_SURFACE_SHELL26; kind++) {
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.mode = kind == VXM_SURFACE_THIN ? VXM_MODE_BOTH : VXM_MODE_SURFACE;
    options.surface = (vxm_surface_kind)kind;
    options.vote = VXM_VOTE_MAJORITY;
    options.vote_always = true;
    check(mesh, &options, expected);
  }
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.confidence = true;
  options.vote = VXM_VOTE_ALL;
  check(mesh, &options, expected);
  vxm_mesh_destroy(mesh);
}

static void test_modes(void **state) {
  (void)state;
  with_context(2, run_modes);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_methods), cmocka_unit_test(test_modes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

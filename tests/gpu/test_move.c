/* SPDX-License-Identifier: BSD-3-Clause */
/* An engine moves and places points as the CPU does, bit for bit: any matrix, with displacements and without,
 * points halfway between two steps; and it leaves to the CPU what does not fit 32 bits. */
#include "gpu_test.h"

#include "base/rng.h"
#include "voxel/model/model.h"

enum { RESOLUTION = 48, SHIFT = 6, NOISE = 300 };

typedef struct scene {
  vxm_model *model;
  const vxm_triangle_set *triangles;
  vxm_lattice lattice;
  uint32_t *entry;
  float noise[NOISE][4];
  double matrix[12];
} scene;

static double uniform(vxm_rng *rng, double reach) {
  return reach * (2 * vxm_rng_unit(rng) - 1);
}

static void start(scene *s, const vxm_soup *soup, int64_t resolution, vxm_rng *rng) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.engine = engine;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_model_make(&s->model, soup, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  double size = 1.0 / (double)resolution;
  vxm_space space = {{resolution, resolution, resolution}, {0, 0, 0}, {size, size, size}};
  s->lattice = vxm_lattice_of(&space);
  s->triangles = &s->model->analysis.triangles;
  s->entry = malloc(s->triangles->first_apex * sizeof *s->entry);
  assert_non_null(s->entry);
  for (size_t p = 0; p < s->triangles->first_apex; p++)
    s->entry[p] = (uint32_t)vxm_rng_below(rng, NOISE);
  for (size_t v = 0; v < NOISE; v++)
    for (int a = 0; a < 3; a++)
      s->noise[v][a] = (float)uniform(rng, 0.1);
}

static void stop(scene *s) {
  free(s->entry);
  vxm_model_destroy(s->model);
}

/** Whether the engine moves them; then all it made must be what the CPU makes. */
static bool moves_alike(scene *s, uint32_t offset, uint64_t noise_serial, bool displaced, bool apexes) {
  vxm_snapped_points by[2] = {{.context = context}, {.context = context}};
  const vxm_triangle_set *triangles = s->triangles;
  vxm_vertex_transform motion = {.from = (const double(*)[3])triangles->positions,
                                 .count = triangles->first_apex,
                                 .matrix = s->matrix,
                                 .entry = displaced ? s->entry : NULL,
                                 .noise = (const float(*)[4])s->noise,
                                 .noise_size = NOISE,
                                 .offset = offset,
                                 .from_serial = triangles->serial * 2 + displaced,
                                 .noise_serial = noise_serial};
  vxm_move_job job = {triangles, &motion, apexes};
  vxm_error error = VXM_ERROR_INIT;
  bool done = false;
  vxm_status status = vxm_snapped_points_move(&by[0], triangles, &s->lattice, &motion, apexes, &error);
  assert_int_equal(vxm_snapped_points_begin(&by[1], triangles, &s->lattice, &motion, NULL), VXM_OK);
  if (engine->ops->move(engine, &by[1], &job, &done, &error) != VXM_OK)
    fail_msg("%s", error.text);
  if (done) {
    assert_int_equal(status, VXM_OK);
    assert_null(by[0].wide);
    assert_memory_equal(by[0].narrow, by[1].narrow, triangles->point_count * sizeof *by[0].narrow);
    assert_memory_equal(by[0].cells, by[1].cells, triangles->point_count * sizeof *by[0].cells);
  } else
    assert_true(status != VXM_OK || by[0].wide);
  vxm_snapped_points_destroy(&by[0]);
  vxm_snapped_points_destroy(&by[1]);
  return done;
}

static void test_random_matrices(void **state) {
  (void)state;
  vxm_rng rng = {3};
  vxm_soup *soup = shape_empty(context);
  shape_torus(soup, 60, 30, 0.3, 0.1, (double[3]){0.01, 0.02, 0.03});
  scene s;
  start(&s, soup, RESOLUTION, &rng);
  for (int i = 0; i < 60; i++) {
    double reach = i % 3 == 0 ? 1e-3 : i % 3 == 1 ? 1 : 100;
    for (int k = 0; k < 12; k++)
      s.matrix[k] = uniform(&rng, reach);
    uint32_t offset = i % 5 == 0 ? NOISE - 1 : (uint32_t)vxm_rng_below(&rng, NOISE);
    if (i % 10 == 0) /* another noise */
      s.noise[i % NOISE][0] = (float)uniform(&rng, 0.1);
    assert_true(moves_alike(&s, offset, (uint64_t)(1000 + i / 10), i % 4 != 0, i % 2 == 0));
  }
  stop(&s);
  vxm_soup_destroy(soup);
}

/** Points on a lattice twice as fine: every second coordinate lies halfway between two steps, and is rounded
 * to even. */
static void test_ties(void **state) {
  (void)state;
  vxm_rng rng = {4};
  vxm_soup *soup = shape_empty(context);
  for (int f = 0; f < 500; f++) {
    uint32_t corner[3];
    for (int c = 0; c < 3; c++)
      corner[c] = shape_vertex(soup, uniform(&rng, 4000), uniform(&rng, 4000), uniform(&rng, 4000));
    for (int c = 0; c < 9; c++)
      soup->positions[3 * corner[0] + (size_t)c] = rint(soup->positions[3 * corner[0] + (size_t)c]);
    shape_face(soup, corner, 3);
  }
  scene s;
  start(&s, soup, 1 << SHIFT, &rng);
  double half = 0.5 / ((double)(1 << SHIFT) * (double)s.lattice.unit); /* exact, as is all that follows */
  memset(s.matrix, 0, sizeof s.matrix);
  for (int a = 0; a < 3; a++) {
    s.matrix[5 * a] = half;
    s.matrix[4 * a + 3] = half * (a + 2000);
  }
  assert_true(moves_alike(&s, 0, 1, false, true));
  stop(&s);
  vxm_soup_destroy(soup);
}

static void test_beyond(void **state) {
  (void)state;
  vxm_rng rng = {5};
  vxm_soup *soup = shape_empty(context);
  shape_box(soup, (double[3]){0, 0, 0}, (double[3]){1, 1, 1});
  scene s;
  start(&s, soup, RESOLUTION, &rng);
  const double far[] = {1e3, 1e9, 1e300, INFINITY, NAN};
  for (size_t i = 0; i < sizeof far / sizeof far[0]; i++) {
    memset(s.matrix, 0, sizeof s.matrix);
    s.matrix[0] = s.matrix[5] = s.matrix[10] = 0.5;
    assert_true(moves_alike(&s, 0, 2, true, false));
    s.matrix[3] = far[i];
    assert_false(moves_alike(&s, 0, 2, true, false));
  }
  stop(&s);
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_random_matrices), cmocka_unit_test(test_ties),
                                     cmocka_unit_test(test_beyond)};
  int status = gpu_test_start(NULL);
  if (status == 0 && !vxm_engine_describe(engine)->moves) {
    fprintf(stderr, "skipped: the device does not move points\n");
    status = 77;
  }
  if (status == 0)
    status = cmocka_run_group_tests_name("moving points by " ENGINE, tests, setup, teardown);
  vxm_engine_destroy(engine);
  return status;
}

/* SPDX-License-Identifier: BSD-3-Clause */
/* Variants for training have the bits of the CPU: closed meshes and open ones on which voters disagree,
 * solids and surfaces, several models and samplers by turns, into memory and into a grid; the engine moves
 * the points, and the CPU does where it does not. */
#include "gpu_test.h"

#include "base/rng.h"
#include "grid/window.h"

enum { COUNT = 12, RESOLUTION = 33 };

/* ---- The engine, watched ---- */

static vxm_engine_ops watched;
static const vxm_engine_ops *own;
static int moved;
static bool fails; /**< the next move */

static vxm_status watch_move(vxm_engine *by, vxm_snapped_points *placed, const vxm_move_job *job, bool *done,
                             vxm_error *error) {
  if (fails) {
    fails = false;
    return vxm_fail(error, VXM_ERROR_UNAVAILABLE, "lost");
  }
  vxm_status status = own->move(by, placed, job, done, error);
  moved += *done;
  return status;
}

static void watch(void) {
  own = engine->ops;
  watched = *own;
  watched.move = watch_move;
  engine->ops = &watched;
}

/* ---- Variants ---- */

/** Everything at once. */
static vxm_sampler *make_sampler(vxm_mode mode, vxm_method method, vxm_vote vote, vxm_engine *by) {
  vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT;
  vxm_voxelize_options how = VXM_VOXELIZE_OPTIONS_INIT;
  options.voxelize = &how;
  options.resolution = RESOLUTION;
  options.seed = 77;
  options.rotation = VXM_ROTATION_ANY;
  options.scale = 0.5;
  options.displace = 0.03;
  options.mirror = 7;
  options.translate = 1;
  how.mode = mode;
  how.method = method;
  how.vote = vote;
  how.engine = by;
  vxm_sampler *sampler;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_sampler_create(&sampler, context, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return sampler;
}

static void check(const vxm_soup *const soups[], uint32_t soup_count, vxm_mode mode, vxm_method method,
                  vxm_vote vote) {
  vxm_sampler *sampler[2] = {make_sampler(mode, method, vote, NULL),
                             make_sampler(mode, method, vote, engine)};
  size_t bytes = vxm_sampler_bytes(sampler[0], VXM_VOXEL_FORMAT_PACKED), set = 0;
  uint8_t *out[2] = {malloc(COUNT * bytes), malloc(COUNT * bytes)};
  vxm_variant variants[COUNT];
  vxm_space space = vxm_sampler_space(sampler[0]);
  for (uint32_t v = 0; v < COUNT; v++)
    variants[v] = (vxm_variant){v % soup_count, 5, v};
  for (int s = 0; s < 2; s++) {
    vxm_error error = VXM_ERROR_INIT;
    vxm_grid *grid;
    assert_non_null(out[s]);
    for (uint32_t m = 0; m < soup_count; m++)
      assert_int_equal(vxm_sampler_put(sampler[s], m, soups[m], NULL), VXM_OK);
    if (vxm_sampler_batch(out[s], sampler[s], variants, COUNT, VXM_VOXEL_FORMAT_PACKED, &error) != VXM_OK)
      fail_msg("%s", error.text);
    assert_int_equal(vxm_grid_create(&grid, context, &space, NULL), VXM_OK);
    assert_int_equal(vxm_sampler_grid(grid, sampler[s], &variants[1], NULL), VXM_OK);
    for (int64_t x = 0; x < RESOLUTION; x++)
      for (int64_t y = 0; y < RESOLUTION; y++)
        for (int64_t z = 0; z < RESOLUTION; z++) {
          size_t row = (size_t)(x * RESOLUTION + y) * ((RESOLUTION + 7) / 8);
          assert_int_equal(vxm_grid_get(grid, x, y, z), out[0][bytes + row + (size_t)z / 8] >> (z % 8) & 1);
        }
    vxm_grid_destroy(grid);
    vxm_sampler_destroy(sampler[s]);
  }
  if (mode != VXM_MODE_SURFACE) /* each in the batch, and one into a grid */
    assert_int_equal(moved, engine->ops && engine->info.moves ? COUNT + 1 : 0);
  moved = 0;
  assert_memory_equal(out[0], out[1], COUNT * bytes);
  for (size_t b = 0; b < COUNT * bytes; b++)
    set += out[0][b] != 0;
  assert_true(set > COUNT * 20);
  free(out[0]);
  free(out[1]);
}

/** Every second face of a torus is left out. */
static vxm_soup *sieve(void) {
  vxm_soup *whole = shape_empty(context);
  shape_torus(whole, 24, 12, 10, 4, (double[3]){0, 0, 0});
  vxm_soup *out = shape_sieve(whole);
  vxm_soup_destroy(whole);
  return out;
}

static void test_variants(void **state) {
  (void)state;
  vxm_soup *torus = shape_empty(context), *boxes = shape_empty(context), *open = sieve();
  shape_torus(torus, 40, 20, 10, 4, (double[3]){0, 0, 0});
  shape_box(boxes, (double[3]){0, 0, 0}, (double[3]){8, 8, 8});
  shape_box(boxes, (double[3]){5, 5, 5}, (double[3]){12, 11, 13});
  const vxm_soup *soups[] = {torus, boxes, open};
  check(soups, 3, VXM_MODE_SOLID, VXM_METHOD_VOTE, VXM_VOTE_AUTO);
  check(soups, 3, VXM_MODE_SOLID, VXM_METHOD_VOTE, VXM_VOTE_MAJORITY);
  check(soups, 3, VXM_MODE_SOLID, VXM_METHOD_TETRA, VXM_VOTE_AUTO); /* the apexes are on the device, too */
  check(soups, 3, VXM_MODE_BOTH, VXM_METHOD_VOTE, VXM_VOTE_AUTO);
  check(soups, 2, VXM_MODE_SURFACE, VXM_METHOD_VOTE, VXM_VOTE_AUTO);
  vxm_soup_destroy(torus);
  vxm_soup_destroy(boxes);
  vxm_soup_destroy(open);
}

static void save(uint8_t *out, vxm_sampler *sampler, uint32_t model, uint32_t index) {
  vxm_variant variant = {model, 1, index};
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_sampler_batch(out, sampler, &variant, 1, VXM_VOXEL_FORMAT_PACKED, &error) != VXM_OK)
    fail_msg("%s", error.text);
}

/** Two samplers with noises of their own and one without share the engine with plain voxelizing; models are
 * replaced in between. */
static void test_shared_engine(void **state) {
  (void)state;
  enum { SAMPLERS = 3, ROUNDS = 30 };
  vxm_soup *soups[2] = {shape_empty(context), shape_empty(context)};
  shape_torus(soups[0], 40, 20, 10, 4, (double[3]){0, 0, 0});
  shape_box(soups[1], (double[3]){0, 0, 0}, (double[3]){8, 9, 7});
  vxm_sampler *samplers[SAMPLERS][2];
  vxm_space space = engine_space(20, 20, 20);
  for (int s = 0; s < SAMPLERS; s++)
    for (int by = 0; by < 2; by++) {
      vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT;
      vxm_voxelize_options how = VXM_VOXELIZE_OPTIONS_INIT;
      options.voxelize = &how;
      options.resolution = RESOLUTION;
      options.seed = (uint64_t)s;
      options.rotation = VXM_ROTATION_ANY;
      options.displace = 0.02 * s;
      options.noise = s == 1 ? 70 : 500;
      how.engine = by ? engine : NULL;
      assert_int_equal(vxm_sampler_create(&samplers[s][by], context, &options, NULL), VXM_OK);
    }
  size_t bytes = vxm_sampler_bytes(samplers[0][0], VXM_VOXEL_FORMAT_PACKED);
  uint8_t *out[2] = {malloc(bytes), malloc(bytes)};
  vxm_rng rng = {8};
  for (uint32_t round = 0; round < ROUNDS; round++) {
    size_t s = round < SAMPLERS ? round : vxm_rng_below(&rng, SAMPLERS);
    uint32_t model = (uint32_t)vxm_rng_below(&rng, 2), first = (uint32_t)vxm_rng_below(&rng, 2);
    bool puts = round < SAMPLERS || vxm_rng_below(&rng, 4) == 0;
    for (int by = 0; by < 2; by++)
      for (uint32_t m = 0; m < 2 && puts; m++)
        assert_int_equal(vxm_sampler_put(samplers[s][by], m, soups[(m + first) % 2], NULL), VXM_OK);
    save(out[0], samplers[s][0], model, round);
    save(out[1], samplers[s][1], model, round);
    assert_memory_equal(out[0], out[1], bytes);
    if (round % 3 == 0) {
      vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
      vxm_voxelize_report reports[2] = {VXM_VOXELIZE_REPORT_INIT, VXM_VOXELIZE_REPORT_INIT};
      for (int by = 0; by < 2; by++) {
        options.engine = by ? engine : NULL;
        vxm_grid_destroy(engine_solid(soups[model], &space, &options, &reports[by]));
      }
      assert_true(reports[0].hash == reports[1].hash);
    }
  }
  moved = 0;
  for (int s = 0; s < SAMPLERS; s++)
    for (int by = 0; by < 2; by++)
      vxm_sampler_destroy(samplers[s][by]);
  for (int i = 0; i < 2; i++) {
    vxm_soup_destroy(soups[i]);
    free(out[i]);
  }
}

/** Last: the engine is gone afterwards. */
static void test_the_cpu_goes_on(void **state) {
  (void)state;
  vxm_soup *torus = shape_empty(context);
  shape_torus(torus, 40, 20, 10, 4, (double[3]){0, 0, 0});
  const vxm_soup *soups[] = {torus};
  bool moves = engine->info.moves;
  engine->info.moves = false;
  check(soups, 1, VXM_MODE_SOLID, VXM_METHOD_VOTE, VXM_VOTE_AUTO);
  engine->info.moves = moves;
  check(soups, 1, VXM_MODE_SOLID, VXM_METHOD_VOTE, VXM_VOTE_AUTO);
  engine->falls_back = fails = true;
  check(soups, 1, VXM_MODE_SOLID, VXM_METHOD_VOTE, VXM_VOTE_AUTO);
  assert_null(engine->ops);
  vxm_soup_destroy(torus);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_variants), cmocka_unit_test(test_shared_engine),
                                     cmocka_unit_test(test_the_cpu_goes_on)};
  int status = gpu_test_start(NULL);
  if (status == 0)
    watch();
  if (status == 0)
    status = cmocka_run_group_tests_name("variants by " ENGINE, tests, setup, teardown);
  vxm_engine_destroy(engine);
  return status;
}

/* SPDX-License-Identifier: BSD-3-Clause */
/* Several devices at once have the bits and the report of one: solids, votes, surfaces, variants; the faster
 * one gets more to do; what a device fails to do goes to the others, until none is left; limits and
 * cancelling end all of it. OpenCL's first device is there twice, in two halves or by PoCL's own setting. */
#include "gpu/multi_device.h" /* before the test's own `engine` */

#include "gpu_test.h"

#include <time.h>

static vxm_multi_device *group(void) {
  vxm_multi_device *made = vxm_multi_device_of(engine);
  assert_non_null(made);
  return made;
}

/* ---- Members, watched ---- */

static struct watched {
  vxm_engine_ops ops;
  const vxm_engine_ops *own;
  int64_t slices;
  int calls, fails_at; /**< the call that fails; 0 = none does */
  vxm_status with;
  int delay_ms;
  bool votes_alone; /**< count as calls */
} watched[VXM_MULTI_DEVICE_MOST];

static vxm_status begin_call(const vxm_engine *by, int64_t slices, bool is_vote, struct watched **out,
                             vxm_error *error) {
  int m = 0;
  while (group()->members[m].engine != by)
    m++;
  struct watched *w = *out = &watched[m];
  nanosleep(&(struct timespec){.tv_nsec = w->delay_ms * 1000000L}, NULL);
  w->slices += slices;
  if (w->votes_alone && !is_vote)
    return VXM_OK;
  if (++w->calls == w->fails_at)
    return vxm_fail(error, w->with, "made to fail");
  return VXM_OK;
}

static vxm_status watch_unite(vxm_engine *by, const vxm_window *window, const vxm_parity_union_job *job,
                              vxm_error *error) {
  struct watched *w;
  vxm_status status = begin_call(by, window->end - window->begin, false, &w, error);
  if (status != VXM_OK && job->fresh) /* half done */
    memset(window->words, 0x55, window->slice_words * sizeof(uint64_t));
  return status == VXM_OK ? w->own->unite(by, window, job, error) : status;
}

static vxm_status watch_vote(vxm_engine *by, const vxm_window *window, const vxm_vote_job *job,
                             vxm_vote_tally *tally, vxm_error *error) {
  struct watched *w;
  vxm_status status = begin_call(by, window->end - window->begin, true, &w, error);
  vxm_status made = w->own->vote(by, window, job, tally, error); /* all done, before it fails */
  return status == VXM_OK ? made : status;
}

static vxm_status watch_surface(vxm_engine *by, const vxm_surface *surface, const vxm_window *window,
                                vxm_surface_kind kind, bool is_fresh, vxm_error *error) {
  struct watched *w;
  vxm_status status = begin_call(by, window->end - window->begin, false, &w, error);
  return status == VXM_OK ? w->own->surface(by, surface, window, kind, is_fresh, error) : status;
}

/** A new group; nothing fails yet. Each call takes a little, so that all of them get some. */
static void make_group(vxm_context *owner) {
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_engine_create(&engine, owner, ENGINE, NULL, &error) != VXM_OK)
    fail_msg("%s", error.text);
  for (int m = 0; m < group()->count; m++) {
    vxm_engine *member = group()->members[m].engine;
    watched[m] = (struct watched){.ops = *member->ops, .own = member->ops, .delay_ms = 3};
    watched[m].ops.unite = watch_unite;
    watched[m].ops.vote = watch_vote;
    watched[m].ops.surface = watch_surface;
    member->ops = &watched[m].ops;
  }
}

static void drop_group(void) {
  vxm_engine_destroy(engine);
  engine = NULL;
}

/* ---- Grids ---- */

static vxm_soup *make_sieve(void) {
  vxm_soup *whole = shape_empty(context);
  shape_torus(whole, 40, 20, 20, 8, (double[3]){30, 30, 16});
  vxm_soup *out = shape_sieve(whole);
  vxm_soup_destroy(whole);
  return out;
}

enum { KINDS = 5 };

static vxm_voxelize_options options_of(int kind) {
  vxm_voxelize_options how = VXM_VOXELIZE_OPTIONS_INIT;
  how.thin = kind == 0 ? VXM_THIN_AUTO : VXM_THIN_DROP;
  how.mode = kind == 1 ? VXM_MODE_BOTH : VXM_MODE_SOLID;
  how.vote = kind == 2 ? VXM_VOTE_MAJORITY : VXM_VOTE_AUTO;
  how.method = kind == 3 ? VXM_METHOD_Z : VXM_METHOD_VOTE;
  return how;
}

/** By the group, and by the CPU. */
static void check_same(int kind) {
  vxm_space space = engine_space(61, 62, 33);
  vxm_soup *sieve = make_sieve();
  vxm_voxelize_options how = options_of(kind);
  vxm_voxelize_report report[2] = {VXM_VOXELIZE_REPORT_INIT, VXM_VOXELIZE_REPORT_INIT};
  vxm_grid *grid[2];
  shape_box(sieve, (double[3]){2, 2, 2}, (double[3]){20, 50, 9.5});
  shape_box(sieve, (double[3]){10, 10, 4}, (double[3]){55, 15, 30});
  for (int by = 0; by < 2; by++) {
    how.engine = by ? engine : NULL;
    grid[by] = engine_solid(sieve, &space, &how, &report[by]);
  }
  assert_equal_bits(grid[0], grid[1]);
  assert_equal_reports(&report[0], &report[1]);
  assert_true(report[0].voxels > 1000);
  vxm_grid_destroy(grid[0]);
  vxm_grid_destroy(grid[1]);
  vxm_soup_destroy(sieve);
}

static void test_the_same(void **state) {
  (void)state;
  make_group(NULL);
  assert_int_equal(vxm_engine_describe(engine)->devices, group()->count);
  for (int kind = 0; kind < KINDS; kind++)
    check_same(kind);
  for (int m = 0; m < group()->count; m++)
    assert_true(watched[m].calls > 0);
  assert_int_equal(vxm_engine_describe(engine)->lost_devices, 0);
  drop_group();
}

/** Eight slices are at least as many as each of the pieces has. */
static void test_by_speed(void **state) {
  (void)state;
  make_group(NULL);
  watched[0].delay_ms = 60;
  check_same(3); /* to know the speeds */
  for (int m = 0; m < group()->count; m++)
    watched[m].slices = 0;
  check_same(3);
  int64_t others = 0;
  for (int m = 1; m < group()->count; m++)
    others += watched[m].slices;
  assert_int_equal(others + watched[0].slices, 33);
  assert_true(watched[0].slices * 2 < others);
  drop_group();
}

/* ---- Failures ---- */

static void test_one_fails(void **state) {
  (void)state;
  for (int kind = 0; kind < KINDS; kind++)
    for (int at = 0; at <= 2; at++) {
      bool votes = at == 0;
      if (votes && kind != 2)
        continue;
      at += votes;
      make_group(NULL);
      watched[1].votes_alone = votes;
      watched[1].fails_at = at;
      watched[1].delay_ms = 0;
      watched[1].with = at == 1 ? VXM_ERROR_UNAVAILABLE : VXM_ERROR_MEMORY;
      check_same(kind);
      bool is_lost = watched[1].calls >= at;
      const vxm_engine_info *info = vxm_engine_describe(engine);
      assert_true(is_lost || at > 1);
      assert_int_equal(info->lost_devices, is_lost);
      assert_int_equal(info->devices, group()->count - is_lost);
      assert_int_equal(strstr(info->note, "made to fail") != NULL, is_lost);
      if (is_lost)
        assert_int_equal(watched[1].calls, at); /* and it is asked no more */
      at -= votes;
      drop_group();
    }
}

static vxm_status voxelize(vxm_context *owner) {
  vxm_soup *soup = shape_empty(owner);
  vxm_grid *grid = NULL;
  vxm_voxelize_options how = options_of(3);
  vxm_space space = engine_space(61, 62, 33);
  vxm_space_options where = VXM_SPACE_OPTIONS_INIT;
  where.like = &space;
  how.engine = engine;
  shape_box(soup, (double[3]){2, 2, 2}, (double[3]){20, 50, 9.5});
  vxm_error error = VXM_ERROR_INIT;
  vxm_status status = vxm_voxelize(&grid, NULL, soup, &where, &how, &error);
  if (status != VXM_OK) {
    assert_null(grid);
    assert_true(error.text[0] != '\0');
  }
  vxm_grid_destroy(grid);
  vxm_soup_destroy(soup);
  return status;
}

static void test_all_fail(void **state) {
  (void)state;
  make_group(NULL);
  for (int m = 0; m < group()->count; m++) {
    watched[m].fails_at = 1;
    watched[m].with = VXM_ERROR_UNAVAILABLE;
  }
  assert_int_equal(voxelize(context), VXM_ERROR_UNAVAILABLE);
  assert_int_equal(vxm_engine_describe(engine)->devices, 0);
  assert_int_equal(voxelize(context), VXM_ERROR_UNAVAILABLE);
  drop_group();
}

/** Work that is more than any can hold is refused, and less of it is done afterwards. */
static void test_too_large(void **state) {
  (void)state;
  make_group(NULL);
  for (int m = 0; m < group()->count; m++) {
    watched[m].fails_at = 1;
    watched[m].with = VXM_ERROR_RANGE;
  }
  assert_int_equal(voxelize(context), VXM_ERROR_RANGE);
  assert_int_equal(vxm_engine_describe(engine)->devices, group()->count);
  assert_int_equal(vxm_engine_describe(engine)->lost_devices, 0);
  assert_int_equal(voxelize(context), VXM_OK);
  drop_group();
}

static int stop(const char *phase, double fraction, void *payload) {
  (void)phase;
  (void)payload;
  return fraction >= 0;
}

/** What is nobody's fault costs no device. */
static void test_limits(void **state) {
  (void)state;
  vxm_context *owner = context_of(1, 0);
  size_t used = memory_used(owner);
  make_group(owner);
  watched[1].fails_at = 1;
  watched[1].with = VXM_ERROR_MEMORY_LIMIT;
  watched[0].delay_ms = 30;
  assert_int_equal(voxelize(owner), VXM_ERROR_MEMORY_LIMIT);
  assert_int_equal(vxm_engine_describe(engine)->lost_devices, 0);
  owner->progress = stop;
  assert_int_equal(voxelize(owner), VXM_ERROR_CANCELLED);
  owner->progress = NULL;
  assert_int_equal(voxelize(owner), VXM_OK);
  leave_memory(owner, 20000);
  assert_int_equal(voxelize(owner), VXM_ERROR_MEMORY_LIMIT);
  leave_memory(owner, SIZE_MAX);
  drop_group();
  assert_int_equal(memory_used(owner), used);
  vxm_context_destroy(owner);
}

/* ---- Variants ---- */

static void make_variants(uint8_t *out, size_t bytes, vxm_engine *by, size_t count) {
  vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT;
  vxm_voxelize_options how = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_sampler *sampler;
  vxm_variant variants[20];
  vxm_soup *sieve = make_sieve(), *box = box_with_ties(0.25, 0.5);
  options.resolution = 33;
  options.rotation = VXM_ROTATION_ANY;
  options.displace = 0.02;
  options.voxelize = &how;
  how.engine = by;
  assert_int_equal(vxm_sampler_create(&sampler, context, &options, NULL), VXM_OK);
  assert_int_equal(vxm_sampler_bytes(sampler, VXM_VOXEL_FORMAT_UINT8), bytes);
  for (int round = 0; round < 2; round++) { /* a model that has gone, and one in its place */
    assert_int_equal(vxm_sampler_put(sampler, 0, sieve, NULL), VXM_OK);
    assert_int_equal(vxm_sampler_put(sampler, 1, round ? box : sieve, NULL), VXM_OK);
    for (uint32_t v = 0; v < count; v++)
      variants[v] = (vxm_variant){v % 2, 1, v};
    assert_int_equal(vxm_sampler_batch(out, sampler, variants, count, VXM_VOXEL_FORMAT_UINT8, NULL), VXM_OK);
  }
  variants[count / 2].model = 7;
  assert_int_equal(
      vxm_sampler_batch(out + count * bytes, sampler, variants, count, VXM_VOXEL_FORMAT_UINT8, NULL),
      VXM_ERROR_ARGUMENT);
  vxm_sampler_destroy(sampler);
  vxm_soup_destroy(sieve);
  vxm_soup_destroy(box);
}

static void test_variants(void **state) {
  (void)state;
  enum { COUNT = 20, BYTES = 33 * 33 * 33 };
  uint8_t *out[2];
  for (int by = 0; by < 2; by++) {
    out[by] = malloc((size_t)2 * COUNT * BYTES);
    assert_non_null(out[by]);
    if (by)
      make_group(NULL);
    make_variants(out[by], BYTES, by ? engine : NULL, COUNT);
  }
  assert_memory_equal(out[0], out[1], COUNT * BYTES);
  for (int m = 0; m < group()->count; m++)
    assert_true(watched[m].calls > 0);
  watched[1].fails_at = watched[1].calls + 3;
  watched[1].with = VXM_ERROR_UNAVAILABLE;
  make_variants(out[1], BYTES, engine, COUNT);
  assert_memory_equal(out[0], out[1], COUNT * BYTES);
  drop_group();
  free(out[0]);
  free(out[1]);
}

/** A format that needs a module that is not there costs no device. */
static void test_unwritable_files(void **state) {
  (void)state;
  make_group(NULL);
  vxm_sampler_options options = VXM_SAMPLER_OPTIONS_INIT;
  vxm_voxelize_options how = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_grid_write_options as = VXM_GRID_WRITE_OPTIONS_INIT;
  vxm_sampler *sampler;
  const vxm_variant variants[4] = {{0, 1, 0}, {0, 1, 1}, {0, 1, 2}, {0, 1, 3}};
  const char *const paths[4] = {"/nowhere/0.vdb", "/nowhere/1.vdb", "/nowhere/2.vdb", "/nowhere/3.vdb"};
  const char *modules = getenv("VOXMEND_MODULES");
  char *before = modules ? strdup(modules) : NULL;
  setenv("VOXMEND_MODULES", "/nowhere", 1);
  vxm_soup *box = box_with_ties(0.25, 0.5);
  vxm_error error = VXM_ERROR_INIT;
  options.resolution = 9;
  options.voxelize = &how;
  how.engine = engine;
  as.format = "vdb";
  assert_int_equal(vxm_sampler_create(&sampler, context, &options, NULL), VXM_OK);
  assert_int_equal(vxm_sampler_put(sampler, 0, box, NULL), VXM_OK);
  assert_int_not_equal(vxm_sampler_files(paths, sampler, variants, 4, &as, NULL, &error), VXM_OK);
  assert_null(strstr(error.text, "device"));
  assert_int_equal(vxm_engine_describe(engine)->devices, group()->count);
  assert_int_equal(voxelize(context), VXM_OK);
  if (before)
    setenv("VOXMEND_MODULES", before, 1);
  else
    unsetenv("VOXMEND_MODULES");
  free(before);
  vxm_sampler_destroy(sampler);
  vxm_soup_destroy(box);
  drop_group();
}

/* ---- Names ---- */

static void test_names(void **state) {
  (void)state;
  static const char *const wrong[] = {ENGINE "+cpu", ENGINE "+", "cpu+" ENGINE,
                                      ENGINE "+opencl:no such device", "opencl:0:17"};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    vxm_error error = VXM_ERROR_INIT;
    vxm_engine *none;
    vxm_status status = vxm_engine_create(&none, NULL, wrong[i], NULL, &error);
    assert_true(status == VXM_ERROR_ARGUMENT || status == VXM_ERROR_RANGE);
    assert_null(none);
    assert_true(error.text[0] != '\0');
  }
  vxm_engine_options options = VXM_ENGINE_OPTIONS_INIT;
  vxm_engine *none;
  options.device = "0";
  assert_int_equal(vxm_engine_create(&none, NULL, ENGINE, &options, NULL), VXM_ERROR_ARGUMENT);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_the_same),  cmocka_unit_test(test_by_speed),
      cmocka_unit_test(test_one_fails), cmocka_unit_test(test_all_fail),
      cmocka_unit_test(test_too_large), cmocka_unit_test(test_limits),
      cmocka_unit_test(test_variants),  cmocka_unit_test(test_unwritable_files),
      cmocka_unit_test(test_names)};
  setenv("POCL_DEVICES", "pthread pthread", 0);
  int status = gpu_test_start(NULL);
  if (status != 0)
    return status;
  bool are_several = vxm_multi_device_of(engine) != NULL;
  drop_group();
  if (!are_several) {
    fprintf(stderr, "skipped: " ENGINE " is one device\n");
    return 77;
  }
  return cmocka_run_group_tests_name("several devices: " ENGINE, tests, setup, teardown);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How right the defaults are on damaged bodies: a floor for every damage, a little below what is reached. The
 * floors are those of 48 voxels; doc/accuracy.md has the figures of real meshes at 128.
 */
#include "measure.h"
#include "truth.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

enum { RESOLUTION = 48 };

static const double floors[DAMAGE_COUNT] = {
    [DAMAGE_NONE] = 1,           [DAMAGE_DOUBLED] = 1,
    [DAMAGE_FLIPPED] = 1,        [DAMAGE_REMOVED_1] = 0.9995,
    [DAMAGE_REMOVED_5] = 0.9993, [DAMAGE_REMOVED_20] = 0.998,
    [DAMAGE_COPIES] = 1,         [DAMAGE_SHAKEN] = 0.999,
    [DAMAGE_MOVED] = 0.999,      [DAMAGE_SHEET] = 1,
    [DAMAGE_CAVITY] = 1,         [DAMAGE_HOLE] = 0.999,
    [DAMAGE_PANELS] = 0.9995,    [DAMAGE_PANELS_DOUBLED] = 0.9995,
    [DAMAGE_ALL] = 0.9985,
};

static void expect_floor(const char *name, damage kind, double iou) {
  if (iou < floors[kind])
    fail_msg("%s, %s: %.5f of the truth, expected %.5f", name, damage_names[kind], iou, floors[kind]);
}

static void test_floors(void **state) {
  (void)state;
  const bool wanted[METHOD_COUNT] = {[METHOD_AUTO] = true};
  for (int b = 0; b < BODY_COUNT; b++) {
    shape body = body_make(b);
    for (int kind = 0; kind < DAMAGE_COUNT; kind++) {
      question q;
      answer found;
      assert_true(question_make(&q, NULL, &body, (damage)kind, RESOLUTION, (uint64_t)b + 1));
      measure(&found, &q, wanted, false);
      expect_floor(body_names[b], (damage)kind, found.iou[METHOD_AUTO].value);
      question_free(&q);
    }
    shape_free(&body);
  }
}

/** The truth of two overlapping parts is the union of what each is alone. */
static void test_truth_unites_parts(void **state) {
  (void)state;
  shape cube = shape_box(-1, -1, -1, 1, 1, 1), both = shape_box(0.2, 0.3, 0.1, 2, 1.5, 0.7);
  shape box = {0};
  shape_append(&box, &both);
  shape_append(&both, &cube);
  vxm_space space = truth_space(NULL, &both, RESOLUTION);
  vxm_grid *whole = truth_solid(NULL, &both, &space);
  vxm_grid *one = truth_solid(NULL, &cube, &space), *other = truth_solid(NULL, &box, &space);
  assert_true(vxm_grid_count(one) + vxm_grid_count(other) > vxm_grid_count(whole));
  truth_unite(one, other);
  assert_int_equal(vxm_grid_hash(one), vxm_grid_hash(whole));
  truth_subtract(one, whole);
  assert_int_equal(vxm_grid_count(one), 0);
  vxm_grid_destroy(whole);
  vxm_grid_destroy(one);
  vxm_grid_destroy(other);
  shape_free(&cube);
  shape_free(&both);
  shape_free(&box);
}

/** The damage is what its name says. */
static void test_damage_is_done(void **state) {
  (void)state;
  shape body = body_make(0);
  int64_t faces = (int64_t)body.face_count;
  for (int kind = 0; kind < DAMAGE_COUNT; kind++) {
    question q;
    vxm_census census = VXM_CENSUS_INIT;
    assert_true(question_make(&q, NULL, &body, (damage)kind, RESOLUTION, 7));
    assert_int_equal(vxm_mesh_census(&census, q.mesh, NULL), VXM_OK);
    if (kind == DAMAGE_NONE || kind == DAMAGE_SHAKEN)
      assert_true(census.watertight && census.inconsistent_edges == 0 && census.faces == faces);
    if (kind == DAMAGE_DOUBLED)
      assert_int_equal(census.opposite_duplicate_faces, faces);
    if (kind == DAMAGE_FLIPPED)
      assert_true(census.watertight && census.inconsistent_edges > faces / 3);
    if (kind == DAMAGE_REMOVED_20)
      assert_in_range(census.faces, faces * 75 / 100, faces * 85 / 100);
    if (kind == DAMAGE_COPIES || kind == DAMAGE_CAVITY)
      assert_true(census.watertight && census.components == 2);
    if (kind == DAMAGE_MOVED)
      assert_int_equal(census.boundary_edges, 3 * faces);
    if (kind == DAMAGE_SHEET)
      assert_int_equal(census.boundary_edges, 4);
    if (kind == DAMAGE_HOLE)
      assert_true(census.faces < faces && census.boundary_edges > 2);
    if (kind == DAMAGE_PANELS)
      assert_true(census.components_raw == 6 && census.boundary_edges > 0);
    question_free(&q);
  }
  shape_free(&body);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_truth_unites_parts),
      cmocka_unit_test(test_damage_is_done),
      cmocka_unit_test(test_floors),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

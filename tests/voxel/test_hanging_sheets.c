/* SPDX-License-Identifier: BSD-3-Clause */
/** Sheets that hang on the edges of bodies leave the bodies what they are. */
#include "fins.h"

static bool is_at_the_side(size_t cell) {
  for (int a = 0; a < 3; a++, cell /= SIDE)
    if (cell % SIDE == 0 || cell % SIDE == SIDE - 1)
      return true;
  return false;
}

/** Adds the squares of all boxes together, which are those of their union, or of each box by itself. */
static body add_boxes(vxm_soup *soup, const manner *how, bool separate, vxm_rng *rng) {
  body all = {.turned = false};
  for (int boxes = 1 + (int)vxm_rng_below(rng, 3), i = 0; i < boxes; i++) {
    body one = {.turned = false};
    add_random_box(&one, rng);
    for (size_t c = 0; c < CELLS; c++) { /* there is room about it, and the middle is in it */
      one.cells[c] = (i == 0 && c == cell_at(2, 3, 2)) || (one.cells[c] && !is_at_the_side(c));
      all.cells[c] = all.cells[c] || one.cells[c];
    }
    if (separate)
      add_body(soup, &one, how, rng);
  }
  if (!separate)
    add_body(soup, &all, how, rng);
  return all;
}

/** Adds single squares within a body, each looking this way or that. */
static void add_random_walls(vxm_soup *soup, const body *b, const manner *how, vxm_rng *rng) {
  bool taken[3][CELLS] = {{false}};
  for (int tries = 0; tries < 60; tries++) {
    int at[3], axis = (int)vxm_rng_below(rng, 3);
    for (int a = 0; a < 3; a++)
      at[a] = (int)vxm_rng_below(rng, SIDE);
    int before[3] = {at[0], at[1], at[2]};
    before[axis]--;
    bool *is_taken = &taken[axis][cell_at(at[0], at[1], at[2])];
    if (*is_taken || !has_cell(b, at) || !has_cell(b, before))
      continue;
    add_square(soup, how, at, axis, vxm_rng_below(rng, 2) == 0, rng);
    *is_taken = true;
  }
}

/** What there is beside the squares of the bodies. */
typedef struct scene {
  bool separate; /**< each body has squares of its own */
  bool walls, fins;
} scene;

static void assert_solid(vxm_context *context, uint64_t seed, const manner *how, scene drawn) {
  vxm_rng rng = {seed};
  vxm_soup *soup = new_soup(context), *sheets = new_soup(context);
  body b = add_boxes(soup, how, drawn.separate, &rng);
  if (drawn.walls)
    add_random_walls(sheets, &b, how, &rng);
  if (drawn.fins)
    add_random_fins(sheets, &b, how, &rng);
  append(soup, sheets, 0);
  int wrong = count_wrong_beside(soup, sheets, &b, how);
  if (wrong > 0)
    fail_msg("seed %llu: %d voxels are wrong", (unsigned long long)seed, wrong);
  vxm_soup_destroy(sheets);
  vxm_soup_destroy(soup);
}

static void check_scenes(vxm_context *context, scene drawn) {
  manner triangles = squares;
  triangles.triangles = true;
  for (uint64_t seed = 1; seed <= rounds_of(300); seed++)
    assert_solid(context, seed, seed % 2 == 0 ? &triangles : &squares, drawn);
}

static void fins_do_nothing(void **state) {
  check_scenes(*state, (scene){.fins = true});
}

/** What boxes share is there several times, cut along other diagonals; it is not to be told by a fin. */
static void fins_do_nothing_to_boxes_that_overlap(void **state) {
  check_scenes(*state, (scene){.separate = true, .fins = true});
}

static void walls_do_nothing_to_boxes_that_overlap(void **state) {
  check_scenes(*state, (scene){.separate = true, .walls = true});
}

static void walls_and_fins_do_nothing(void **state) {
  check_scenes(*state, (scene){.separate = true, .walls = true, .fins = true});
}

enum { LOW = 2, HIGH = 4, FLAPS = 6 };

/** A flap goes out from an edge of a box and around in front of one of its faces, for each face another one.
 */
static void add_flap(vxm_soup *soup, int number, int depth, vxm_rng *rng) {
  int axis = number % 3, next = (axis + 1) % 3, last = (axis + 2) % 3, up = number / 3;
  fin out = {.axis = next, .size = {2, depth}}, hood = {.axis = axis, .size = {2, 2}};
  out.corner[axis] = up ? HIGH : LOW - depth;
  out.corner[next] = HIGH;
  out.corner[last] = LOW;
  hood.corner[axis] = up ? HIGH + depth : LOW - depth;
  hood.corner[next] = hood.corner[last] = LOW;
  add_fin(soup, &out, &squares, rng);
  add_fin(soup, &hood, &squares, rng);
}

/** A box, or what is left of it without its first square, with flaps: along every axis there may be as many
 * faces before the box as behind it. */
static void assert_flaps_do_nothing(vxm_context *context, int count, int depth, bool with_hole) {
  vxm_rng rng = {1};
  vxm_soup *soup = new_soup(context), *box = new_soup(context), *flaps = new_soup(context);
  body b = {.turned = false};
  for (int i = 0; i < 8; i++)
    b.cells[cell_at(LOW + i % 2, LOW + i / 2 % 2, LOW + i / 4)] = true;
  add_body(box, &b, &squares, &rng);
  append(soup, box, with_hole);
  for (int i = 0; i < count; i++)
    add_flap(flaps, i, depth, &rng);
  append(soup, flaps, 0);
  assert_int_equal(count_wrong_beside(soup, flaps, &b, &squares), 0);
  vxm_soup_destroy(flaps);
  vxm_soup_destroy(box);
  vxm_soup_destroy(soup);
}

static void flaps_do_nothing(void **state) {
  for (int count = 1; count <= FLAPS; count++)
    assert_flaps_do_nothing(*state, count, 1, false);
}

/** So many that with them it is a sheet rather than a body with a hole. */
static void flaps_do_nothing_to_a_box_with_a_hole(void **state) {
  assert_flaps_do_nothing(*state, FLAPS, 2, true);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(fins_do_nothing),
                                     cmocka_unit_test(fins_do_nothing_to_boxes_that_overlap),
                                     cmocka_unit_test(walls_do_nothing_to_boxes_that_overlap),
                                     cmocka_unit_test(walls_and_fins_do_nothing),
                                     cmocka_unit_test(flaps_do_nothing),
                                     cmocka_unit_test(flaps_do_nothing_to_a_box_with_a_hole)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}

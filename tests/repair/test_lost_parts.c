/* SPDX-License-Identifier: BSD-3-Clause */
/** The net under the repair: what it finds lost, and what not. */
#include "repair_test.h"
#include "solids.h"

#include "repair/exact/union_loss.h"
#include "repair/state/lost_parts.h"

/** Three bodies: a box, a ball, and a small box in a far corner. */
static vxm_soup *three_bodies(bool ball, bool small) {
  vxm_soup *soup = new_soup(context);
  add_cuboid(soup, 0, 0, 0, 3, 2, 1);
  if (ball)
    add_ball(soup, (double[]){6, 6, 6}, 2, 8, &upright, false);
  if (small)
    add_cuboid(soup, 9.9, 9.9, 9.9, 10, 10, 10);
  return soup;
}

static size_t count_lost(const vxm_soup *before, const vxm_soup *after, size_t lost_part) {
  vxm_lost_parts lost;
  assert_int_equal(vxm_lost_parts_find(&lost, before, after, NULL), VXM_OK);
  size_t count = lost.count;
  if (lost_part != SIZE_MAX)
    assert_true(lost.lost[lost_part]);
  vxm_lost_parts_destroy(&lost, before->context);
  return count;
}

static void missing_bodies_are_found(void **state) {
  (void)state;
  vxm_soup *all = three_bodies(true, true), *no_ball = three_bodies(false, true),
           *no_small = three_bodies(true, false);
  assert_int_equal(count_lost(all, all, SIZE_MAX), 0);
  assert_int_equal(count_lost(all, no_ball, 1), 1);
  assert_int_equal(count_lost(all, no_small, 2), 1);
  vxm_soup *none = new_soup(context);
  assert_int_equal(count_lost(all, none, 0), 3);
  vxm_soup_destroy(none);
  vxm_soup_destroy(no_small);
  vxm_soup_destroy(no_ball);
  vxm_soup_destroy(all);
}

/** One body instead of two equal ones, faces turned over, and a wall less between two rooms are no loss. */
static void mended_bodies_are_not(void **state) {
  (void)state;
  vxm_soup *before = three_bodies(true, true), *after = three_bodies(true, true);
  add_cuboid(before, 0, 0, 0, 3, 2, 1);
  turn_faces(before, 20);
  assert_int_equal(count_lost(before, after, SIZE_MAX), 0);
  vxm_soup_destroy(before);
  vxm_soup_destroy(after);
  before = new_soup(context);
  after = new_soup(context);
  add_cuboid(before, 0, 0, 0, 1, 1, 1);
  add_cuboid(before, 1, 0, 0, 2, 1, 1);
  add_cuboid(after, 0, 0, 0, 2, 1, 1);
  assert_int_equal(count_lost(before, after, SIZE_MAX), 0);
  vxm_soup_destroy(before);
  vxm_soup_destroy(after);
}

static void halves_and_what_is_open(void **state) {
  (void)state;
  vxm_soup *whole = new_soup(context), *half = new_soup(context);
  add_cuboid(whole, 0, 0, 0, 2, 1, 1);
  add_cuboid(half, 0, 0, 0, 1, 1, 1);
  assert_int_equal(count_lost(whole, half, 0), 1);
  assert_int_equal(count_lost(half, whole, SIZE_MAX), 0);
  add_triangle(whole, 0, 1, 2); /* open now: it encloses nothing for sure */
  assert_int_equal(count_lost(whole, half, SIZE_MAX), 0);
  vxm_soup_destroy(whole);
  vxm_soup_destroy(half);
}

/** Of thousands of plates every line meets all: neither time nor memory grows with the square, and what is
 * lost is found all the same. */
static void stacks_are_asked_by_few_lines(void **state) {
  (void)state;
  enum { PLATES = 4000 };
  vxm_context *small = NULL;
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.memory_limit = UINT64_C(256) << 20;
  assert_int_equal(vxm_context_create(&small, &options, NULL), VXM_OK);
  vxm_soup *stack = new_soup(small), *no_box = new_soup(small);
  add_cuboid(stack, 200, 200, 0, 400, 400, 2 * PLATES);
  for (int i = 0; i < PLATES; i++) {
    add_cuboid(stack, 0, 0, 2 * i, 100, 100, 2 * i + 1);
    add_cuboid(no_box, 0, 0, 2 * i, 100, 100, 2 * i + 1);
  }
  assert_int_equal(count_lost(stack, stack, SIZE_MAX), 0);
  assert_int_equal(count_lost(stack, no_box, 0), 1);
  vxm_soup_destroy(no_box);
  vxm_soup_destroy(stack);
  vxm_context_destroy(small);
}

static int64_t count_emptied(const vxm_soup *before, const vxm_soup *united) {
  int64_t count = -1;
  assert_int_equal(vxm_union_loss_find(&count, before, united, NULL), VXM_OK);
  return count;
}

/** Half of a bow tie, as unions leave it, is a loss, and the other one too; a cavity that cuts through its
 * body, or bodies that swallow others, are none. */
static void what_unions_lose(void **state) {
  (void)state;
  vxm_soup *bow = new_soup(context), *half = new_soup(context);
  add_bow(bow);
  const double x = 4.0 / 3, outline[3][2] = {{x, x}, {4, 0}, {4, 4}};
  for (int i = 0; i < 6; i++)
    add_vertex(half, outline[i % 3][0], outline[i % 3][1], i / 3);
  for (uint32_t i = 0; i < 3; i++)
    add_face(half, (uint32_t[]){i, (i + 1) % 3, (i + 1) % 3 + 3, i + 3}, 4);
  add_face(half, (uint32_t[]){2, 1, 0}, 3);
  add_face(half, (uint32_t[]){3, 4, 5}, 3);
  assert_int_equal(count_emptied(bow, half), 1);
  assert_int_equal(count_emptied(bow, bow), 0);
  add_cuboid(half, -1, -1, -1, 2, 3, 2); /* which has the other half in it */
  assert_int_equal(count_emptied(bow, half), 0);
  vxm_soup_destroy(half);
  vxm_soup_destroy(bow);

  vxm_soup *before = new_soup(context), *after = new_soup(context);
  add_cuboid(before, 0, 0, 0, 4, 1, 1);
  size_t faces = before->face_count;
  add_cuboid(before, 1, -1, -1, 3, 2, 2);
  add_cuboid(after, 0, 0, 0, 1, 1, 1);
  add_cuboid(after, 3, 0, 0, 4, 1, 1);
  assert_int_equal(count_emptied(before, after), 2);
  turn_faces(before, faces);
  assert_int_equal(count_emptied(before, after), 0);
  vxm_soup_destroy(after);
  after = new_soup(context);
  add_cuboid(after, 0, 0, 0, 1, 1, 1);
  assert_int_equal(count_emptied(before, after), 1);
  vxm_soup_destroy(after);
  vxm_soup_destroy(before);
}

/** Bodies that lie in a cavity may not go with what it takes away. */
static void what_lies_in_cavities(void **state) {
  (void)state;
  vxm_soup *before = new_soup(context), *after = new_soup(context), *all = new_soup(context);
  add_cuboid(before, 2, 2, 2, 4, 4, 4);
  add_cuboid(before, 5, 3, 5, 6, 5, 6);
  size_t faces = before->face_count;
  add_cuboid(before, 1, 0, 1, 7, 6, 7);
  turn_faces(before, faces);
  add_cuboid(before, 0, 0, 0, 8, 8, 8);
  add_cuboid(after, 0, 0, 0, 1, 8, 8);
  add_cuboid(after, 7, 0, 0, 8, 8, 8);
  add_cuboid(after, 1, 0, 0, 7, 8, 1);
  add_cuboid(after, 1, 0, 7, 7, 8, 8);
  add_cuboid(after, 1, 6, 1, 7, 8, 7);
  assert_int_equal(count_emptied(before, after), 2);
  add_cuboid(after, 2, 2, 2, 4, 4, 4);
  assert_int_equal(count_emptied(before, after), 1);
  add_cuboid(all, 0, 0, 0, 8, 8, 8);
  assert_int_equal(count_emptied(before, all), 0);
  vxm_soup_destroy(all);
  vxm_soup_destroy(after);
  vxm_soup_destroy(before);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(missing_bodies_are_found), cmocka_unit_test(mended_bodies_are_not),
      cmocka_unit_test(halves_and_what_is_open),  cmocka_unit_test(stacks_are_asked_by_few_lines),
      cmocka_unit_test(what_unions_lose),         cmocka_unit_test(what_lies_in_cavities)};
  return cmocka_run_group_tests(tests, hold_context, release_context);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Boxes without one side that stand on the same floor, or at the same wall: where they are flush their rims
 * have edges or vertices in common once vertices are welded. The solid is the union of the boxes, cell by
 * cell, as for closed ones.
 */
#include "cells.h"

#include "base/context_struct.h"

enum { BOXES_MAX = 5, FACES_MAX = 2 * 5 * BOXES_MAX };

typedef struct box {
  int low[3], high[3];
} box;

/** What is done to faces. */
typedef enum damage { NONE, FACES_TURNED, BOXES_TURNED } damage;

/** A scene: boxes without side `open` (2 * axis, + 1 for the upper one), which all have at one place. */
typedef struct scene {
  box boxes[BOXES_MAX];
  int count, open;
  bool wanted[CELLS];
} scene;

static box random_box(vxm_rng *rng, int open) {
  box b;
  for (int a = 0; a < 3; a++) {
    b.low[a] = (int)vxm_rng_below(rng, SIDE);
    b.high[a] = b.low[a] + 1 + (int)vxm_rng_below(rng, (uint64_t)(SIDE - b.low[a]));
  }
  if (open % 2)
    b.high[open / 2] = SIDE;
  else
    b.low[open / 2] = 0;
  return b;
}

static bool has(const box *b, int x, int y, int z) {
  return x >= b->low[0] && x < b->high[0] && y >= b->low[1] && y < b->high[1] && z >= b->low[2] &&
         z < b->high[2];
}

/** Whether each box has a cell of its own: what lies within others may be a void. */
static bool find_wanted(scene *s) {
  bool own[BOXES_MAX] = {false};
  for (int c = 0; c < CELLS; c++) {
    int boxes = 0, last = 0;
    for (int i = 0; i < s->count; i++)
      if (has(&s->boxes[i], c % SIDE, c / SIDE % SIDE, c / SIDE / SIDE)) {
        boxes++;
        last = i;
      }
    s->wanted[c] = boxes > 0;
    own[last] = own[last] || boxes == 1;
  }
  bool all = true;
  for (int i = 0; i < s->count; i++)
    all = all && own[i];
  return all;
}

/** Whether no box is so flat that it is a sheet to the repair, which keeps the side that it came with. */
static bool are_deep(const scene *s) {
  for (int i = 0; i < s->count; i++) {
    const box *b = &s->boxes[i];
    int axis = s->open / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    int size[3] = {b->high[axis] - b->low[axis], b->high[u] - b->low[u], b->high[v] - b->low[v]};
    int lid = size[1] * size[2], walls = 2 * size[0] * (size[1] + size[2]);
    if (10 * lid > 4 * (lid + walls))
      return false;
  }
  return true;
}

static scene random_scene(vxm_rng *rng, bool deep) {
  scene s;
  do {
    s = (scene){.count = 2 + (int)vxm_rng_below(rng, BOXES_MAX - 1), .open = (int)vxm_rng_below(rng, 6)};
    for (int i = 0; i < s.count; i++)
      s.boxes[i] = random_box(rng, s.open);
  } while (!find_wanted(&s) || (deep && !are_deep(&s)));
  return s;
}

static void add_side(vxm_soup *soup, const box *b, int side, const manner *how, bool inward, vxm_rng *rng) {
  int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  uint32_t first = (uint32_t)soup->vertex_count, face[4];
  for (int c = 0; c < 4; c++) {
    int p[3];
    p[axis] = side % 2 ? b->high[axis] : b->low[axis];
    p[u] = c == 1 || c == 2 ? b->high[u] : b->low[u];
    p[v] = c >= 2 ? b->high[v] : b->low[v];
    add_corner(soup, how, p);
    face[(side % 2 == 1) != inward ? c : 3 - c] = first + (uint32_t)c;
  }
  size_t cut = (size_t)vxm_rng_below(rng, 2);
  if (!how->triangles) {
    add_face(soup, face, 4);
    return;
  }
  add_triangle(soup, face[cut], face[cut + 1], face[cut + 2]);
  add_triangle(soup, face[cut], face[cut + 2], face[(cut + 3) % 4]);
}

static bool overlaps_others(const scene *s, int number) {
  for (int i = 0; i < s->count; i++) {
    bool apart = i == number;
    for (int a = 0; a < 3; a++)
      apart = apart || s->boxes[i].low[a] >= s->boxes[number].high[a] ||
              s->boxes[i].high[a] <= s->boxes[number].low[a];
    if (!apart)
      return true;
  }
  return false;
}

/** Adds the sides of the boxes, in any order. Boxes turned over overlap no others: of those that do nobody
 * can tell whether they are cut out. */
static void add_scene(vxm_soup *soup, const scene *s, const manner *how, damage done, vxm_rng *rng) {
  int sides[FACES_MAX], count = 0;
  bool inward[FACES_MAX];
  for (int i = 0; i < s->count; i++) {
    int turned = done == FACES_TURNED ? (int)vxm_rng_below(rng, 6) : 6;
    bool all = done == BOXES_TURNED && !overlaps_others(s, i) && vxm_rng_below(rng, 3) > 0;
    for (int side = 0; side < 6; side++)
      if (side != s->open) {
        inward[6 * i + side] = all || side == turned;
        sides[count++] = 6 * i + side;
      }
  }
  for (int left = count; left > 0; left--) {
    int at = (int)vxm_rng_below(rng, (uint64_t)left), side = sides[at];
    add_side(soup, &s->boxes[side / 6], side % 6, how, inward[side], rng);
    sides[at] = sides[left - 1];
  }
}

static void describe(const scene *s) {
  for (int i = 0; i < s->count; i++)
    print_message("%d %d %d to %d %d %d\n", s->boxes[i].low[0], s->boxes[i].low[1], s->boxes[i].low[2],
                  s->boxes[i].high[0], s->boxes[i].high[1], s->boxes[i].high[2]);
  print_message("without side %d\n", s->open);
}

/** @param level that the mesh is repaired to before, as a file that is read again; or -1 */
static bool is_right(vxm_context *context, uint64_t seed, const manner *how, damage done, int level) {
  vxm_rng rng = {seed};
  scene s = random_scene(&rng, done != NONE);
  vxm_soup *soup = new_soup(context), *prepared;
  add_scene(soup, &s, how, done, &rng);
  if (level >= 0) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.level = (vxm_level)level;
    vxm_soup *out;
    assert_int_equal(vxm_repair_run(&out, NULL, soup, &options, NULL), VXM_OK);
    vxm_soup_destroy(soup);
    soup = out;
  }
  assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
  int wrong = count_wrong(prepared, how, s.wanted);
  if (wrong > 0) {
    print_message("seed %llu: %d voxels are wrong\n", (unsigned long long)seed, wrong);
    describe(&s);
  }
  vxm_soup_destroy(prepared);
  vxm_soup_destroy(soup);
  return wrong == 0;
}

static int count_bad(vxm_context *context, const manner *how, damage done, int level) {
  int bad = 0;
  for (uint64_t seed = 1; seed <= rounds_of(300); seed++)
    bad += !is_right(context, seed, how, done, level);
  return bad;
}

static void boxes_are_united(void **state) {
  manner triangles = squares;
  triangles.triangles = true;
  assert_int_equal(count_bad(*state, &squares, NONE, -1), 0);
  assert_int_equal(count_bad(*state, &triangles, NONE, -1), 0);
}

static void so_they_are_in_any_direction(void **state) {
  double c = cos(0.7), s = sin(0.7), d = cos(0.4), t = sin(0.4);
  manner how = {.turn = {{c, -s * d, s * t}, {s, c * d, -c * t}, {0, t, d}}, .unit = 0.01};
  assert_int_equal(count_bad(*state, &how, NONE, -1), 0);
}

static void so_they_are_by_way_of_a_file(void **state) {
  assert_int_equal(count_bad(*state, &squares, NONE, VXM_LEVEL_CLEAN), 0);
  assert_int_equal(count_bad(*state, &squares, NONE, VXM_LEVEL_CLOSED), 0);
}

static void faces_may_be_turned(void **state) {
  assert_int_equal(count_bad(*state, &squares, FACES_TURNED, -1), 0);
}

static void boxes_may_be_turned(void **state) {
  assert_int_equal(count_bad(*state, &squares, BOXES_TURNED, -1), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(boxes_are_united),
      cmocka_unit_test(so_they_are_in_any_direction),
      cmocka_unit_test(so_they_are_by_way_of_a_file),
      cmocka_unit_test(faces_may_be_turned),
      cmocka_unit_test(boxes_may_be_turned),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}

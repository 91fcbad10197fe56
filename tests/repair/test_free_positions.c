/* SPDX-License-Identifier: BSD-3-Clause */
/** Positions for many vertices of one position: the same as by asking for each position anew whether it is
 * taken. */
#include "../mesh/soups.h"

#include "repair/manifold/free_positions.h"

#include <math.h>

enum { MOST = 20000 };

typedef struct crowd {
  vxm_soup *soup;
  uint32_t number[MOST];
  vxm_position_set taken, floats;
  vxm_free_positions near;
} crowd;

/** Whether a vertex other than one has a position, in doubles or in 32-bit floats, by looking at each. */
static bool taken_by_all(const vxm_soup *soup, uint32_t vertex, const double p[3], bool floats) {
  for (uint32_t v = 0; v < soup->vertex_count; v++) {
    const double *q = vxm_position(soup, v);
    if (v != vertex &&
        ((p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) ||
         (floats && (float)p[0] == (float)q[0] && (float)p[1] == (float)q[1] && (float)p[2] == (float)q[2])))
      return true;
  }
  return false;
}

/** The definition: the nearest by distance and number, of those that are free and near enough. */
static bool nearest_by_all(const vxm_soup *soup, uint32_t vertex, const vxm_position_move *by, double p[3]) {
  double least = INFINITY;
  for (int n = 1; n < 64; n++) {
    const int steps[3] = {n % 4, n / 4 % 4, n / 16};
    double at[3], along = 0, squared = 0;
    bool is_near = true;
    for (int a = 0; a < 3; a++) {
      double step = copysign(steps[a] * fmax(by->step, by->unit[a]), by->toward[a]);
      at[a] = by->from[a] + step;
      along += step * by->toward[a];
      squared += step * step;
      is_near = is_near && fabs(at[a] - by->from[a]) <= by->coarse;
    }
    if (is_near && along >= VXM_MOVE_AXIS * sqrt(squared) && sqrt(squared) < least &&
        !taken_by_all(soup, vertex, at, by->floats)) {
      least = sqrt(squared);
      memcpy(p, at, sizeof at);
    }
  }
  return least < INFINITY;
}

static vxm_position_move random_moves(const double from[3], vxm_rng *rng) {
  vxm_position_move by = {.step = vxm_rng_below(rng, 4) ? 0.125 : 0.25,
                          .fine = -1, /* nothing but the search all around */
                          .coarse = vxm_rng_below(rng, 3) ? 4 : 0.3,
                          .floats = vxm_rng_below(rng, 2)};
  double squared = 0;
  for (int a = 0; a < 3; a++) {
    by.from[a] = from[a];
    by.unit[a] = a == 2 ? 0.25 : 0.0625;
    by.toward[a] = 2 * vxm_rng_unit(rng) - 1;
    squared += by.toward[a] * by.toward[a];
  }
  for (int a = 0; a < 3; a++)
    by.toward[a] /= sqrt(squared);
  return by;
}

/** Vertices at a few positions; where these lie near to each other what one vertex leaves another may take.
 */
static void crowd_open(crowd *c, vxm_context *context, size_t count, double apart, vxm_rng *rng) {
  vxm_soup *soup = c->soup = new_soup(context);
  for (size_t v = 0; v < count; v++) {
    add_vertex(soup, 2 * apart * (double)vxm_rng_below(rng, 3), apart * (double)vxm_rng_below(rng, 2), 1);
    c->number[v] = vxm_rng_below(rng, 50) ? (uint32_t)v : VXM_NO_VERTEX;
  }
  assert_int_equal(vxm_position_set_open(&c->taken, soup, 2 * count, VXM_MERGE_EXACT, NULL), VXM_OK);
  assert_int_equal(vxm_position_set_open(&c->floats, soup, 2 * count, VXM_MERGE_FLOAT, NULL), VXM_OK);
  for (uint32_t v = 0; v < count; v++) {
    vxm_position_set_add(&c->taken, v);
    vxm_position_set_add(&c->floats, v);
  }
  c->near = (vxm_free_positions){.taken = &c->taken, .floats = &c->floats, .number = c->number};
  c->near.full = calloc(VXM_FULL_POSITIONS, sizeof *c->near.full);
  assert_non_null(c->near.full);
}

static void crowd_close(crowd *c) {
  free(c->near.full);
  vxm_position_set_close(&c->floats);
  vxm_position_set_close(&c->taken);
  vxm_soup_destroy(c->soup);
}

static bool crowd_move(crowd *c, uint32_t v, const vxm_position_move *by, double to[3]) {
  bool found = vxm_free_positions_find(&c->near, v, by, to);
  if (found)
    memcpy(c->soup->positions + 3 * (size_t)v, to, 3 * sizeof *to);
  vxm_position_set_add(&c->taken, v);
  vxm_position_set_add(&c->floats, v);
  return found;
}

static crowd the_crowd;

static void same_as_asking_anew(void **state) {
  (void)state;
  enum { COUNT = 900 };
  crowd *c = &the_crowd;
  vxm_context *context = context_of_threads(1);
  vxm_rng rng = {4};
  int moved = 0, stayed = 0;
  for (int round = 0; round < 6; round++) {
    crowd_open(c, context, COUNT, round % 2 ? 0.125 : 8, &rng);
    for (uint32_t v = 0; v < COUNT; v++) {
      double to[3], expected[3];
      const double from[3] = {vxm_position(c->soup, v)[0], vxm_position(c->soup, v)[1],
                              vxm_position(c->soup, v)[2]};
      vxm_position_move by = random_moves(from, &rng);
      if (c->number[v] == VXM_NO_VERTEX)
        continue;
      bool is_there = nearest_by_all(c->soup, v, &by, expected);
      assert_int_equal(crowd_move(c, v, &by, to), is_there);
      if (is_there)
        assert_memory_equal(to, expected, sizeof to);
      moved += is_there;
      stayed += !is_there;
    }
    crowd_close(c);
  }
  assert_true(moved > 500 && stayed > 500);
  vxm_context_destroy(context);
}

/** Where all positions about it are taken, that is not found out anew for each of many vertices. */
static void looks_up_few(void **state) {
  (void)state;
  crowd *c = &the_crowd;
  vxm_context *context = context_of_threads(1);
  vxm_rng rng = {5};
  crowd_open(c, context, MOST, 8, &rng);
  for (uint32_t v = 0; v < MOST; v++) {
    double to[3];
    vxm_position_move by = random_moves(vxm_position(c->soup, v), &rng);
    (void)crowd_move(c, v, &by, to);
  }
  print_message("%.2f positions looked up for each of %d vertices\n", (double)c->near.looked_up / MOST, MOST);
  assert_true(c->near.looked_up < 5 * (uint64_t)MOST);
  crowd_close(c);
  vxm_context_destroy(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(same_as_asking_anew),
      cmocka_unit_test(looks_up_few),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

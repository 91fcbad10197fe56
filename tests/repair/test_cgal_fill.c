/* SPDX-License-Identifier: BSD-3-Clause */
/** Holes filled smoothly, and components turned. */
#include "solids.h"

#include "repair_test.h"

static vxm_soup *fill(const vxm_soup *soup, size_t max_edges, int64_t filled, int64_t left) {
  vxm_soup *out;
  uint64_t *origin;
  int64_t counts[2];
  vxm_error error = VXM_ERROR_INIT;
  if (cgal->fill(&out, &origin, &counts[0], &counts[1], soup, max_edges, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_int_equal(counts[0], filled);
  assert_int_equal(counts[1], left);
  /* what was there comes first, as it was */
  assert_true(out->vertex_count >= soup->vertex_count && out->face_count >= soup->face_count);
  if (soup->vertex_count > 0)
    assert_memory_equal(out->positions, soup->positions, 3 * soup->vertex_count * sizeof *soup->positions);
  assert_memory_equal(out->offsets, soup->offsets, (soup->face_count + 1) * sizeof *soup->offsets);
  assert_memory_equal(out->indices, soup->indices, soup->corner_count * sizeof *soup->indices);
  for (size_t f = 0; f < out->face_count; f++)
    assert_true(origin[f] == (f < soup->face_count ? f : VXM_NO_FACE));
  vxm_free(context, origin);
  return out;
}

/** Leaves out the faces whose middle is nearer to a point than so much. */
static vxm_soup *with_hole(const vxm_soup *soup, const double at[3], double radius) {
  vxm_soup *out = new_soup(context);
  for (size_t v = 0; v < soup->vertex_count; v++)
    add_vertex(out, soup->positions[3 * v], soup->positions[3 * v + 1], soup->positions[3 * v + 2]);
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    double middle[3] = {0, 0, 0};
    for (size_t c = 0; c < count; c++)
      for (int i = 0; i < 3; i++)
        middle[i] += vxm_position(soup, corner[c])[i] / (double)count;
    if (distance_between(middle, at) >= radius)
      add_face(out, corner, count);
  }
  return out;
}

static void holes_in_a_ball(void **state) {
  (void)state;
  vxm_soup *ball = new_soup(context);
  add_ball(ball, (double[]){3, -2, 1}, 2, 20, &upright, false);
  double whole = volume_of(ball);
  vxm_soup *soup = ball;
  const double at[4][3] = {{5, -2, 1}, {3, 0, 1}, {3, -2, 3}, {1.6, -3.4, 1}};
  const double radius[4] = {0.7, 0.4, 1, 0.5};
  for (int i = 0; i < 4; i++) {
    vxm_soup *next = with_hole(soup, at[i], radius[i]);
    vxm_soup_destroy(soup);
    soup = next;
  }
  double open = fabs(volume_of(soup) - whole);
  vxm_soup *out = fill(soup, 0, 4, 0);
  /* the vertices in the holes are not used any more */
  assert_solid(out);
  assert_true(fabs(volume_of(out) - whole) < 0.01 * whole && open > 0.02 * whole);
  /* and what is new lies on the ball, nearly */
  for (size_t v = soup->vertex_count; v < out->vertex_count; v++) {
    double r = distance_between(vxm_position(out, v), (double[]){3, -2, 1});
    assert_true(fabs(r - 2) < 0.1);
  }
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

static void at_most_so_many_edges(void **state) {
  (void)state;
  vxm_soup *ball = new_soup(context);
  add_ball(ball, (double[]){0, 0, 0}, 1, 12, &upright, false);
  vxm_soup *one = with_hole(ball, (double[]){0, 0, 1}, 0.2), *two = with_hole(one, (double[]){0, 0, -1}, 0.5);
  /* the rims at the poles have 24 edges both */
  vxm_soup_destroy(fill(two, 23, 0, 2));
  vxm_soup_destroy(fill(two, 24, 2, 0));
  vxm_soup_destroy(two);
  vxm_soup_destroy(one);
  vxm_soup_destroy(ball);
}

static void corners_and_edges(void **state) {
  (void)state;
  /* a cube without a face, without two that share an edge, and without a triangle */
  for (int missing = 1; missing <= 3; missing++) {
    vxm_soup *soup = new_soup(context), *open = new_soup(context);
    add_box(soup, (double[]){0, 0, 0}, (double[]){1, 1, 1}, &upright, missing == 3, false);
    for (size_t v = 0; v < soup->vertex_count; v++)
      add_vertex(open, soup->positions[3 * v], soup->positions[3 * v + 1], soup->positions[3 * v + 2]);
    for (size_t f = missing == 2 ? 0 : 1; f < soup->face_count; f++) {
      size_t count;
      const uint32_t *corner = vxm_face(soup, f, &count);
      if (missing != 2 || (f != 1 && f != 3))
        add_face(open, corner, count);
    }
    vxm_soup *out = fill(open, 0, 1, 0);
    assert_solid(out);
    assert_true(volume_of(out) > 0.4 && volume_of(out) < 2.5);
    vxm_soup_destroy(out);
    vxm_soup_destroy(open);
    vxm_soup_destroy(soup);
  }
}

static void what_is_left(void **state) {
  (void)state;
  /* a sheet: its filling would lie on it */
  vxm_soup *soup = grid_sheet(context, 5), *out = fill(soup, 0, 0, 1);
  assert_int_equal(out->face_count, soup->face_count);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
  /* a slit: the rim lies upon itself */
  soup = new_soup(context);
  add_cuboid(soup, 0, 0, 0, 1, 1, 1);
  for (uint32_t v = 0; v < 2; v++) {
    uint32_t copy = (uint32_t)soup->vertex_count, old = soup->indices[v];
    add_vertex(soup, soup->positions[3 * old], soup->positions[3 * old + 1], soup->positions[3 * old + 2]);
    soup->indices[v] = copy;
  }
  out = fill(soup, 0, 0, 1);
  assert_int_equal(out->face_count, soup->face_count);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
  /* nothing at all */
  soup = new_soup(context);
  out = fill(soup, 0, 0, 0);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

/** A pyramid whose tip has been cut off and a lid that a smooth filling would run through. */
static void not_through_the_surface(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context);
  add_ball(soup, (double[]){0, 0, 0}, 1, 16, &upright, false);
  vxm_soup *open = with_hole(soup, (double[]){0, 0, 1}, 0.5);
  /* a plate just above the rim's plane, below where the ball would go on */
  add_cuboid(open, -3, -3, 0.93, 3, 3, 0.94);
  vxm_soup *out = fill(open, 0, 1, 0);
  assert_solid(out);
  vxm_soup_destroy(out);
  vxm_soup_destroy(open);
  vxm_soup_destroy(soup);
}

static void tags_of_new_faces(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context);
  add_ball(soup, (double[]){0, 0, 0}, 1, 8, &upright, false);
  vxm_soup *open = with_hole(soup, (double[]){0, 0, 1}, 0.5);
  uint32_t tag;
  assert_int_equal(vxm_soup_add_tag(open, "a", 1, &tag, NULL), VXM_OK);
  assert_int_equal(vxm_soup_add_tag(open, "b", 1, &tag, NULL), VXM_OK);
  open->face_tags = vxm_alloc(context, open->face_count, sizeof *open->face_tags, NULL);
  for (size_t f = 0; f < open->face_count; f++)
    open->face_tags[f] = 1;
  vxm_soup *out = fill(open, 0, 1, 0);
  assert_int_equal(out->tag_count, 2);
  for (size_t f = 0; f < out->face_count; f++)
    assert_int_equal(out->face_tags[f], 1);
  vxm_soup_destroy(out);
  vxm_soup_destroy(open);
  vxm_soup_destroy(soup);
}

/* ---- Components turned ---- */

static void check_turned(const vxm_soup *right, vxm_rng *rng) {
  /* whole components are turned at random: those of 12 faces are boxes */
  vxm_soup *soup;
  assert_int_equal(vxm_soup_copy(&soup, right, NULL), VXM_OK);
  int64_t expected = 0, turned;
  for (size_t f = 0; f < soup->face_count; f += 12)
    if (vxm_rng_below(rng, 2)) {
      for (size_t k = f; k < f + 12; k++) {
        uint32_t *corner = soup->indices + soup->offsets[k], kept = corner[0];
        corner[0] = corner[2];
        corner[2] = kept;
      }
      expected += 12;
    }
  vxm_soup *out;
  assert_int_equal(cgal->orient(&out, &turned, soup, NULL), VXM_OK);
  assert_int_equal(turned, expected);
  assert_same_soup(out, right);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

static void components_are_turned(void **state) {
  (void)state;
  vxm_rng rng = {1};
  vxm_soup *soup = new_soup(context);
  /* shells in shells, beside each other, and parts that overlap with a cavity in each and in both */
  for (int at = 0; at < 3; at++)
    for (int i = 0; i < 5; i++) {
      double low = i + 20 * at, high = 20 * at + 12 - i;
      (i % 2 ? add_hollow : add_cuboid)(soup, low, low, low, high, high, high);
    }
  add_cuboid(soup, 100, 0, 0, 110, 10, 10);
  add_cuboid(soup, 105, 2, 2, 115, 8, 8);
  add_hollow(soup, 101, 1, 1, 102, 2, 2);
  add_hollow(soup, 106, 4, 4, 107, 5, 5);
  add_hollow(soup, 112, 4, 4, 113, 5, 5);
  for (int round = 0; round < 20; round++)
    check_turned(soup, &rng);
  vxm_soup_destroy(soup);
}

static void open_parts_stay(void **state) {
  (void)state;
  vxm_soup *soup = grid_sheet(context, 3), *out;
  add_hollow(soup, 5, 5, 5, 6, 6, 6);
  int64_t turned;
  assert_int_equal(cgal->orient(&out, &turned, soup, NULL), VXM_OK);
  assert_int_equal(turned, 12);
  assert_memory_equal(out->indices, soup->indices, 18 * 3 * sizeof *soup->indices);
  assert_true(volume_of(out) == 1);
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

/* ---- Promises ---- */

static int calls_left;

static int stop_after(const char *phase, double fraction, void *payload) {
  (void)phase;
  (void)payload;
  assert_true(fraction >= 0 && fraction <= 1);
  return calls_left-- <= 0;
}

static void cancelled(void **state) {
  (void)state;
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.progress = stop_after;
  vxm_context *owner;
  assert_int_equal(vxm_context_create(&owner, &options, NULL), VXM_OK);
  vxm_soup *soup = new_soup(owner);
  add_ball(soup, (double[]){0, 0, 0}, 1, 20, &upright, false);
  soup->face_count -= 10;
  soup->corner_count = soup->offsets[soup->face_count];
  bool done = false;
  for (int calls = 0; !done; calls++) {
    calls_left = calls;
    vxm_soup *out;
    uint64_t *origin;
    int64_t filled, left;
    vxm_status status = cgal->fill(&out, &origin, &filled, &left, soup, 0, NULL);
    done = status == VXM_OK;
    assert_true(done || (status == VXM_ERROR_CANCELLED && out == NULL && origin == NULL));
    vxm_soup_destroy(out);
    vxm_free(owner, origin);
  }
  vxm_soup_destroy(soup);
  vxm_context_destroy(owner);
}

static void the_same_each_time(void **state) {
  (void)state;
  vxm_soup *ball = new_soup(context);
  add_ball(ball, (double[]){0, 0, 0}, 1, 14, &upright, false);
  vxm_soup *open = with_hole(ball, (double[]){1, 0, 0}, 0.6);
  vxm_soup *first = fill(open, 0, 1, 0), *second = fill(open, 0, 1, 0);
  assert_same_soup(first, second);
  vxm_soup_destroy(first);
  vxm_soup_destroy(second);
  vxm_soup_destroy(open);
  vxm_soup_destroy(ball);
}

int main(void) {
  if (!open_cgal())
    return 77;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(holes_in_a_ball),
      cmocka_unit_test(at_most_so_many_edges),
      cmocka_unit_test(corners_and_edges),
      cmocka_unit_test(what_is_left),
      cmocka_unit_test(not_through_the_surface),
      cmocka_unit_test(tags_of_new_faces),
      cmocka_unit_test(components_are_turned),
      cmocka_unit_test(open_parts_stay),
      cmocka_unit_test(cancelled),
      cmocka_unit_test(the_same_each_time),
  };
  return cmocka_run_group_tests(tests, hold_context, release_context);
}

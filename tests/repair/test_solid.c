/* SPDX-License-Identifier: BSD-3-Clause */
/** What a repair does with the module for CGAL: unions among open parts, wraps, counts of self-intersections.
 */
#include "solids.h"

#include "repair/defects.h"
#include "repair/repair.h"
#include "repair/verify.h"
#include "repair_test.h"

enum { CELLS = 8 };

/** Boxes on a lattice, and how many of its cells they cover. */
static vxm_soup *random_boxes(vxm_rng *rng, int count, double *volume) {
  bool full[CELLS][CELLS][CELLS] = {false};
  vxm_soup *soup = new_soup(context);
  for (int i = 0; i < count; i++) {
    int low[3], high[3];
    for (int a = 0; a < 3; a++) {
      low[a] = (int)vxm_rng_below(rng, CELLS - 3);
      high[a] = low[a] + 1 + (int)vxm_rng_below(rng, 3);
    }
    add_box(soup, (double[]){low[0], low[1], low[2]}, (double[]){high[0], high[1], high[2]}, &upright,
            i % 2 == 0, false);
    for (int x = low[0]; x < high[0]; x++)
      for (int y = low[1]; y < high[1]; y++)
        for (int z = low[2]; z < high[2]; z++)
          full[x][y][z] = true;
  }
  *volume = 0;
  for (int c = 0; c < CELLS * CELLS * CELLS; c++)
    *volume += full[c / CELLS / CELLS][c / CELLS % CELLS][c % CELLS];
  return soup;
}

static vxm_soup *repair(const vxm_soup *soup, const vxm_repair_options *options, vxm_repair_report *report) {
  vxm_soup *out;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_repair_run(&out, report, soup, options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return out;
}

static void solids_of_boxes(void **state) {
  (void)state;
  vxm_rng rng = {3};
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.level = VXM_LEVEL_SOLID;
  options.intersections = true;
  for (int round = 0; round < 30; round++) {
    double volume;
    vxm_soup *soup = random_boxes(&rng, 1 + round / 3, &volume);
    vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
    options.single_precision = round % 2 == 0;
    vxm_soup *out = repair(soup, &options, &report);
    assert_true(report.self_intersections_before == (int64_t)count_meetings(soup));
    assert_int_equal(report.self_intersections_after, 0);
    assert_int_equal(report.union_failures, 0);
    assert_int_equal(report.emptied_parts, 0);
    assert_solid(out);
    assert_true(fabs(volume_of(out) - volume) < 1e-4 * volume);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

/** Boxes whose walls lie in one plane but for some digits: between them unions have slivers of that size. */
static void solids_of_noisy_boxes(void **state) {
  (void)state;
  enum { ROUNDS = 40 };
  vxm_rng rng = {5};
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.level = VXM_LEVEL_SOLID;
  int reached = 0;
  for (int round = 0; round < ROUNDS; round++) {
    double volume, noise = pow(10, -6 - round % 5);
    options.part_changes = round % 2; /* whose account follows all moves */
    vxm_soup *soup = random_boxes(&rng, 2 + round / 4, &volume);
    for (size_t i = 0; i < 3 * soup->vertex_count; i++)
      soup->positions[i] += noise * (vxm_rng_unit(&rng) - 0.5);
    vxm_soup *out = repair(soup, &options, NULL);
    vxm_verification found = VXM_VERIFICATION_INIT;
    assert_int_equal(vxm_verify(&found, out, &options, NULL), VXM_OK);
    reached += found.reached;
    if (found.reached)
      assert_solid(out);
    assert_true(fabs(volume_of(out) - volume) < 1e-4 * volume);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
  printf("%d of %d noisy unions are solids\n", reached, ROUNDS);
  assert_true(reached >= ROUNDS * 9 / 10);
}

/** Five boards, as of a cabinet, of which each lies flat on others but for the rounding of its corners. */
static double add_cabinet(vxm_soup *soup, vxm_rng *rng) {
  double t = 4 + 8 * vxm_rng_unit(rng), w = 60 + 50 * vxm_rng_unit(rng), d = 60 + 50 * vxm_rng_unit(rng),
         h = 60 + 50 * vxm_rng_unit(rng);
  const double boards[5][6] = {{0, 0, 0, w, d, t},
                               {0, 0, h - t, w, d, h},
                               {0, 0, t, t, d, h - t},
                               {w - t, 0, t, w, d, h - t},
                               {t, d - t, t, w - t, d, h - t}};
  const frame3 turned = random_frame(rng);
  double volume = 0;
  for (int b = 0; b < 5; b++) {
    double low[3], high[3], size = 1;
    for (int a = 0; a < 3; a++) {
      const double middle = (double[]){w, d, h}[a] / 2;
      low[a] = boards[b][a] - middle;
      high[a] = boards[b][a + 3] - middle;
      size *= high[a] - low[a];
    }
    add_box(soup, low, high, &turned, true, false);
    volume += size;
  }
  return volume;
}

/** A union that is to be right in floats is so without any more rounding. */
static void unions_in_floats(void **state) {
  (void)state;
  vxm_rng rng = {8};
  const vxm_union_options options = {.single_precision = true};
  for (int round = 0; round < 10; round++) {
    vxm_soup *soup = new_soup(context), *out;
    add_cabinet(soup, &rng);
    for (size_t i = 0; i < 3 * soup->vertex_count; i++)
      soup->positions[i] = (double)(float)soup->positions[i];
    assert_int_equal(cgal->unite(&out, NULL, NULL, soup, &options, NULL), VXM_OK);
    for (size_t i = 0; i < 3 * out->vertex_count; i++)
      assert_true(out->positions[i] == (double)(float)out->positions[i]);
    assert_int_equal(count_meetings(out), 0);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

static void solids_of_cabinets(void **state) {
  (void)state;
  vxm_rng rng = {7};
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.level = VXM_LEVEL_SOLID;
  for (int round = 0; round < 40; round++) {
    vxm_soup *soup = new_soup(context);
    vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
    double volume = add_cabinet(soup, &rng);
    options.single_precision = round % 4 != 3;
    vxm_soup *out = repair(soup, &options, &report);
    assert_int_equal(report.union_failures, 0);
    assert_solid(out);
    assert_true(fabs(volume_of(out) - volume) < 1e-4 * volume);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

/** A surface that runs through itself keeps what it winds round the other way. */
static void both_halves_of_a_bow(void **state) {
  (void)state;
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.level = VXM_LEVEL_SOLID;
  for (int beside = 0; beside < 2; beside++) {
    vxm_soup *soup = new_soup(context);
    add_bow(soup);
    if (beside) {
      add_cuboid(soup, 10, 0, 0, 12, 1, 1);
      add_cuboid(soup, 11, 0.5, 0.5, 13, 2, 2);
    }
    vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
    vxm_soup *out = repair(soup, &options, &report);
    assert_int_equal(report.emptied_parts, 0);
    assert_solid(out);
    double boxes = beside ? 2 + 4.5 - 0.25 : 0;
    assert_true(fabs(volume_of(out) - 20.0 / 3 - boxes) < 1e-4);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

/** Open parts stay, each as it was, and the others are united. */
static void open_parts_among_them(void **state) {
  (void)state;
  vxm_rng rng = {4};
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.boolean_union = options.part_changes = options.intersections = true;
  for (int round = 0; round < 20; round++) {
    double volume;
    vxm_soup *soup = random_boxes(&rng, 5, &volume);
    uint32_t first = (uint32_t)soup->vertex_count;
    /* one sheet beside all, one through all that is there at this height */
    for (int i = 0; i < 2; i++) {
      double z = i ? 2.5 : 20.5;
      add_vertex(soup, -20, -20, z);
      add_vertex(soup, 40, -20, z);
      add_vertex(soup, -20, 40, z);
      add_triangle(soup, first, first + 1, first + 2);
      first += 3;
    }
    vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
    vxm_soup *out = repair(soup, &options, &report);
    const vxm_part_change *parts = out->part_changes;
    int64_t left = 0, sheets = 0;
    for (size_t p = 0; p < out->part_count; p++) {
      bool crossed = parts[p].after->self_intersections > 0;
      assert_true(!crossed || parts[p].union_failed);
      left += parts[p].union_failed;
      if (parts[p].before->closed)
        continue;
      sheets++;
      assert_int_equal(parts[p].after->faces, 1);
      assert_true(parts[p].union_failed == (parts[p].before->self_intersections > 0));
    }
    assert_int_equal(sheets, 2);
    assert_int_equal(report.union_failures, left);
    /* without the sheets it is the union */
    vxm_soup *closed = new_soup(context);
    for (size_t v = 0; v < out->vertex_count; v++)
      add_vertex(closed, out->positions[3 * v], out->positions[3 * v + 1], out->positions[3 * v + 2]);
    for (size_t f = 0; f < out->face_count; f++) {
      size_t n;
      const uint32_t *corner = vxm_face(out, f, &n);
      if (vxm_position(out, corner[0])[0] > -10)
        add_face(closed, corner, n);
    }
    assert_true(fabs(volume_of(closed) - volume) < 1e-9 * volume);
    assert_int_equal(count_meetings(closed), 0);
    vxm_soup_destroy(closed);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
}

static void what_is_not_to_be_combined(void **state) {
  (void)state;
  double volume;
  vxm_soup *soup = random_boxes(&(vxm_rng){5}, 3, &volume), *out;
  for (int i = 0; i < 4; i++) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.wrap_alpha = 0.1;
    options.fill_holes = i == 0 ? -1 : 0;
    options.hole_fill = i == 1 ? VXM_HOLE_FILL_SMOOTH : VXM_HOLE_FILL_FAN;
    options.boolean_union = i == 2;
    options.max_change = i == 3 ? 0.1 : 0;
    assert_int_equal(vxm_repair_run(&out, NULL, soup, &options, NULL), VXM_ERROR_ARGUMENT);
  }
  vxm_soup_destroy(soup);
}

static void wraps_keep_tags(void **state) {
  (void)state;
  vxm_soup *soup = new_soup(context);
  add_cuboid(soup, 0, 0, 0, 1, 1, 1);
  add_cuboid(soup, 3, 0, 0, 4, 1, 1);
  uint32_t tag;
  assert_int_equal(vxm_soup_add_tag(soup, "left", 4, &tag, NULL), VXM_OK);
  assert_int_equal(vxm_soup_add_tag(soup, "right", 5, &tag, NULL), VXM_OK);
  soup->face_tags = vxm_alloc(context, soup->face_count, sizeof *soup->face_tags, NULL);
  for (size_t f = 0; f < soup->face_count; f++)
    soup->face_tags[f] = f >= 12;
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.wrap_alpha = 0.05;
  options.part_changes = true;
  options.level = VXM_LEVEL_SOLID;
  vxm_soup *out = repair(soup, &options, NULL);
  assert_solid(out);
  assert_int_equal(out->tag_count, 2);
  for (size_t f = 0; f < out->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(out, f, &n);
    assert_int_equal(out->face_tags[f], vxm_position(out, corner[0])[0] > 2);
  }
  for (size_t p = 0; p < out->part_count; p++)
    assert_string_equal(out->tags[out->part_changes[p].tag], p ? "right" : "left");
  vxm_soup_destroy(out);
  vxm_soup_destroy(soup);
}

static void counted_beyond_the_list(void **state) {
  (void)state;
  double volume;
  vxm_soup *soup = random_boxes(&(vxm_rng){6}, 10, &volume);
  size_t pairs = count_meetings(soup);
  assert_true(pairs > 20);
  /* a vertex that is not finite takes its faces out of the account, and does no other harm */
  uint32_t first = (uint32_t)soup->vertex_count;
  add_vertex(soup, NAN, 0, 0);
  add_triangle(soup, 0, 1, first);
  vxm_defects *found;
  for (size_t most = 0; most < 6; most += 5) {
    assert_int_equal(vxm_defects_find(&found, soup, most, true, NULL), VXM_OK);
    assert_int_equal(found->totals[VXM_DEFECT_SELF_INTERSECTION], pairs);
    size_t listed = 0;
    for (size_t i = 0; i < found->count; i++)
      listed += found->items[i].kind == VXM_DEFECT_SELF_INTERSECTION;
    assert_int_equal(listed, most ? most : pairs);
    vxm_defects_destroy(found);
  }
  assert_int_equal(vxm_defects_find(&found, soup, 1, false, NULL), VXM_OK);
  assert_int_equal(found->totals[VXM_DEFECT_SELF_INTERSECTION], -1);
  vxm_defects_destroy(found);
  vxm_soup_destroy(soup);
}

static int calls_left;

static int stop_after(const char *phase, double fraction, void *payload) {
  (void)phase;
  (void)fraction;
  (void)payload;
  return calls_left-- <= 0;
}

static void stopped_anywhere(void **state) {
  (void)state;
  double volume;
  vxm_soup *large = random_boxes(&(vxm_rng){7}, 6, &volume);
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.level = VXM_LEVEL_SOLID;
  options.part_changes = options.intersections = true;
  bool done = false;
  for (int calls = 0; !done && calls < 500; calls++) {
    /* every other time it is the memory that ends it */
    vxm_context_options limits = VXM_CONTEXT_OPTIONS_INIT;
    limits.progress = calls % 2 ? stop_after : NULL;
    limits.memory_limit = calls % 2 ? 0 : (uint64_t)(calls + 1) * 20000;
    calls_left = calls / 2;
    vxm_context *owner;
    assert_int_equal(vxm_context_create(&owner, &limits, NULL), VXM_OK);
    vxm_soup *soup = new_soup(owner), *out = NULL;
    bool fits =
        vxm_soup_reserve(soup, large->vertex_count, large->face_count, large->corner_count, NULL) == VXM_OK;
    for (size_t v = 0; fits && v < large->vertex_count; v++)
      add_vertex(soup, large->positions[3 * v], large->positions[3 * v + 1], large->positions[3 * v + 2]);
    for (size_t f = 0; fits && f < large->face_count; f++) {
      size_t n;
      const uint32_t *corner = vxm_face(large, f, &n);
      add_face(soup, corner, n);
    }
    if (fits) {
      vxm_status status = vxm_repair_run(&out, NULL, soup, &options, NULL);
      done = calls % 2 && status == VXM_OK;
      assert_true(status == VXM_OK || status == (calls % 2 ? VXM_ERROR_CANCELLED : VXM_ERROR_MEMORY_LIMIT));
      assert_true((status == VXM_OK) == (out != NULL));
    }
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
    vxm_context_destroy(owner);
  }
  assert_true(done);
  vxm_soup_destroy(large);
}

int main(void) {
  if (!open_cgal())
    return 77;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(solids_of_boxes),       cmocka_unit_test(solids_of_noisy_boxes),
      cmocka_unit_test(open_parts_among_them), cmocka_unit_test(what_is_not_to_be_combined),
      cmocka_unit_test(wraps_keep_tags),       cmocka_unit_test(counted_beyond_the_list),
      cmocka_unit_test(stopped_anywhere),      cmocka_unit_test(both_halves_of_a_bow),
      cmocka_unit_test(solids_of_cabinets),    cmocka_unit_test(unions_in_floats),
  };
  return cmocka_run_group_tests(tests, hold_context, release_context);
}

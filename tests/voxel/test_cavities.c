/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Voids in a block, that touch each other and are filled by other bodies in part or altogether: the solid
 * after the repair is that of the cells, whatever the order of the bodies. Faces of a void meet those of
 * others and of what fills it along edges with four faces or more.
 */
#include "cells.h"

#include "mesh/geometry.h"
#include "mesh/unit_scale.h"

enum { FILLINGS = 2 /**< bodies at most that lie in voids */ };

typedef struct block {
  body bodies[1 + FILLINGS]; /**< the block first */
  size_t order[1 + FILLINGS], count;
  bool wanted[CELLS];
} block;

static bool is_inner(size_t cell) {
  size_t at[3] = {cell % SIDE, cell / SIDE % SIDE, cell / SIDE / SIDE};
  for (int a = 0; a < 3; a++)
    if (at[a] == 0 || at[a] == SIDE - 1)
      return false;
  return true;
}

/** Inner cells are void, now few and now many of them, and some of these are filled. */
static void make_block(block *b, vxm_rng *rng, size_t fillings) {
  uint64_t solid = 1 + vxm_rng_below(rng, 4);
  *b = (block){.count = 1 + fillings};
  for (size_t c = 0; c < CELLS; c++) {
    bool is_void = is_inner(c) && vxm_rng_below(rng, 5) >= solid;
    size_t filling = is_void ? (size_t)vxm_rng_below(rng, 2 + 2 * fillings) : 0;
    if (!is_void || (filling > 0 && filling <= fillings))
      b->bodies[filling].cells[c] = b->wanted[c] = true;
  }
  for (size_t i = 0; i < b->count; i++) {
    size_t j = (size_t)vxm_rng_below(rng, i + 1);
    b->order[i] = b->order[j];
    b->order[j] = i;
  }
}

/** @param inside_out all faces are turned over */
static vxm_soup *faces_of(vxm_context *context, const block *b, const manner *how, bool inside_out,
                          vxm_rng *rng) {
  vxm_soup *soup = new_soup(context);
  for (size_t i = 0; i < b->count; i++) {
    body one = b->bodies[b->order[i]];
    one.turned = inside_out;
    add_body(soup, &one, how, rng);
  }
  return soup;
}

/** Puts the faces, all of which have four corners, in another order. */
static void shuffle(vxm_soup *soup, vxm_rng *rng) {
  for (size_t i = soup->face_count - 1; i > 0; i--) {
    size_t j = (size_t)vxm_rng_below(rng, i + 1);
    for (size_t c = 0; c < 4; c++) {
      uint32_t kept = soup->indices[4 * i + c];
      soup->indices[4 * i + c] = soup->indices[4 * j + c];
      soup->indices[4 * j + c] = kept;
    }
  }
}

static double volume_of(const vxm_soup *soup) {
  double volume = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    const double *p = vxm_position(soup, corner[0]);
    volume +=
        vxm_polygon_cone((vxm_vec3){p[0], p[1], p[2]}, vxm_polygon_area(soup->positions, corner, count, 1));
  }
  return volume;
}

/** The same for a repair that leaves bodies together, and loses none. */
static void assert_repaired(const vxm_soup *soup, double volume, double off, uint64_t seed) {
  vxm_soup *clean;
  vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
  assert_int_equal(vxm_repair_run(&clean, &report, soup, NULL, NULL), VXM_OK);
  if (report.lost_parts != 0 || report.opened_parts != 0 || fabs(volume_of(clean) - volume) > off)
    fail_msg("seed %llu: %lld parts are lost, the volume is %g instead of %g", (unsigned long long)seed,
             (long long)report.lost_parts, volume_of(clean), volume);
  vxm_soup_destroy(clean);
}

static void assert_cells(vxm_context *context, uint64_t seed, const manner *how, size_t fillings) {
  vxm_rng rng = {seed};
  block b;
  make_block(&b, &rng, fillings);
  vxm_soup *soup = faces_of(context, &b, how, seed % 4 == 0, &rng), *prepared;
  if (!how->triangles && seed % 2 == 0)
    shuffle(soup, &rng);
  assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
  int wrong = count_wrong(prepared, how, b.wanted);
  double volume = 0, cell = how->unit * how->unit * how->unit;
  for (size_t c = 0; c < CELLS; c++)
    volume += b.wanted[c] ? cell : 0;
  if (wrong > 0 || fabs(volume_of(prepared) - volume) > 1e-6 * cell)
    fail_msg("seed %llu: %d voxels are wrong, the volume is %g instead of %g", (unsigned long long)seed,
             wrong, volume_of(prepared), volume);
  assert_repaired(soup, volume, 1e-6 * cell, seed);
  vxm_soup_destroy(prepared);
  vxm_soup_destroy(soup);
}

static void voids_stay(void **state) {
  for (uint64_t seed = 1; seed <= rounds_of(200); seed++)
    assert_cells(*state, seed, &squares, 0);
}

/** Points that are the mean of others lie beside these, by rounding; what they tell must be the same. */
static void voids_stay_in_any_unit(void **state) {
  static const double units[] = {0.1, 0.001, 0.7, 25.4};
  for (size_t u = 0; u < sizeof units / sizeof *units; u++) {
    manner how = squares;
    how.unit = units[u];
    for (uint64_t seed = 1; seed <= rounds_of(100); seed++) {
      how.triangles = seed % 2 == 0;
      assert_cells(*state, seed, &how, seed % 3 == 0 ? 1 : 0);
    }
  }
}

static void voids_stay_in_triangles(void **state) {
  manner how = squares;
  how.triangles = true;
  for (uint64_t seed = 1; seed <= rounds_of(200); seed++)
    assert_cells(*state, seed, &how, 0);
}

/** Without one of the squares of its skin the block is not closed, but has the same voids. */
static void assert_open(vxm_context *context, uint64_t seed, size_t fillings) {
  vxm_rng rng = {seed};
  block b;
  make_block(&b, &rng, fillings);
  b.order[0] = fillings; /* the block last */
  b.order[fillings] = 0;
  vxm_soup *soup = faces_of(context, &b, &squares, false, &rng), *prepared;
  soup->face_count--; /* of the last cell, at a corner */
  soup->corner_count -= 4;
  assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
  int wrong = count_wrong(prepared, &squares, b.wanted);
  if (wrong > 0)
    fail_msg("seed %llu: %d voxels are wrong", (unsigned long long)seed, wrong);
  vxm_soup_destroy(prepared);
  vxm_soup_destroy(soup);
}

static void voids_of_an_open_block_stay(void **state) {
  for (uint64_t seed = 1; seed <= rounds_of(100); seed++)
    assert_open(*state, seed, 0);
}

static void fillings_of_an_open_block_stay(void **state) {
  for (uint64_t seed = 1; seed <= rounds_of(100); seed++)
    assert_open(*state, seed, 1);
}

/** Those that fill a void have the same faces as that; where they fill it altogether these are all it has. */
static void fillings_stay(void **state) {
  for (uint64_t seed = 1; seed <= rounds_of(300); seed++)
    assert_cells(*state, seed, &squares, 1 + seed % FILLINGS);
}

static void fillings_stay_in_triangles(void **state) {
  manner how = squares;
  how.triangles = true;
  for (uint64_t seed = 1; seed <= rounds_of(200); seed++)
    assert_cells(*state, seed, &how, 1 + seed % FILLINGS);
}

/** A block of which the skin lacks a square, the core first or last. */
static void a_core_of_an_open_block_stays(void **state) {
  for (int core_first = 0; core_first < 2; core_first++) {
    vxm_rng rng = {1};
    block b = {.order = {core_first == 1, core_first == 0}, .count = 2};
    for (size_t c = 0; c < CELLS; c++) {
      b.bodies[is_inner(c) && c % SIDE < 4].cells[c] = true;
      b.wanted[c] = true;
    }
    vxm_soup *soup = faces_of(*state, &b, &squares, false, &rng), *prepared;
    uint32_t *last = soup->indices + soup->corner_count - 4, *square = soup->indices;
    for (size_t c = 0; c < 4 && core_first == 0; c++) /* the first one of the skin */
      square[c] = last[c];
    soup->face_count--;
    soup->corner_count -= 4;
    assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
    assert_int_equal(count_wrong(prepared, &squares, b.wanted), 0);
    vxm_soup_destroy(prepared);
    vxm_soup_destroy(soup);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(voids_stay),
                                     cmocka_unit_test(voids_stay_in_triangles),
                                     cmocka_unit_test(voids_stay_in_any_unit),
                                     cmocka_unit_test(voids_of_an_open_block_stay),
                                     cmocka_unit_test(fillings_stay),
                                     cmocka_unit_test(fillings_of_an_open_block_stay),
                                     cmocka_unit_test(fillings_stay_in_triangles),
                                     cmocka_unit_test(a_core_of_an_open_block_stays)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}

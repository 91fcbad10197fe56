/* SPDX-License-Identifier: BSD-3-Clause */
/** Sheets that hang on the edges of bodies leave the bodies what they are. */
#include "cells.h"

/** A flag of unit squares in a plane across an axis. */
typedef struct fin {
  int corner[3], axis, size[2];
  bool pierced; /**< one of its squares is left out */
} fin;

static void corner_of(const fin *f, int i, int j, int corner[3]) {
  memcpy(corner, f->corner, sizeof f->corner);
  corner[(f->axis + 1) % 3] += i;
  corner[(f->axis + 2) % 3] += j;
}

static void add_fin(vxm_soup *soup, const fin *f, const manner *how, vxm_rng *rng) {
  int corner[3];
  for (int i = 0; i < f->size[0]; i++)
    for (int j = 0; j < f->size[1]; j++) {
      corner_of(f, i, j, corner);
      if (!f->pierced || i != f->size[0] / 2 || j != f->size[1] / 2)
        add_square(soup, how, corner, f->axis, true, rng);
    }
}

/** Whether a body has a cell about a lattice point. */
static bool is_met(const body *b, const int point[3]) {
  for (int i = 0; i < 8; i++) {
    const int cell[3] = {point[0] - (i & 1), point[1] - (i >> 1 & 1), point[2] - (i >> 2)};
    if (has_cell(b, cell))
      return true;
  }
  return false;
}

enum { POINTS = (SIDE + 1) * (SIDE + 1) * (SIDE + 1) };

static size_t point_at(const int p[3]) {
  return (size_t)((p[2] * (SIDE + 1) + p[1]) * (SIDE + 1) + p[0]);
}

/** Whether the row `root` of the points of a fin lies on a body, the others on none, and none is taken. */
static bool is_free(const fin *f, int root, const body *b, const bool taken[POINTS]) {
  for (int i = 0; i <= f->size[0]; i++)
    for (int j = 0; j <= f->size[1]; j++) {
      int p[3];
      corner_of(f, i, j, p);
      for (int a = 0; a < 3; a++)
        if (p[a] < 0 || p[a] > SIDE)
          return false;
      if (taken[point_at(p)] || is_met(b, p) != (i == root))
        return false;
    }
  return true;
}

static void take(const fin *f, bool taken[POINTS]) {
  for (int i = 0; i <= f->size[0]; i++)
    for (int j = 0; j <= f->size[1]; j++) {
      int p[3];
      corner_of(f, i, j, p);
      taken[point_at(p)] = true;
    }
}

/** Adds flags of which each hangs on a row of edges of a body; some turn at a right angle. */
static void add_random_fins(vxm_soup *soup, const body *b, const manner *how, vxm_rng *rng) {
  bool taken[POINTS] = {false};
  int fins = 0;
  for (int tries = 0; tries < 400 && fins < 12; tries++) {
    int up = (int)vxm_rng_below(rng, 2), axis = (int)vxm_rng_below(rng, 3), next = (axis + 1) % 3;
    fin out = {.axis = axis, .size = {1 + (int)vxm_rng_below(rng, 3), 1 + (int)vxm_rng_below(rng, 3)}};
    out.pierced = out.size[0] == 3 && out.size[1] == 3;
    for (int a = 0; a < 3; a++)
      out.corner[a] = (int)vxm_rng_below(rng, SIDE);
    fin turned = {.axis = next, .size = {out.size[1], (int)vxm_rng_below(rng, 4)}};
    memcpy(turned.corner, out.corner, sizeof out.corner);
    turned.corner[next] += up ? out.size[0] : 0;
    turned.corner[axis] -= vxm_rng_below(rng, 2) ? turned.size[1] : 0;
    if (!is_free(&out, up ? 0 : out.size[0], b, taken) || !is_free(&turned, -1, b, taken))
      continue;
    add_fin(soup, &out, how, rng);
    add_fin(soup, &turned, how, rng);
    take(&out, taken);
    take(&turned, taken);
    fins++;
  }
}

static bool is_at_the_side(size_t cell) {
  for (int a = 0; a < 3; a++, cell /= SIDE)
    if (cell % SIDE == 0 || cell % SIDE == SIDE - 1)
      return true;
  return false;
}

/** Adds the faces of another soup from `begin` on. */
static void append(vxm_soup *soup, const vxm_soup *other, size_t begin) {
  size_t first = soup->vertex_count;
  for (size_t v = 0; v < other->vertex_count; v++)
    add_vertex(soup, other->positions[3 * v], other->positions[3 * v + 1], other->positions[3 * v + 2]);
  for (size_t f = begin; f < other->face_count; f++) {
    uint32_t corners[4];
    size_t count;
    const uint32_t *corner = vxm_face(other, f, &count);
    for (size_t c = 0; c < count; c++)
      corners[c] = (uint32_t)first + corner[c];
    add_face(soup, corners, count);
  }
}

/** The cells that a soup covers. */
static void find_covered(const vxm_soup *soup, bool covered[CELLS]) {
  memset(covered, 0, CELLS * sizeof *covered);
  if (soup->face_count == 0)
    return;
  vxm_space_options place = VXM_SPACE_OPTIONS_INIT;
  vxm_space space = {.dims = {SIDE, SIDE, SIDE}, .voxel_size = {1, 1, 1}};
  place.like = &space;
  vxm_soup *prepared;
  vxm_grid *grid;
  assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.thin = VXM_THIN_DROP;
  assert_int_equal(vxm_voxelize(&grid, NULL, prepared, &place, &options, NULL), VXM_OK);
  for (int64_t c = 0; c < CELLS; c++)
    covered[c] = vxm_grid_get(grid, c % SIDE, c / SIDE % SIDE, c / SIDE / SIDE);
  vxm_grid_destroy(grid);
  vxm_soup_destroy(prepared);
}

/** The solid of a body with sheets on its edges is to be what each covers by itself: a fold of a sheet may
 * cover a little. */
static int count_wrong_beside(const vxm_soup *soup, const vxm_soup *sheets, const body *b,
                              const manner *how) {
  bool wanted[CELLS];
  vxm_soup *prepared;
  find_covered(sheets, wanted);
  for (size_t c = 0; c < CELLS; c++)
    wanted[c] = wanted[c] || b->cells[c];
  assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
  int wrong = count_wrong(prepared, how, wanted);
  vxm_soup_destroy(prepared);
  return wrong;
}

static void assert_fins_do_nothing(vxm_context *context, uint64_t seed, const manner *how) {
  vxm_rng rng = {seed};
  body b = {.turned = false};
  for (int boxes = 1 + (int)vxm_rng_below(&rng, 3); boxes > 0; boxes--)
    add_random_box(&b, &rng);
  for (size_t c = 0; c < CELLS; c++) /* there is room about it, and the middle is in it */
    b.cells[c] = c == cell_at(2, 3, 2) || (b.cells[c] && !is_at_the_side(c));
  vxm_soup *soup = new_soup(context), *fins = new_soup(context);
  add_body(soup, &b, how, &rng);
  add_random_fins(fins, &b, how, &rng);
  append(soup, fins, 0);
  int wrong = count_wrong_beside(soup, fins, &b, how);
  if (wrong > 0)
    fail_msg("seed %llu: %d voxels are wrong", (unsigned long long)seed, wrong);
  vxm_soup_destroy(fins);
  vxm_soup_destroy(soup);
}

static void fins_do_nothing(void **state) {
  manner triangles = squares;
  triangles.triangles = true;
  for (uint64_t seed = 1; seed <= rounds_of(300); seed++)
    assert_fins_do_nothing(*state, seed, seed % 2 == 0 ? &triangles : &squares);
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
  const struct CMUnitTest tests[] = {cmocka_unit_test(fins_do_nothing), cmocka_unit_test(flaps_do_nothing),
                                     cmocka_unit_test(flaps_do_nothing_to_a_box_with_a_hole)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}

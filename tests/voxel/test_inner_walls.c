/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Bodies that walls of one sheet divide into chambers are solid throughout. They are sets of unit cells, each
 * of one of several chambers; a square is drawn once wherever cells of two chambers meet, or one of them and
 * the outside.
 */
#include "fins.h"

#include "../repair/repair_test.h"

enum { CHAMBERS_MAX = 4 };

typedef struct division {
  int chamber[CELLS]; /**< 0 = outside */
  bool walls;         /**< there are some */
} division;

static int chamber_at(const division *d, const int at[3]) {
  for (int a = 0; a < 3; a++)
    if (at[a] < 0 || at[a] >= SIDE)
      return 0;
  return d->chamber[cell_at(at[0], at[1], at[2])];
}

/** Cells that are in no chamber but cannot be reached from the outside come to the first one. */
static void fill_voids(division *d) {
  bool reached[CELLS] = {false}, more = true;
  while (more) {
    more = false;
    for (int c = 0; c < CELLS; c++) {
      const int at[3] = {c % SIDE, c / SIDE % SIDE, c / SIDE / SIDE};
      if (reached[c] || d->chamber[c] != 0)
        continue;
      for (int side = 0; side < 6 && !reached[c]; side++) {
        int beside[3] = {at[0], at[1], at[2]}, axis = side / 2;
        beside[axis] += side % 2 ? 1 : -1;
        bool edge = beside[axis] < 0 || beside[axis] >= SIDE;
        reached[c] = edge || reached[cell_at(beside[0], beside[1], beside[2])];
        more = more || reached[c];
      }
    }
  }
  for (size_t c = 0; c < CELLS; c++)
    if (d->chamber[c] == 0 && !reached[c])
      d->chamber[c] = 1;
}

/** A block of n x n x n cells, each in the chamber whose middle is next; some cells are missing. */
static division random_division(vxm_rng *rng) {
  division d = {.walls = false};
  double middle[CHAMBERS_MAX][3];
  int n = 2 + (int)vxm_rng_below(rng, 3), chambers = 2 + (int)vxm_rng_below(rng, CHAMBERS_MAX - 1);
  bool gaps = vxm_rng_below(rng, 2) == 0;
  for (int i = 0; i < chambers; i++)
    for (int a = 0; a < 3; a++)
      middle[i][a] = n * vxm_rng_unit(rng);
  for (int c = 0; c < CELLS; c++) {
    const int at[3] = {c % SIDE, c / SIDE % SIDE, c / SIDE / SIDE};
    double least = INFINITY;
    for (int i = 0; i < chambers && at[0] < n && at[1] < n && at[2] < n; i++) {
      double square = 0;
      for (int a = 0; a < 3; a++)
        square += (at[a] + 0.5 - middle[i][a]) * (at[a] + 0.5 - middle[i][a]);
      if (square < least) {
        least = square;
        d.chamber[c] = i + 1;
      }
    }
    if (gaps && vxm_rng_below(rng, 7) == 0)
      d.chamber[c] = 0;
  }
  fill_voids(&d);
  return d;
}

/** How the squares are drawn. */
typedef struct drawing {
  bool any_way; /**< each looks this way or that; else out of the chamber with the lower number */
  bool torn;    /**< of the walls, some squares are missing */
} drawing;

/** Draws the squares; to weld them is left to the repair. */
static void add_division(vxm_soup *soup, division *d, const manner *how, drawing drawn, vxm_rng *rng) {
  for (int z = -1; z < SIDE; z++)
    for (int y = -1; y < SIDE; y++)
      for (int x = -1; x < SIDE; x++)
        for (int axis = 0; axis < 3; axis++) {
          const int at[3] = {x, y, z};
          int beside[3] = {x, y, z};
          beside[axis]++;
          int here = chamber_at(d, at), there = chamber_at(d, beside);
          bool wall = here != 0 && there != 0, up = here != 0 && (there == 0 || here < there);
          if (here == there || (wall && drawn.torn && vxm_rng_below(rng, 4) == 0))
            continue;
          d->walls = d->walls || wall;
          add_square(soup, how, beside, axis, drawn.any_way ? vxm_rng_below(rng, 2) == 0 : up, rng);
        }
}

static double volume_closed(const vxm_soup *soup) {
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.level = VXM_LEVEL_CLOSED;
  options.sheets = VXM_SHEETS_DROP; /* what is left of torn walls, and hangs on nothing */
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(soup, &options, &report);
  vxm_soup_destroy(out);
  return report.after->volume;
}

/** Checks the voxels of a mesh, and its volume once it is closed. */
static void assert_solid(const vxm_soup *soup, const manner *how, const bool wanted[CELLS], uint64_t seed) {
  vxm_soup *prepared;
  assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
  int wrong = count_wrong(prepared, how, wanted);
  double count = 0;
  for (size_t c = 0; c < CELLS; c++)
    count += wanted[c];
  if (wrong > 0)
    fail_msg("seed %llu: %d of %g voxels are wrong", (unsigned long long)seed, wrong, count);
  double volume = volume_closed(soup);
  if (!(fabs(volume - count) <= 1e-3 * count))
    fail_msg("seed %llu: a volume of %g instead of %g", (unsigned long long)seed, volume, count);
  vxm_soup_destroy(prepared);
}

static void check_divisions(vxm_context *context, drawing drawn, bool triangles) {
  int divided = 0;
  for (uint64_t seed = 1; seed <= rounds_of(250); seed++) {
    vxm_rng rng = {seed};
    manner how = squares;
    how.triangles = triangles;
    division d = random_division(&rng);
    bool wanted[CELLS];
    for (size_t c = 0; c < CELLS; c++)
      wanted[c] = d.chamber[c] != 0;
    vxm_soup *soup = new_soup(context);
    add_division(soup, &d, &how, drawn, &rng);
    if (d.walls)
      assert_solid(soup, &how, wanted, seed);
    divided += d.walls;
    vxm_soup_destroy(soup);
  }
  assert_true(4 * divided > (int)rounds_of(250));
}

static void chambers(void **state) {
  check_divisions(*state, (drawing){0}, false);
}

static void chambers_of_triangles_turned_anyhow(void **state) {
  check_divisions(*state, (drawing){.any_way = true}, true);
}

static void torn_walls(void **state) {
  check_divisions(*state, (drawing){.torn = true}, true);
}

/* ---- Sheets on the skin ---- */

/** Flags hang on the skin of a divided body, some of them where walls end. */
static void assert_fins_do_nothing(vxm_context *context, drawing drawn, const manner *how, uint64_t seed) {
  vxm_rng rng = {seed};
  division d = random_division(&rng);
  body b = {.turned = false};
  vxm_soup *soup = new_soup(context), *fins = new_soup(context);
  for (size_t c = 0; c < CELLS; c++)
    b.cells[c] = d.chamber[c] != 0;
  add_division(soup, &d, how, drawn, &rng);
  add_random_fins(fins, &b, how, &rng);
  append(soup, fins, 0);
  int wrong = count_wrong_beside(soup, fins, &b, how);
  if (wrong > 0)
    fail_msg("seed %llu: %d voxels are wrong", (unsigned long long)seed, wrong);
  vxm_soup_destroy(fins);
  vxm_soup_destroy(soup);
}

static void fins_on_the_skin(void **state) {
  manner triangles = squares;
  triangles.triangles = true;
  for (uint64_t seed = 1; seed <= rounds_of(250); seed++) {
    assert_fins_do_nothing(*state, (drawing){0}, &squares, seed);
    assert_fins_do_nothing(*state, (drawing){.any_way = true}, &triangles, seed);
    assert_fins_do_nothing(*state, (drawing){.torn = true}, &triangles, seed);
  }
}

/* ---- What else is there ---- */

/** A block of 4 x 4 x 4 cells with a wall in the middle, and a void of one cell on one side of it. */
static vxm_soup *block_with_void(vxm_context *context, bool inside_out, bool wanted[CELLS]) {
  vxm_rng rng = {1};
  division block = {.walls = false}, hollow = {.walls = false};
  vxm_soup *soup = new_soup(context);
  for (int c = 0; c < CELLS; c++) {
    const int at[3] = {c % SIDE, c / SIDE % SIDE, c / SIDE / SIDE};
    block.chamber[c] = at[0] < 4 && at[1] < 4 && at[2] < 4 ? 1 + (at[2] > 1) : 0;
    hollow.chamber[c] = at[0] == 1 && at[1] == 1 && at[2] == 3; /* to be moved down by half a cell */
    wanted[c] = block.chamber[c] != 0;
  }
  add_division(soup, &block, &squares, (drawing){0}, &rng);
  size_t vertices = soup->vertex_count, corners = soup->corner_count;
  add_division(soup, &hollow, &squares, (drawing){0}, &rng);
  for (size_t v = vertices; v < soup->vertex_count; v++)
    soup->positions[3 * v + 2] -= 0.5;
  for (size_t c = inside_out ? 0 : corners; c + 3 < soup->corner_count; c += 4)
    if (inside_out == (c < corners)) { /* the void looks the other way */
      uint32_t kept = soup->indices[c + 1];
      soup->indices[c + 1] = soup->indices[c + 3];
      soup->indices[c + 3] = kept;
    }
  return soup;
}

static void voids_stay(void **state) {
  for (int inside_out = 0; inside_out < 2; inside_out++) {
    bool wanted[CELLS];
    vxm_soup *soup = block_with_void(*state, inside_out, wanted), *prepared;
    assert_true(fabs(volume_closed(soup) - 63) < 1e-3);
    assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
    assert_int_equal(count_wrong(prepared, &squares, wanted), 1); /* of the two that it lies in half */
    vxm_soup_destroy(prepared);
    vxm_soup_destroy(soup);
  }
}

/** How many walls a repair at a level finds. */
static int64_t count_walls(const vxm_soup *soup, vxm_level level) {
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
  options.level = level;
  vxm_soup_destroy(repaired(soup, &options, &report));
  return count_of(&report, "inner_walls");
}

/** Below the level closed walls stay, and so do those of a block that is open; those of one with a fin on its
 * outside go as without. */
static void other_walls_stay(void **state) {
  vxm_rng rng = {1};
  division block = {.walls = false};
  for (int c = 0; c < CELLS; c++)
    block.chamber[c] = c % SIDE < 2 && c / SIDE < 1 ? 1 + c % SIDE : 0;
  vxm_soup *soup = new_soup(*state), *open = new_soup(*state);
  add_division(soup, &block, &squares, (drawing){0}, &rng);
  assert_int_equal(soup->face_count, 11);
  assert_int_equal(count_walls(soup, VXM_LEVEL_CLEAN), 0);
  assert_int_equal(count_walls(soup, VXM_LEVEL_MANIFOLD), 0);
  assert_int_equal(count_walls(soup, VXM_LEVEL_CLOSED), 1);
  for (size_t v = 0; v < soup->vertex_count; v++)
    add_vertex(open, soup->positions[3 * v], soup->positions[3 * v + 1], soup->positions[3 * v + 2]);
  for (size_t f = 1; f < soup->face_count; f++) /* without a square of the skin: one chamber is open */
    add_face(open, soup->indices + soup->offsets[f], 4);
  assert_int_equal(count_walls(open, VXM_LEVEL_CLOSED), 0);
  const int corner[3] = {2, 0, 1};
  add_square(soup, &squares, corner, 0, true, &rng);
  assert_int_equal(count_walls(soup, VXM_LEVEL_CLOSED), 1);
  vxm_soup_destroy(open);
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(chambers),   cmocka_unit_test(chambers_of_triangles_turned_anyhow),
      cmocka_unit_test(torn_walls), cmocka_unit_test(fins_on_the_skin),
      cmocka_unit_test(voids_stay), cmocka_unit_test(other_walls_stay)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}

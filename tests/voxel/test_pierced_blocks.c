/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Blocks with a void, and boxes that stand in it or come through the wall, and share edges and parts of faces
 * with it: solid is what lies in the block and not in the void, or in one of the boxes. Each cell is known
 * from whole numbers alone.
 */
#include "../base/rounds.h"
#include "../mesh/soups.h"

#include "repair/repair.h"
#include "voxmend.h"

enum { SIDE = 8, AROUND = 2, CELLS = SIDE + 2 * AROUND, BOXES_MAX = 2 };

typedef struct box {
  int low[3], high[3];
} box;

typedef struct pierced_block {
  box hollow, boxes[BOXES_MAX];
  size_t count;
} pierced_block;

static int between(int low, int high, vxm_rng *rng) {
  return low + (int)vxm_rng_below(rng, (uint64_t)(high - low));
}

static void random_void(pierced_block *b, vxm_rng *rng) {
  for (int a = 0; a < 3; a++) {
    b->hollow.low[a] = between(1, SIDE - 2, rng);
    b->hollow.high[a] = between(b->hollow.low[a] + 1, SIDE, rng);
  }
}

/** A box that comes from outside, from the skin or out of the wall, along one axis, and ends at the void, in
 * it, on its far side or beyond; across that it is as wide as the void, or lies at one of its sides or
 * between. */
static box random_pin(const box *hollow, vxm_rng *rng) {
  int axis = between(0, 3, rng);
  box pin = *hollow;
  for (int a = 0; a < 3; a++) {
    int way = between(0, 3, rng), wide = hollow->high[a] - hollow->low[a];
    if (a == axis || way == 0)
      continue;
    pin.low[a] += way == 2 && wide > 2 ? 1 : 0;
    pin.high[a] = pin.low[a] + 1;
  }
  const int starts[3] = {-AROUND, 0, hollow->low[axis] - 1};
  const int ends[4] = {hollow->low[axis], hollow->low[axis] + 1, hollow->high[axis], SIDE + 1};
  pin.low[axis] = starts[between(0, 3, rng)];
  do
    pin.high[axis] = ends[between(0, 4, rng)];
  while (pin.high[axis] <= pin.low[axis]);
  return pin;
}

static box random_insert(const box *hollow, vxm_rng *rng) {
  box insert;
  for (int a = 0; a < 3; a++) {
    insert.low[a] = between(hollow->low[a], hollow->high[a], rng);
    insert.high[a] = between(insert.low[a] + 1, hollow->high[a] + 1, rng);
  }
  return insert;
}

static bool is_in(const box *b, const int64_t cell[3]) {
  for (int a = 0; a < 3; a++)
    if (cell[a] < b->low[a] || cell[a] >= b->high[a])
      return false;
  return true;
}

static bool is_solid(const pierced_block *b, const int64_t cell[3]) {
  static const box block = {{0, 0, 0}, {SIDE, SIDE, SIDE}};
  bool solid = is_in(&block, cell) && !is_in(&b->hollow, cell);
  for (size_t i = 0; i < b->count; i++)
    solid = solid || is_in(&b->boxes[i], cell);
  return solid;
}

/** Each side is two triangles, cut now this way and now that. */
static void add_box(vxm_soup *soup, const box *b, bool inward, vxm_rng *rng) {
  uint32_t first = (uint32_t)soup->vertex_count;
  static const uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (int v = 0; v < 8; v++)
    add_vertex(soup, v & 1 ? b->high[0] : b->low[0], v & 2 ? b->high[1] : b->low[1],
               v & 4 ? b->high[2] : b->low[2]);
  for (int f = 0; f < 6; f++) {
    uint32_t c[4], cut = (uint32_t)vxm_rng_below(rng, 2);
    for (uint32_t i = 0; i < 4; i++)
      c[i] = first + faces[f][inward ? (3 - i + cut) % 4 : (i + cut) % 4];
    add_triangle(soup, c[0], c[1], c[2]);
    add_triangle(soup, c[0], c[2], c[3]);
  }
}

static int count_wrong(const vxm_soup *soup, const pierced_block *b) {
  vxm_space space = {.dims = {CELLS, CELLS, CELLS}, .voxel_size = {1, 1, 1}};
  vxm_space_options place = VXM_SPACE_OPTIONS_INIT;
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  vxm_grid *grid;
  vxm_error error = VXM_ERROR_INIT;
  int wrong = 0;
  for (int a = 0; a < 3; a++)
    space.origin[a] = -AROUND;
  place.like = &space;
  options.thin = VXM_THIN_DROP;
  if (vxm_voxelize(&grid, NULL, soup, &place, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  for (int64_t z = 0; z < CELLS; z++)
    for (int64_t y = 0; y < CELLS; y++)
      for (int64_t x = 0; x < CELLS; x++) {
        const int64_t cell[3] = {x - AROUND, y - AROUND, z - AROUND};
        wrong += vxm_grid_get(grid, x, y, z) != is_solid(b, cell);
      }
  vxm_grid_destroy(grid);
  return wrong;
}

/** Before it is voxelized, and after repairs that leave bodies as they are. */
static void assert_solid(vxm_context *context, const pierced_block *b, uint64_t seed, vxm_rng *rng) {
  static const box block = {{0, 0, 0}, {SIDE, SIDE, SIDE}};
  static const vxm_level levels[] = {VXM_LEVEL_CLEAN, VXM_LEVEL_MANIFOLD, VXM_LEVEL_CLOSED};
  vxm_soup *soup = new_soup(context), *repaired;
  add_box(soup, &block, false, rng);
  add_box(soup, &b->hollow, true, rng);
  for (size_t i = 0; i < b->count; i++)
    add_box(soup, &b->boxes[i], false, rng);
  for (int l = -1; l < (int)(sizeof levels / sizeof *levels); l++) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.level = l < 0 ? VXM_LEVEL_CLEAN : levels[l];
    if (l < 0)
      assert_int_equal(vxm_repair_prepare(&repaired, NULL, soup, NULL, NULL), VXM_OK);
    else
      assert_int_equal(vxm_repair_run(&repaired, NULL, soup, &options, NULL), VXM_OK);
    if (l == 0) { /* which leaves bodies together: they come apart before they are voxelized */
      vxm_soup *clean = repaired;
      assert_int_equal(vxm_repair_prepare(&repaired, NULL, clean, NULL, NULL), VXM_OK);
      vxm_soup_destroy(clean);
    }
    int wrong = count_wrong(repaired, b);
    if (wrong > 0)
      fail_msg("seed %llu, level %d: %d voxels are wrong", (unsigned long long)seed, l, wrong);
    vxm_soup_destroy(repaired);
  }
  vxm_soup_destroy(soup);
}

static bool overlap(const box *b, const box *c) {
  for (int a = 0; a < 3; a++)
    if (b->high[a] <= c->low[a] || c->high[a] <= b->low[a])
      return false;
  return true;
}

static void pins(void **state) {
  for (uint64_t seed = 1; seed <= ROUNDS(600); seed++) {
    vxm_rng rng = {seed};
    pierced_block b = {.count = 1};
    random_void(&b, &rng);
    b.boxes[0] = random_pin(&b.hollow, &rng);
    assert_solid(*state, &b, seed, &rng);
  }
}

static void inserts(void **state) {
  for (uint64_t seed = 1; seed <= ROUNDS(600); seed++) {
    vxm_rng rng = {seed};
    pierced_block b = {.count = 1 + (size_t)vxm_rng_below(&rng, BOXES_MAX)};
    random_void(&b, &rng);
    for (size_t i = 0; i < b.count; i++)
      b.boxes[i] = random_insert(&b.hollow, &rng);
    if (b.count == 2 && overlap(&b.boxes[0], &b.boxes[1]))
      b.count = 1;
    assert_solid(*state, &b, seed, &rng);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(pins), cmocka_unit_test(inserts)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}

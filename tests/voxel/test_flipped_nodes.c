/* SPDX-License-Identifier: BSD-3-Clause */
/** Flips put to the nodes that have some, against one bit for each voxel of a slab. */
#include "shapes.h"

#include "base/rng.h"
#include "voxel/parity/kernels.h"
#include "voxel/sparse/flipped_nodes.h"

#include <stdlib.h>
#include <string.h>

enum { STRIPS = 5, ROW_SHIFT = 7, ROW = 1 << ROW_SHIFT, NODES = ROW / 16, SLAB = STRIPS * 256 * ROW };

/** Whether a flip at a place along x turns a voxel of the same brick: all from there on. */
static bool is_turned(const uint8_t *flips, size_t row, unsigned x) {
  bool turned = false;
  for (unsigned i = x & ~3U; i <= x; i++)
    turned ^= flips[row * ROW + i];
  return turned;
}

/** Takes all nodes, and compares their bricks with the flips of the slab. */
static void check_nodes(vxm_flipped_nodes *nodes, const uint8_t *flips, const bool *reached) {
  for (size_t strip = 0; strip < STRIPS; strip++) {
    size_t x = 0;
    for (size_t node = 0; node < NODES; node++) {
      assert_true(vxm_flipped_nodes_next(nodes, strip, &x) == (x < NODES));
      if (!reached[strip * NODES + node]) {
        assert_true(x > node);
        continue;
      }
      assert_int_equal(x, node);
      uint64_t *bricks = vxm_flipped_nodes_take(nodes, strip, x++);
      for (unsigned v = 0; v < 16 * 16 * 16; v++) {
        unsigned i = v & 15, j = v >> 4 & 15, k = v >> 8;
        unsigned brick = (i >> 2) * 16 + (j >> 2 & 1) + 2 * (k >> 2 & 1) + 4 * (j >> 3) + 8 * (k >> 3);
        bool turned = bricks[brick] >> (16 * (k & 3) + 4 * (j & 3) + (i & 3)) & 1;
        assert_true(turned == is_turned(flips, strip * 256 + 16 * j + k, (unsigned)(16 * node) + i));
      }
      memset(bricks, 0, VXM_STRIP_BRICKS * sizeof *bricks);
    }
    assert_false(vxm_flipped_nodes_next(nodes, strip, &x));
    bool any = false;
    for (size_t node = 0; node < NODES; node++)
      any |= reached[strip * NODES + node];
    assert_true(vxm_flipped_nodes_touch_end(nodes, strip) == any);
    assert_false(vxm_flipped_nodes_touch_end(nodes, strip));
  }
  vxm_flipped_nodes_end(nodes);
}

/** Flips records some at a time, as many as one likes. */
static void flip_some(vxm_flipped_nodes *nodes, const uint64_t *records, size_t count, vxm_rng *rng) {
  for (size_t begin = 0, some; begin < count; begin += some) {
    some = 1 + vxm_rng_below(rng, 300);
    some = some < count - begin ? some : count - begin;
    assert_int_equal(vxm_flipped_nodes_flip(nodes, records + begin, some), VXM_OK);
  }
}

static void check_flips(void) {
  vxm_rng rng = {516};
  vxm_flipped_nodes nodes;
  uint8_t *flips = malloc(SLAB);
  uint64_t *words = malloc(SLAB / 8);
  static uint64_t records[4000];
  assert_true(flips && words);
  assert_int_equal(vxm_flipped_nodes_create(&nodes, context, STRIPS, ROW_SHIFT, NULL), VXM_OK);
  for (int round = 0; round < 30; round++) {
    bool reached[STRIPS * NODES] = {false};
    memset(flips, 0, SLAB);
    memset(words, 0, SLAB / 8);
    const bool by_strip = round % 3 == 2;
    const size_t count = vxm_rng_below(&rng, round < 15 ? 20 : 4000);
    for (size_t f = 0; f < count; f++) {
      uint64_t record = vxm_rng_below(&rng, by_strip ? 256 * ROW : SLAB);
      uint32_t in_strip = (uint32_t)record;
      records[f] = record;
      if (by_strip)
        assert_int_equal(vxm_flipped_nodes_flip_strip(&nodes, &in_strip, 1), VXM_OK);
      words[record / 64] ^= UINT64_C(1) << record % 64;
      flips[record] ^= 1;
      reached[record / 256 / ROW * NODES + record % ROW / 16] = true;
    }
    if (round % 3 == 0)
      flip_some(&nodes, records, count, &rng);
    if (round % 3 == 1) {
      memset(reached, 0, sizeof reached); /* of a bitmap what was flipped twice is not told */
      for (size_t r = 0; r < SLAB; r++)
        reached[r / 256 / ROW * NODES + r % ROW / 16] |= flips[r];
      assert_int_equal(vxm_flipped_nodes_flip_bitmap(&nodes, words, SLAB / 64), VXM_OK);
    }
    check_nodes(&nodes, flips, reached);
  }
  vxm_flipped_nodes_destroy(&nodes);
  free(words);
  free(flips);
}

static void test_every_flip_is_in_its_brick(void **state) {
  (void)state;
  const vxm_kernels *builds[3];
  for (size_t b = 0, count = vxm_kernels_all(builds); b < count; b++) {
    vxm_kernels_force(builds[b]);
    check_flips();
  }
  vxm_kernels_force(NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_flip_is_in_its_brick)};
  return cmocka_run_group_tests(tests, setup, teardown);
}

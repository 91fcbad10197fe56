/* SPDX-License-Identifier: BSD-3-Clause */
/* Every build of the kernels does the same as plain loops, and gives the same solids. */
#include "../base/rounds.h"
#include "engine.h"

#include "base/cpu.h"
#include "voxel/parity/kernels.h"

enum { WORDS_MAX = 40, ROW_WORDS_MAX = 20 };

static const vxm_kernels *builds[3];
static size_t build_count;

/** Random words of every density, zeros and ones included. */
static void random_words(vxm_rng *rng, uint64_t *out, size_t count) {
  uint64_t density = vxm_rng_below(rng, 6);
  for (size_t i = 0; i < count; i++) {
    uint64_t word = vxm_rng_next(rng);
    for (uint64_t d = 0; d < density; d++)
      word &= vxm_rng_next(rng);
    out[i] = density == 5 && vxm_rng_below(rng, 3) ? 0 : word;
  }
}

/** A block of exactly `count` words, so that sanitizers see the first word behind it. */
static uint64_t *block_of(size_t count) {
  uint64_t *block = malloc(count * sizeof *block + (count == 0));
  assert_non_null(block);
  return block;
}

static uint64_t *copy_of(const uint64_t *words, size_t count) {
  uint64_t *copy = block_of(count);
  if (count > 0)
    memcpy(copy, words, count * sizeof *words);
  return copy;
}

static void assert_words(const uint64_t *a, const uint64_t *b, size_t count) {
  for (size_t i = 0; i < count; i++)
    assert_true(a[i] == b[i]);
}

/* ---- Prefix XOR ---- */

static void plain_fold_rows(uint64_t *words, size_t row_words, size_t rows, uint64_t tail_mask) {
  for (size_t r = 0; r < rows; r++) {
    bool open = false;
    for (size_t bit = 0; bit < 64 * row_words; bit++) {
      uint64_t *word = &words[r * row_words + bit / 64], mask = UINT64_C(1) << (bit % 64);
      open ^= (*word & mask) != 0;
      *word = open ? *word | mask : *word & ~mask;
    }
    words[(r + 1) * row_words - 1] &= tail_mask;
  }
}

static void check_fold_rows(const uint64_t *data, size_t row_words, size_t rows, unsigned tail) {
  size_t count = row_words * rows;
  uint64_t tail_mask = vxm_low_bits(tail), want_any = 0;
  uint64_t *start = copy_of(data, count);
  for (size_t r = 1; r <= rows; r++)
    start[r * row_words - 1] &= tail_mask; /* nothing is flipped behind the end of a row */
  uint64_t *want = copy_of(start, count);
  plain_fold_rows(want, row_words, rows, tail_mask);
  for (size_t i = 0; i < count; i++)
    want_any |= want[i];
  for (size_t b = 0; b < build_count; b++) {
    uint64_t *got = copy_of(start, count);
    uint64_t any = builds[b]->fold_rows(got, row_words, rows, tail_mask);
    assert_words(got, want, count);
    assert_true((any != 0) == (want_any != 0));
    free(got);
  }
  free(want);
  free(start);
}

static void test_rows_are_folded(void **state) {
  (void)state;
  vxm_rng rng = {11};
  uint64_t data[ROW_WORDS_MAX * 20];
  for (size_t row_words = 1; row_words <= ROW_WORDS_MAX; row_words++)
    for (size_t rows = 0; rows <= (row_words <= 4 ? WORDS_MAX / row_words : 5); rows++)
      for (int round = 0; round < 6; round++) {
        random_words(&rng, data, row_words * rows);
        check_fold_rows(data, row_words, rows, round < 2 ? 64 : 1 + (unsigned)vxm_rng_below(&rng, 64));
      }
}

/** A single bit that is set runs on to the end of its row and no further, from every place. */
static void test_single_bits_fill_their_row(void **state) {
  (void)state;
  for (size_t row_words = 1; row_words <= ROW_WORDS_MAX; row_words++)
    for (size_t bit = 0; bit < 64 * row_words; bit += 13) {
      uint64_t data[3 * ROW_WORDS_MAX] = {0};
      data[row_words + bit / 64] = UINT64_C(1) << (bit % 64);
      check_fold_rows(data, row_words, 3, 64);
      check_fold_rows(data, row_words, 3, 40);
    }
}

/** Rows of which many are folded some at a time, and such as are folded in pieces. */
static void test_many_and_long_rows_are_folded(void **state) {
  (void)state;
  const size_t shapes[][2] = {{3, 400}, {5, 203}, {12, 90}, {100, 9}, {255, 3}, {256, 3}, {257, 3}, {300, 2}};
  vxm_rng rng = {18};
  for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++)
    for (int round = 0; round < 3; round++) {
      size_t count = shapes[s][0] * shapes[s][1];
      uint64_t *data = block_of(count);
      random_words(&rng, data, count);
      for (size_t i = 0; i < count; i++)
        data[i] = vxm_rng_below(&rng, 3) ? 0 : data[i];
      check_fold_rows(data, shapes[s][0], shapes[s][1], 1 + (unsigned)vxm_rng_below(&rng, 64));
      free(data);
    }
}

/** Rows folded past the cache, to any place in a line, are those folded in place; nothing is left behind, and
 * nothing written around. */
static void check_fold_streaming(vxm_rng *rng, size_t row_words, size_t rows) {
  enum { AROUND = 8 };
  const uint64_t other = UINT64_C(0xa5a5a5a5a5a5a5a5);
  size_t count = row_words * rows, shift = (size_t)vxm_rng_below(rng, AROUND);
  uint64_t tail_mask = vxm_low_bits(vxm_rng_below(rng, 2) ? 64 : 1 + (unsigned)vxm_rng_below(rng, 64));
  uint64_t *data = block_of(count);
  random_words(rng, data, count);
  for (size_t i = 0; i < count; i++) /* many lines without a flip */
    data[i] = vxm_rng_below(rng, 4) ? 0 : data[i];
  for (size_t r = 1; r <= rows; r++)
    data[r * row_words - 1] &= tail_mask;
  for (size_t b = 0; b < build_count; b++) {
    uint64_t *want = copy_of(data, count), *from = copy_of(data, count);
    uint64_t *room = aligned_alloc(64, (count + 3 * AROUND) / 8 * 64), *to = room + AROUND + shift;
    assert_non_null(room);
    for (size_t i = 0; i < count + 2 * AROUND; i++)
      room[i] = other;
    uint64_t any = builds[b]->fold_rows_streaming(to, from, row_words, rows, tail_mask);
    uint64_t in_place = builds[b]->fold_rows(want, row_words, rows, tail_mask);
    assert_true((any != 0) == (in_place != 0));
    assert_words(to, want, count);
    for (size_t i = 0; i < count; i++)
      assert_true(from[i] == 0);
    for (size_t i = 0; i < AROUND + shift; i++)
      assert_true(room[i] == other);
    for (size_t i = AROUND + shift + count; i < count + 2 * AROUND; i++)
      assert_true(room[i] == other);
    free(room);
    free(from);
    free(want);
  }
  free(data);
}

static void test_rows_are_folded_past_the_cache(void **state) {
  (void)state;
  vxm_rng rng = {14};
  for (size_t row_words = 1; row_words <= 40; row_words++)
    for (int round = 0; round < 20; round++)
      check_fold_streaming(&rng, row_words, 5);
  const size_t shapes[][2] = {{2, 300}, {4, 150}, {7, 99},  {8, 99}, {16, 40},
                              {255, 3}, {256, 3}, {257, 3}, {264, 2}};
  for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++)
    for (int round = 0; round < 20; round++)
      check_fold_streaming(&rng, shapes[s][0], shapes[s][1]);
}

static void test_rows_are_folded_onto_rows(void **state) {
  (void)state;
  vxm_rng rng = {12};
  uint64_t data[WORDS_MAX];
  for (size_t count = 0; count <= WORDS_MAX; count++)
    for (size_t distance = 1; distance <= count + 1; distance++) {
      random_words(&rng, data, count);
      uint64_t *want = copy_of(data, count);
      for (size_t i = distance; i < count; i++)
        want[i] ^= want[i - distance];
      for (size_t b = 0; b < build_count; b++) {
        uint64_t *got = copy_of(data, count);
        builds[b]->fold_across(got, distance, count);
        assert_words(got, want, count);
        free(got);
      }
      free(want);
    }
}

/** Rows of 16 voxels in four bricks each, as a prefix XOR voxel by voxel. */
static void test_nodes_are_folded(void **state) {
  (void)state;
  vxm_rng rng = {17};
  for (int round = 0; round < ROUNDS(300); round++) {
    uint64_t flipped[64], inside[16], want[64] = {0}, want_inside[16] = {0}, all = 0;
    uint64_t want_masks[2] = {0, 0};
    random_words(&rng, flipped, 64);
    for (int r = 0; r < 16; r++) {
      inside[r] = 0;
      for (int row = 0; row < 16; row++)
        inside[r] |= vxm_rng_below(&rng, 2) ? UINT64_C(15) << 4 * row : 0;
      if (round % 3 == 0) { /* empty and full bricks */
        inside[r] = r % 2 ? ~UINT64_C(0) : 0;
        flipped[r] = flipped[16 + r] = 0;
      }
      for (int row = 0; row < 16; row++) {
        unsigned bit = inside[r] >> 4 * row & 1;
        for (int x = 0; x < 16; x++) {
          /* A flip is stored as what it changes in its brick: all voxels from it on. */
          unsigned change = flipped[x / 4 * 16 + r] >> (4 * row + x % 4) & 1;
          want[x / 4 * 16 + r] |= (uint64_t)(change ^ bit) << (4 * row + x % 4);
          if (x % 4 == 3)
            bit ^= change;
        }
        want_inside[r] |= bit ? UINT64_C(15) << 4 * row : 0;
      }
    }
    for (int b = 0; b < 64; b++) {
      all |= want[b];
      want_masks[0] |= (uint64_t)(want[b] != 0) << b;
      want_masks[1] |= (uint64_t)(want[b] == ~UINT64_C(0)) << b;
    }
    for (size_t b = 0; b < build_count; b++) {
      uint64_t bricks[64], from[64], in[16], masks[2];
      static const uint64_t none[64] = {0};
      memcpy(from, flipped, sizeof from);
      memcpy(in, inside, sizeof in);
      assert_true(builds[b]->fold_node(bricks, from, in, masks) == all);
      assert_memory_equal(bricks, want, sizeof want);
      assert_memory_equal(in, want_inside, sizeof in);
      assert_memory_equal(masks, want_masks, sizeof masks);
      assert_memory_equal(from, none, sizeof from);
    }
  }
}

/* ---- Moving and voting ---- */

static void test_words_are_moved(void **state) {
  (void)state;
  vxm_rng rng = {13};
  uint64_t from[WORDS_MAX], to[WORDS_MAX];
  for (size_t count = 0; count <= WORDS_MAX; count++)
    for (int round = 0; round < 8; round++) {
      random_words(&rng, from, count);
      random_words(&rng, to, count);
      for (size_t b = 0; b < build_count; b++) {
        uint64_t *f = copy_of(from, count), *t = copy_of(to, count), want_any = 0;
        uint64_t any = builds[b]->move_or(t, f, count);
        for (size_t i = 0; i < count; i++) {
          want_any |= from[i];
          assert_true(f[i] == 0 && t[i] == (from[i] | to[i]));
        }
        assert_true(any == want_any);
        free(f);
        free(t);
      }
    }
}

static void check_vote(vxm_rng *rng, size_t count, vxm_vote rule, bool fourth, bool masked) {
  uint64_t data[5][WORDS_MAX];
  bool fresh = vxm_rng_below(rng, 2), streaming = vxm_rng_below(rng, 2);
  size_t at = (size_t)vxm_rng_below(rng, 8); /* in a line */
  for (int v = 0; v < 5; v++)
    random_words(rng, data[v], count);
  for (size_t b = 0; b < build_count; b++) {
    uint64_t *voter[4], *mask = copy_of(data[0], count);
    uint64_t *room = block_of(count + 8), *out = room + at;
    memcpy(out, data[4], count * sizeof *out);
    for (int v = 0; v < 4; v++)
      voter[v] = copy_of(data[v], count);
    const uint64_t *const voters[4] = {voter[0], voter[1], voter[2], fourth ? voter[3] : NULL};
    uint64_t added = 0, want_added = 0;
    int64_t contested = builds[b]->vote(out, voters, NULL, masked ? mask : NULL, count, rule, fresh,
                                        streaming, &added),
            want = 0;
    for (size_t i = 0; i < count; i++) {
      uint64_t x = data[0][i], y = data[1][i], z = data[2][i], t = fourth ? data[3][i] : x;
      uint64_t any = x | y | z | t, all = x & y & z & t;
      uint64_t elected = rule == VXM_VOTE_MAJORITY ? (x & y) | (y & z) | (z & x)
                         : rule == VXM_VOTE_ANY    ? any
                                                   : all;
      uint64_t before = fresh ? 0 : data[4][i], disagree = any & ~all & ~before;
      assert_true(out[i] == (before | elected));
      assert_true(mask[i] == (masked ? disagree : data[0][i]));
      want += vxm_popcount(disagree);
      want_added |= elected & ~before;
    }
    assert_int_equal(contested, want);
    assert_true(added == want_added);
    for (int v = 0; v < 4; v++)
      free(voter[v]);
    free(room);
    free(mask);
  }
}

static void test_votes_are_counted(void **state) {
  (void)state;
  vxm_rng rng = {14};
  for (size_t count = 0; count <= WORDS_MAX; count++)
    for (int rule = VXM_VOTE_AUTO; rule <= VXM_VOTE_ALL; rule++)
      for (int round = 0; round < 4; round++)
        check_vote(&rng, count, (vxm_vote)rule, round & 1, round & 2);
}

/* ---- Placing ---- */

/** What three votes count, of which those that are odd say nothing. */
static void abstain_one(bool voter[3], const bool odd[3]) {
  int left = 0, votes = 0;
  for (int a = 0; a < 3; a++) {
    left += !odd[a];
    votes += !odd[a] && voter[a];
  }
  if (left == 3)
    return;
  const bool inside = votes == 3, some = votes > 0 || left < 2, most = votes >= 2;
  voter[0] = some;
  voter[1] = inside;
  voter[2] = most;
}

static void test_axes_abstain(void **state) {
  (void)state;
  vxm_rng rng = {15};
  uint64_t data[6][WORDS_MAX];
  for (size_t count = 0; count <= WORDS_MAX; count++) {
    for (int v = 0; v < 6; v++)
      random_words(&rng, data[v], count);
    for (size_t b = 0; b < build_count; b++) {
      uint64_t *voter[3];
      for (int v = 0; v < 3; v++)
        voter[v] = copy_of(data[v], count);
      builds[b]->abstain(voter, (const uint64_t *[]){data[3], data[4], data[5]}, count);
      uint64_t *told[4] = {copy_of(data[0], count), copy_of(data[1], count), copy_of(data[2], count), NULL};
      uint64_t *out = block_of(count), *mask = block_of(count), added = 0;
      builds[b]->vote(out, (const uint64_t *const *)told, (const uint64_t *[]){data[3], data[4], data[5]},
                      mask, count, VXM_VOTE_AUTO, true, false, &added);
      for (size_t i = 0; i < count; i++) {
        uint64_t any = voter[0][i] | voter[1][i] | voter[2][i], all = voter[0][i] & voter[1][i] & voter[2][i];
        assert_true(out[i] == all && mask[i] == (any & ~all));
      }
      free(out);
      free(mask);
      for (size_t i = 0; i < 64 * count; i++) {
        bool want[3], odd[3];
        for (int v = 0; v < 3; v++) {
          want[v] = data[v][i / 64] >> (i % 64) & 1;
          odd[v] = data[3 + v][i / 64] >> (i % 64) & 1;
        }
        abstain_one(want, odd);
        for (int v = 0; v < 3; v++)
          assert_int_equal(voter[v][i / 64] >> (i % 64) & 1, want[v]);
      }
      for (int v = 0; v < 3; v++) {
        free(voter[v]);
        free(told[v]);
      }
    }
  }
}

static void check_place(const double *positions, const uint32_t *entries, size_t count,
                        const vxm_affine *affine) {
  for (size_t b = 0; b < build_count; b++) {
    int32_t(*got)[4] = aligned_alloc(64, (count * sizeof *got + 64) / 64 * 64);
    uint64_t *cells = malloc(count * sizeof *cells + (count == 0));
    assert_non_null(got);
    assert_non_null(cells);
    bool good = builds[b]->place(got, cells, positions, entries, count, affine), want_good = true;
    vxm_lattice lattice = {.bits = affine->bits, .unit = INT64_C(1) << affine->bits};
    for (size_t i = 0; i < count; i++) {
      uint64_t want_cells = 0;
      for (int a = 0; a < 4; a++) {
        const double *p = positions + 3 * i;
        double at = affine->column[0][a] * p[0] + affine->column[1][a] * p[1] + affine->column[2][a] * p[2] +
                    affine->column[3][a];
        uint32_t entry = entries ? (entries[i] + affine->offset) % affine->noise_size : 0;
        at += entries ? (double)affine->noise[entry][a] : 0;
        at = rint((at - affine->origin[a]) * affine->scale[a]);
        bool fits = a == 3 || fabs(at) < (double)VXM_NARROW_MAX;
        want_good &= fits;
        assert_int_equal(got[i][a], a < 3 && fits ? (int32_t)at : 0);
        int64_t cell = vxm_lattice_first(&lattice, got[i][a]);
        if (a < 3)
          want_cells |= (uint64_t)vxm_min(vxm_max(cell, 0), affine->cells[a]) << (VXM_CELL_BITS * a);
      }
      assert_true(cells[i] == want_cells);
    }
    assert_true(good == want_good);
    free(cells);
    free(got);
  }
}

static void test_points_are_placed(void **state) {
  (void)state;
  static const double far[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300, 1e12, -4e9, 5.4e8, -5.4e8, 0.5, -0.0};
  vxm_rng rng = {15};
  for (int round = 0; round < ROUNDS(400); round++) {
    double positions[3 * 9];
    size_t count = vxm_rng_below(&rng, 10);
    vxm_affine affine = {.bits = 8 + round % 9};
    for (int a = 0; a < 3; a++) {
      affine.cells[a] = (int32_t)vxm_rng_below(&rng, round % 3 ? 10 : 1 << VXM_CELL_BITS);
      for (int c = 0; c < 4; c++)
        affine.column[c][a] = round % 2 ? c == a : 4 * vxm_rng_unit(&rng) - 2;
      affine.origin[a] = round % 4 < 2 ? 0 : 100 * vxm_rng_unit(&rng);
      affine.scale[a] = round % 3 ? 1 : 300 * vxm_rng_unit(&rng);
    }
    for (size_t i = 0; i < 3 * count; i++)
      positions[i] = round % 5 == 0 && vxm_rng_below(&rng, 9) == 0
                         ? far[vxm_rng_below(&rng, 11)]
                         : (double)(int64_t)vxm_rng_below(&rng, 4001) / 2 - 1000; /* halves, so ties */
    float noise[7][4] = {{0}};
    uint32_t entries[9];
    for (int e = 0; e < 7; e++)
      for (int a = 0; a < 3; a++)
        noise[e][a] = (float)(3 * vxm_rng_unit(&rng) - 1.5);
    affine.noise = (const float(*)[4])noise;
    affine.noise_size = 1 + (uint32_t)vxm_rng_below(&rng, 7);
    affine.offset = (uint32_t)vxm_rng_below(&rng, affine.noise_size);
    for (int i = 0; i < 9; i++)
      entries[i] = (uint32_t)vxm_rng_below(&rng, affine.noise_size);
    check_place(positions, round % 7 < 3 ? entries : NULL, count, &affine);
  }
  /* The last that fit, and the first that do not. */
  const int32_t cell_max = (1 << VXM_CELL_BITS) - 1;
  vxm_affine affine = {.scale = {1, 1, 1, 0}, .bits = 8, .cells = {cell_max, cell_max, cell_max, 0}};
  for (int a = 0; a < 3; a++)
    affine.column[a][a] = 1;
  double limit = (double)VXM_NARROW_MAX;
  for (int a = 0; a < 3; a++)
    for (int k = 0; k < 4; k++) {
      double p[3] = {1, 2, 3};
      p[a] = (k % 2 ? -1 : 1) * (limit - (k < 2 ? 1 : 0));
      check_place(p, NULL, 1, &affine);
    }
}

/* ---- Whole solids ---- */

static vxm_grid *forced(const vxm_kernels *build, const vxm_soup *soup, const vxm_space *space,
                        const vxm_voxelize_options *options, vxm_voxelize_report *report) {
  vxm_kernels_force(build);
  vxm_grid *grid = engine_solid(soup, space, options, report);
  vxm_kernels_force(NULL);
  return grid;
}

/** Rows of 1, 2, 3, 8, 9 and 17 words along each axis, full to the last bit or not. */
static vxm_space random_space(vxm_rng *rng, int round) {
  static const int64_t row_words[] = {1, 2, 3, 8, 9, 17};
  vxm_space space = engine_space(1, 1, 1);
  for (int a = 0; a < 3; a++)
    space.dims[a] = 1 + (int64_t)vxm_rng_below(rng, 7);
  space.dims[round % 3] = 64 * row_words[round / 3 % 6] - (int64_t)(round % 2 ? vxm_rng_below(rng, 64) : 0);
  return space;
}

static void compare_builds(const vxm_soup *soup, const vxm_space *space,
                           const vxm_voxelize_options *options) {
  vxm_voxelize_report first_report = VXM_VOXELIZE_REPORT_INIT, report = VXM_VOXELIZE_REPORT_INIT;
  vxm_grid *first = forced(builds[0], soup, space, options, &first_report);
  for (size_t b = 1; b < build_count; b++) {
    vxm_grid *other = forced(builds[b], soup, space, options, &report);
    assert_equal_bits(first, other);
    assert_equal_reports(&first_report, &report);
    vxm_grid_destroy(other);
  }
  vxm_grid_destroy(first);
}

static void test_solids_are_the_same_in_every_build(void **state) {
  (void)state;
  vxm_rng rng = {16};
  for (int round = 0; round < ROUNDS(108); round++) {
    vxm_space space = random_space(&rng, round);
    vxm_soup *soup = random_soup(context, 100 + (uint64_t)round, round % SOUP_KINDS, &space);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    options.split_mode = (vxm_split_mode)(round / 2 % 3);
    for (int method = VXM_METHOD_X; method <= (round % 6 ? VXM_METHOD_Z : VXM_METHOD_TETRA); method++) {
      options.method = (vxm_method)method;
      compare_builds(soup, &space, &options);
    }
    options.method = VXM_METHOD_VOTE;
    for (int rule = VXM_VOTE_MAJORITY; rule <= VXM_VOTE_ALL; rule++) {
      options.vote = (vxm_vote)rule;
      options.vote_always = round % 4 == 0;
      compare_builds(soup, &space, &options);
    }
    options.vote = VXM_VOTE_AUTO;
    if (round % 9 == 0)
      compare_builds(soup, &space, &options);
    vxm_soup_destroy(soup);
  }
}

/** The solid along each axis by every build, as one part, against the oracle. */
static void compare_with_oracle(const vxm_soup *soup, const vxm_space *space) {
  size_t count = (size_t)(space->dims[0] * space->dims[1] * space->dims[2]);
  for (int w = 0; w < 3; w++) {
    uint8_t *want = calloc(count, 1);
    assert_non_null(want);
    exact_unite(want, soup, 0, soup->face_count, space, w);
    for (size_t b = 0; b < build_count; b++) {
      vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
      options.method = (vxm_method)(VXM_METHOD_X + w);
      options.split_mode = VXM_SPLIT_MODE_WHOLE;
      vxm_grid *grid = forced(builds[b], soup, space, &options, NULL);
      assert_grid_is(grid, want);
      vxm_grid_destroy(grid);
    }
    free(want);
  }
}

/** Each build against the oracle: long rows, ties, and triangles of every shape. */
static void test_every_build_matches_the_oracle(void **state) {
  (void)state;
  vxm_rng rng = {17};
  for (int round = 0; round < ROUNDS(60); round++) {
    vxm_space space = random_space(&rng, round % 9);
    size_t count = (size_t)(space.dims[0] * space.dims[1] * space.dims[2]);
    if (count > 20000)
      continue;
    vxm_soup *soup = random_soup(context, 900 + (uint64_t)round, round % 4 == 3 ? 3 : round % 2, &space);
    compare_with_oracle(soup, &space);
    vxm_soup_destroy(soup);
  }
}

/** A coordinate in or beside the window: often exactly on a centre or on the side of a voxel. */
static double random_place(vxm_rng *rng, int64_t dim) {
  double at = (double)(dim + 4) * vxm_rng_unit(rng) - 2;
  return vxm_rng_below(rng, 3) ? at : floor(2 * at) / 2;
}

/** Up to 21 triangles, the longest of which are about as long as what vectors of doubles take, or their boxes
 * as wide; now and then one that is far larger, or degenerate. */
static vxm_soup *small_triangles(vxm_rng *rng, const vxm_space *space) {
  vxm_soup *soup = shape_empty(context);
  double unit = (double)vxm_lattice_of(space).unit, near = 65536 / unit;
  const double extents[] = {0.4, 1, 3, 7.5, 8, 8.5, 14, 30, 32, 32.5, near - 1 / unit, near, near + 1 / unit};
  size_t count = 1 + vxm_rng_below(rng, 21);
  for (size_t f = 0; f < count; f++) {
    double extent = extents[vxm_rng_below(rng, sizeof extents / sizeof *extents)], low[3];
    uint32_t corner[3];
    int longest = (int)vxm_rng_below(rng, 3), flat = vxm_rng_below(rng, 4) ? 3 : (int)vxm_rng_below(rng, 3);
    bool centred = vxm_rng_below(rng, 3) == 0; /* so that the plane passes through centres */
    for (int a = 0; a < 3; a++)
      low[a] = random_place(rng, space->dims[a]);
    for (int k = 0; k < 3; k++) {
      double at[3];
      for (int a = 0; a < 3; a++) {
        double part = k < 2 && a == longest ? k : vxm_rng_below(rng, 3) ? vxm_rng_unit(rng) : 0.5;
        at[a] = low[a] + (a == flat ? 0 : part * extent);
        at[a] = centred ? floor(at[a]) + 0.5 : at[a];
      }
      corner[k] = shape_vertex(soup, at[0], at[1], at[2]);
    }
    shape_triangle(soup, corner[0], corner[1], corner[2]);
  }
  return soup;
}

/** Groups of triangles in lanes, full and not, and what is left to one at a time. */
static void test_small_triangles_match_the_oracle(void **state) {
  (void)state;
  vxm_rng rng = {18};
  for (int round = 0; round < ROUNDS(240); round++) {
    vxm_space space = engine_space(11, 13, 12);
    if (round % 2) /* fewer steps to a voxel, so that boxes of many columns are not too long */
      space.dims[round / 2 % 3] = round % 4 == 1 ? 130 : 520;
    vxm_soup *soup = small_triangles(&rng, &space);
    compare_with_oracle(soup, &space);
    vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
    compare_builds(soup, &space, &options); /* each triangle a part, several in a group */
    vxm_soup_destroy(soup);
  }
}

static void test_the_level_limits_the_builds(void **state) {
  (void)state;
  const vxm_kernels *all[3];
  vxm_error error = {0};
  vxm_cpu_level highest = vxm_cpu_highest();
  assert_int_equal(vxm_cpu_used(), highest);
  for (int level = VXM_CPU_PLAIN; level <= VXM_CPU_AVX512; level++) {
    vxm_status status = vxm_cpu_limit((vxm_cpu_level)level, &error);
    assert_int_equal(status, level <= (int)highest ? VXM_OK : VXM_ERROR_UNAVAILABLE);
    if (status != VXM_OK)
      continue;
    assert_int_equal(vxm_cpu_used(), level);
    assert_int_equal(vxm_kernels_all(all), level + 1);
    assert_ptr_equal(vxm_kernels_get(), builds[level]);
  }
  assert_int_equal(vxm_cpu_limit((vxm_cpu_level)3, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_cpu_limit(highest, &error), VXM_OK);
}

static void test_builds_are_chosen(void **state) {
  (void)state;
  assert_in_range(build_count, 1, 3);
  assert_int_equal(builds[0]->level, VXM_CPU_PLAIN);
  assert_ptr_equal(vxm_kernels_get(), builds[build_count - 1]);
  for (size_t b = 0; b < build_count; b++) {
    vxm_kernels_force(builds[b]);
    assert_ptr_equal(vxm_kernels_get(), builds[b]);
  }
  vxm_kernels_force(NULL);
  assert_ptr_equal(vxm_kernels_get(), builds[build_count - 1]);
}

int main(void) {
  build_count = vxm_kernels_all(builds);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_builds_are_chosen),
      cmocka_unit_test(test_the_level_limits_the_builds),
      cmocka_unit_test(test_rows_are_folded),
      cmocka_unit_test(test_single_bits_fill_their_row),
      cmocka_unit_test(test_many_and_long_rows_are_folded),
      cmocka_unit_test(test_rows_are_folded_past_the_cache),
      cmocka_unit_test(test_rows_are_folded_onto_rows),
      cmocka_unit_test(test_nodes_are_folded),
      cmocka_unit_test(test_words_are_moved),
      cmocka_unit_test(test_votes_are_counted),
      cmocka_unit_test(test_axes_abstain),
      cmocka_unit_test(test_points_are_placed),
      cmocka_unit_test(test_solids_are_the_same_in_every_build),
      cmocka_unit_test(test_every_build_matches_the_oracle),
      cmocka_unit_test(test_small_triangles_match_the_oracle),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}

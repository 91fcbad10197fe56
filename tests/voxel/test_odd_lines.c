/* SPDX-License-Identifier: BSD-3-Clause */
/** Which axes abstain, and what the others elect: against an oracle that looks along each line from both
 * ends. */
#include "oracle.h"
#include "shapes.h"

#include "grid/bitgrid.h"
#include "voxel/parity/axis_vote.h"
#include "voxel/parity/odd_lines.h"
#include "voxel/parity/parity_union.h"
#include "voxmend/grid.h"
#include "voxmend/voxelize.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BEHIND = 40, TRIANGLES = 64, WORDS = 4096 };

typedef struct subject {
  vxm_triangle_set triangles;
  vxm_snapped_points placed;
  vxm_space space;
  oracle_triangle of[TRIANGLES]; /* sorted by part */
  size_t begin[TRIANGLES + 1];   /* of each part */
} subject;

static const vxm_layout layouts[6] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}, {0, 2, 1}, {1, 0, 2}};

/** Triangles that stick out of a grid on all sides, some with common edges; in parts if there are to be many.
 */
static vxm_soup *random_soup(vxm_rng *rng) {
  vxm_soup *soup = shape_empty(context);
  uint32_t vertices = 4 + (uint32_t)vxm_rng_below(rng, 12);
  for (uint32_t v = 0; v < vertices; v++) {
    double x = shape_quarter(rng, -12, 44), y = shape_quarter(rng, -12, 44);
    shape_vertex(soup, x, y, shape_quarter(rng, -12, 44));
  }
  size_t faces = 1 + vxm_rng_below(rng, 9);
  for (size_t f = 0; f < faces; f++)
    shape_triangle(soup, (uint32_t)vxm_rng_below(rng, vertices), (uint32_t)vxm_rng_below(rng, vertices),
                   (uint32_t)vxm_rng_below(rng, vertices));
  return soup;
}

static bool begin(subject *s, const vxm_soup *soup, vxm_rng *rng, vxm_split_mode mode) {
  const vxm_split_rule rule = {mode, VXM_CAVITIES_FILL, false};
  s->space = (vxm_space){{5, 6, 7}, {0, 0, 0}, {1, 1, 1}};
  s->space.dims[vxm_rng_below(rng, 3)] = (int64_t)(vxm_rng_below(rng, 2) ? 70 : 9);
  s->placed = (vxm_snapped_points){.context = context};
  if (vxm_triangle_set_create(&s->triangles, soup, rule, NULL) != VXM_OK)
    return false; /* no face */
  vxm_lattice lattice = vxm_lattice_of(&s->space);
  assert_int_equal(vxm_snapped_points_set(&s->placed, &s->triangles, &lattice, NULL, true, NULL), VXM_OK);
  size_t count = 0;
  for (size_t p = 0; p < s->triangles.split.part_count; p++) {
    s->begin[p] = count;
    for (size_t t = s->triangles.parts[p].begin; t < s->triangles.parts[p].caps; t++, count++)
      for (int c = 0; c < 3; c++)
        for (int a = 0; a < 3; a++)
          s->of[count].at[c][a] = (int64_t)(4 * s->triangles.positions[s->triangles.corners[t][c]][a]);
  }
  s->begin[s->triangles.split.part_count] = count;
  return true;
}

static void end(subject *s) {
  vxm_snapped_points_destroy(&s->placed);
  vxm_triangle_set_destroy(&s->triangles);
}

/** Whether a part has an odd number of faces on the whole line through a voxel. */
static bool is_odd(const subject *s, const int64_t voxel[3], int axis) {
  int64_t behind[3] = {voxel[0], voxel[1], voxel[2]};
  behind[axis] = BEHIND;
  for (size_t p = 0; p < s->triangles.split.part_count; p++)
    if (oracle_parity(s->of + s->begin[p], (int)(s->begin[p + 1] - s->begin[p]), behind, axis))
      return true;
  return false;
}

/** By the faces before a voxel, of the parts' union. */
static bool is_inside(const subject *s, const int64_t voxel[3], int axis) {
  for (size_t p = 0; p < s->triangles.split.part_count; p++)
    if (oracle_parity(s->of + s->begin[p], (int)(s->begin[p + 1] - s->begin[p]), voxel, axis))
      return true;
  return false;
}

static size_t word_of(const vxm_window *w, const int64_t voxel[3]) {
  return (size_t)(voxel[w->layout.slow] - w->begin) * w->slice_words +
         (size_t)voxel[w->layout.middle] * w->row_words + (size_t)voxel[w->layout.fast] / 64;
}

static bool bit_of(const uint64_t *words, const vxm_window *w, const int64_t voxel[3]) {
  return words[word_of(w, voxel)] >> (voxel[w->layout.fast] % 64) & 1;
}

/** Calls for the voxels of a window, one after the other; false behind the last one. */
static bool next_voxel(int64_t voxel[3], const vxm_window *w) {
  const int axes[3] = {w->layout.fast, w->layout.middle, w->layout.slow};
  const int64_t first[3] = {0, 0, w->begin}, last[3] = {w->fast_dim, w->middle_dim, w->end};
  for (int a = 0; a < 3; a++) {
    if (++voxel[axes[a]] < last[a])
      return true;
    voxel[axes[a]] = first[a];
  }
  return false;
}

/** What the axes say of a voxel that do not abstain: two of them may tell outside and three inside, where
 * none says anything else. */
typedef enum verdict { OUTSIDE, INSIDE, CONTESTED } verdict;

static verdict verdict_of(const bool inside[3], const bool odd[3]) {
  int count = 0, votes = 0;
  for (int a = 0; a < 3; a++) {
    count += !odd[a];
    votes += !odd[a] && inside[a];
  }
  return votes == 3 ? INSIDE : votes == 0 && count >= 2 ? OUTSIDE : CONTESTED;
}

static verdict expected(const subject *s, const int64_t voxel[3]) {
  bool inside[3], odd[3];
  for (int a = 0; a < 3; a++) {
    inside[a] = is_inside(s, voxel, a);
    odd[a] = is_odd(s, voxel, a);
  }
  return verdict_of(inside, odd);
}

static void check(const subject *s, const vxm_window *w, const uint64_t *mask, int counts[3]) {
  int64_t voxel[3] = {0, 0, 0};
  voxel[w->layout.slow] = w->begin;
  do {
    verdict told = bit_of(mask, w, voxel)       ? CONTESTED
                   : bit_of(w->words, w, voxel) ? INSIDE
                                                : OUTSIDE,
            wanted = expected(s, voxel);
    if (told != wanted)
      fail_msg("voxel %d %d %d: %d, not %d", (int)voxel[0], (int)voxel[1], (int)voxel[2], (int)told,
               (int)wanted);
    counts[told]++;
  } while (next_voxel(voxel, w));
}

/** One part, polled window by window with what is carried on. */
static void polls_elect_what_the_oracle_elects(void **state) {
  (void)state;
  static uint64_t words[WORDS], mask[WORDS], carry[WORDS];
  vxm_rng rng = {31};
  vxm_workspace workspace = vxm_workspace_of(context);
  int counts[3] = {0};
  for (int round = 0; round < 1500; round++) {
    subject s;
    vxm_soup *soup = random_soup(&rng);
    if (!begin(&s, soup, &rng, VXM_SPLIT_MODE_WHOLE)) {
      vxm_soup_destroy(soup);
      continue;
    }
    const vxm_layout layout = layouts[round % 6];
    memset(carry, 0, sizeof carry);
    int64_t slices = 1 + (int64_t)vxm_rng_below(&rng, 9), all = s.space.dims[layout.slow];
    for (int64_t k = 0; k < all; k += slices) {
      vxm_window window = vxm_window_of(&s.space, layout, k, k + slices < all ? k + slices : all);
      assert_true(window.slice_words * (size_t)slices <= WORDS);
      window.words = words;
      const vxm_axis_vote_job job = {.triangles = &s.triangles,
                                     .placed = &s.placed,
                                     .rule = VXM_VOTE_AUTO,
                                     .fresh = true,
                                     .mask = mask,
                                     .carry = carry};
      vxm_vote_tally tally = {0, false};
      assert_int_equal(vxm_axis_vote(&workspace, &window, &job, &tally, NULL), VXM_OK);
      int seen[3] = {0};
      check(&s, &window, mask, seen);
      assert_int_equal(tally.contested, seen[CONTESTED]);
      assert_int_equal(tally.added, seen[INSIDE] > 0);
      for (int v = 0; v < 3; v++)
        counts[v] += seen[v];
    }
    end(&s);
    vxm_soup_destroy(soup);
  }
  vxm_workspace_destroy(&workspace);
  print_message("outside %d, inside %d, contested %d\n", counts[0], counts[1], counts[2]);
  assert_true(counts[OUTSIDE] > 1000 && counts[INSIDE] > 500 && counts[CONTESTED] > 1000);
}

/** Of many parts a line is odd if it is for one. */
static void lines_are_those_of_the_oracle(void **state) {
  (void)state;
  vxm_rng rng = {32};
  int odd = 0, parts = 0;
  for (int round = 0; round < 1500; round++) {
    subject s;
    vxm_soup *soup = random_soup(&rng);
    if (!begin(&s, soup, &rng, round % 2 ? VXM_SPLIT_MODE_WHOLE : VXM_SPLIT_MODE_GROUP)) {
      vxm_soup_destroy(soup);
      continue;
    }
    const vxm_layout layout = layouts[round % 6];
    const int axes[3] = {layout.fast, layout.middle, layout.slow};
    int64_t all = s.space.dims[layout.slow], from = (int64_t)vxm_rng_below(&rng, (uint32_t)all);
    vxm_window window = vxm_window_of(&s.space, layout, from, all);
    size_t part_count = s.triangles.split.part_count;
    vxm_odd_lines lines;
    assert_int_equal(
        vxm_odd_lines_find(&lines, context, &window, &s.placed, &s.triangles, 0, part_count, NULL), VXM_OK);
    parts += part_count > 1;
    int64_t voxel[3] = {0, 0, 0};
    voxel[layout.slow] = from;
    do {
      const int64_t at[3] = {voxel[layout.fast], voxel[layout.middle], voxel[layout.slow] - from};
      const size_t middle_words = ((size_t)window.middle_dim + 63) / 64;
      const uint64_t told[3] = {
          lines.along[0][(size_t)at[2] * middle_words + (size_t)at[1] / 64] >> (at[1] % 64) & 1,
          lines.along[1][(size_t)at[2] * window.row_words + (size_t)at[0] / 64] >> (at[0] % 64) & 1,
          lines.along[2][(size_t)at[1] * window.row_words + (size_t)at[0] / 64] >> (at[0] % 64) & 1};
      for (int a = 0; a < 3; a++) {
        assert_int_equal(told[a], is_odd(&s, voxel, axes[a]));
        assert_true(!told[a] || vxm_odd_lines_in(&lines, (size_t)at[2]));
        odd += (int)told[a];
      }
    } while (next_voxel(voxel, &window));
    vxm_odd_lines_destroy(&lines);
    end(&s);
    vxm_soup_destroy(soup);
  }
  assert_true(odd > 10000 && parts > 100);
}

/** All that three axes can say, and what counts of three votes make of it; from the other end of the lines it
 * is the same. */
static void every_combination(void **state) {
  (void)state;
  vxm_space space = {{64, 1, 1}, {0, 0, 0}, {1, 1, 1}};
  vxm_odd_lines lines = {.window = vxm_window_of(&space, layouts[0], 0, 1)};
  bool majority[64];
  for (int c = 0; c < 64; c++) {
    bool inside[3], odd[3];
    uint64_t vote[3], along[3];
    for (int a = 0; a < 3; a++) {
      inside[a] = c >> a & 1;
      odd[a] = c >> (3 + a) & 1;
      vote[a] = (uint64_t)inside[a] << 5;
      along[a] = (uint64_t)odd[a] << (a == 0 ? 0 : 5);
      lines.along[a] = &along[a];
    }
    vxm_odd_lines_abstain(&lines, 0, (uint64_t *[]){&vote[0], &vote[1], &vote[2]});
    int votes = 0;
    for (int a = 0; a < 3; a++)
      votes += (int)(vote[a] >> 5 & 1);
    verdict told = votes == 3 ? INSIDE : votes == 0 ? OUTSIDE : CONTESTED;
    assert_int_equal(told, verdict_of(inside, odd));
    majority[c] = votes >= 2;
  }
  for (int c = 0; c < 64; c++) /* an odd line's other end tells the opposite */
    assert_int_equal(majority[c], majority[c ^ c >> 3]);
}

/** Rows of any length, of which some words are looked at together. */
static void long_and_short_rows(void **state) {
  (void)state;
  static const int64_t lengths[] = {1, 64, 65, 1000, 64 * 64, 64 * 64 + 1, 64 * 150 - 7};
  enum { ROWS = 37, MOST = 150 * ROWS };
  static uint64_t vote[3][MOST], before[3][MOST], along[3][MOST];
  vxm_rng rng = {33};
  for (size_t l = 0; l < sizeof lengths / sizeof *lengths; l++) {
    vxm_space space = {{lengths[l], ROWS, 1}, {0, 0, 0}, {1, 1, 1}};
    vxm_odd_lines lines = {.window = vxm_window_of(&space, layouts[0], 0, 1)};
    const size_t row_words = lines.window.row_words;
    for (int a = 0; a < 3; a++) {
      lines.along[a] = along[a];
      for (size_t w = 0; w < row_words * ROWS; w++) {
        uint64_t mask = w % row_words + 1 == row_words ? vxm_window_tail_mask(&lines.window) : ~UINT64_C(0);
        vote[a][w] = before[a][w] = vxm_rng_next(&rng) & mask;
        along[a][w] = vxm_rng_next(&rng) & vxm_rng_next(&rng) & (a == 0 ? ~UINT64_C(0) : mask);
      }
    }
    vxm_odd_lines_abstain(&lines, 0, (uint64_t *[]){vote[0], vote[1], vote[2]});
    for (size_t row = 0; row < ROWS; row++)
      for (size_t i = 0; i < 64 * row_words; i++) {
        const size_t w = row * row_words + i / 64;
        const bool is_in = i < (size_t)lengths[l];
        const bool odd[3] = {is_in && along[0][row / 64] >> (row % 64) & 1, along[1][i / 64] >> (i % 64) & 1,
                             along[2][w] >> (i % 64) & 1};
        bool inside[3];
        int votes = 0;
        for (int a = 0; a < 3; a++) {
          inside[a] = before[a][w] >> (i % 64) & 1;
          votes += (int)(vote[a][w] >> (i % 64) & 1);
        }
        assert_int_equal(votes == 3 ? INSIDE : votes == 0 ? OUTSIDE : CONTESTED, verdict_of(inside, odd));
      }
  }
}

/** A sheet that is not flat, a triangle fan with a rim, anywhere. */
static vxm_soup *random_sheets(vxm_rng *rng, const double mirror[3]) {
  vxm_soup *soup = shape_empty(context);
  for (int sheet = 0; sheet < 3; sheet++) {
    double middle[3], first = (double)soup->vertex_count;
    for (int a = 0; a < 3; a++)
      middle[a] = 1.2 * vxm_rng_unit(rng) - 0.6;
    for (int v = 0; v < 7; v++) {
      double p[3];
      for (int a = 0; a < 3; a++)
        p[a] = mirror[a] * (middle[a] + (v == 0 ? 0 : 0.9 * (vxm_rng_unit(rng) - 0.5)));
      shape_vertex(soup, p[0], p[1], p[2]);
    }
    for (uint32_t v = 1; v < 6; v++)
      shape_triangle(soup, (uint32_t)first, (uint32_t)first + v, (uint32_t)first + v + 1);
  }
  return soup;
}

static void a_mirrored_mesh_gets_mirrored_voxels(void **state) {
  (void)state;
  enum { SIDE = 32 };
  const vxm_space cube = {{SIDE, SIDE, SIDE}, {-1.6, -1.6, -1.6}, {0.1, 0.1, 0.1}};
  vxm_space_options space = VXM_SPACE_OPTIONS_INIT;
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  space.like = &cube;
  int64_t contested = 0;
  for (uint64_t round = 0; round < 60; round++) {
    vxm_grid *grid[2];
    const double mirror[3] = {round & 1 ? -1 : 1, round & 2 ? -1 : 1, round & 4 ? -1 : 1};
    for (int m = 0; m < 2; m++) {
      vxm_rng rng = {round / 8 + 100};
      vxm_soup *soup = random_sheets(&rng, m ? mirror : (const double[]){1, 1, 1});
      vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
      assert_int_equal(vxm_voxelize(&grid[m], &report, soup, &space, &options, NULL), VXM_OK);
      contested += report.contested;
      vxm_soup_destroy(soup);
    }
    for (int64_t z = 0; z < SIDE; z++)
      for (int64_t y = 0; y < SIDE; y++)
        for (int64_t x = 0; x < SIDE; x++) {
          const int64_t of[3] = {mirror[0] < 0 ? SIDE - 1 - x : x, mirror[1] < 0 ? SIDE - 1 - y : y,
                                 mirror[2] < 0 ? SIDE - 1 - z : z};
          assert_int_equal(vxm_grid_get(grid[0], x, y, z), vxm_grid_get(grid[1], of[0], of[1], of[2]));
        }
    vxm_grid_destroy(grid[0]);
    vxm_grid_destroy(grid[1]);
  }
  assert_true(contested > 10000);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lines_are_those_of_the_oracle),
      cmocka_unit_test(polls_elect_what_the_oracle_elects),
      cmocka_unit_test(every_combination),
      cmocka_unit_test(long_and_short_rows),
      cmocka_unit_test(a_mirrored_mesh_gets_mirrored_voxels),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}

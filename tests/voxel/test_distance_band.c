/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Tiles of a band, in all builds, against the distance to every triangle asked for every voxel, to the bit;
 * and what becomes of them against the same done voxel by voxel.
 */
#include "../base/rounds.h"
#include "distance_triangles.h"
#include "shapes.h"

#include "base/bits.h"
#include "voxel/closest/triangle_distance.h"
#include "voxel/fields/distance_band.h"

#include <math.h>
#include <stdlib.h>

static triangle_corners *make_corners(size_t count, double extent, vxm_rng *rng, int kind) {
  triangle_corners *corners = malloc(count * sizeof *corners);
  fill_corners(corners, count, extent, rng, kind);
  return corners;
}

/* ---- Tiles ---- */

static vxm_band_grid random_grid(double extent, vxm_rng *rng, int kind) {
  static const int axes[6][3] = {{0, 1, 2}, {2, 1, 0}, {1, 2, 0}, {0, 2, 1}, {2, 0, 1}, {1, 0, 2}};
  static const double bands[] = {3, 0.4, 8, 1.5, 2.25};
  vxm_band_grid grid = {.band = bands[kind % 5]};
  memcpy(grid.axes, axes[kind % 6], sizeof grid.axes);
  for (int a = 0; a < 3; a++) {
    grid.step[a] = kind % 4 == 3 ? 0.2 + 0.8 * vxm_rng_unit(rng) : 1;
    grid.dims[a] = 1 + (int64_t)vxm_rng_below(rng, kind % 2 ? 40 : (uint64_t)(2 * extent));
  }
  return grid;
}

/** The least distance of a voxel of a tile, or the band. */
static double right_square(const vxm_band_grid *grid, const int64_t at[3],
                           const vxm_distance_triangle *triangles, size_t count) {
  double p[3], right = grid->band * grid->band;
  for (int a = 0; a < 3; a++)
    p[grid->axes[a]] = ((double)at[a] + 0.5) * grid->step[grid->axes[a]];
  for (size_t t = 0; t < count; t++)
    right = fmin(right, vxm_triangle_distance2(&triangles[t], p));
  return right;
}

static void check_tile(vxm_band_tile *tile, const vxm_band_clusters *all, const uint32_t *list,
                       const vxm_distance_triangle *triangles) {
  const vxm_band_kernels *builds[3];
  size_t build_count = vxm_band_kernels_all(builds);
  int64_t n[3];
  for (size_t b = 0; b < build_count; b++) {
    builds[b]->measure(tile, all, list, all->count);
    for (n[2] = 0; n[2] < tile->count[2]; n[2]++)
      for (n[1] = 0; n[1] < tile->count[1]; n[1]++)
        for (n[0] = 0; n[0] < tile->count[0]; n[0]++) {
          /* All in the plain build; some in the others, whose bits are to be the same. */
          if (b > 0 && (n[0] + n[1] + n[2]) % 3)
            continue;
          const int64_t at[3] = {tile->first[0] + n[0], tile->first[1] + n[1], tile->first[2] + n[2]};
          double right = right_square(&all->grid, at, triangles, all->triangle_count);
          double made = tile->squares[n[2] * VXM_BAND_SLICE + n[1] * VXM_BAND_ROW + n[0]];
          if (made != right)
            fail_msg("(%d, %d, %d), build %zu: %.17g, not %.17g", (int)at[0], (int)at[1], (int)at[2], b, made,
                     right);
        }
  }
}

/** A tile of a grid, not always one that begins at a multiple. */
static void choose_tile(vxm_band_tile *tile, const vxm_band_grid *grid, vxm_rng *rng) {
  for (int a = 0; a < 3; a++) {
    tile->first[a] = (int64_t)vxm_rng_below(rng, (uint64_t)grid->dims[a]);
    tile->count[a] = (int)vxm_min(grid->dims[a] - tile->first[a], VXM_BAND_TILE);
  }
}

/** As many points as corners. */
static vxm_band_soup soup_of(const triangle_corners *corners, size_t count) {
  uint32_t(*numbers)[3] = malloc(count * sizeof *numbers);
  for (size_t t = 0; t < count; t++)
    for (size_t c = 0; c < 3; c++)
      numbers[t][c] = (uint32_t)(3 * t + c);
  return (vxm_band_soup){corners[0], (const uint32_t(*)[3])numbers, count};
}

static void soup_free(const vxm_band_soup *soup) {
  free((void *)soup->corners);
}

static void check_clusters(const triangle_corners *corners, size_t count, const vxm_band_grid *grid,
                           vxm_rng *rng) {
  static vxm_band_tile tile;
  vxm_distance_triangle *triangles = malloc(count * sizeof *triangles);
  for (size_t t = 0; t < count; t++)
    vxm_distance_triangle_make(&triangles[t], (const double(*)[3])corners[t]);
  vxm_band_clusters *all;
  vxm_band_soup soup = soup_of(corners, count);
  assert_int_equal(vxm_band_clusters_create(&all, context, &soup, grid, NULL), VXM_OK);
  uint32_t *list = malloc(all->count * sizeof *list);
  for (uint32_t i = 0; i < all->count; i++)
    list[i] = i;
  for (int n = 0; n < 2; n++) {
    choose_tile(&tile, grid, rng);
    check_tile(&tile, all, list, triangles);
  }
  free(list);
  vxm_band_clusters_destroy(all);
  soup_free(&soup);
  free(triangles);
}

/** Few triangles of all kinds, so that each is the nearest somewhere: their frames are the same to the bit.
 */
static void test_frames(void **state) {
  (void)state;
  vxm_rng rng = {41};
  vxm_band_grid grid = {{0, 1, 2}, {9, 8, 7}, {1, 1, 1}, 6};
  for (int kind = 0; kind < 15; kind++)
    for (int round = 0; round < ROUNDS(20); round++) {
      size_t count = 1 + (size_t)vxm_rng_below(&rng, 12);
      triangle_corners *corners = make_corners(count, 8, &rng, kind);
      check_clusters((const triangle_corners *)corners, count, &grid, &rng);
      free(corners);
    }
}

static void test_tiles(void **state) {
  (void)state;
  static const size_t counts[] = {1, 2, 7, 9, 64, 65, 130, 400, 700};
  vxm_rng rng = {42};
  for (int round = 0; round < ROUNDS(60); round++) {
    size_t count = counts[round % 9];
    double extent = round % 4 == 0 ? 60 : 16;
    triangle_corners *corners = make_corners(count, extent, &rng, round / 9 + round);
    vxm_band_grid grid = random_grid(extent, &rng, round);
    check_clusters((const triangle_corners *)corners, count, &grid, &rng);
    free(corners);
  }
}

/** So many that candidates are measured before all clusters have been tested. */
static void test_crowd(void **state) {
  (void)state;
  enum { COUNT = 6000 };
  vxm_rng rng = {43};
  triangle_corners *corners = malloc(COUNT * sizeof *corners);
  for (size_t t = 0; t < COUNT; t++) {
    double from[3];
    for (int a = 0; a < 3; a++)
      from[a] = 12 * vxm_rng_unit(&rng);
    for (int c = 0; c < 3; c++)
      for (int a = 0; a < 3; a++)
        corners[t][c][a] = from[a] + vxm_rng_unit(&rng);
  }
  vxm_band_grid grid = {{2, 1, 0}, {12, 12, 12}, {1, 1, 1}, 3};
  check_clusters((const triangle_corners *)corners, COUNT, &grid, &rng);
  free(corners);
}

/** Faces of an octahedron, cut into pieces: their normals are equally long along all axes. */
static void test_equal_slopes(void **state) {
  (void)state;
  enum { CUTS = 12, COUNT = 8 * CUTS * CUTS };
  vxm_rng rng = {46};
  triangle_corners *corners = malloc(COUNT * sizeof *corners);
  size_t t = 0;
  for (int octant = 0; octant < 8; octant++)
    for (int i = 0; i < CUTS; i++)
      for (int j = 0; i + j < CUTS; j++)
        for (int turned = 0; turned < (i + j + 1 < CUTS ? 2 : 1); turned++, t++) {
          const int places[2][3][2] = {{{i, j}, {i + 1, j}, {i, j + 1}},
                                       {{i + 1, j}, {i + 1, j + 1}, {i, j + 1}}};
          for (int c = 0; c < 3; c++) {
            const int *at = places[turned][c], parts[3] = {at[0], at[1], CUTS - at[0] - at[1]};
            for (int a = 0; a < 3; a++)
              corners[t][c][a] = 10 + (octant >> a & 1 ? -9.0 : 9.0) * parts[a] / CUTS;
          }
        }
  assert_int_equal(t, COUNT);
  vxm_band_grid grid = {{0, 1, 2}, {20, 20, 20}, {1, 1, 1}, 3};
  check_clusters((const triangle_corners *)corners, COUNT, &grid, &rng);
  free(corners);
}

/** So far away, or so large, that floats cannot tell which is nearer. */
static void test_far_and_large(void **state) {
  (void)state;
  enum { COUNT = 100 };
  vxm_rng rng = {44};
  for (int round = 0; round < 16; round++) {
    triangle_corners *corners = make_corners(COUNT, 16, &rng, 1);
    double size = pow(10, 2 + round % 8);
    for (size_t t = 0; t < COUNT; t++)
      for (int c = 0; c < 3; c++)
        for (int a = 0; a < 3; a++) {
          if (round < 8) /* fans about points of the grid */
            corners[t][c][a] += c > 0 ? size * (vxm_rng_unit(&rng) - 0.5) : 0;
          else /* all about the same plane */
            corners[t][c][a] = a == 2 ? 7 + 1e-6 * vxm_rng_unit(&rng) : size * (vxm_rng_unit(&rng) - 0.5);
        }
    vxm_band_grid grid = {{0, 1, 2}, {20, 20, 14}, {1, 1, 1}, 3};
    check_clusters((const triangle_corners *)corners, COUNT, &grid, &rng);
    free(corners);
  }
}

/* ---- Values ---- */

static float value_of(const vxm_band_values *out, double square, bool is_inside) {
  double distance = fmin(sqrt(square), out->band);
  float value = (float)(distance * out->side);
  return is_inside ? -value : value;
}

static void test_values(void **state) {
  (void)state;
  static vxm_band_tile tile;
  vxm_rng rng = {45};
  const vxm_band_kernels *builds[3];
  size_t build_count = vxm_band_kernels_all(builds);
  static float values[VXM_BAND_TILE * VXM_BAND_TILE * 200];
  static uint64_t words[VXM_BAND_TILE * VXM_BAND_TILE * 5];
  for (int round = 0; round < ROUNDS(40); round++) {
    bool is_fill = round % 2;
    int64_t count[3];
    int shift = is_fill ? (int)vxm_rng_below(&rng, 2) * 32 : 32;
    for (int a = 0; a < 3; a++) {
      count[a] = 1 + (int64_t)vxm_rng_below(&rng, a == 0 && is_fill ? 190 : VXM_BAND_TILE);
      tile.count[a] = (int)vxm_min(count[a], VXM_BAND_TILE);
    }
    for (size_t i = 0; i < VXM_BAND_VOXELS; i++)
      tile.squares[i] = fmin(6.25, 9 * vxm_rng_unit(&rng));
    for (size_t w = 0; w < sizeof words / sizeof *words; w++)
      words[w] = w % 3 ? vxm_rng_next(&rng) : w % 2 ? ~UINT64_C(0) : 0;
    vxm_band_values out = {values,
                           200,
                           (size_t)200 * VXM_BAND_TILE,
                           round % 5 ? words : NULL,
                           5,
                           5 * VXM_BAND_TILE,
                           shift,
                           round % 4 > 1,
                           2.5,
                           0.3};
    for (size_t b = 0; b < build_count; b++) {
      vxm_band_tally tally = {.min = INFINITY, .max = -INFINITY}, right = tally;
      if (is_fill)
        builds[b]->fill(&out, count, &tally);
      else
        builds[b]->finish(&out, &tile, &tally);
      for (int64_t z = 0; z < count[2]; z++)
        for (int64_t y = 0; y < count[1]; y++)
          for (int64_t x = 0; x < count[0]; x++) {
            int64_t bit = x + shift, row = z * VXM_BAND_TILE + y;
            bool is_inside = out.words && words[row * 5 + bit / 64] >> (bit % 64) & 1;
            double square = is_fill ? 6.25 : tile.squares[z * VXM_BAND_SLICE + y * VXM_BAND_ROW + x];
            float value = value_of(&out, square, is_inside);
            assert_true(values[row * 200 + x] == value);
            right.exact += sqrt(square) < 2.5;
            right.inside += is_inside;
            right.min = fminf(right.min, value);
            right.max = fmaxf(right.max, value);
          }
      assert_int_equal(tally.exact, right.exact);
      assert_int_equal(tally.inside, right.inside);
      assert_true(tally.min == right.min && tally.max == right.max);
    }
  }
}

/** Estimates hold, and what cannot be made leaves nothing behind. */
static void test_memory(void **state) {
  (void)state;
  enum { COUNT = 5000 };
  vxm_rng rng = {46};
  triangle_corners *corners = make_corners(COUNT, 50, &rng, 2);
  vxm_band_soup soup = soup_of((const triangle_corners *)corners, COUNT);
  vxm_band_grid grid = {{0, 1, 2}, {50, 70, 90}, {1, 1, 1}, 3};
  for (int part = 0; part <= 10; part++) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.memory_limit = (vxm_band_clusters_bytes(COUNT) + vxm_distance_band_bytes(COUNT, 2, grid.dims)) *
                               (uint64_t)part / 10 +
                           1;
    vxm_context *own;
    assert_int_equal(vxm_context_create(&own, &options, NULL), VXM_OK);
    vxm_band_clusters *all;
    vxm_distance_band *band = NULL;
    vxm_status status = vxm_band_clusters_create(&all, own, &soup, &grid, NULL);
    if (status == VXM_OK)
      status = vxm_distance_band_create(&band, all, 2, NULL);
    assert_true(status == VXM_OK || status == VXM_ERROR_MEMORY_LIMIT);
    assert_true((status == VXM_OK) == (band != NULL));
    assert_true(part < 10 || status == VXM_OK);
    vxm_distance_band_destroy(band);
    vxm_band_clusters_destroy(all);
    vxm_context_destroy(own);
  }
  soup_free(&soup);
  free(corners);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_tiles),         cmocka_unit_test(test_frames),
      cmocka_unit_test(test_crowd),         cmocka_unit_test(test_equal_slopes),
      cmocka_unit_test(test_far_and_large), cmocka_unit_test(test_values),
      cmocka_unit_test(test_memory),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}

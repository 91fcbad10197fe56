/* SPDX-License-Identifier: BSD-3-Clause */
/** The bins between triangles and slabs, and solids in which parts have few flips or very many. */
#include "engine.h"

#include "voxel/parity/crossing_bins.h"
#include "voxel/parity/kernels.h"
#include "voxel/parity/raster_schedule.h"
#include "voxel/parity/slabs.h"

/* ---- Bins alone ---- */

enum { PARTS = 12, SLAB_WORDS_MAX = 60 };

/** Puts records one by one, or as vectors are stored: eight at once, of which some count. */
static void put_some(vxm_crossing_bins *bins, size_t worker, vxm_crossing_bin *bin, vxm_rng *rng,
                     size_t count, uint64_t words[]) {
  for (size_t i = 0; i < count;) {
    uint64_t eight[8];
    size_t used = 1 + vxm_rng_below(rng, 8);
    used = used < count - i ? used : count - i;
    for (size_t k = 0; k < 8; k++)
      eight[k] = vxm_rng_below(rng, 64 * bins->slab_words);
    for (size_t k = 0; k < used; k++)
      words[eight[k] / 64] ^= UINT64_C(1) << (eight[k] % 64);
    if (vxm_rng_below(rng, 2)) {
      for (size_t k = 0; k < used; k++)
        vxm_crossing_bin_put(bins, worker, bin, eight[k]);
    } else {
      if (bin->at >= bin->limit)
        vxm_crossing_bin_grow(bins, worker, bin);
      memcpy(bin->at, eight, sizeof eight);
      bin->at += used;
    }
    i += used;
  }
}

/** What comes out of a bin is what went in, part after part. */
static void check_bin(const vxm_crossing_bins *bins, vxm_crossing_bin *bin, const bool began[PARTS],
                      uint64_t words[PARTS][SLAB_WORDS_MAX], const size_t records[PARTS]) {
  vxm_crossing_bin_reader reader = vxm_crossing_bin_read(bin, false);
  for (uint32_t part = 0; part < PARTS; part++) {
    if (!began[part])
      continue;
    assert_int_equal(reader.part, part);
    size_t read = 0;
    bool bitmap = false;
    vxm_crossing_bin_piece piece;
    while (vxm_crossing_bin_next(&reader, &piece)) {
      bitmap |= piece.is_bitmap;
      read += piece.count;
      if (piece.is_bitmap)
        assert_int_equal(piece.count, bins->slab_words);
      for (size_t i = 0; i < piece.count; i++)
        if (piece.is_bitmap)
          words[part][i] ^= piece.data[i];
        else
          words[part][piece.data[i] / 64] ^= UINT64_C(1) << (piece.data[i] % 64);
    }
    for (size_t w = 0; w < bins->slab_words; w++)
      assert_true(words[part][w] == 0);
    assert_true(bitmap || read == records[part]);
    /* However many there are, the memory stays bounded. */
    assert_true(read <= 2 * bins->slab_words + 4 * 1024);
  }
  assert_true(reader.part == VXM_BIN_NONE);
}

static void test_bins_give_back_what_was_put(void **state) {
  (void)state;
  vxm_rng rng = {21};
  vxm_crossing_bins bins = {.context = context};
  for (int round = 0; round < 150; round++) {
    size_t workers = 1 + vxm_rng_below(&rng, 3), voters = 1 + vxm_rng_below(&rng, 4),
           slabs = 1 + vxm_rng_below(&rng, 3), slab_words = 1 + vxm_rng_below(&rng, SLAB_WORDS_MAX);
    assert_int_equal(vxm_crossing_bins_reset(&bins, workers, voters, slabs, slab_words, NULL), VXM_OK);
    for (size_t w = 0; w < workers; w++)
      for (size_t b = 0; b < voters * slabs; b++) {
        vxm_crossing_bin *bin = vxm_crossing_bins_at(&bins, w, b / slabs, b % slabs);
        uint64_t words[PARTS][SLAB_WORDS_MAX] = {{0}};
        size_t records[PARTS] = {0};
        bool began[PARTS] = {false};
        for (uint32_t part = 0; part < PARTS; part++) {
          static const size_t most[] = {2, 30, 300, 1100, 9000};
          if (vxm_rng_below(&rng, 3) == 0)
            continue;
          records[part] = vxm_rng_below(&rng, most[vxm_rng_below(&rng, round % 4 ? 3 : 5)]);
          began[part] = true;
          vxm_crossing_bin_begin(&bins, w, bin, part);
          put_some(&bins, w, bin, &rng, records[part] / 2, words[part]);
          vxm_crossing_bin_begin(&bins, w, bin, part); /* the same part goes on */
          put_some(&bins, w, bin, &rng, records[part] - records[part] / 2, words[part]);
        }
        check_bin(&bins, bin, began, words, records);
      }
    assert_int_equal(vxm_crossing_bins_check(&bins, NULL), VXM_OK);
  }
  vxm_crossing_bins_destroy(&bins);
}

/** When memory runs out records are dropped, the failure is told, and the bins can be used again. */
static void test_bins_survive_a_lack_of_memory(void **state) {
  (void)state;
  vxm_rng rng = {22};
  vxm_context *own = context_of(1, 0);
  vxm_crossing_bins bins = {.context = own};
  uint64_t words[SLAB_WORDS_MAX] = {0};
  for (size_t left = 0; left < 6000; left += 64) { /* the small blocks, one after another */
    leave_memory(own, left);
    vxm_error error = VXM_ERROR_INIT;
    vxm_status status = vxm_crossing_bins_reset(&bins, 7, 2, 1, 50, &error);
    assert_true(status == VXM_OK || (status == VXM_ERROR_MEMORY_LIMIT && error.code == status));
    if (status == VXM_OK) {
      vxm_crossing_bin *bin = vxm_crossing_bins_at(&bins, 6, 1, 0);
      vxm_crossing_bin_begin(&bins, 6, bin, 3);
      put_some(&bins, 6, bin, &rng, 300, words);
      assert_int_equal(vxm_crossing_bins_check(&bins, &error), VXM_ERROR_MEMORY_LIMIT);
    }
  }
  for (size_t left = 0; left < 600000; left += 7000) {
    leave_memory(own, left);
    memset(words, 0, sizeof words);
    assert_int_equal(vxm_crossing_bins_reset(&bins, 7, 2, 1, 50, NULL), VXM_OK);
    size_t records[PARTS] = {0};
    bool began[PARTS] = {false};
    uint64_t put[PARTS][SLAB_WORDS_MAX] = {{0}};
    vxm_crossing_bin *bin = vxm_crossing_bins_at(&bins, 0, 0, 0);
    for (uint32_t part = 0; part < PARTS; part++) {
      began[part] = true;
      records[part] = 2000;
      vxm_crossing_bin_begin(&bins, 0, bin, part);
      put_some(&bins, 0, bin, &rng, records[part], put[part]);
    }
    if (vxm_crossing_bins_check(&bins, NULL) == VXM_OK)
      check_bin(&bins, bin, began, put, records);
  }
  vxm_crossing_bins_destroy(&bins);
  assert_int_equal(memory_used(own), 0);
  vxm_context_destroy(own);
}

/* ---- Solids with very many flips, or few ---- */

/** A part of `count` triangles through shared vertices: each covers much of the grid. */
static size_t huge_part(vxm_soup *soup, vxm_rng *rng, const vxm_space *space, int count) {
  double low[3], high[3];
  for (int a = 0; a < 3; a++) {
    low[a] = -0.5 * (double)space->dims[a];
    high[a] = 1.5 * (double)space->dims[a];
  }
  uint32_t first = random_vertex(soup, rng, low, high);
  for (int i = 0; i < count; i++) {
    uint32_t a = random_vertex(soup, rng, low, high), b = random_vertex(soup, rng, low, high);
    shape_triangle(soup, first, a, b);
  }
  return soup->face_count;
}

/** All parts of a soup, ending at part_end[], as their union, along all axes, in any number of threads. */
static void check_parts(uint64_t seed, const vxm_space *space, int parts, int most, bool whole) {
  size_t count = (size_t)(space->dims[0] * space->dims[1] * space->dims[2]), part_end[64];
  uint8_t *want[3];
  for (int threads = 1; threads <= 3; threads++) {
    vxm_context *own = context_of(threads, 0);
    vxm_soup *soup = shape_empty(own);
    vxm_rng rng = {seed};
    for (int p = 0; p < parts; p++)
      part_end[p] = huge_part(soup, &rng, space, 1 + (int)vxm_rng_below(&rng, (uint64_t)most));
    for (int w = 0; w < 3; w++) {
      if (threads == 1) {
        want[w] = calloc(count, 1);
        assert_non_null(want[w]);
        for (int p = 0; !whole && p < parts; p++)
          exact_unite(want[w], soup, p > 0 ? part_end[p - 1] : 0, part_end[p], space, w);
        if (whole)
          exact_unite(want[w], soup, 0, soup->face_count, space, w);
      }
      vxm_grid *grid = engine_method(soup, space, (vxm_method)(VXM_METHOD_X + w),
                                     whole ? VXM_SPLIT_MODE_WHOLE : VXM_SPLIT_MODE_GROUP, NULL);
      assert_grid_is(grid, want[w]);
      vxm_grid_destroy(grid);
    }
    vxm_soup_destroy(soup);
    vxm_context_destroy(own);
  }
  for (int w = 0; w < 3; w++)
    free(want[w]);
}

/** A part flips more often than a slab has words, also in the last slab, which is not full. */
static void test_bins_that_become_bitmaps(void **state) {
  (void)state;
  static const int64_t dims[][3] = {{7, 65, 37}, {64, 19, 33}, {3, 129, 9}, {130, 40, 5}, {5, 5, 257}};
  for (int d = 0; d < 5; d++) {
    vxm_space space = engine_space(dims[d][0], dims[d][1], dims[d][2]);
    check_parts(400 + (uint64_t)d, &space, 1, 60, true);
    check_parts(500 + (uint64_t)d, &space, 1, 120, false);
    check_parts(600 + (uint64_t)d, &space, 6, 50, false);
  }
}

/** The same with votes, which flip four voters at once and carry along slices. */
static void test_bitmaps_of_votes(void **state) {
  (void)state;
  static const int64_t dims[][3] = {{7, 65, 37}, {64, 19, 33}, {130, 40, 5}};
  for (int d = 0; d < 3; d++) {
    vxm_space space = engine_space(dims[d][0], dims[d][1], dims[d][2]);
    size_t count = (size_t)(dims[d][0] * dims[d][1] * dims[d][2]);
    for (int threads = 1; threads <= 3; threads++) {
      vxm_context *own = context_of(threads, 0);
      vxm_soup *soup = shape_empty(own);
      vxm_rng rng = {700 + (uint64_t)d};
      huge_part(soup, &rng, &space, 90);
      uint8_t *sum = calloc(count, 1), *axis = malloc(count);
      assert_true(sum && axis);
      for (int w = 0; w < 3; w++) {
        memset(axis, 0, count);
        exact_unite(axis, soup, 0, soup->face_count, &space, w);
        for (size_t i = 0; i < count; i++)
          sum[i] = (uint8_t)(sum[i] + axis[i]);
      }
      for (size_t i = 0; i < count; i++)
        sum[i] = sum[i] >= 2;
      vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
      options.vote = VXM_VOTE_MAJORITY;
      vxm_grid *grid = engine_solid(soup, &space, &options, NULL);
      assert_grid_is(grid, sum);
      vxm_grid_destroy(grid);
      free(sum);
      free(axis);
      vxm_soup_destroy(soup);
      vxm_context_destroy(own);
    }
  }
}

/** Parts of 1 to 130 flips in a slab: those of up to 64 are sorted, those above folded. */
static void test_parts_of_few_flips(void **state) {
  (void)state;
  vxm_space space = engine_space(70, 11, 13);
  for (uint64_t seed = 0; seed < 12; seed++)
    check_parts(800 + seed, &space, 30, 1, false);
  /* Boxes that flip 2 n columns in one slab, n = 28 to 37 about the limit, along all axes. */
  for (int n = 28; n < 38; n++)
    for (int axis = 0; axis < 3; axis++) {
      vxm_soup *soup = shape_empty(context);
      double low[3] = {1, 1, 1}, high[3] = {2, 2, 2};
      high[axis] = 1 + n;
      triangle_box(soup, low, high, 0, false);
      low[axis] += 0.5; /* another part over it, so that none is made in place */
      triangle_box(soup, low, high, 0, false);
      vxm_space long_space = engine_space(40, 40, 40);
      for (int method = VXM_METHOD_X; method <= VXM_METHOD_Z; method++) {
        vxm_grid *grid = engine_method(soup, &long_space, (vxm_method)method, VXM_SPLIT_MODE_GROUP, NULL);
        assert_int_equal(vxm_grid_count(grid), n);
        vxm_grid_destroy(grid);
      }
      vxm_soup_destroy(soup);
    }
}

/* ---- Rounds ---- */

/** How many rounds a union takes under a limit. */
static size_t rounds_of(const vxm_soup *soup, const vxm_space *space) {
  vxm_triangle_set triangles;
  vxm_split_rule rule = {VXM_SPLIT_MODE_GROUP, VXM_CAVITIES_AUTO, false};
  assert_int_equal(vxm_triangle_set_create(&triangles, soup, rule, NULL), VXM_OK);
  vxm_lattice lattice = vxm_lattice_of(space);
  vxm_snapped_points placed = {.context = soup->context};
  assert_int_equal(vxm_snapped_points_set(&placed, &triangles, &lattice, NULL, false, NULL), VXM_OK);
  vxm_window window = vxm_window_of(space, (vxm_layout)VXM_LAYOUT_GRID, 0, space->dims[2]);
  vxm_columns columns = vxm_columns_of(&window, 0);
  columns.triangle_end = triangles.triangle_count;
  vxm_raster_schedule crossings = {.context = soup->context};
  assert_int_equal(vxm_raster_schedule_plan(&crossings, &triangles, &placed, &columns, 1, NULL), VXM_OK);
  size_t rounds = crossings.round_count, at = 0;
  /* The ranges are all triangles in order, and rounds end between parts. */
  for (size_t r = 0; r < crossings.range_count; r++) {
    assert_int_equal(crossings.ranges[r].begin, at);
    at = crossings.ranges[r].end;
  }
  assert_int_equal(at, triangles.triangle_count);
  for (size_t r = 0; r + 1 < rounds; r++) {
    size_t next = crossings.ranges[crossings.round_end[r]].begin;
    assert_true(triangles.part[next] != triangles.part[next - 1]);
  }
  assert_int_equal(crossings.round_end[rounds - 1], crossings.range_count);
  vxm_raster_schedule_destroy(&crossings);
  vxm_snapped_points_destroy(&placed);
  vxm_triangle_set_destroy(&triangles);
  return rounds;
}

/** Many parts of many crossings: with little memory they are united in rounds, to the same bits. */
static void test_rounds_give_the_same(void **state) {
  (void)state;
  vxm_space space = engine_space(150, 140, 130);
  uint64_t hash[3] = {0};
  size_t rounds[3] = {0};
  for (int pass = 0; pass < 4; pass++) {
    vxm_context *own = context_of(pass % 2 ? 3 : 1, pass < 2 ? 0 : UINT64_C(6) << 20);
    vxm_soup *soup = shape_empty(own);
    vxm_rng rng = {900};
    for (int i = 0; i < 24; i++)
      huge_part(soup, &rng, &space, 2);
    rounds[pass / 2] = rounds_of(soup, &space);
    for (int w = 0; w < 3; w++) {
      vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
      vxm_grid *grid =
          engine_method(soup, &space, (vxm_method)(VXM_METHOD_X + w), VXM_SPLIT_MODE_GROUP, &report);
      assert_true(pass == 0 || hash[w] == report.hash);
      assert_int_equal(report.parts, 24);
      hash[w] = report.hash;
      vxm_grid_destroy(grid);
    }
    vxm_soup_destroy(soup);
    vxm_context_destroy(own);
  }
  assert_int_equal(rounds[0], 1);
  assert_true(rounds[1] > 2);
}

/** The bound on crossings holds: of any soup, in any grid, along any axis, with cones and without; turned,
 * and moved and displaced. */
static void test_crossings_stay_below_their_bound(void **state) {
  (void)state;
  for (int round = 0; round < 60; round++) {
    vxm_space space = engine_space(20 + round, 33, 5 + round / 2);
    space.voxel_size[round % 3] = 0.6;
    vxm_soup *soup = random_soup(context, (uint64_t)round, round % SOUP_KINDS, &space);
    vxm_triangle_set triangles;
    vxm_split_rule rule = {VXM_SPLIT_MODE_GROUP, VXM_CAVITIES_AUTO, round % 2 != 0};
    assert_int_equal(vxm_triangle_set_create(&triangles, soup, rule, NULL), VXM_OK);
    double transform[12] = {0.7, -0.8, 0, 1, 0.9, 0.6, 0.1, 0, 0, -0.2, 1.3, 2};
    vxm_lattice lattice = vxm_lattice_of(&space);
    vxm_snapped_points placed = {.context = context};
    const double turned[12] = {0, -1, 0, 33, 1, 0, 0, 0, 0, 0, 1, 0};
    const double *matrix = (const double *[]){NULL, transform, turned}[round % 3];
    float noise[7][4];
    uint32_t *entry = calloc(triangles.first_apex, sizeof *entry);
    assert_non_null(entry);
    vxm_rng rng = {(uint64_t)round};
    for (int i = 0; i < 28; i++)
      noise[i / 4][i % 4] = i % 4 < 3 ? (float)vxm_rng_below(&rng, 3) - 1 : 0;
    for (size_t p = 0; p < triangles.first_apex; p++)
      entry[p] = (uint32_t)vxm_rng_below(&rng, 7);
    vxm_vertex_transform motion = {.from = (const double(*)[3])triangles.positions,
                                   .count = triangles.first_apex,
                                   .matrix = turned,
                                   .entry = entry,
                                   .noise = (const float(*)[4])noise,
                                   .noise_size = 7,
                                   .stretch = 1,
                                   .reach = 2 * sqrt(3.0)};
    if (round % 4 == 3)
      assert_int_equal(vxm_snapped_points_move(&placed, &triangles, &lattice, &motion, true, NULL), VXM_OK);
    else
      assert_int_equal(vxm_snapped_points_set(&placed, &triangles, &lattice, matrix, true, NULL), VXM_OK);
    free(entry);
    vxm_window window = vxm_window_of(&space, (vxm_layout)VXM_LAYOUT_GRID, 0, space.dims[2]);
    for (int axis = 0; axis < 3; axis++) {
      vxm_columns columns = vxm_columns_of(&window, axis);
      columns.roles = VXM_ROLE_FACE | VXM_ROLE_CAP | ((axis + round) % 2 ? VXM_ROLE_CONE : 0);
      columns.triangle_end = triangles.triangle_count;
      columns.slab_shift = 20;
      double bound = vxm_raster_schedule_placed_bound(&placed, columns.roles);
      vxm_crossing_bins bins = {.context = context};
      size_t words = window.slice_words * (size_t)space.dims[2] + (64 << 20);
      assert_int_equal(vxm_crossing_bins_reset(&bins, 1, 1, 1, words, NULL), VXM_OK);
      vxm_raster_task task = {.placed = &placed,
                              .triangles = &triangles,
                              .end = triangles.triangle_count,
                              .columns = &columns,
                              .columns_count = 1,
                              .bins = &bins};
      vxm_kernels_get()->raster(&task);
      vxm_crossing_bin_reader reader = vxm_crossing_bin_read(vxm_crossing_bins_at(&bins, 0, 0, 0), false);
      vxm_crossing_bin_piece piece;
      size_t crossings = 0;
      while (reader.part != VXM_BIN_NONE)
        while (vxm_crossing_bin_next(&reader, &piece))
          crossings += piece.count;
      assert_true((double)crossings <= bound);
      vxm_crossing_bins_destroy(&bins);
    }
    vxm_snapped_points_destroy(&placed);
    vxm_triangle_set_destroy(&triangles);
    vxm_soup_destroy(soup);
  }
}

/** Puts what triangles flip into words, straight or by way of bins. */
static uint64_t *flipped(const vxm_snapped_points *placed, const vxm_triangle_set *triangles,
                         const vxm_columns *columns, size_t words, bool straight) {
  uint64_t *out = calloc(words, sizeof *out);
  assert_non_null(out);
  vxm_crossing_bins bins = {.context = context};
  assert_int_equal(vxm_crossing_bins_reset(&bins, 1, 1, 1, words, NULL), VXM_OK);
  vxm_raster_task task = {.placed = placed,
                          .triangles = triangles,
                          .end = triangles->triangle_count,
                          .columns = columns,
                          .columns_count = 1,
                          .bins = straight ? NULL : &bins,
                          .words = straight ? out : NULL};
  vxm_kernels_get()->raster(&task);
  vxm_crossing_bin_piece piece;
  for (vxm_crossing_bin_reader r = vxm_crossing_bin_read(vxm_crossing_bins_at(&bins, 0, 0, 0), false);
       r.part != VXM_BIN_NONE;)
    while (vxm_crossing_bin_next(&r, &piece))
      for (size_t i = 0; i < piece.count; i++)
        if (piece.is_bitmap)
          out[i] ^= piece.data[i];
        else
          out[piece.data[i] / 64] ^= UINT64_C(1) << (piece.data[i] % 64);
  vxm_crossing_bins_destroy(&bins);
  return out;
}

/** Every build flips words as it fills bins: small triangles and those of many tiles, narrow, far and wide,
 * in windows along two axes. */
static void test_words_get_what_bins_get(void **state) {
  (void)state;
  const vxm_kernels *builds[3];
  size_t count = vxm_kernels_all(builds);
  for (int round = 0; round < 48; round++) {
    vxm_space space = engine_space(9 + 2 * round, 8 + round, 12 + 3 * (round % 24));
    vxm_rng rng = {(uint64_t)round};
    vxm_soup *soup = shape_empty(context);
    for (int i = 0; i < 40; i++) {
      int low = (int)vxm_rng_below(&rng, 200) - 30, side = i % 4 ? 3 + (int)vxm_rng_below(&rng, 60) : 700;
      shape_random_octahedron(soup, &rng, i % 4 ? low : -300, i % 4 ? low + side : 400);
    }
    if (round % 8 == 7) /* coordinates of 64 bits */
      shape_random_octahedron(soup, &rng, -40000000, 40000000);
    vxm_triangle_set triangles;
    assert_int_equal(
        vxm_triangle_set_create(&triangles, soup, (vxm_split_rule){.split_mode = VXM_SPLIT_MODE_WHOLE}, NULL),
        VXM_OK);
    vxm_lattice lattice = vxm_lattice_of(&space);
    vxm_snapped_points placed = {.context = context};
    assert_int_equal(vxm_snapped_points_set(&placed, &triangles, &lattice, NULL, false, NULL), VXM_OK);
    vxm_window window =
        vxm_window_of(&space, (vxm_layout)VXM_LAYOUT_GRID, round % 3, space.dims[2] - round % 5);
    size_t words = window.slice_words * (size_t)(window.end - window.begin);
    for (int axis = 0; axis < 2; axis++) { /* those with slabs along v */
      vxm_columns columns = vxm_columns_of(&window, axis);
      columns.roles = VXM_ROLE_FACE | VXM_ROLES_ALL;
      columns.triangle_end = triangles.triangle_count;
      columns.slab_shift = 62;
      columns.keep_before = round % 2 == 0;
      for (size_t b = 0; b < count; b++) {
        vxm_kernels_force(builds[b]);
        uint64_t *expected = flipped(&placed, &triangles, &columns, words, false);
        uint64_t *found = flipped(&placed, &triangles, &columns, words, true);
        assert_memory_equal(expected, found, words * sizeof *found);
        free(expected);
        free(found);
      }
      vxm_kernels_force(NULL);
    }
    vxm_snapped_points_destroy(&placed);
    vxm_triangle_set_destroy(&triangles);
    vxm_soup_destroy(soup);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_bins_give_back_what_was_put),
      cmocka_unit_test(test_bins_survive_a_lack_of_memory),
      cmocka_unit_test(test_bins_that_become_bitmaps),
      cmocka_unit_test(test_bitmaps_of_votes),
      cmocka_unit_test(test_parts_of_few_flips),
      cmocka_unit_test(test_rounds_give_the_same),
      cmocka_unit_test(test_crossings_stay_below_their_bound),
      cmocka_unit_test(test_words_get_what_bins_get),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}

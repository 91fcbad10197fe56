/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * .vdb files: what is written comes back, in whatever pieces it is written, under limits and with failures;
 * and damaged files are refused. With files as arguments only these are damaged and read.
 */
#include "grids.h"

#include "gridio/common/format.h"
#include "gridio/formats/vdb/vdb.h"
#include "gridio/formats/vdb/vdb_field.h"
#include "gridio/sparse_write.h"

#include <ctype.h>
#include <math.h>

static bool same_files(const char *a, const char *b) {
  size_t sizes[2];
  unsigned char *data[2] = {load_file(a, &sizes[0]), load_file(b, &sizes[1])};
  bool same = sizes[0] == sizes[1] && memcmp(data[0], data[1], sizes[0]) == 0;
  free(data[0]);
  free(data[1]);
  return same;
}

#if defined(__SANITIZE_ADDRESS__)
enum { SANITIZED = 1 };
#else
enum { SANITIZED = 0 };
#endif

/* ---- What is written comes back ---- */

static void write_pieces(const vxm_grid *grid, const char *path, vxm_rng *rng) {
  vxm_grid_writer *slices;
  assert_int_equal(vxm_grid_writer_open(&slices, grid->context, &grid->space, path, NULL, NULL), VXM_OK);
  int64_t all = grid->space.dims[2];
  for (int64_t at = 0, next; at < all; at = next) {
    next = at + 1 + (int64_t)vxm_rng_below(rng, (uint64_t)(vxm_min(all - at, 20)));
    vxm_window window = vxm_window_of_grid(grid);
    window.words = vxm_grid_row(grid, 0, at);
    window.begin = at;
    window.end = next;
    assert_int_equal(vxm_grid_writer_put(slices, &window, NULL), VXM_OK);
  }
  assert_int_equal(vxm_grid_writer_commit(slices, NULL), VXM_OK);
}

/** Grids, pieces of them and octrees make the same bytes, which are the grid again. */
static void test_round_trips(void **state) {
  (void)state;
  char folder[64], whole[80], pieces[80], octree[80];
  make_folder(folder);
  snprintf(whole, sizeof whole, "%s/whole.vdb", folder);
  snprintf(pieces, sizeof pieces, "%s/pieces.vdb", folder);
  snprintf(octree, sizeof octree, "%s/octree.vdb", folder);
  vxm_rng rng = {71};
  for (int round = 0; round < 36; round++) {
    vxm_context *context = context_with(1 + round % 3, 0, NULL, NULL);
    vxm_grid *grid = new_grid(context, random_space(&rng, round % 5 ? 75 : 140, round % 2));
    fill_random(grid, &rng, round % KINDS);
    write_grid(grid, whole);
    write_pieces(grid, pieces, &rng);
    assert_true(same_files(whole, pieces));
    vxm_sparse *sparse;
    assert_int_equal(vxm_sparse_from_grid(&sparse, grid, NULL), VXM_OK);
    assert_int_equal(vxm_gridio_write_sparse(sparse, octree, NULL, NULL), VXM_OK);
    assert_true(same_files(whole, octree));
    vxm_sparse_destroy(sparse);
    assert_reads_back(grid, whole);
    vxm_grid_destroy(grid);
    vxm_context_destroy(context);
  }
  remove_folder(folder);
}

/** Tiles of 128 voxels, and blocks cut at the ends, in long grids; nothing set at all. */
static void test_large(void **state) {
  (void)state;
  static const int64_t dims[][3] = {{300, 290, 280}, {4200, 20, 20}, {7, 9000, 9}, {128, 128, 256}};
  char folder[64];
  make_folder(folder);
  for (int d = 0; d < 4; d++)
    for (int kind = 0; kind < 3; kind++) {
      vxm_context *context = context_with(2, 0, NULL, NULL);
      vxm_grid *grid = new_grid(context, unit_space(dims[d][0], dims[d][1], dims[d][2]));
      for (int64_t k = 0; k < dims[d][2] && kind > 0; k++)
        for (int64_t j = 0; j < dims[d][1]; j++)
          vxm_row_set_span(vxm_grid_row(grid, j, k), 0, dims[d][0] - (kind == 2 && k == 3 && j == 4));
      write_grid(grid, path_in(folder, "a.vdb"));
      vxm_sparse *sparse;
      assert_int_equal(vxm_sparse_from_grid(&sparse, grid, NULL), VXM_OK);
      assert_int_equal(vxm_gridio_write_sparse(sparse, path_in(folder, "b.vdb"), NULL, NULL), VXM_OK);
      assert_true(same_files(path_in(folder, "a.vdb"), path_in(folder, "b.vdb")));
      assert_reads_back(grid, path_in(folder, "a.vdb"));
      vxm_sparse_destroy(sparse);
      vxm_grid_destroy(grid);
      vxm_context_destroy(context);
    }
  remove_folder(folder);
}

static void test_transforms(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_rng rng = {72};
  for (int round = 0; round < 24; round++) {
    vxm_space space = unit_space(3, 2, 1);
    for (int a = 0; a < 3; a++) {
      space.origin[a] = ldexp(vxm_rng_unit(&rng) - 0.5, (int)vxm_rng_below(&rng, 60) - 30);
      space.voxel_size[a] = a > 0 && round % 2
                                ? space.voxel_size[0]
                                : ldexp(vxm_rng_unit(&rng) + 0.5, (int)vxm_rng_below(&rng, 40) - 14);
    }
    vxm_grid *grid = new_grid(context, space);
    write_grid(grid, path_in(folder, "a.vdb"));
    assert_reads_back(grid, path_in(folder, "a.vdb"));
    vxm_grid_destroy(grid);
  }
  /* Too small, and too far from 0, for OpenVDB. */
  static const vxm_space others[] = {{{3, 3, 3}, {0, 0, 0}, {1e-5, 1e-5, 1e-5}},
                                     {{3, 3, 3}, {1e20, 0, 0}, {1e-3, 1e-3, 1e-3}}};
  empty_folder(folder);
  for (int o = 0; o < 2; o++) {
    vxm_grid *grid = new_grid(context, others[o]);
    vxm_error error = VXM_ERROR_INIT;
    assert_int_equal(vxm_gridio_write(grid, path_in(folder, "a.vdb"), NULL, &error), VXM_ERROR_RANGE);
    assert_non_null(strstr(error.text, "OpenVDB cannot hold voxels of"));
    assert_int_equal(count_files(folder), 0);
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/** The identifier follows the content: the same twice, another for each other grid. */
static void test_identifier(void **state) {
  (void)state;
  enum { GRIDS = 6, BEGIN = 21, LENGTH = 36 };
  char folder[64], seen[GRIDS][LENGTH + 1];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  for (int g = 0; g < GRIDS; g++) {
    vxm_space space = unit_space(g == 1 ? 65 : 64, 64, 64);
    space.origin[1] = g == 2;
    vxm_grid *grid = new_grid(context, space);
    for (int64_t x = 0; x < 8; x++)
      for (int64_t z = 0; z < 64; z++) /* whole blocks, so that there is not one leaf */
        vxm_grid_row(grid, 8 * (g == 3) + x, z)[0] = g == 4 ? 0xff00 : 0xff;
    vxm_grid_set(grid, 40, 40, 40, g == 5);
    for (int twice = 0; twice < 2; twice++) {
      write_grid(grid, path_in(folder, "a.vdb"));
      size_t size;
      unsigned char *data = load_file(path_in(folder, "a.vdb"), &size);
      char id[LENGTH + 1] = {0};
      memcpy(id, data + BEGIN, LENGTH);
      free(data);
      if (twice)
        assert_string_equal(id, seen[g]);
      memcpy(seen[g], id, sizeof id);
    }
    for (int i = 0; i < LENGTH; i++)
      assert_true(i == 8 || i == 13 || i == 18 || i == 23 ? seen[g][i] == '-' : isxdigit(seen[g][i]));
    assert_true(seen[g][14] == '8' && strchr("89ab", seen[g][19]));
    for (int before = 0; before < g; before++)
      assert_string_not_equal(seen[g], seen[before]);
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/* ---- Numbers ---- */

static float value_of(const vxm_vdb_kind *kind, int64_t i, int64_t j, int64_t k) {
  double r = sqrt((double)((i - 20) * (i - 20) + (j - 63) * (j - 63) + (k - 65) * (k - 65))) - 61.3;
  if (kind->content == VXM_VDB_FOG)
    return (float)fmin(1, fmax(0, -r / 3));
  return (float)fmin(2, fmax(-2, r));
}

/** Puts tiles of z fastest values, of some all alike without these, and none that is only background. */
static void put_tiles(vxm_vdb_field *field, const float *values, const int64_t n[3], float background) {
  for (int64_t x = 0; x < n[0]; x += VXM_VALUE_TILE)
    for (int64_t y = 0; y < n[1]; y += VXM_VALUE_TILE)
      for (int64_t z = 0; z < n[2]; z += VXM_VALUE_TILE) {
        const int64_t first[3] = {z, y, x}, dims[3] = {n[2], n[1], n[0]};
        vxm_value_tile tile = {.values = values + (x * n[1] + y) * n[2] + z,
                               .row = (size_t)n[2],
                               .slice = (size_t)(n[1] * n[2])};
        bool is_even = true;
        tile.value = tile.values[0];
        for (int a = 0; a < 3; a++) {
          tile.first[a] = first[a];
          tile.count[a] = (int)vxm_min(dims[a] - first[a], VXM_VALUE_TILE);
        }
        for (int64_t i = 0; i < tile.count[2]; i++)
          for (int64_t j = 0; j < tile.count[1]; j++)
            for (int64_t k = 0; k < tile.count[0]; k++)
              is_even = is_even && tile.values[(i * n[1] + j) * n[2] + k] == tile.value;
        if (is_even)
          tile.values = NULL;
        if (!is_even || tile.value != background)
          assert_int_equal(vxm_vdb_field_put_tile(field, &tile, NULL), VXM_OK);
      }
}

/** Numbers come back as they are, and are never taken for bits; slices come in any number, or as tiles. */
static void test_fields(void **state) {
  (void)state;
  static const vxm_vdb_kind kinds[] = {{VXM_VDB_LEVEL_SET, "distance", 2, NULL},
                                       {VXM_VDB_FOG, "coverage", 0, NULL}};
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(2, 0, NULL, NULL);
  vxm_rng rng = {73};
  vxm_space space = {{41, 127, 135}, {1, 2, 3}, {0.5, 0.25, 1}};
  const int64_t *n = space.dims;
  for (int kind = 0; kind < 2; kind++) {
    vxm_vdb_field *field;
    float *values = malloc((size_t)(n[0] * n[1] * n[2]) * sizeof *values);
    for (int64_t v = 0; v < n[0] * n[1] * n[2]; v++)
      values[v] = value_of(&kinds[kind], v / (n[1] * n[2]), v / n[2] % n[1], v % n[2]);
    for (int round = 0; round < 2; round++) {
      assert_int_equal(vxm_vdb_field_create(&field, context, &space, &kinds[kind], NULL), VXM_OK);
      if (round == 0)
        put_tiles(field, values, n, kinds[kind].background);
      for (int64_t at = 0, next; at < n[0] && round > 0; at = next) {
        next = at + 1 + (int64_t)vxm_rng_below(&rng, (uint64_t)(n[0] - at));
        assert_int_equal(vxm_vdb_field_put(field, values + at * n[1] * n[2], at, next, NULL), VXM_OK);
      }
      vxm_output *output;
      assert_int_equal(vxm_output_open(&output, context, path_in(folder, round ? "b.vdb" : "a.vdb"), NULL),
                       VXM_OK);
      assert_int_equal(vxm_vdb_field_write(field, output, NULL), VXM_OK);
      assert_int_equal(vxm_output_commit(output, NULL), VXM_OK);
      vxm_vdb_field_destroy(field);
    }
    assert_true(same_files(path_in(folder, "a.vdb"), path_in(folder, "b.vdb")));
    vxm_grid *grid = NULL;
    vxm_field *back = NULL;
    assert_int_equal(vxm_gridio_read(&grid, context, path_in(folder, "a.vdb"), NULL), VXM_ERROR_NUMBERS);
    assert_int_equal(vxm_gridio_read_either(&grid, &back, context, path_in(folder, "a.vdb"), NULL), VXM_OK);
    assert_true(grid == NULL && back->scalar == VXM_FLOAT32);
    assert_int_equal(back->about.kind, kind == 0 ? VXM_FIELD_DISTANCE : VXM_FIELD_COVERAGE);
    assert_memory_equal(&back->space, &space, sizeof space);
    assert_memory_equal(back->values, values, (size_t)(n[0] * n[1] * n[2]) * sizeof *values);
    vxm_field_destroy(back);
    free(values);
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/** -0 is another number than 0, alone, in whole blocks and in all of the grid. */
static void test_signs_of_zero(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(2, 0, NULL, NULL);
  vxm_rng rng = {75};
  const vxm_space space = {{17, 40, 133}, {1, 2, 3}, {0.5, 0.25, 1}};
  for (int round = 0; round < 4; round++) {
    vxm_field *field, *back = NULL;
    vxm_grid *grid = NULL;
    assert_int_equal(vxm_field_make(&field, context, &space, VXM_FIELD_NUMBERS, VXM_FLOAT32, NULL), VXM_OK);
    float *values = (float *)field->values;
    size_t plane = 40 * 133;
    for (size_t v = 0; v < 17 * plane; v++)
      values[v] = round == 0 || v < 8 * plane ? -0.0F : vxm_rng_below(&rng, 2) ? -0.0F : (float)(round - 2);
    assert_int_equal(vxm_gridio_write_field(field, path_in(folder, "a.vdb"), NULL, NULL), VXM_OK);
    assert_int_equal(vxm_gridio_read_either(&grid, &back, context, path_in(folder, "a.vdb"), NULL), VXM_OK);
    assert_non_null(back);
    assert_memory_equal(back->values, field->values, 17 * plane * sizeof *values);
    assert_false(back->about.is_declared);
    vxm_field_destroy(back);
    vxm_field_destroy(field);
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/* ---- Limits and failures ---- */

/** From too little to enough: the limit's own error and no file; and all is given back. */
static void test_memory_limit(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {74};
  for (int kind = 0; kind < 4; kind++) {
    int too_little = 0;
    for (uint64_t limit = 300 << 10, ok = 0; !ok; limit += 50 << 10) {
      vxm_context *context = context_with(2, limit, NULL, NULL);
      vxm_grid *grid = new_grid(context, unit_space(100, 90, 130));
      fill_random(grid, &rng, kind);
      size_t left = vxm_memory_left(context);
      vxm_error error = VXM_ERROR_INIT;
      vxm_status status = vxm_gridio_write(grid, path_in(folder, "a.vdb"), NULL, &error);
      ok = status == VXM_OK;
      too_little += !ok;
      assert_true(ok || (status == VXM_ERROR_MEMORY_LIMIT && error.code == status));
      assert_int_equal(count_files(folder), (int)ok);
      assert_int_equal(vxm_memory_left(context), left);
      assert_true(vxm_context_peak_bytes(context) <= limit);
      vxm_grid_destroy(grid);
      vxm_context_destroy(context);
    }
    assert_true(too_little > 5);
    empty_folder(folder);
  }
  remove_folder(folder);
}

/** The plan is about right for a body: not less than it takes, and not far more. */
static void test_plan(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_space space = unit_space(300, 300, 300);
  vxm_grid_writer_plan plan;
  assert_int_equal(vxm_grid_writer_plan_of(&plan, &space, path_in(folder, "a.vdb"), NULL, NULL), VXM_OK);
  assert_true(plan.streams && plan.layout.fast == 0 && plan.layout.slow == 2 && plan.gather_bytes == 0);
  vxm_grid *grid = new_grid(context, space);
  for (int64_t k = 0; k < 300; k++)
    for (int64_t j = 0; j < 300; j++) {
      double rest = 149.0 * 149 - (double)((k - 150) * (k - 150) + (j - 150) * (j - 150));
      if (rest > 0)
        vxm_row_set_span(vxm_grid_row(grid, j, k), 150 - (int64_t)sqrt(rest), 150 + (int64_t)sqrt(rest));
    }
  size_t used = (size_t)vxm_context_peak_bytes(context);
  write_grid(grid, path_in(folder, "a.vdb"));
  size_t taken = (size_t)vxm_context_peak_bytes(context) - used;
  assert_true(taken <= plan.bytes && plan.bytes < 3 * taken);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  remove_folder(folder);
}

/** The same for reading, which takes half of what is left there. */
static void test_reading_limit(void **state) {
  (void)state;
  if (SANITIZED) /* which ends a process that lacks memory */
    skip();
  char folder[64];
  make_folder(folder);
  vxm_context *free_context = context_with(1, 0, NULL, NULL);
  vxm_rng rng = {79};
  vxm_grid *grid = new_grid(free_context, unit_space(300, 290, 280));
  fill_random(grid, &rng, 3);
  write_grid(grid, path_in(folder, "a.vdb"));
  int too_little = 0;
  for (uint64_t limit = 1 << 20, ok = 0; !ok; limit *= 2) {
    vxm_context *context = context_with(1, limit, NULL, NULL);
    vxm_error error = VXM_ERROR_INIT;
    vxm_grid *back = NULL;
    vxm_status status = vxm_gridio_read(&back, context, path_in(folder, "a.vdb"), &error);
    ok = status == VXM_OK;
    too_little += !ok;
    assert_true(ok || (status == VXM_ERROR_MEMORY_LIMIT && error.code == status));
    assert_true(vxm_context_peak_bytes(context) <= limit && limit < UINT64_C(1) << 30);
    if (ok)
      assert_same_bits(grid, back);
    vxm_grid_destroy(back);
    vxm_context_destroy(context);
  }
  assert_true(too_little > 2);
  vxm_grid_destroy(grid);
  vxm_context_destroy(free_context);
  remove_folder(folder);
}

static int stop_later(const char *phase, double fraction, void *payload) {
  (void)phase;
  assert_true(fraction >= 0 && fraction <= 1);
  return --*(int *)payload < 0;
}

static void test_cancel(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {75};
  int calls = 1 << 30;
  vxm_context *context = context_with(2, 0, stop_later, &calls);
  vxm_grid *grid = new_grid(context, unit_space(240, 230, 250));
  fill_random(grid, &rng, 3);
  vxm_sparse *sparse;
  assert_int_equal(vxm_sparse_from_grid(&sparse, grid, NULL), VXM_OK);
  size_t peak = (size_t)vxm_memory_left(context);
  for (int kind = 0; kind < 3; kind++) {
    int stop = 0;
    for (;; stop += 1 + stop / 4) {
      calls = stop;
      vxm_error error = VXM_ERROR_INIT;
      vxm_grid *back = NULL;
      vxm_status status = kind == 0 ? vxm_gridio_write(grid, path_in(folder, "a.vdb"), NULL, &error)
                          : kind == 1
                              ? vxm_gridio_write_sparse(sparse, path_in(folder, "a.vdb"), NULL, &error)
                              : vxm_gridio_read(&back, context, path_in(folder, "a.vdb"), &error);
      vxm_grid_destroy(back);
      if (status == VXM_OK)
        break;
      assert_int_equal(status, VXM_ERROR_CANCELLED);
      assert_int_equal(error.code, VXM_ERROR_CANCELLED);
      assert_int_equal(count_files(folder), kind == 2);
      assert_int_equal(vxm_memory_left(context), peak);
    }
    assert_true(stop > (kind == 2 ? 0 : 2));
    if (kind < 1)
      empty_folder(folder);
  }
  vxm_sparse_destroy(sparse);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  remove_folder(folder);
}

static void test_full_disk(void **state) {
  (void)state;
  if (access("/dev/full", W_OK) != 0)
    skip();
  vxm_context *context = context_with(2, 0, NULL, NULL);
  vxm_rng rng = {76};
  vxm_grid *grid = new_grid(context, unit_space(200, 200, 200));
  fill_random(grid, &rng, 0);
  vxm_sparse *sparse;
  assert_int_equal(vxm_sparse_from_grid(&sparse, grid, NULL), VXM_OK);
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_gridio_write(grid, "/dev/full", "vdb", &error), VXM_ERROR_IO);
  assert_non_null(strstr(error.text, "/dev/full"));
  error = (vxm_error)VXM_ERROR_INIT;
  assert_int_equal(vxm_gridio_write_sparse(sparse, "/dev/full", "vdb", &error), VXM_ERROR_IO);
  assert_non_null(strstr(error.text, "/dev/full"));
  vxm_sparse_destroy(sparse);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
}

/* ---- Damage ---- */

/** Reads in little memory; a grid that keeps its invariants, or one clear line. */
static bool read_damaged(const unsigned char *data, size_t size) {
  vxm_context *context = context_with(1, 64 << 20, NULL, NULL);
  vxm_input input = {.data = data, .size = size, .name = "a.vdb", .context = context};
  vxm_grid *grid = NULL;
  vxm_error error = VXM_ERROR_INIT;
  vxm_field *field = NULL;
  vxm_status status = vxm_format_vdb.read(&grid, &input, VXM_BITS_ANY, &error);
  if (status == VXM_ERROR_NUMBERS) {
    error = (vxm_error)VXM_ERROR_INIT;
    status = vxm_format_vdb.read_field(&field, &input, &error);
  }
  assert_int_equal(grid != NULL || field != NULL, status == VXM_OK);
  if (field)
    assert_int_equal(vxm_space_check(&field->space, NULL), VXM_OK);
  else if (status == VXM_OK) {
    assert_padding_clear(grid);
    assert_int_equal(vxm_space_check(&grid->space, NULL), VXM_OK);
  } else {
    /* A sanitizer ends the other process by itself. */
    if (status != VXM_ERROR_FORMAT && status != VXM_ERROR_RANGE && status != VXM_ERROR_MEMORY_LIMIT &&
        !(SANITIZED && status == VXM_ERROR_UNAVAILABLE))
      fail_msg("status %d: %s", (int)status, error.text);
    assert_int_equal(error.code, status);
    assert_true(error.text[0] != '\0');
    assert_null(strchr(error.text, '\n'));
    assert_true(error.offset <= (int64_t)size);
  }
  vxm_field_destroy(field);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  return status == VXM_OK;
}

/** Cut here and there; then bits turned, most of them where lengths are. Each time a process reads it. */
static void damage(const unsigned char *whole, size_t size, vxm_rng *rng) {
  enum { HEAD = 1400, CUTS = 16, ROUNDS = 24 };
  assert_false(read_damaged(whole, size - 1));
  for (int cut = 0; cut < CUTS; cut++)
    assert_false(read_damaged(whole, vxm_rng_below(rng, cut % 2 && size > HEAD ? HEAD : size)));
  unsigned char *data = malloc(size);
  memcpy(data, whole, size);
  int read = 0;
  for (int round = 0; round < ROUNDS; round++) {
    size_t at = vxm_rng_below(rng, round % 2 && size > HEAD ? HEAD : size);
    unsigned char before = data[at];
    data[at] = (unsigned char)(round % 3 ? before ^ 1u << vxm_rng_below(rng, 8) : vxm_rng_next(rng));
    read += read_damaged(data, size);
    data[at] = before;
  }
  assert_true(read > 0);
  free(data);
}

static void test_damage(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {77};
  vxm_context *context = context_with(1, 0, NULL, NULL);
  for (int kind = 3; kind < 6; kind += 2) {
    vxm_grid *grid = new_grid(context, unit_space(60, 41, 33));
    fill_random(grid, &rng, kind);
    vxm_grid_set(grid, 17, 18, 19, true);
    write_grid(grid, path_in(folder, "a.vdb"));
    size_t size;
    unsigned char *data = load_file(path_in(folder, "a.vdb"), &size);
    assert_true(read_damaged(data, size));
    damage(data, size, &rng);
    free(data);
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/** Files of another program. */
static int damage_files(int count, char **paths) {
  vxm_rng rng = {78};
  for (int f = 0; f < count; f++) {
    size_t size;
    unsigned char *data = load_file(paths[f], &size);
    printf("%s, %zu bytes\n", paths[f], size);
    fflush(stdout);
    if (read_damaged(data, size))
      damage(data, size, &rng);
    free(data);
  }
  return 0;
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_round_trips),  cmocka_unit_test(test_large),
      cmocka_unit_test(test_transforms),   cmocka_unit_test(test_identifier),
      cmocka_unit_test(test_fields),       cmocka_unit_test(test_signs_of_zero),
      cmocka_unit_test(test_memory_limit), cmocka_unit_test(test_reading_limit),
      cmocka_unit_test(test_plan),         cmocka_unit_test(test_cancel),
      cmocka_unit_test(test_full_disk),    cmocka_unit_test(test_damage),
  };
  const vxm_vdb_functions *functions;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_vdb_open(&functions, &error) != VXM_OK) {
    puts(error.text);
    return 77;
  }
  if (argc > 1)
    return damage_files(argc - 1, argv + 1);
  return cmocka_run_group_tests(tests, NULL, NULL);
}

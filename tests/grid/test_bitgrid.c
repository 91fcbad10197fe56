/* SPDX-License-Identifier: BSD-3-Clause */
/** The bit grid against an array of bytes: every operation, at row ends and far beyond the grid. */
#include "../gridio/grids.h"

#include <inttypes.h>
#include <math.h>

/** What the grid should hold: one byte per voxel, x fastest. */
typedef struct model {
  int64_t dims[3];
  uint8_t *voxels;
} model;

static model new_model(const vxm_space *space) {
  model m = {{space->dims[0], space->dims[1], space->dims[2]}, NULL};
  m.voxels = calloc((size_t)(m.dims[0] * m.dims[1] * m.dims[2]), 1);
  assert_non_null(m.voxels);
  return m;
}

static uint8_t *at(const model *m, int64_t i, int64_t j, int64_t k) {
  return &m->voxels[(k * m->dims[1] + j) * m->dims[0] + i];
}

/** A part of the columns, taken out and put into a full grid: what lies beside it stays. */
static void check_ranges(const vxm_grid *grid, const uint8_t *unpacked, vxm_rng *rng) {
  const vxm_space *space = vxm_grid_space(grid);
  int64_t nx = space->dims[0], begin = (int64_t)vxm_rng_below(rng, (uint64_t)nx + 1),
          end = begin + (int64_t)vxm_rng_below(rng, (uint64_t)(nx - begin) + 1);
  size_t column = (size_t)(space->dims[1] * space->dims[2]), count = (size_t)(end - begin) * column;
  uint8_t *part = malloc(count + 1);
  part[count] = 77;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_grid_unpack_range(grid, begin, end, part, &error), VXM_OK);
  for (size_t v = 0; v < count; v++)
    assert_int_equal(part[v], unpacked[(size_t)begin * column + v] != 0);
  assert_int_equal(part[count], 77);
  vxm_grid *full = new_grid(grid->context, *space);
  for (int64_t k = 0; k < space->dims[2]; k++)
    for (int64_t j = 0; j < space->dims[1]; j++)
      vxm_row_set_span(vxm_grid_row(full, j, k), 0, nx);
  assert_int_equal(vxm_grid_pack_range(full, begin, end, part, &error), VXM_OK);
  assert_padding_clear(full);
  for (int64_t k = 0; k < space->dims[2]; k++)
    for (int64_t j = 0; j < space->dims[1]; j++)
      for (int64_t i = 0; i < nx; i++)
        assert_int_equal(vxm_grid_get(full, i, j, k), i < begin || i >= end || vxm_grid_get(grid, i, j, k));
  assert_int_equal(vxm_grid_unpack_range(grid, -1, end, part, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_grid_unpack_range(grid, begin, nx + 1, part, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_grid_pack_range(full, end + 1, end, part, &error), VXM_ERROR_ARGUMENT);
  free(part);
  vxm_grid_destroy(full);
}

/** Words make the same grid, whatever they have beyond the rows. */
static void check_words(const vxm_grid *grid) {
  vxm_grid *other = new_grid(grid->context, *vxm_grid_space(grid));
  uint64_t *words = malloc(grid->word_count * sizeof *words);
  memcpy(words, vxm_grid_words(grid), grid->word_count * sizeof *words);
  for (size_t w = grid->row_words - 1; w < grid->word_count; w += grid->row_words)
    words[w] |= ~vxm_grid_tail_mask(grid);
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_grid_set_words(other, words, grid->word_count - 1, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_grid_set_words(other, words, grid->word_count, &error), VXM_OK);
  assert_padding_clear(other);
  assert_int_equal(vxm_grid_hash(other), vxm_grid_hash(grid));
  free(words);
  vxm_grid_destroy(other);
}

/** Random sets and clears, a third of them outside; then everything that can be asked. */
static void check_grid(vxm_context *context, vxm_rng *rng) {
  vxm_space space = random_space(rng, 90, false);
  vxm_grid *grid = new_grid(context, space);
  model m = new_model(&space);
  assert_int_equal(vxm_grid_count(grid), 0);
  for (int n = 0; n < 3000; n++) {
    int64_t p[3];
    bool inside = true, value = vxm_rng_below(rng, 3) > 0;
    for (int a = 0; a < 3; a++) {
      p[a] = (int64_t)vxm_rng_below(rng, (uint64_t)space.dims[a]);
      if (vxm_rng_below(rng, 8) == 0) {
        static const int64_t outside[] = {-1, -64, INT64_MIN, INT64_MAX};
        uint64_t choice = vxm_rng_below(rng, 5);
        p[a] = choice < 4 ? outside[choice] : space.dims[a];
        inside = false;
      }
    }
    vxm_grid_set(grid, p[0], p[1], p[2], value);
    if (inside)
      *at(&m, p[0], p[1], p[2]) = value;
    assert_int_equal(vxm_grid_get(grid, p[0], p[1], p[2]), inside && value);
  }
  assert_padding_clear(grid);

  size_t total = (size_t)(m.dims[0] * m.dims[1] * m.dims[2]);
  uint8_t *unpacked = malloc(total);
  assert_non_null(unpacked);
  vxm_grid_unpack(grid, unpacked);
  int64_t count = 0;
  const uint64_t *words = vxm_grid_words(grid);
  int64_t row_words = vxm_grid_row_words(grid);
  assert_int_equal(row_words, (m.dims[0] + 63) / 64);
  for (int64_t k = 0; k < m.dims[2]; k++)
    for (int64_t j = 0; j < m.dims[1]; j++)
      for (int64_t i = 0; i < m.dims[0]; i++) {
        uint8_t value = *at(&m, i, j, k);
        count += value;
        assert_int_equal(vxm_grid_get(grid, i, j, k), value);
        assert_int_equal(words[(k * m.dims[1] + j) * row_words + i / 64] >> (i % 64) & 1, value);
        assert_int_equal(unpacked[(i * m.dims[1] + j) * m.dims[2] + k], value);
      }
  assert_int_equal(vxm_grid_count(grid), count);
  assert_memory_equal(vxm_grid_space(grid), &space, sizeof space);
  /* and back, into a grid that was full, from any bytes that are not 0 */
  uint64_t hash = vxm_grid_hash(grid);
  for (size_t v = 0; v < total; v++)
    unpacked[v] = (uint8_t)(unpacked[v] * 0x80);
  memset(grid->words, 0xff, grid->word_count * sizeof *grid->words);
  vxm_grid_pack(grid, unpacked);
  assert_int_equal(vxm_grid_hash(grid), hash);
  check_ranges(grid, unpacked, rng);
  check_words(grid);
  free(unpacked);
  free(m.voxels);
  vxm_grid_destroy(grid);
}

static void test_against_bytes(void **state) {
  (void)state;
  vxm_context *context = context_with(2, 0, NULL, NULL);
  vxm_rng rng = {31};
  for (int round = 0; round < 40; round++)
    check_grid(context, &rng);
  vxm_context_destroy(context);
}

static void test_row_spans(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  static const int64_t lengths[] = {1, 63, 64, 65, 130, 200};
  for (int l = 0; l < 6; l++)
    for (int64_t begin = 0; begin <= lengths[l]; begin++)
      for (int64_t end = begin > 0 ? begin - 1 : 0; end <= lengths[l]; end++) {
        vxm_grid *grid = new_grid(context, unit_space(lengths[l], 1, 1));
        vxm_row_set_span(vxm_grid_row(grid, 0, 0), begin, end);
        assert_padding_clear(grid);
        assert_int_equal(vxm_grid_count(grid), end > begin ? end - begin : 0);
        if (end > begin)
          assert_true(vxm_grid_get(grid, begin, 0, 0) && vxm_grid_get(grid, end - 1, 0, 0));
        vxm_grid_destroy(grid);
      }
  vxm_context_destroy(context);
}

/** Every single bit and the dimensions count; the values are the same on every machine. */
static void test_hash(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_grid *grid = new_grid(context, unit_space(70, 3, 2));
  uint64_t empty = vxm_grid_hash(grid), seen[70 * 3 * 2];
  size_t count = 0;
  for (int64_t v = 0; v < 70 * 3 * 2; v++) {
    vxm_grid_set(grid, v % 70, v / 70 % 3, v / 210, true);
    seen[count] = vxm_grid_hash(grid);
    assert_true(seen[count] != empty);
    for (size_t s = 0; s < count; s++)
      assert_true(seen[s] != seen[count]);
    count++;
    vxm_grid_set(grid, v % 70, v / 70 % 3, v / 210, false);
    assert_true(vxm_grid_hash(grid) == empty);
  }
  grid->space.origin[0] = 5; /* the place does not count */
  assert_true(vxm_grid_hash(grid) == empty);
  vxm_grid_set(grid, 69, 2, 1, true);
  assert_true(vxm_grid_hash(grid) == UINT64_C(0xe87980c338db221));
  vxm_grid_destroy(grid);
  grid = new_grid(context, unit_space(70, 2, 3));
  assert_true(vxm_grid_hash(grid) != empty);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
}

static void test_compare(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_rng rng = {32};
  for (int round = 0; round < 40; round++) {
    vxm_space space = random_space(&rng, 50, false);
    vxm_grid *a = new_grid(context, space), *b = new_grid(context, space);
    fill_random(a, &rng, round % KINDS);
    fill_random(b, &rng, round / 2 % KINDS);
    int64_t both = 0, only_a = 0, only_b = 0;
    for (int64_t k = 0; k < space.dims[2]; k++)
      for (int64_t j = 0; j < space.dims[1]; j++)
        for (int64_t i = 0; i < space.dims[0]; i++) {
          bool in_a = vxm_grid_get(a, i, j, k), in_b = vxm_grid_get(b, i, j, k);
          both += in_a && in_b;
          only_a += in_a && !in_b;
          only_b += !in_a && in_b;
        }
    vxm_comparison c = VXM_COMPARISON_INIT;
    assert_int_equal(vxm_grid_compare(&c, a, b, NULL), VXM_OK);
    assert_int_equal(c.both, both);
    assert_int_equal(c.only_a, only_a);
    assert_int_equal(c.only_b, only_b);
    assert_int_equal(c.voxels_a, both + only_a);
    assert_int_equal(c.voxels_b, both + only_b);
    int64_t any = both + only_a + only_b;
    assert_true(c.iou == (any ? (double)both / (double)any : 1));
    vxm_grid_destroy(a);
    vxm_grid_destroy(b);
  }
  vxm_grid *a = new_grid(context, unit_space(64, 2, 3)), *b = new_grid(context, unit_space(64, 3, 2));
  vxm_comparison c = VXM_COMPARISON_INIT;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_grid_compare(&c, a, b, &error), VXM_ERROR_ARGUMENT);
  assert_non_null(strstr(error.text, "64x2x3"));
  assert_non_null(strstr(error.text, "64x3x2"));
  assert_int_equal(vxm_grid_compare(&c, a, a, NULL), VXM_OK);
  assert_true(c.iou == 1 && c.both == 0);
  assert_int_equal(vxm_grid_compare(NULL, a, a, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_grid_compare(&c, NULL, a, NULL), VXM_ERROR_ARGUMENT);
  vxm_grid_destroy(a);
  vxm_grid_destroy(b);
  vxm_context_destroy(context);
}

static void test_space_check(void **state) {
  (void)state;
  vxm_space good = unit_space(VXM_DIM_MAX, 1, 1);
  assert_int_equal(vxm_space_check(&good, NULL), VXM_OK);
  static const struct {
    int64_t dims[3];
    double origin, size;
    vxm_status status;
  } cases[] = {
      {{0, 1, 1}, 0, 1, VXM_ERROR_ARGUMENT},         {{1, -5, 1}, 0, 1, VXM_ERROR_ARGUMENT},
      {{1, 1, INT64_MIN}, 0, 1, VXM_ERROR_ARGUMENT}, {{1, 1, VXM_DIM_MAX + 1}, 0, 1, VXM_ERROR_RANGE},
      {{INT64_MAX, 1, 1}, 0, 1, VXM_ERROR_RANGE},    {{1, 1, 1}, NAN, 1, VXM_ERROR_ARGUMENT},
      {{1, 1, 1}, -INFINITY, 1, VXM_ERROR_ARGUMENT}, {{1, 1, 1}, 0, 0, VXM_ERROR_ARGUMENT},
      {{1, 1, 1}, 0, -1, VXM_ERROR_ARGUMENT},        {{1, 1, 1}, 0, NAN, VXM_ERROR_ARGUMENT},
      {{1, 1, 1}, 0, INFINITY, VXM_ERROR_ARGUMENT},  {{1, 1, 1}, 1e308, 5e-324, VXM_OK},
  };
  for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++)
    for (int axis = 0; axis < 3; axis++) {
      vxm_space space = unit_space(cases[c].dims[0], cases[c].dims[1], cases[c].dims[2]);
      space.origin[axis] = cases[c].origin;
      space.voxel_size[axis] = cases[c].size;
      vxm_error error = VXM_ERROR_INIT;
      assert_int_equal(vxm_space_check(&space, &error), cases[c].status);
      assert_int_equal(error.code, cases[c].status);
      vxm_grid *grid;
      assert_int_equal(vxm_grid_create(&grid, NULL, &space, NULL), cases[c].status);
      assert_int_equal(grid != NULL, cases[c].status == VXM_OK);
      vxm_grid_destroy(grid);
    }
  assert_int_equal(vxm_space_bytes(&(vxm_space){.dims = {65, 3, 2}}), 2 * 3 * 2 * 8);
}

/** The largest grid that can be named is refused by the limit, not by the system. */
static void test_memory_limit(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 1 << 20, NULL, NULL);
  vxm_space space = unit_space(VXM_DIM_MAX, VXM_DIM_MAX, VXM_DIM_MAX);
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid;
  assert_int_equal(vxm_grid_create(&grid, context, &space, &error), VXM_ERROR_MEMORY_LIMIT);
  assert_null(grid);
  space = unit_space(256, 256, 128); /* 1 MiB, and no room for what goes with it */
  assert_int_equal(vxm_grid_create(&grid, context, &space, &error), VXM_ERROR_MEMORY_LIMIT);
  space = unit_space(256, 256, 120);
  assert_int_equal(vxm_grid_create(&grid, context, &space, &error), VXM_OK);
  assert_true(vxm_context_peak_bytes(context) <= 1 << 20);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  assert_int_equal(vxm_grid_create(NULL, NULL, &space, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_grid_create(&grid, NULL, NULL, &error), VXM_ERROR_ARGUMENT);
  vxm_grid_destroy(NULL);
}

/** A grid outlives the handle of its context. */
static void test_context_lives_on(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_grid *grid = new_grid(context, unit_space(5, 5, 5));
  vxm_context_destroy(context);
  vxm_grid_set(grid, 4, 4, 4, true);
  assert_int_equal(vxm_grid_count(grid), 1);
  assert_int_equal(vxm_grid_warning_count(grid), 0);
  assert_string_equal(vxm_grid_warning(grid, 0), "");
  assert_string_equal(vxm_grid_warning(grid, -1), "");
  vxm_grid_destroy(grid);
}

/** Where voxels are set, one after another. */
static void check_box(const vxm_grid *grid) {
  const int64_t *n = grid->space.dims;
  int64_t begin[3] = {n[0], n[1], n[2]}, end[3] = {0, 0, 0}, found[2][3] = {{9, 9, 9}, {9, 9, 9}}, v[3];
  bool is_any = false;
  for (v[2] = 0; v[2] < n[2]; v[2]++)
    for (v[1] = 0; v[1] < n[1]; v[1]++)
      for (v[0] = 0; v[0] < n[0]; v[0]++)
        for (int a = 0; a < 3 && vxm_grid_get(grid, v[0], v[1], v[2]); a++) {
          begin[a] = vxm_min(begin[a], v[a]);
          end[a] = vxm_max(end[a], v[a] + 1);
          is_any = true;
        }
  assert_int_equal(vxm_grid_box(found[0], found[1], grid), is_any);
  for (int a = 0; a < 3; a++) {
    assert_int_equal(found[0][a], is_any ? begin[a] : 0);
    assert_int_equal(found[1][a], is_any ? end[a] : 0);
  }
}

static void test_box(void **state) {
  (void)state;
  vxm_rng rng = {12};
  for (int round = 0; round < 60; round++) {
    vxm_space space = {{1, 1, 1}, {0, 0, 0}, {1, 1, 1}};
    for (int a = 0; a < 3; a++)
      space.dims[a] = 1 + (int64_t)vxm_rng_below(&rng, a == 0 ? 200 : 9);
    vxm_grid *grid = new_grid(NULL, space);
    check_box(grid);
    for (int few = 0; few < 4; few++) {
      int64_t at[3];
      for (int a = 0; a < 3; a++)
        at[a] = (int64_t)vxm_rng_below(&rng, (uint64_t)space.dims[a]);
      vxm_grid_set(grid, at[0], at[1], at[2], true);
      check_box(grid);
    }
    vxm_grid_destroy(grid);
  }
}

/** Voxel by voxel; and what lies beyond the rows stays clear. */
static void test_combine(void **state) {
  (void)state;
  vxm_rng rng = {13};
  for (int round = 0; round < 40; round++) {
    const int64_t widths[4] = {1, 64, 65, 1 + (int64_t)vxm_rng_below(&rng, 150)};
    const vxm_space space = {{widths[round % 4], 3, 4}, {1, 2, 3}, {0.5, 1, 2}};
    vxm_grid *a = new_grid(NULL, space), *b = new_grid(NULL, space), *made = NULL;
    for (int64_t v = 0; v < 12 * space.dims[0]; v++) {
      vxm_grid_set(a, v / 12, v % 3, v / 3 % 4, vxm_rng_below(&rng, 2));
      vxm_grid_set(b, v / 12, v % 3, v / 3 % 4, vxm_rng_below(&rng, 3) == 0);
    }
    b->space.origin[0] = 7; /* the result lies where the first does */
    for (int op = VXM_SET_UNION; op <= VXM_SET_COMPLEMENT; op++) {
      const vxm_grid *second = op == VXM_SET_COMPLEMENT ? NULL : b;
      assert_int_equal(vxm_grid_combine(&made, a, second, (vxm_set_operation)op, NULL), VXM_OK);
      assert_padding_clear(made);
      assert_memory_equal(&made->space, &a->space, sizeof a->space);
      for (int64_t v = 0; v < 12 * space.dims[0]; v++) {
        const int64_t i = v / 12, j = v % 3, k = v / 3 % 4;
        const bool p = vxm_grid_get(a, i, j, k), q = vxm_grid_get(b, i, j, k);
        const bool wanted[] = {p || q, p && q, p && !q, p != q, !p};
        assert_int_equal(vxm_grid_get(made, i, j, k), wanted[op]);
      }
      vxm_grid_destroy(made);
    }
    vxm_grid_destroy(a);
    vxm_grid_destroy(b);
  }
}

static void test_combine_refuses(void **state) {
  (void)state;
  const vxm_space space = {{64, 3, 4}, {0, 0, 0}, {1, 1, 1}}, other = {{64, 4, 3}, {0, 0, 0}, {1, 1, 1}};
  vxm_grid *a = new_grid(NULL, space), *b = new_grid(NULL, other), *made = a;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_grid_combine(&made, a, b, VXM_SET_UNION, &error), VXM_ERROR_ARGUMENT);
  assert_null(made);
  assert_string_equal(error.text, "combine: sets of 64 x 3 x 4 and 64 x 4 x 3 voxels cannot be combined");
  assert_int_equal(vxm_grid_combine(&made, a, NULL, VXM_SET_UNION, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_grid_combine(&made, a, a, (vxm_set_operation)5, &error), VXM_ERROR_ARGUMENT);
  assert_string_equal(error.text, "combine: operation 5 is unknown");
  vxm_grid_destroy(a);
  vxm_grid_destroy(b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_against_bytes),
      cmocka_unit_test(test_row_spans),
      cmocka_unit_test(test_hash),
      cmocka_unit_test(test_compare),
      cmocka_unit_test(test_box),
      cmocka_unit_test(test_combine),
      cmocka_unit_test(test_combine_refuses),
      cmocka_unit_test(test_space_check),
      cmocka_unit_test(test_memory_limit),
      cmocka_unit_test(test_context_lives_on),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** Octree files of numbers, labels and colours: read as they were written, whole and in windows, the same
 * from fields and slices, and damaged ones. */
#include "../base/rounds.h"
#include "grids.h"

#include "base/endian.h"
#include "grid/octree_pieces.h"
#include "gridio/formats/octree/octree_values.h"

typedef struct sort {
  vxm_field_kind kind;
  vxm_scalar scalar;
} sort;

static const sort sorts[] = {{VXM_FIELD_LABELS, VXM_UINT16},    {VXM_FIELD_COLORS, VXM_UINT8},
                             {VXM_FIELD_DISTANCE, VXM_FLOAT32}, {VXM_FIELD_NUMBERS, VXM_FLOAT64},
                             {VXM_FIELD_COVERAGE, VXM_UINT8},   {VXM_FIELD_NUMBERS, VXM_FLOAT16},
                             {VXM_FIELD_LABELS, VXM_INT32},     {VXM_FIELD_NUMBERS, VXM_UINT64}};
enum { SORTS = sizeof sorts / sizeof *sorts };

static const int64_t dims_of[][3] = {{1, 1, 1},     {5, 16, 17},   {64, 65, 3},  {256, 256, 20},
                                     {257, 70, 31}, {300, 300, 9}, {20, 17, 600}};
enum { SHAPES = sizeof dims_of / sizeof *dims_of };

/** Boxes of one value each, and single voxels, over a background. */
static vxm_field *random_field(vxm_context *context, vxm_rng *rng, int shape, sort what) {
  const int64_t *n = dims_of[shape];
  size_t count = (size_t)(n[0] * n[1] * n[2]);
  size_t bytes = vxm_scalar_bytes(what.scalar) * (what.kind == VXM_FIELD_COLORS ? 4 : 1);
  unsigned char *values = calloc(count, bytes), value[8];
  assert_non_null(values);
  bool is_clear = what.kind != VXM_FIELD_DISTANCE && what.kind != VXM_FIELD_NUMBERS;
  for (size_t v = 0; v < count && !is_clear; v++)
    memset(values + v * bytes, 7, bytes);
  uint64_t boxes = vxm_rng_below(rng, 6);
  for (uint64_t box = 0; box < boxes + 200; box++) {
    int64_t low[3], high[3];
    for (int a = 0; a < 3; a++) {
      low[a] = (int64_t)vxm_rng_below(rng, (uint64_t)n[a]);
      high[a] =
          box < boxes ? low[a] + 1 + (int64_t)vxm_rng_below(rng, (uint64_t)(n[a] - low[a])) : low[a] + 1;
    }
    for (size_t b = 0; b < bytes; b++)
      value[b] = (unsigned char)vxm_rng_below(rng, 4);
    if (what.scalar == VXM_FLOAT32 || what.scalar == VXM_FLOAT64 || what.scalar == VXM_FLOAT16)
      value[bytes - 1] = (unsigned char)(value[bytes - 1] << 6); /* -0, too, and none is not a number */
    for (int64_t i = low[0]; i < high[0]; i++)
      for (int64_t j = low[1]; j < high[1]; j++)
        for (int64_t k = low[2]; k < high[2]; k++)
          memcpy(values + (size_t)((i * n[1] + j) * n[2] + k) * bytes, value, bytes);
  }
  vxm_space space = {{n[0], n[1], n[2]}, {-1.5, 0.1, 2e-7}, {0.25, 0.5, 1.0 / 3}};
  vxm_field *field;
  assert_int_equal(vxm_field_create(&field, context, &space, what.kind, what.scalar, values, NULL), VXM_OK);
  free(values);
  return field;
}

static void assert_same_field(const vxm_field *a, const vxm_field *b) {
  assert_int_equal(vxm_field_kind_of(a), vxm_field_kind_of(b));
  assert_int_equal(vxm_field_scalar(a), vxm_field_scalar(b));
  assert_memory_equal(&a->space, &b->space, sizeof a->space);
  assert_memory_equal(vxm_field_values(a), vxm_field_values(b),
                      vxm_field_count(a) * vxm_field_voxel_bytes(a));
}

static void check_windows(const vxm_sparse_file *file, const vxm_field *field, vxm_rng *rng) {
  for (int round = 0; round < 4; round++) {
    int64_t begin[3], end[3];
    vxm_field *part, *wanted;
    for (int a = 0; a < 3; a++) {
      int64_t n = field->space.dims[a];
      begin[a] = (int64_t)vxm_rng_below(rng, (uint64_t)n);
      end[a] = vxm_min(begin[a] + 1 + (int64_t)vxm_rng_below(rng, 90), n);
    }
    assert_int_equal(vxm_field_window(&wanted, field, begin, end, NULL), VXM_OK);
    assert_int_equal(vxm_sparse_file_field(&part, file, begin, end, NULL), VXM_OK);
    assert_same_field(part, wanted);
    vxm_field_destroy(part);
    vxm_field_destroy(wanted);
  }
}

/** Slices in groups of any number give the bytes of the whole. */
static void check_slices(const vxm_field *field, const char *path, const unsigned char *data, size_t size,
                         vxm_rng *rng) {
  vxm_values_spec spec = {.scalar = field->scalar, .channels = field->channels, .about = &field->about};
  vxm_values_writer writer;
  int64_t all = field->space.dims[2];
  assert_int_equal(
      vxm_values_writer_open(&writer, &vxm_octree_values, field->context, &field->space, &spec, path, NULL),
      VXM_OK);
  for (int64_t begin = 0, end; begin < all; begin = end) {
    end = vxm_min(begin + 1 + (int64_t)vxm_rng_below(rng, 40), all);
    unsigned char *slices = malloc((size_t)(end - begin) * writer.slice_bytes);
    assert_non_null(slices);
    vxm_field_take_slices(slices, field, begin, end);
    assert_int_equal(vxm_values_writer_put(&writer, slices, begin, end, NULL), VXM_OK);
    free(slices);
  }
  assert_int_equal(vxm_values_writer_commit(&writer, NULL), VXM_OK);
  size_t again_size;
  unsigned char *again = load_file(path, &again_size);
  assert_int_equal(again_size, size);
  assert_memory_equal(again, data, size);
  free(again);
}

static void test_round_trip(void **state) {
  (void)state;
  char folder[64], path[80];
  make_folder(folder);
  snprintf(path, sizeof path, "%s/a.octree", folder);
  vxm_rng rng = {81};
  for (int round = 0; round < SHAPES * SORTS; round++) {
    vxm_context *context = context_with(1 + round % 3, 0, NULL, NULL);
    vxm_field *field = random_field(context, &rng, round % SHAPES, sorts[round % SORTS]), *back;
    vxm_sparse_file *file;
    vxm_grid *grid;
    vxm_error error = VXM_ERROR_INIT;
    if (vxm_field_write(field, path, NULL, &error) != VXM_OK)
      fail_msg("%s", error.text);
    size_t size;
    unsigned char *data = load_file(path, &size);
    if (vxm_field_read(&back, context, path, &error) != VXM_OK)
      fail_msg("round %d: %s", round, error.text);
    assert_same_field(back, field);
    vxm_field_destroy(back);
    assert_int_equal(vxm_sparse_file_open(&file, context, path, NULL), VXM_OK);
    assert_true(vxm_sparse_file_has_values(file));
    check_windows(file, field, &rng);
    assert_int_equal(vxm_sparse_file_window(&grid, file, (int64_t[3]){0, 0, 0}, (int64_t[3]){1, 1, 1}, NULL),
                     VXM_ERROR_NUMBERS);
    vxm_sparse_file_close(file);
    check_slices(field, path, data, size, &rng);
    free(data);
    vxm_field_destroy(field);
    vxm_context_destroy(context);
  }
  remove_folder(folder);
}

/** Sets of voxels stay such, and give 0 and 1 as a field. */
static void test_bits(void **state) {
  (void)state;
  char folder[64], path[80];
  make_folder(folder);
  snprintf(path, sizeof path, "%s/a.octree", folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_rng rng = {82};
  vxm_grid *grid = new_grid(context, unit_space(20, 30, 9));
  fill_random(grid, &rng, 3);
  vxm_sparse_file *file;
  vxm_field *field;
  vxm_sparse *sparse;
  assert_int_equal(vxm_grid_write(grid, path, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_sparse_file_open(&file, context, path, NULL), VXM_OK);
  assert_false(vxm_sparse_file_has_values(file));
  assert_int_equal(vxm_sparse_file_field(&field, file, (int64_t[3]){1, 2, 3}, (int64_t[3]){20, 30, 9}, NULL),
                   VXM_OK);
  const uint8_t *values = vxm_field_values(field);
  for (int64_t i = 1; i < 20; i++)
    for (int64_t j = 2; j < 30; j++)
      for (int64_t k = 3; k < 9; k++)
        assert_int_equal(*values++, vxm_grid_get(grid, i, j, k));
  vxm_field_destroy(field);
  vxm_sparse_file_close(file);
  field = random_field(context, &rng, 1, sorts[0]);
  assert_int_equal(vxm_field_write(field, path, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_sparse_read(&sparse, context, path, NULL), VXM_ERROR_NUMBERS);
  vxm_field_destroy(field);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  remove_folder(folder);
}

/* ---- Blocks ---- */

typedef struct block {
  uint64_t number;
  int64_t at[3];
} block;

typedef struct block_list {
  block items[2000];
  size_t count;
} block_list;

static bool list_block(uint64_t number, const int64_t at[3], void *payload) {
  block_list *list = payload;
  assert_true(list->count < 2000);
  list->items[list->count++] = (block){number, {at[0], at[1], at[2]}};
  return true;
}

/** In cubes that are full over many tiles, blocks have the same numbers whatever is asked for. */
static void test_blocks(void **state) {
  (void)state;
  static block_list all, some;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_octree_pieces pieces = {.context = context, .space = unit_space(3000, 2500, 2100)};
  vxm_octree_pieces_box(&pieces, (int64_t[3]){300, 0, 0}, (int64_t[3]){2100, 2048, 1500});
  vxm_octree_pieces_box(&pieces, (int64_t[3]){2700, 2300, 2000}, (int64_t[3]){2800, 2500, 2100});
  vxm_sparse *sparse;
  assert_int_equal(vxm_octree_pieces_end(&sparse, &pieces), VXM_OK);
  const int64_t origin[3] = {0, 0, 0};
  uint64_t count =
      vxm_octree_each_block(sparse->nodes, sparse->levels, origin, sparse->space.dims, list_block, &all);
  assert_int_equal(count, all.count);
  assert_int_equal(count, 8 * 8 * 6 + 1 * 2 * 2); /* each axis by hand */
  for (size_t b = 0; b < all.count; b++)
    assert_int_equal(all.items[b].number, b);
  vxm_rng rng = {84};
  for (int round = 0; round < ROUNDS(200); round++) {
    int64_t begin[3], end[3];
    size_t wanted = 0;
    for (int a = 0; a < 3; a++) {
      begin[a] = (int64_t)vxm_rng_below(&rng, (uint64_t)sparse->space.dims[a]);
      end[a] = vxm_min(begin[a] + 1 + (int64_t)vxm_rng_below(&rng, 700), sparse->space.dims[a]);
    }
    some.count = 0;
    assert_int_equal(vxm_octree_each_block(sparse->nodes, sparse->levels, begin, end, list_block, &some),
                     count);
    for (size_t b = 0; b < all.count; b++) {
      bool meets = true;
      for (int a = 0; a < 3; a++)
        meets &= all.items[b].at[a] < end[a] && all.items[b].at[a] + 256 > begin[a];
      if (meets) {
        assert_true(wanted < some.count);
        assert_memory_equal(&some.items[wanted], &all.items[b], sizeof(block));
        wanted++;
      }
    }
    assert_int_equal(wanted, some.count);
  }
  vxm_sparse_destroy(sparse);
  vxm_context_destroy(context);
}

/* ---- Damage ---- */

/** From a block of exactly the size, so that a sanitizer sees every step beyond it. */
static vxm_status read_bytes(vxm_context *context, const unsigned char *data, size_t size, vxm_error *error) {
  unsigned char *copy = malloc(size ? size : 1);
  assert_non_null(copy);
  memcpy(copy, data, size);
  vxm_input input = {.data = copy, .size = size, .name = "a.octree", .context = context};
  vxm_sparse_file *file;
  vxm_field *field;
  vxm_status status = vxm_octree_file_open(&file, &input, error);
  if (status == VXM_OK) {
    status = vxm_sparse_file_field(&field, file, (int64_t[3]){0, 0, 0}, file->space.dims, error);
    vxm_field_destroy(field);
    vxm_sparse_file_close(file);
  }
  free(copy);
  return status;
}

static void test_damage(void **state) {
  (void)state;
  char folder[64], path[80];
  make_folder(folder);
  snprintf(path, sizeof path, "%s/a.octree", folder);
  vxm_context *context = context_with(1, UINT64_C(1) << 26, NULL, NULL);
  vxm_rng rng = {83};
  int refused = 0, rounds = 0;
  for (int kind = 0; kind < 2 * SHAPES; kind++) {
    vxm_field *field = random_field(context, &rng, kind % SHAPES, sorts[kind % SORTS]);
    assert_int_equal(vxm_field_write(field, path, NULL, NULL), VXM_OK);
    vxm_field_destroy(field);
    size_t size;
    unsigned char *data = load_file(path, &size);
    size_t values = (size_t)vxm_load_le64(data + 104);
    vxm_error error = VXM_ERROR_INIT;
    assert_int_equal(read_bytes(context, data, size, &error), VXM_OK);
    for (size_t length = 0; length < size; length += 1 + size / 100) {
      error = (vxm_error)VXM_ERROR_INIT;
      assert_int_equal(read_bytes(context, data, length, &error), VXM_ERROR_FORMAT);
    }
    for (int round = 0; round < ROUNDS(200); round++, rounds++) {
      size_t from = round % 4 == 0 ? 0 : values, room = round % 4 == 0 ? 112 : size - values;
      if (round % 4 == 1 && room > 200)
        room = 200;
      size_t at = from + vxm_rng_below(&rng, room);
      unsigned char before = data[at];
      data[at] = (unsigned char)(before ^ (1U << vxm_rng_below(&rng, 8)));
      error = (vxm_error)VXM_ERROR_INIT;
      vxm_status status = read_bytes(context, data, size, &error);
      data[at] = before;
      if (status == VXM_ERROR_FORMAT)
        assert_true(error.offset >= 0 && error.offset <= (int64_t)size);
      else
        assert_true(status == VXM_OK || status == VXM_ERROR_RANGE || status == VXM_ERROR_MEMORY_LIMIT);
      refused += status != VXM_OK;
    }
    free(data);
  }
  assert_true(refused > rounds / 4); /* other numbers are numbers, too */
  vxm_context_destroy(context);
  remove_folder(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_round_trip),
      cmocka_unit_test(test_bits),
      cmocka_unit_test(test_blocks),
      cmocka_unit_test(test_damage),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

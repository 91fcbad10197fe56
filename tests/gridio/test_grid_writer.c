/* SPDX-License-Identifier: BSD-3-Clause */
/** Files written slice by slice are those of the whole grid, byte for byte, and need no more than they say.
 */
#include "grids.h"

#include "gridio/common/grid_writer.h"
#include "gridio/formats/rle_encoder.h"
#include "gridio/gridio.h"

static const char *const formats[] = {"binvox", "npy",    "raw", "rle", "nrrd",
                                      "nii",    "nii.gz", "vti", "vtk", "tif"};

enum { FORMATS = sizeof formats / sizeof formats[0] };

/** Slices begin..end-1 of a grid in a layout, with noise between slices; the words are to be freed. */
static vxm_window cut(const vxm_grid *grid, vxm_layout layout, int64_t begin, int64_t end) {
  vxm_window window = vxm_window_of(&grid->space, layout, begin, end);
  size_t used = window.slice_words;
  window.slice_words += (size_t)(begin % 3);
  window.words = calloc((size_t)(end - begin) * window.slice_words + 1, sizeof *window.words);
  assert_non_null(window.words);
  int64_t p[3];
  for (int64_t slow = begin; slow < end; slow++) {
    for (int64_t middle = 0; middle < window.middle_dim; middle++)
      for (int64_t fast = 0; fast < window.fast_dim; fast++) {
        p[layout.fast] = fast;
        p[layout.middle] = middle;
        p[layout.slow] = slow;
        if (vxm_grid_get(grid, p[0], p[1], p[2]))
          vxm_window_row(&window, middle, slow)[fast / 64] |= UINT64_C(1) << (fast % 64);
      }
    for (size_t w = used; w < window.slice_words; w++)
      vxm_window_row(&window, 0, slow)[w] = ~UINT64_C(0);
  }
  return window;
}

static vxm_grid_writer *open_slices(vxm_context *context, const vxm_space *space, const char *path) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid_writer *slices;
  if (vxm_grid_writer_open(&slices, context, space, path, NULL, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return slices;
}

/** Puts windows of a random number of slices, up to slice `end`. */
static vxm_status put_until(vxm_grid_writer *slices, const vxm_grid *grid, int64_t end, vxm_rng *rng,
                            vxm_error *error) {
  vxm_status status = VXM_OK;
  for (int64_t at = 0, next; at < end && status == VXM_OK; at = next) {
    next = at + 1 + (int64_t)vxm_rng_below(rng, (uint64_t)(end - at));
    vxm_window window = cut(grid, vxm_grid_writer_layout(slices), at, next);
    status = vxm_grid_writer_put(slices, &window, error);
    free(window.words);
  }
  return status;
}

static void assert_same_files(const char *a, const char *b) {
  size_t sizes[2];
  unsigned char *data[2] = {load_file(a, &sizes[0]), load_file(b, &sizes[1])};
  assert_int_equal(sizes[0], sizes[1]);
  assert_memory_equal(data[0], data[1], sizes[0]);
  free(data[0]);
  free(data[1]);
}

/** In a context of its own, which shows what the writer holds. */
static void check_format(const vxm_grid *grid, const char *folder, const char *format, int threads,
                         vxm_rng *rng) {
  vxm_context *context = context_with(threads, 0, NULL, NULL);
  char whole[80], pieces[80];
  snprintf(whole, sizeof whole, "%s/whole.%s", folder, format);
  snprintf(pieces, sizeof pieces, "%s/pieces.%s", folder, format);
  assert_int_equal(vxm_gridio_write(grid, whole, NULL, NULL), VXM_OK);
  vxm_grid_writer_plan plan;
  assert_int_equal(vxm_grid_writer_plan_of(&plan, &grid->space, pieces, NULL, NULL), VXM_OK);
  assert_true(plan.streams);
  vxm_grid_writer *slices = open_slices(context, &grid->space, pieces);
  vxm_layout layout = vxm_grid_writer_layout(slices);
  assert_memory_equal(&layout, &plan.layout, sizeof layout);
  assert_int_equal(put_until(slices, grid, grid->space.dims[layout.slow], rng, NULL), VXM_OK);
  assert_int_equal(vxm_grid_writer_commit(slices, NULL), VXM_OK);
  assert_true(vxm_context_peak_bytes(context) <= plan.bytes);
  assert_true(vxm_context_peak_bytes(context) + 8192 * 2 + 512 >= plan.bytes);
  vxm_context_destroy(context);
  assert_same_files(whole, pieces);
  bool described = strcmp(format, "npy") == 0 || strcmp(format, "raw") == 0;
  assert_int_equal(count_files(folder), described ? 4 : 2);
  if (described) {
    strcat(whole, ".json");
    strcat(pieces, ".json");
    assert_same_files(whole, pieces);
  }
  empty_folder(folder);
}

static void test_pieces_make_the_file(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {61};
  for (int round = 0; round < 60; round++) {
    vxm_context *context = context_with(1 + round % 3, 0, NULL, NULL);
    vxm_grid *grid = new_grid(context, random_space(&rng, round < 50 ? 70 : 140, true));
    fill_random(grid, &rng, round % KINDS);
    for (int f = round % 2; f < FORMATS; f += 2) /* every other one in turn */
      check_format(grid, folder, formats[f], 1 + (round / 2 + f) % 3, &rng);
    vxm_grid_destroy(grid);
    vxm_context_destroy(context);
  }
  remove_folder(folder);
}

/** Rows that fill a buffer, noise that overflows the buffers, and runs much longer than they are. */
static void test_long_rows_and_rough_grids(void **state) {
  (void)state;
  static const int64_t dims[][3] = {{200003, 3, 2}, {3, 200, 1500}, {2, 1500, 60}, {64, 90, 1100}};
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {62};
  for (size_t d = 0; d < sizeof dims / sizeof dims[0]; d++)
    for (int kind = 0; kind < 4; kind++) {
      vxm_context *context = context_with(2, 0, NULL, NULL);
      vxm_grid *grid = new_grid(context, unit_space(dims[d][0], dims[d][1], dims[d][2]));
      fill_random(grid, &rng, kind == 3 ? 5 : kind);
      if (kind == 3) /* one hole in the last voxel of a full grid */
        vxm_grid_set(grid, dims[d][0] - 1, dims[d][1] - 1, dims[d][2] - 1, false);
      for (int f = kind % 2; f < FORMATS; f += 2) { /* every other one in turn */
        if (f == 0 && d < 3)                        /* the cube around these would be huge */
          continue;
        check_format(grid, folder, formats[f], 1 + f % 2, &rng);
        char path[80];
        snprintf(path, sizeof path, "%s/back.%s", folder, formats[f]);
        assert_int_equal(vxm_gridio_write(grid, path, NULL, NULL), VXM_OK);
        vxm_grid *back;
        assert_int_equal(vxm_gridio_read(&back, context, path, NULL), VXM_OK);
        if (f > 0)
          assert_same_bits(grid, back);
        vxm_grid_destroy(back);
        empty_folder(folder);
      }
      vxm_grid_destroy(grid);
      vxm_context_destroy(context);
    }
  remove_folder(folder);
}

/** Noise in the .binvox order too: its rows of pairs are the longest codes there are. */
static void test_rough_binvox(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {63};
  static const int64_t dims[][3] = {{20, 170, 170}, {90, 300, 200}};
  for (int d = 0; d < 2; d++) {
    vxm_context *context = context_with(2, 0, NULL, NULL);
    vxm_grid *grid = new_grid(context, unit_space(dims[d][0], dims[d][1], dims[d][2]));
    for (size_t w = 0; w < grid->word_count; w++) /* one voxel in turn along y */
      grid->words[w] = w / grid->row_words % 2 ? vxm_grid_tail_mask(grid) : 0;
    for (size_t w = 0; w < grid->word_count; w++)
      if (w % grid->row_words + 1 < grid->row_words && grid->words[w])
        grid->words[w] = ~UINT64_C(0);
    check_format(grid, folder, "binvox", 2, &rng);
    vxm_grid_destroy(grid);
    vxm_context_destroy(context);
  }
  remove_folder(folder);
}

/* ---- Runs alone ---- */

typedef struct code {
  vxm_rle_code kind;
  bool value;
  uint64_t length;
  unsigned char *bytes;
  size_t used, room;
} code;

static void put_code(code *c, unsigned byte) {
  if (c->used == c->room)
    c->bytes = realloc(c->bytes, c->room = 2 * c->room + 1000);
  assert_non_null(c->bytes);
  c->bytes[c->used++] = (unsigned char)byte;
}

/** As doc/formats.md says it, run by run. */
static void end_code(code *c, bool last) {
  while (c->kind == VXM_RUN_BYTES && c->length >= 255) {
    put_code(c, 255);
    c->length -= 255;
  }
  if (c->kind == VXM_RUN_BYTES && !(last && c->length == 0))
    put_code(c, (unsigned)c->length);
  while (c->kind == VXM_RUN_PAIRS && c->length > 0) {
    unsigned count = c->length > 255 ? 255 : (unsigned)c->length;
    put_code(c, c->value);
    put_code(c, count);
    c->length -= count;
  }
  c->value = !c->value;
  c->length = 0;
}

static void add_code(code *c, bool value, uint64_t count) {
  if (value != c->value && count > 0)
    end_code(c, false);
  c->length += count;
}

/** A window without a grid around it, with gaps of any length. */
static void check_runs(vxm_context *context, const char *folder, const vxm_rle_shape *shape, int64_t rows,
                       int64_t slices, uint64_t sparse, vxm_rng *rng) {
  vxm_space space = unit_space((int64_t)shape->length, rows, slices);
  const char *path = path_in(folder, "runs");
  uint64_t all = (uint64_t)(rows * slices);
  vxm_grid_writer file = {.context = context, .space = space, .length = slices};
  assert_int_equal(vxm_output_open(&file.output, context, path, NULL), VXM_OK);
  file.state = vxm_alloc(context, vxm_rle_encoder_bytes(shape, all), 1, NULL);
  assert_non_null(file.state);
  vxm_rle_encoder_begin(file.state, shape, all);
  vxm_grid *grid = new_grid(context, space);
  code expected = {.kind = shape->code};
  for (int64_t k = 0; k < slices; k++) {
    for (int64_t j = 0; j < rows; j++) {
      for (int64_t i = 0; i < space.dims[0]; i++) {
        bool value = vxm_rng_below(rng, sparse) == 0;
        vxm_grid_set(grid, i, j, k, value);
        add_code(&expected, value, 1);
      }
      add_code(&expected, false, shape->row_gap);
    }
    add_code(&expected, false, shape->slice_gap);
  }
  add_code(&expected, false, 12345);
  end_code(&expected, true);
  vxm_window window = vxm_window_of_grid(grid);
  assert_int_equal(vxm_rle_encoder_put(&file, &window, NULL), VXM_OK);
  vxm_rle_encoder_skip(&file, 12345);
  vxm_rle_encoder_end(&file);
  assert_int_equal(vxm_output_commit(file.output, NULL), VXM_OK);
  vxm_free(context, file.state);
  vxm_grid_destroy(grid);
  size_t size;
  unsigned char *bytes = load_file(path, &size);
  assert_int_equal(size, expected.used);
  assert_memory_equal(bytes, expected.bytes, size);
  free(bytes);
  free(expected.bytes);
}

/** Gaps that make many codes of one run, at and around multiples of 255; buffers that fill between them. */
static void test_runs(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {67};
  static const uint64_t gaps[] = {0, 1, 254, 255, 256, 510, 1000, 20000};
  for (int round = 0; round < 120; round++) {
    vxm_context *context = context_with(1 + round % 2, 0, NULL, NULL);
    vxm_rle_shape shape = {round % 3 ? VXM_RUN_PAIRS : VXM_RUN_BYTES, 1 + vxm_rng_below(&rng, 130),
                           gaps[vxm_rng_below(&rng, 8)], gaps[vxm_rng_below(&rng, 8)]};
    int64_t rows = 1 + (int64_t)vxm_rng_below(&rng, 40), slices = 1 + (int64_t)vxm_rng_below(&rng, 30);
    check_runs(context, folder, &shape, rows, slices, 1 + vxm_rng_below(&rng, 3), &rng);
    if (round < 6) {
      shape = (vxm_rle_shape){shape.code, 1 + (size_t)round % 3, 10000 + 255 * (uint64_t)round, 700000};
      check_runs(context, folder, &shape, 5000, 2, 300, &rng);
      check_runs(context, folder, &shape, 5000, 2, 3, &rng);
    }
    vxm_context_destroy(context);
  }
  remove_folder(folder);
}

/* ---- Refusals ---- */

static void test_plan(void **state) {
  (void)state;
  vxm_space space = unit_space(100, 200, 300);
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid_writer_plan plan;
  static const char *const meshes[] = {"obj", "ply", "stl", "off"};
  for (int m = 0; m < 4; m++) {
    assert_int_equal(vxm_grid_writer_plan_of(&plan, &space, "-", meshes[m], &error), VXM_OK);
    assert_true(!plan.streams && plan.bytes == 0);
    vxm_grid_writer *slices;
    assert_int_equal(vxm_grid_writer_open(&slices, NULL, &space, "x", meshes[m], &error), VXM_ERROR_ARGUMENT);
    assert_null(slices);
  }
  assert_int_equal(vxm_grid_writer_plan_of(&plan, &space, "a.xyz", NULL, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_grid_writer_plan_of(&plan, &space, "-", NULL, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_grid_writer_plan_of(&plan, &space, "-", "raw", &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_grid_writer_plan_of(&plan, &space, "-", "RLE", &error), VXM_OK);
  assert_true(plan.streams && plan.layout.fast == 0 && plan.gather_bytes == 0);
  assert_int_equal(vxm_grid_writer_plan_of(&plan, &space, "a.binvox", NULL, &error), VXM_OK);
  assert_true(plan.layout.fast == 1 && plan.layout.middle == 2 && plan.layout.slow == 0);
  assert_true(plan.gather_bytes >= 64 * 300 * 4 * 8);
  assert_int_equal(vxm_grid_writer_plan_of(&plan, &space, "a.npy", NULL, &error), VXM_OK);
  assert_true(plan.layout.fast == 2 && plan.layout.middle == 1 && plan.layout.slow == 0);
  /* The writer stays small however large the grid. */
  space = unit_space(VXM_DIM_MAX, VXM_DIM_MAX, VXM_DIM_MAX);
  for (int f = 0; f < FORMATS; f++)
    if (vxm_grid_writer_plan_of(&plan, &space, "a", formats[f], &error) == VXM_OK)
      assert_true(plan.bytes < 5 << 20);
  space = unit_space(9, 9, 9);
  space.voxel_size[1] = 2;
  assert_int_equal(vxm_grid_writer_plan_of(&plan, &space, "a.binvox", NULL, &error), VXM_ERROR_ARGUMENT);
  assert_non_null(strstr(error.text, "cubes"));
}

/** Slices that are not next, or not all there, make no file. */
static void test_order_of_slices(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_rng rng = {64};
  vxm_grid *grid = new_grid(context, unit_space(20, 21, 22));
  for (int f = 0; f < FORMATS; f++) {
    char path[80];
    snprintf(path, sizeof path, "%s/a.%s", folder, formats[f]);
    for (int wrong = 0; wrong < 4; wrong++) {
      vxm_error error = VXM_ERROR_INIT;
      vxm_grid_writer *slices = open_slices(context, &grid->space, path);
      vxm_layout layout = vxm_grid_writer_layout(slices);
      assert_int_equal(put_until(slices, grid, 5, &rng, &error), VXM_OK);
      if (wrong == 1)
        layout = (vxm_layout){layout.middle, layout.fast, layout.slow};
      vxm_window window = cut(grid, layout, wrong == 2 ? 6 : wrong == 3 ? 4 : 5, 8);
      if (wrong > 0) {
        assert_int_equal(vxm_grid_writer_put(slices, &window, &error), VXM_ERROR_ARGUMENT);
        vxm_grid_writer_abort(slices);
      } else
        assert_int_equal(vxm_grid_writer_commit(slices, &error), VXM_ERROR_ARGUMENT);
      free(window.words);
      assert_int_equal(error.code, VXM_ERROR_ARGUMENT);
      assert_int_equal(count_files(folder), 0);
    }
  }
  vxm_grid_writer_abort(NULL);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  remove_folder(folder);
}

static void test_memory_limit(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_space space = unit_space(300, 300, 300);
  for (int f = 0; f < FORMATS; f++) {
    const char *path = path_in(folder, "a");
    vxm_grid_writer_plan plan;
    assert_int_equal(vxm_grid_writer_plan_of(&plan, &space, path, formats[f], NULL), VXM_OK);
    for (int enough = 0; enough < 2; enough++) {
      vxm_context *context = context_with(1, enough ? plan.bytes : plan.bytes / 2, NULL, NULL);
      vxm_grid_writer *slices;
      assert_int_equal(vxm_grid_writer_open(&slices, context, &space, path, formats[f], NULL),
                       enough ? VXM_OK : VXM_ERROR_MEMORY_LIMIT);
      vxm_grid_writer_abort(slices);
      vxm_context_destroy(context);
      assert_int_equal(count_files(folder), 0);
    }
  }
  remove_folder(folder);
}

/** A failed write ends the work at the next put or soon after, and tells why. */
static void test_full_disk(void **state) {
  (void)state;
  if (access("/dev/full", W_OK) != 0)
    skip();
  vxm_context *context = context_with(2, 0, NULL, NULL);
  vxm_rng rng = {65};
  vxm_grid *grid = new_grid(context, unit_space(130, 130, 130));
  fill_random(grid, &rng, 1);
  for (int f = 0; f < FORMATS; f++) {
    vxm_error error = VXM_ERROR_INIT;
    vxm_grid_writer *slices;
    assert_int_equal(vxm_grid_writer_open(&slices, context, &grid->space, "/dev/full", formats[f], &error),
                     VXM_OK);
    vxm_status status = put_until(slices, grid, 130, &rng, &error);
    if (status == VXM_OK)
      status = vxm_grid_writer_commit(slices, &error);
    else
      vxm_grid_writer_abort(slices);
    assert_int_equal(status, VXM_ERROR_IO);
    assert_non_null(strstr(error.text, "/dev/full"));
    assert_int_equal(vxm_gridio_write(grid, "/dev/full", formats[f], &error), VXM_ERROR_IO);
  }
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
}

typedef struct calls {
  int count, stop_at;
  double last;
} calls;

static int count_calls(const char *phase, double fraction, void *payload) {
  calls *c = payload;
  assert_string_equal(phase, "writing");
  assert_true(fraction >= c->last && fraction <= 1);
  c->last = fraction;
  return ++c->count == c->stop_at;
}

/** Puts are silent unless told to report; padding and whole grids can be stopped at every report. */
static void test_progress(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  calls c = {0};
  vxm_context *context = context_with(1, 0, count_calls, &c);
  vxm_rng rng = {66};
  vxm_grid *grid = new_grid(context, unit_space(40, 200, 200));
  fill_random(grid, &rng, 2);
  for (int f = 0; f < FORMATS; f++) {
    const char *path = path_in(folder, "a");
    vxm_error error = VXM_ERROR_INIT;
    vxm_grid_writer *slices;
    c = (calls){0};
    assert_int_equal(vxm_grid_writer_open(&slices, context, &grid->space, path, formats[f], &error), VXM_OK);
    assert_int_equal(
        put_until(slices, grid, grid->space.dims[vxm_grid_writer_layout(slices).slow], &rng, &error), VXM_OK);
    assert_int_equal(c.count, 0);
    c.stop_at = f == 0 ? 7 : 0; /* in the padding of the cube */
    assert_int_equal(vxm_grid_writer_commit(slices, &error), f == 0 ? VXM_ERROR_CANCELLED : VXM_OK);
    assert_int_equal(count_files(folder), f == 0 ? 0 : f < 3 ? 2 : 1);
    empty_folder(folder);

    c = (calls){0};
    assert_int_equal(vxm_gridio_write(grid, path, formats[f], &error), VXM_OK);
    int reports = c.count;
    assert_true(reports > 0);
    empty_folder(folder);
    for (int stop = 1; stop <= reports; stop += 1 + reports / 5) {
      c = (calls){.stop_at = stop};
      assert_int_equal(vxm_gridio_write(grid, path, formats[f], &error), VXM_ERROR_CANCELLED);
      assert_int_equal(c.count, stop);
      assert_int_equal(count_files(folder), 0);
    }
  }
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  remove_folder(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_pieces_make_the_file),
      cmocka_unit_test(test_long_rows_and_rough_grids),
      cmocka_unit_test(test_rough_binvox),
      cmocka_unit_test(test_runs),
      cmocka_unit_test(test_plan),
      cmocka_unit_test(test_order_of_slices),
      cmocka_unit_test(test_memory_limit),
      cmocka_unit_test(test_full_disk),
      cmocka_unit_test(test_progress),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

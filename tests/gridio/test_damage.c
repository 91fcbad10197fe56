/* SPDX-License-Identifier: BSD-3-Clause */
/** Damaged files end in an error with an offset, in bounded memory; failed writes leave no file. */
#include "grids.h"

#include "gridio/common/format.h"
#include "gridio/gridio.h"
#include "gridio/picture/picture.h"

#include <sys/stat.h>

/** Reads from a block of exactly the size, so that a sanitizer sees every step beyond it. */
static vxm_status read_bytes(vxm_grid **grid, const vxm_grid_format *format, vxm_context *context,
                             const char *name, const unsigned char *data, size_t size, vxm_error *error) {
  unsigned char *copy = malloc(size ? size : 1);
  assert_non_null(copy);
  memcpy(copy, data, size);
  vxm_input input = {.data = copy, .size = size, .name = name, .context = context};
  *grid = NULL;
  vxm_status status = format->read(grid, &input, VXM_BITS_ANY, error);
  free(copy);
  return status;
}

typedef struct sample {
  const vxm_grid_format *format;
  char path[80];
  unsigned char *data;
  size_t size;
} sample;

enum { SAMPLES = 5 };

static void make_samples(sample samples[SAMPLES], const char *folder, vxm_context *context) {
  const vxm_grid_format *formats[SAMPLES] = {&vxm_format_binvox, &vxm_format_npy, &vxm_format_raw,
                                             &vxm_format_rle, &vxm_format_nrrd};
  vxm_rng rng = {5};
  vxm_grid *grid = new_grid(context, (vxm_space){{11, 9, 7}, {1, 2, 3}, {0.5, 0.5, 0.5}});
  fill_random(grid, &rng, 1);
  for (int s = 0; s < SAMPLES; s++) {
    samples[s].format = formats[s];
    snprintf(samples[s].path, sizeof samples[s].path, "%s/s.%s", folder, formats[s]->name);
    assert_int_equal(vxm_gridio_write(grid, samples[s].path, NULL, NULL), VXM_OK);
    samples[s].data = load_file(samples[s].path, &samples[s].size);
  }
  vxm_grid_destroy(grid);
}

static void free_samples(sample samples[SAMPLES]) {
  for (int s = 0; s < SAMPLES; s++)
    free(samples[s].data);
}

/** Cut at every byte: never a grid, always VXM_ERROR_FORMAT with an offset within the file. */
static void test_truncation(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  sample samples[SAMPLES];
  make_samples(samples, folder, context);
  for (int s = 0; s < SAMPLES; s++)
    for (size_t size = 0; size < samples[s].size; size++) {
      vxm_error error = VXM_ERROR_INIT;
      vxm_grid *grid;
      assert_int_equal(
          read_bytes(&grid, samples[s].format, context, samples[s].path, samples[s].data, size, &error),
          VXM_ERROR_FORMAT);
      assert_null(grid);
      assert_true(error.offset >= 0 && error.offset <= (int64_t)size);
      assert_non_null(strstr(error.text, "s."));
    }
  free_samples(samples);
  vxm_context_destroy(context);
  remove_folder(folder);
}

static size_t mutate(unsigned char *data, size_t size, vxm_rng *rng) {
  uint64_t times = 1 + vxm_rng_below(rng, 4);
  for (uint64_t t = 0; t < times; t++) {
    size_t at = vxm_rng_below(rng, size);
    switch (vxm_rng_below(rng, 5)) {
    case 0:
      data[at] ^= (unsigned char)(1u << vxm_rng_below(rng, 8));
      break;
    case 1:
      data[at] = (unsigned char)vxm_rng_next(rng);
      break;
    case 2: /* a digit, where the header is text */
      data[at % 100 % size] = (unsigned char)('0' + vxm_rng_below(rng, 10));
      break;
    case 3: /* take a byte out */
      memmove(data + at, data + at + 1, --size - at);
      if (size == 0)
        return 0;
      break;
    default: /* put one in */
      memmove(data + at + 1, data + at, size - at);
      data[at] = (unsigned char)vxm_rng_next(rng);
      size++;
    }
  }
  return size;
}

/** Random damage: a grid that keeps its invariants, or an error; never much more memory than the file earns.
 */
static void test_mutation(void **state) {
  (void)state;
  enum { ROUNDS = 20000 };
  char folder[64];
  make_folder(folder);
  vxm_context *writer = context_with(1, 0, NULL, NULL);
  sample samples[SAMPLES];
  make_samples(samples, folder, writer);
  vxm_context *context = context_with(1, 8 << 20, NULL, NULL);
  vxm_rng rng = {6};
  for (int s = 0; s < SAMPLES; s++) {
    int read = 0;
    unsigned char *data = malloc(samples[s].size + 8);
    for (int round = 0; round < ROUNDS; round++) {
      memcpy(data, samples[s].data, samples[s].size);
      size_t size = mutate(data, samples[s].size, &rng);
      vxm_error error = VXM_ERROR_INIT;
      vxm_grid *grid;
      vxm_status status = read_bytes(&grid, samples[s].format, context, samples[s].path, data, size, &error);
      assert_int_equal(grid != NULL, status == VXM_OK);
      if (status != VXM_OK) {
        assert_true(status == VXM_ERROR_FORMAT || status == VXM_ERROR_RANGE || status == VXM_ERROR_NUMBERS);
        assert_true(error.text[0] != '\0');
        continue;
      }
      read++;
      assert_padding_clear(grid);
      assert_int_equal(vxm_space_check(&grid->space, NULL), VXM_OK);
      vxm_grid_destroy(grid);
    }
    assert_true(read > 0 && read < ROUNDS);
    free(data);
  }
  free_samples(samples);
  vxm_context_destroy(context);
  vxm_context_destroy(writer);
  remove_folder(folder);
}

typedef struct refused {
  const char *name, *text;
  size_t size;
  vxm_status status;
  int64_t offset;
  const char *words;
} refused;

#define CASE(name, text, status, offset, words) \
  { name, text, sizeof(text) - 1, status, offset, words }

#define NPY(text) "\x93NUMPY\1\0\x50\0" text

static const refused cases[] = {
    CASE("a.txt", "", VXM_ERROR_FORMAT, -1, "not a grid"),
    CASE("a.obj", "v 0 0 0\n", VXM_ERROR_FORMAT, -1, "voxelize"),
    CASE("a.raw", "\1", VXM_ERROR_FORMAT, -1, ".json"),
    CASE("a.binvox", "", VXM_ERROR_FORMAT, 0, "#binvox"),
    CASE("a.binvox", "#binvox 1\ndim 2 2 2\ntranslate 0 0 0\nscale 1\n", VXM_ERROR_FORMAT, 44, "data"),
    CASE("a.binvox", "#binvox 1\ntranslate 0 0 0\nscale 1\ndata\n\0\10", VXM_ERROR_FORMAT, 34, "dim"),
    CASE("a.binvox", "#binvox 1\ndim 2 2\ndata\n\0\10", VXM_ERROR_FORMAT, 10, "three"),
    CASE("a.binvox", "#binvox 1\ndim 2 2 x\ndata\n\0\10", VXM_ERROR_FORMAT, 10, "three"),
    CASE("a.binvox", "#binvox 1\ndim 0 0 0\ndata\n\0\10", VXM_ERROR_FORMAT, 10, "0 voxels"),
    CASE("a.binvox", "#binvox 1\ndim -2 2 2\ndata\n\0\10", VXM_ERROR_FORMAT, 10, "-2"),
    CASE("a.binvox", "#binvox 1\ndim 1048577 1 1\ndata\n\0\10", VXM_ERROR_RANGE, 10, "1048576"),
    CASE("a.binvox", "#binvox 1\ndim 99999999999999999999 1 1\ndata\n", VXM_ERROR_FORMAT, 10, "three"),
    CASE("a.binvox", "#binvox 1\ndim 1048576 1048576 1048576\ndata\n\1\377", VXM_ERROR_FORMAT, 45, "short"),
    CASE("a.binvox", "#binvox 1\ndim 2 2 2\nscale 0\ndata\n\0\10", VXM_ERROR_FORMAT, 20, "positive"),
    CASE("a.binvox", "#binvox 1\ndim 2 2 2\nscale nan\ndata\n\0\10", VXM_ERROR_FORMAT, 20, "positive"),
    CASE("a.binvox", "#binvox 1\ndim 2 2 2\ntranslate 1 2 inf\ndata\n\0\10", VXM_ERROR_FORMAT, 20, "finite"),
    CASE("a.binvox", "#binvox 1\ndim 2 2 2\nscale 1,5\ndata\n\0\10", VXM_ERROR_FORMAT, 20, "positive"),
    CASE("a.binvox", "#binvox 1\ndim 2 2 2\ndata\n\0\4\1\3", VXM_ERROR_FORMAT, 29, "7 of 8"),
    CASE("a.binvox", "#binvox 1\ndim 2 2 2\ndata\n\0\4\1\5", VXM_ERROR_FORMAT, 27, "beyond"),
    CASE("a.binvox", "#binvox 1\ndim 2 2 2\ndata\n\0\10\0\1", VXM_ERROR_FORMAT, 27, "beyond"),
    CASE("a.rle", "VXMRLE2\n", VXM_ERROR_FORMAT, 0, "VXMRLE1"),
    CASE("a.rle", "VXMRLE1\n\2\0\0\0", VXM_ERROR_FORMAT, 12, "header"),
    CASE("a.npy", "\x93NUMPY\4\0\x10\0", VXM_ERROR_FORMAT, 6, "version 4"),
    CASE("a.npy", "\x93NUMPY\1\0\377\377{}", VXM_ERROR_FORMAT, 12, "header"),
    CASE("a.npy", NPY("{'descr': '|b1', 'fortran_order': False, 'shape': (1, 1), }                     \0"),
         VXM_ERROR_FORMAT, 65, "three dimensions"),
    CASE("a.npy", NPY("{'descr': '|b1', 'fortran_order': False, 'shape': (1, 1, 1, 1), }               \0"),
         VXM_ERROR_FORMAT, 71, "three dimensions"),
    CASE("a.npy", NPY("{'descr': '|b1', 'fortran_order': False, 'shape': (1, 0, 1), }                  \0"),
         VXM_ERROR_FORMAT, 60, "0 voxels"),
    CASE("a.npy", NPY("{'descr': '|b1', 'fortran_order': False, 'shape': (1, -1, 1), }                 \0"),
         VXM_ERROR_FORMAT, 64, "whole numbers"),
    CASE("a.npy", NPY("{'descr': '<c8', 'fortran_order': False, 'shape': (1, 1, 1), }                  \0"),
         VXM_ERROR_FORMAT, 19, "elements"),
    CASE("a.npy", NPY("{'descr': '|O', 'fortran_order': False, 'shape': (1, 1, 1), }                   \0"),
         VXM_ERROR_FORMAT, 19, "elements"),
    CASE("a.npy", NPY("{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (1, 1, 1), }         \0"),
         VXM_ERROR_FORMAT, 20, "records"),
    CASE("a.npy", NPY("{'descr': '|b1', 'descr': '|b1', 'shape': (1, 1, 1), }                          \0"),
         VXM_ERROR_FORMAT, 27, "repeated"),
    CASE("a.npy", NPY("{'descr': '|b1', 'shape': (1, 1, 1), }                                          \0"),
         VXM_ERROR_FORMAT, 90, "needed"),
    CASE("a.npy", NPY("{'descr': '|b1', 'fortran_order': False, 'shape': (1, 1, 1), 'more': 1}         \0"),
         VXM_ERROR_FORMAT, 71, "unknown key"),
    CASE("a.npy", NPY("{'descr': '|b1', 'fortran_order': False, 'shape': (1, 1, 1), } or 1             \0"),
         VXM_ERROR_FORMAT, 73, "behind"),
    CASE("a.npy", NPY("{'descr': '|b1', 'fortran_order': None, 'shape': (1, 1, 1), }                   \0"),
         VXM_ERROR_FORMAT, 44, "True or False"),
    CASE("a.npy",
         NPY("{'descr': '<i4', 'fortran_order': False, 'shape': (1, 1, 2), }                  \0\0\0\0\0"),
         VXM_ERROR_FORMAT, 95, "1 of 2"),
};

static void test_refusals(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 1 << 20, NULL, NULL);
  for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
    const char *path = path_in(folder, cases[c].name);
    save_file(path, cases[c].text, cases[c].size);
    vxm_error error = VXM_ERROR_INIT;
    vxm_grid *grid = NULL;
    vxm_status status = vxm_gridio_read(&grid, context, path, &error);
    if (status != cases[c].status || error.offset != cases[c].offset || !strstr(error.text, cases[c].words))
      fail_msg("case %zu: status %d, offset %lld: %s", c, (int)status, (long long)error.offset, error.text);
    assert_null(grid);
    assert_int_equal(error.code, status);
    remove(path);
  }
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid = NULL;
  assert_int_equal(vxm_gridio_read(&grid, context, path_in(folder, "none.rle"), &error), VXM_ERROR_IO);
  assert_int_equal(vxm_gridio_read(&grid, context, folder, &error), VXM_ERROR_IO);
  vxm_context_destroy(context);
  remove_folder(folder);
}

/** rle: bytes behind the end, too long runs, and a zero run too many; and the JSON of raw. */
static void test_refused_binary(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_grid *grid = new_grid(context, unit_space(10, 1, 1)), *back = NULL;
  vxm_grid_set(grid, 9, 0, 0, true);
  char rle[80], raw[80], json[80];
  snprintf(rle, sizeof rle, "%s/g.rle", folder);
  snprintf(raw, sizeof raw, "%s/g.raw", folder);
  snprintf(json, sizeof json, "%s/g.raw.json", folder);
  assert_int_equal(vxm_gridio_write(grid, rle, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_gridio_write(grid, raw, NULL, NULL), VXM_OK);
  size_t size;
  unsigned char *data = load_file(rle, &size);
  assert_int_equal(size, 82);
  static const struct {
    const char *runs;
    size_t count;
    vxm_status status;
    int64_t offset;
  } runs[] = {{"\x9\x1", 2, VXM_OK, -1},
              {"\x0\x0\x9\x0\x0\x1", 6, VXM_OK, -1}, /* needless zero runs */
              {"\x9\x1\x0", 3, VXM_ERROR_FORMAT, 82},
              {"\x9\x1\x1", 3, VXM_ERROR_FORMAT, 82},
              {"\x9\x2", 2, VXM_ERROR_FORMAT, 81},
              {"\xff\x1", 2, VXM_ERROR_FORMAT, 80},
              {"\x9", 1, VXM_ERROR_FORMAT, 81},
              {"", 0, VXM_ERROR_FORMAT, 80}};
  for (size_t r = 0; r < sizeof runs / sizeof runs[0]; r++) {
    unsigned char file[100];
    memcpy(file, data, 80);
    memcpy(file + 80, runs[r].runs, runs[r].count);
    save_file(rle, file, 80 + runs[r].count);
    vxm_error error = VXM_ERROR_INIT;
    assert_int_equal(vxm_gridio_read(&back, context, rle, &error), runs[r].status);
    assert_int_equal(error.offset, runs[r].offset);
    if (back)
      assert_same_bits(grid, back);
    vxm_grid_destroy(back);
    back = NULL;
  }
  free(data);
  save_file(raw, "\0\6", 2); /* a bit behind the last voxel */
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_gridio_read(&back, context, raw, &error), VXM_ERROR_FORMAT);
  assert_int_equal(error.offset, 1);
  save_file(raw, "\0\2\0", 3);
  assert_int_equal(vxm_gridio_read(&back, context, raw, &error), VXM_ERROR_FORMAT);
  assert_int_equal(error.offset, 2);
  save_file(raw, "\0\2", 2);
  assert_int_equal(vxm_gridio_read(&back, context, raw, &error), VXM_OK);
  vxm_grid_destroy(back);
#define HEAD "{\"format\":\"voxmend raw\",\"version\":1,"
  static const char *const bad[] = {"",
                                    "{",
                                    "7",
                                    HEAD "\"dims\":[10,1]}",
                                    "{\"format\":\"voxmend raw\",\"version\":2,\"dims\":[10,1,1]}",
                                    HEAD "\"dims\":[10,1,1],\"origin\":[0,0,0]}",
                                    HEAD "\"dims\":[10,1.0,1],\"origin\":[0,0,0],\"voxel_size\":[1,1,1]}",
                                    HEAD "\"dims\":[10,1,1],\"origin\":[0,0,0],\"voxel_size\":[1,0,1]}",
                                    HEAD "\"dims\":[10,1,1],\"origin\":[0,0,null],\"voxel_size\":[1,1,1]}",
                                    HEAD "\"dims\":[10,-1,1],\"origin\":[0,0,0],\"voxel_size\":[1,1,1]}",
                                    HEAD "\"dims\":[10,1,1],\"origin\":[0,0,0],\"voxel_size\":[1,1,1e999]}"};
  for (size_t b = 0; b < sizeof bad / sizeof bad[0]; b++) {
    save_file(json, bad[b], strlen(bad[b]));
    assert_int_equal(vxm_gridio_read(&back, context, raw, &error), VXM_ERROR_FORMAT);
    assert_non_null(strstr(error.text, "g.raw.json"));
    assert_null(back);
  }
  static const char good[] =
      HEAD "\"dims\":[10,1,1],\"origin\":[0,-1,2.5],\"voxel_size\":[1,2,3],\"note\":{}}";
  save_file(json, good, sizeof good - 1);
  assert_int_equal(vxm_gridio_read(&back, context, raw, &error), VXM_OK);
  assert_true(back->space.origin[2] == 2.5 && back->space.voxel_size[1] == 2);
  assert_same_bits(grid, back);
  vxm_grid_destroy(back);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  remove_folder(folder);
}

/* ---- Limits and cancelling ---- */

static int stop_later(const char *phase, double fraction, void *payload) {
  (void)phase;
  assert_true(fraction >= 0 && fraction <= 1);
  return --*(int *)payload < 0;
}

static const char *const all_formats[] = {"binvox", "npy", "raw", "rle", "nrrd", "png"};

enum { ALL_FORMATS = sizeof all_formats / sizeof all_formats[0] };

static vxm_status write_as(const vxm_grid *grid, const char *path, const char *format, vxm_error *error) {
  vxm_picture_options options = VXM_PICTURE_OPTIONS_INIT;
  options.width = options.height = 64;
  return strcmp(format, "png") == 0 ? vxm_gridio_picture(grid, NULL, NULL, path, &options, error)
                                    : vxm_gridio_write(grid, path, format, error);
}

/** Stopped at every call of the callback, reading and writing end as cancelled and leave nothing. */
static void test_cancel(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {7};
  int calls = 1 << 30;
  vxm_context *context = context_with(2, 0, stop_later, &calls);
  vxm_grid *grid = new_grid(context, unit_space(130, 20, 40));
  fill_random(grid, &rng, 3);
  for (int f = 0; f < ALL_FORMATS; f++) {
    char path[80];
    snprintf(path, sizeof path, "%s/g.%s", folder, all_formats[f]);
    vxm_error error = VXM_ERROR_INIT;
    int stop = 0;
    for (;; stop++) {
      calls = stop;
      vxm_status status = write_as(grid, path, all_formats[f], &error);
      if (status == VXM_OK || status == VXM_ERROR_UNAVAILABLE)
        break;
      assert_int_equal(status, VXM_ERROR_CANCELLED);
      assert_int_equal(count_files(folder), 0);
    }
    if (strcmp(all_formats[f], "png") == 0)
      continue;
    assert_true(stop > 0);
    for (stop = 0;; stop++) {
      calls = stop;
      vxm_grid *back = NULL;
      vxm_status status = vxm_gridio_read(&back, context, path, &error);
      vxm_grid_destroy(back);
      if (status == VXM_OK)
        break;
      assert_int_equal(status, VXM_ERROR_CANCELLED);
      assert_null(back);
    }
    assert_true(stop > 0);
    empty_folder(folder);
  }
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  remove_folder(folder);
}

/** With every limit from too little to enough: the limit's own error, no file, and never more than the limit.
 */
static void test_memory_limit(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {8};
  vxm_space space = unit_space(100, 60, 60);
  for (int f = 0; f < ALL_FORMATS; f++) {
    char path[80];
    snprintf(path, sizeof path, "%s/g.%s", folder, all_formats[f]);
    bool done = false;
    for (uint64_t limit = 100 << 10; !done; limit += 20 << 10) {
      vxm_context *context = context_with(1, limit, NULL, NULL);
      vxm_error error = VXM_ERROR_INIT;
      vxm_grid *grid;
      if (vxm_grid_create(&grid, context, &space, &error) == VXM_OK) {
        fill_random(grid, &rng, 3);
        vxm_status status = write_as(grid, path, all_formats[f], &error);
        done = status == VXM_OK || status == VXM_ERROR_UNAVAILABLE;
        if (!done) {
          assert_int_equal(status, VXM_ERROR_MEMORY_LIMIT);
          assert_int_equal(error.code, VXM_ERROR_MEMORY_LIMIT);
          assert_int_equal(count_files(folder), 0);
        }
        vxm_grid_destroy(grid);
      } else
        assert_int_equal(error.code, VXM_ERROR_MEMORY_LIMIT);
      assert_true(vxm_context_peak_bytes(context) <= limit);
      vxm_context_destroy(context);
    }
    if (strcmp(all_formats[f], "png") == 0)
      continue;
    for (uint64_t limit = 20 << 10, ok = 0; !ok; limit += 20 << 10) {
      vxm_context *context = context_with(1, limit, NULL, NULL);
      vxm_error error = VXM_ERROR_INIT;
      vxm_grid *back = NULL;
      vxm_status status = vxm_gridio_read(&back, context, path, &error);
      ok = status == VXM_OK;
      assert_true(ok || status == VXM_ERROR_MEMORY_LIMIT);
      vxm_grid_destroy(back);
      vxm_context_destroy(context);
    }
    empty_folder(folder);
  }
  remove_folder(folder);
}

/** If the JSON cannot be written there is no grid either. */
static void test_pair_is_whole(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_grid *grid = new_grid(context, unit_space(3, 4, 5));
  char path[80], json[90];
  for (int f = 0; f < 2; f++) {
    snprintf(path, sizeof path, "%s/g.%s", folder, f ? "npy" : "raw");
    snprintf(json, sizeof json, "%s.json", path);
    assert_int_equal(mkdir(json, 0777), 0);
    vxm_error error = VXM_ERROR_INIT;
    assert_int_equal(vxm_gridio_write(grid, path, NULL, &error), VXM_ERROR_IO);
    assert_non_null(strstr(error.text, ".json"));
    assert_int_equal(count_files(folder), 1);
    assert_int_equal(rmdir(json), 0);
  }
  assert_int_equal(vxm_gridio_write(grid, path_in(folder, "no/g.rle"), NULL, NULL), VXM_ERROR_IO);
  /* A device has nothing beside it. */
  int before = access("/dev/null.json", F_OK);
  assert_int_equal(vxm_gridio_write(grid, "/dev/null", "npy", NULL), VXM_OK);
  assert_int_equal(access("/dev/null.json", F_OK), before);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  remove_folder(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_truncation),    cmocka_unit_test(test_mutation),
      cmocka_unit_test(test_refusals),      cmocka_unit_test(test_refused_binary),
      cmocka_unit_test(test_cancel),        cmocka_unit_test(test_memory_limit),
      cmocka_unit_test(test_pair_is_whole),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** NRRD files as other programs write them: types, byte orders, compression, transforms; and damaged ones. */
#include "config.h"
#include "grids.h"

#include "gridio/common/format.h"
#include "gridio/gridio.h"

#include <locale.h>
#include <math.h>
#ifdef HAVE_ZLIB
#include <zlib.h>
#endif

static vxm_status read_bytes(vxm_grid **grid, vxm_context *context, const void *data, size_t size,
                             vxm_error *error) {
  unsigned char *copy = malloc(size ? size : 1);
  assert_non_null(copy);
  memcpy(copy, data, size);
  vxm_input input = {.data = copy, .size = size, .name = "a.nrrd", .context = context};
  *grid = NULL;
  vxm_status status = vxm_format_nrrd.read(grid, &input, VXM_BITS_ANY, error);
  free(copy);
  return status;
}

/** A header and the values behind it, in `file`; returns the length. */
static size_t join(unsigned char *file, const char *header, const void *values, size_t size) {
  size_t length = strlen(header);
  memcpy(file, header, length);
  memcpy(file + length, values, size);
  return length + size;
}

static vxm_grid *must_read(vxm_context *context, const void *data, size_t size) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid;
  if (read_bytes(&grid, context, data, size, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_padding_clear(grid);
  return grid;
}

/* ---- Values ---- */

static void test_types(void **state) {
  (void)state;
  static const struct {
    const char *name;
    size_t size;
    bool is_float;
  } types[] = {{"uchar", 1, false},
               {"unsigned char", 1, false},
               {"int8", 1, false},
               {"signed char", 1, false},
               {"uint8_t", 1, false},
               {"short", 2, false},
               {"unsigned short int", 2, false},
               {"int32_t", 4, false},
               {"UINT", 4, false},
               {"long long", 8, false},
               {"uint64", 8, false},
               {"float", 4, true},
               {"double", 8, true}};
  enum { NX = 67, NY = 5, NZ = 3, COUNT = NX * NY * NZ };
  vxm_context *context = context_with(2, 0, NULL, NULL);
  vxm_rng rng = {11};
  for (size_t t = 0; t < sizeof types / sizeof types[0]; t++)
    for (int big = 0; big < 2; big++) {
      size_t size = types[t].size;
      unsigned char values[COUNT * 8] = {0}, file[COUNT * 8 + 300];
      for (size_t v = 0; v < COUNT; v++) {
        uint64_t choice = vxm_rng_below(&rng, 3);
        if (choice == 0)
          put_one(values + v * size, size, types[t].is_float, big);
        else if (choice == 1 && types[t].is_float) /* minus zero is zero */
          values[v * size + (big ? 0 : size - 1)] = 0x80;
      }
      char header[300];
      snprintf(header, sizeof header,
               "NRRD0001\nType: %s\r\n# by hand\ncontent: a: b\ndimension: 3\nsizes: %d %d %d\n"
               "encoding: raw\nendian: %s\nspacings: 1 2 3\naxis mins: 0 0 0\n\n",
               types[t].name, NX, NY, NZ, big ? "big" : "little");
      vxm_grid *grid = must_read(context, file, join(file, header, values, COUNT * size));
      assert_int_equal(grid->warnings.count, 0);
      for (size_t v = 0; v < COUNT; v++) {
        bool set = false;
        for (size_t b = 0; b < size; b++)
          set |= (values[v * size + b] & (types[t].is_float && b == (big ? 0 : size - 1) ? 0x7f : 0xff)) != 0;
        assert_int_equal(vxm_grid_get(grid, (int64_t)v % NX, (int64_t)v / NX % NY, (int64_t)v / (NX * NY)),
                         set);
      }
      vxm_grid_destroy(grid);
    }
  vxm_context_destroy(context);
}

/* ---- Transforms ---- */

typedef struct placed {
  const char *lines;
  double origin[3], size[3];
  int warnings;
} placed;

/** Sizes are 4 2 3. */
static const placed places[] = {
    {"", {0, 0, 0}, {1, 1, 1}, 2},
    {"spacings: 2 3 4\n", {0, 0, 0}, {2, 3, 4}, 1},
    {"spacings: 2 3 4\naxis mins: 1 1 1\n", {1, 1, 1}, {2, 3, 4}, 0},
    {"spacings: 2 3 4\naxis mins: 1 1 1\ncenterings: node node cell\n", {0, -0.5, 1}, {2, 3, 4}, 0},
    {"axis mins: 0 0 0\naxis maxs: 2 2 6\n", {0, 0, 0}, {0.5, 1, 2}, 0},
    {"axismins: 0 0 0\naxismaxs: 6 2 6\ncenters: node node node\n", {-1, -1, -1.5}, {2, 2, 3}, 0},
    {"space: left-posterior-superior\nspace directions: (2,0,0) (0,3,0) ( 0 , 0 , 4 )\n"
     "space origin: (1,1.5,2)\n",
     {0, 0, 0},
     {2, 3, 4},
     0},
    {"space dimension: 3\nspace directions: (2,0,0) (0,3,0) (0,0,4)\n", {0, 0, 0}, {2, 3, 4}, 1},
    /* The exact corner counts as long as the grid has not been moved. */
    {"space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (1e17,0,0)\nvoxmend_origin:=1e17 -0.5 -0.5\n",
     {1e17, -0.5, -0.5},
     {1, 1, 1},
     0},
    {"space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (9,0,0)\nvoxmend_origin:=-0.5 -0.5 -0.5\n",
     {8.5, -0.5, -0.5},
     {1, 1, 1},
     0},
    {"space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (9,0,0)\nvoxmend_origin:=nonsense\n",
     {8.5, -0.5, -0.5},
     {1, 1, 1},
     0},
};

static void test_transforms(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  for (size_t p = 0; p < sizeof places / sizeof places[0]; p++) {
    unsigned char values[24] = {0, 1}, file[600];
    char header[500];
    snprintf(header, sizeof header, "NRRD0005\ntype: uint8\ndimension: 3\n%ssizes: 4 2 3\nencoding: RAW\n\n",
             places[p].lines);
    vxm_grid *grid = must_read(context, file, join(file, header, values, sizeof values));
    assert_int_equal(grid->warnings.count, places[p].warnings);
    assert_memory_equal(grid->space.origin, places[p].origin, sizeof grid->space.origin);
    assert_memory_equal(grid->space.voxel_size, places[p].size, sizeof grid->space.voxel_size);
    assert_true(vxm_grid_count(grid) == 1 && vxm_grid_get(grid, 1, 0, 0));
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
}

/** Numbers have a point also where the host program has set a locale with a comma, if there is one here. */
static void test_locale(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_grid *grid = new_grid(context, (vxm_space){{2, 2, 2}, {0.1, 1e-7, 2.5e300}, {0.3, 0.25, 1e299}});
  const char *before = setlocale(LC_NUMERIC, NULL);
  char *kept = strdup(before);
  if (!setlocale(LC_NUMERIC, "de_DE.UTF-8"))
    print_message("no locale with a comma here\n");
  assert_int_equal(vxm_gridio_write(grid, path_in(folder, "a.nrrd"), NULL, NULL), VXM_OK);
  vxm_grid *back = NULL;
  assert_int_equal(vxm_gridio_read(&back, context, path_in(folder, "a.nrrd"), NULL), VXM_OK);
  setlocale(LC_NUMERIC, kept);
  free(kept);
  assert_memory_equal(&grid->space, &back->space, sizeof grid->space);
  vxm_grid_destroy(back);
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  remove_folder(folder);
}

/* ---- Refusals ---- */

typedef struct refused {
  const char *text;
  vxm_status status;
  int64_t offset;
  const char *words;
} refused;

#define HEAD "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n"

static const refused cases[] = {
    {"", VXM_ERROR_FORMAT, 0, "NRRD000"},
    {"NRRD0009\n\n", VXM_ERROR_FORMAT, 0, "NRRD000"},
    {"NRRD0004\ntype: uchar\n", VXM_ERROR_FORMAT, 21, "empty line"},
    {"NRRD0004\n\n", VXM_ERROR_FORMAT, 9, "are needed"},
    {"NRRD0004\ntype: block\n\n", VXM_ERROR_FORMAT, 9, "type"},
    {"NRRD0004\ndimension: 5\n\n", VXM_ERROR_FORMAT, 9, "three dimensions"},
    {"NRRD0004\ndimension: 4\nsizes: 3 2 2 2\n\n", VXM_ERROR_FORMAT, 22, "three dimensions"},
    {"NRRD0004\ntype: uchar\ndimension: 4\nsizes: 4 2 2 2\nencoding: raw\n\n", VXM_ERROR_FORMAT, 63,
     "RGBA-color"},
    {"NRRD0004\nsizes: 2 2\n\n", VXM_ERROR_FORMAT, 9, "three whole numbers"},
    {"NRRD0004\nsizes: 2 2 2 2\n\n", VXM_ERROR_FORMAT, 9, "three whole numbers"},
    {"NRRD0004\nsizes: 2 2 2.5\n\n", VXM_ERROR_FORMAT, 9, "three whole numbers"},
    {"NRRD0004\nsizes: 2 2 1e300\n\n", VXM_ERROR_FORMAT, 9, "three whole numbers"},
    {"NRRD0004\nsizes: 2 nan 2\n\n", VXM_ERROR_FORMAT, 9, "three whole numbers"},
    {"NRRD0004\nencoding: bzip2\n\n", VXM_ERROR_FORMAT, 9, "raw or gzip"},
    {"NRRD0004\nendian: middle\n\n", VXM_ERROR_FORMAT, 9, "little or big"},
    {"NRRD0004\ndata file: a.raw\n\n", VXM_ERROR_FORMAT, 9, "another file"},
    {"NRRD0004\nbyte skip: 7\n\n", VXM_ERROR_FORMAT, 9, "skipped"},
    {"NRRD0004\ntype: uchar\ntype: uchar\n\n", VXM_ERROR_FORMAT, 21, "repeated"},
    {"NRRD0004\nno colon here\n\n", VXM_ERROR_FORMAT, 9, "neither"},
    {"NRRD0004\nspace directions: (0,1,0) (1,0,0) (0,0,1)\n\n", VXM_ERROR_FORMAT, 9, "turned"},
    {"NRRD0004\nspace directions: (-1,0,0) (0,1,0) (0,0,1)\n\n", VXM_ERROR_FORMAT, 9, "mirrored"},
    {"NRRD0004\nspace directions: (1,0,0.1) (0,1,0) (0,0,1)\n\n", VXM_ERROR_FORMAT, 9, "turned"},
    {"NRRD0004\nspace directions: none (1,0,0) (0,1,0)\n\n", VXM_ERROR_FORMAT, 9, "vectors"},
    {"NRRD0004\nspace origin: 1 2 3\n\n", VXM_ERROR_FORMAT, 9, "vector"},
    {"NRRD0004\nspacings: 1 2\n\n", VXM_ERROR_FORMAT, 9, "spacings"},
    {"NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n", VXM_ERROR_FORMAT, 61, "endian"},
    {HEAD "\n1234567", VXM_ERROR_FORMAT, 69, "cut short"},
    {HEAD "spacings: 1 0 1\n\n12345678", VXM_ERROR_FORMAT, 34, "positive"},
    {HEAD "spacings: 1 nan 1\n\n12345678", VXM_ERROR_FORMAT, 34, "positive"},
    {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 -2 2\nencoding: raw\n\n", VXM_ERROR_FORMAT, 34, "-2"},
    {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2097152 1 1\nencoding: raw\n\n", VXM_ERROR_RANGE, 34,
     "1048576"},
    {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 1048576 1048576 1048576\nencoding: gzip\n\nabc",
     VXM_ERROR_FORMAT, 84, "cut short"},
};

static void test_refusals(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 1 << 20, NULL, NULL);
  for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
    vxm_error error = VXM_ERROR_INIT;
    vxm_grid *grid;
    vxm_status status = read_bytes(&grid, context, cases[c].text, strlen(cases[c].text), &error);
    if (status != cases[c].status || error.offset != cases[c].offset || !strstr(error.text, cases[c].words))
      fail_msg("case %zu: status %d, offset %lld: %s", c, (int)status, (long long)error.offset, error.text);
    assert_null(grid);
  }
  vxm_context_destroy(context);
}

/* ---- Compressed values ---- */

#ifdef HAVE_ZLIB
static size_t pack(unsigned char *to, size_t room, const unsigned char *from, size_t size, int wbits) {
  z_stream z = {.next_in = (unsigned char *)(uintptr_t)from, .avail_in = (unsigned)size};
  assert_int_equal(deflateInit2(&z, 6, Z_DEFLATED, wbits, 8, Z_DEFAULT_STRATEGY), Z_OK);
  z.next_out = to;
  z.avail_out = (unsigned)room;
  assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
  size_t used = room - z.avail_out;
  deflateEnd(&z);
  return used;
}

static const char gzip_head[] =
    "NRRD0004\ntype: float\nendian: little\ndimension: 3\nsizes: 100 71 33\nencoding: gzip\n"
    "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0.5,0.5,0.5)\n\n";

enum { PACKED = 100 * 71 * 33 };

/** The file of a random grid, to be freed. */
static unsigned char *packed_file(size_t *size, const vxm_grid *grid, int wbits) {
  unsigned char *values = calloc(PACKED, 4), *file = malloc(PACKED * 4);
  for (size_t v = 0; v < PACKED; v++)
    if (vxm_grid_get(grid, (int64_t)v % 100, (int64_t)v / 100 % 71, (int64_t)v / 7100))
      put_one(values + 4 * v, 4, true, false);
  *size = join(file, gzip_head, "", 0);
  *size += pack(file + *size, PACKED * 4 - *size, values, PACKED * 4, wbits);
  free(values);
  return file;
}

static void test_gzip(void **state) {
  (void)state;
  vxm_context *context = context_with(2, 0, NULL, NULL);
  vxm_rng rng = {12};
  vxm_grid *grid = new_grid(context, unit_space(100, 71, 33));
  fill_random(grid, &rng, 0);
  for (int kind = 0; kind < 2; kind++) { /* as gzip writes it, as zlib does */
    size_t size;
    unsigned char *file = packed_file(&size, grid, kind == 0 ? 16 + MAX_WBITS : MAX_WBITS);
    vxm_grid *back = must_read(context, file, size);
    assert_same_bits(grid, back);
    assert_memory_equal(&grid->space, &back->space, sizeof grid->space);
    vxm_grid_destroy(back);
    for (size_t cut = 0; cut < size - 8; cut += 1 + cut / 40) {
      vxm_error error = VXM_ERROR_INIT;
      assert_int_equal(read_bytes(&back, context, file, cut, &error), VXM_ERROR_FORMAT);
      assert_true(error.offset >= 0 && error.offset <= (int64_t)cut);
    }
    for (int round = 0; round < 300; round++) {
      size_t at = strlen(gzip_head) + vxm_rng_below(&rng, size - strlen(gzip_head));
      unsigned char bit = (unsigned char)(1u << vxm_rng_below(&rng, 8));
      file[at] ^= bit;
      vxm_error error = VXM_ERROR_INIT;
      if (read_bytes(&back, context, file, size, &error) == VXM_OK)
        vxm_grid_destroy(back);
      else
        assert_true(error.code == VXM_ERROR_FORMAT || error.code == VXM_ERROR_NUMBERS);
      file[at] ^= bit;
    }
    free(file);
  }
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
}

/** What zlib itself takes counts too. */
static void test_gzip_limit(void **state) {
  (void)state;
  vxm_context *writer = context_with(1, 0, NULL, NULL);
  vxm_rng rng = {13};
  vxm_grid *grid = new_grid(writer, unit_space(100, 71, 33));
  fill_random(grid, &rng, 3);
  size_t size;
  unsigned char *file = packed_file(&size, grid, 16 + MAX_WBITS);
  int too_little = 0;
  for (uint64_t limit = 10 << 10, ok = 0; !ok; limit += 10 << 10) {
    vxm_context *context = context_with(1, limit, NULL, NULL);
    vxm_error error = VXM_ERROR_INIT;
    vxm_grid *back;
    vxm_status status = read_bytes(&back, context, file, size, &error);
    ok = status == VXM_OK;
    too_little += !ok;
    assert_true(ok || (status == VXM_ERROR_MEMORY_LIMIT && error.code == status));
    assert_true(vxm_context_peak_bytes(context) <= limit);
    vxm_grid_destroy(back);
    vxm_context_destroy(context);
  }
  assert_true(too_little > 5);
  free(file);
  vxm_grid_destroy(grid);
  vxm_context_destroy(writer);
}
#else
static void test_gzip(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid;
  static const char text[] = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: gzip\n\n12345678";
  assert_int_equal(read_bytes(&grid, context, text, sizeof text - 1, &error), VXM_ERROR_UNAVAILABLE);
  assert_non_null(strstr(error.text, "zlib1g-dev"));
  vxm_context_destroy(context);
}

static void test_gzip_limit(void **state) {
  (void)state;
  skip();
}
#endif

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_types),    cmocka_unit_test(test_transforms), cmocka_unit_test(test_locale),
      cmocka_unit_test(test_refusals), cmocka_unit_test(test_gzip),       cmocka_unit_test(test_gzip_limit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

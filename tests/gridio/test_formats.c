/* SPDX-License-Identifier: BSD-3-Clause */
/** What is written comes back; what is written is what doc/formats.md and the published formats say. */
#include "grids.h"

#include <inttypes.h>
#include <math.h>

/** raw, rle, npy and nrrd keep everything bit for bit, in any number of threads. */
static void test_exact_round_trips(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {1};
  for (int round = 0; round < 60; round++) {
    vxm_context *context = context_with(1 + round % 3 * 3, 0, NULL, NULL);
    vxm_grid *grid = new_grid(context, random_space(&rng, round < 50 ? 140 : 70, false));
    fill_random(grid, &rng, round % KINDS);
    const char *names[] = {"g.raw", "g.rle", "g.npy", "g.nrrd"};
    for (int f = 0; f < 4; f++) {
      const char *path = path_in(folder, names[f]);
      write_grid(grid, path);
      assert_reads_back(grid, path);
    }
    vxm_grid_destroy(grid);
    vxm_context_destroy(context);
  }
  remove_folder(folder);
}

/** Transforms that test the text of the JSON: extremes, subnormals, negative zero, and random bits. */
static void test_transforms_bit_for_bit(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_rng rng = {2};
  for (int round = 0; round < 300; round++) {
    vxm_space space = unit_space(3, 2, 1);
    for (int a = 0; a < 3; a++) {
      uint64_t bits = vxm_rng_next(&rng);
      double value;
      memcpy(&value, &bits, sizeof value);
      static const double special[] = {-0.0, 5e-324, 1.7976931348623157e308, 0.1, -1e22, 3.0};
      if (round < 6)
        value = special[round];
      if (isfinite(value))
        space.origin[a] = value;
      if (isfinite(value) && value != 0)
        space.voxel_size[a] = fabs(value);
      if (!isfinite(space.origin[a] + 3 * space.voxel_size[a])) /* which no grid may */
        space.voxel_size[a] = 1;
    }
    vxm_grid *grid = new_grid(context, space);
    const char *names[] = {"g.raw", "g.rle", "g.npy", "g.nrrd"};
    for (int f = 0; f < 4; f++) {
      write_grid(grid, path_in(folder, names[f]));
      assert_reads_back(grid, path_in(folder, names[f]));
    }
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/* ---- binvox ---- */

/** A reader made from the published description alone. Returns D*D*D values in the file's order. */
static unsigned char *plain_binvox_reader(const char *path, int *d, double translate[3], double *scale) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  int version, d2, d3;
  assert_int_equal(fscanf(file, "#binvox %d\ndim %d %d %d\ntranslate %lf %lf %lf\nscale %lf\ndata", &version,
                          d, &d2, &d3, &translate[0], &translate[1], &translate[2], scale),
                   8);
  assert_int_equal(fgetc(file), '\n');
  assert_int_equal(version, 1);
  assert_true(*d == d2 && *d == d3);
  size_t total = (size_t)*d * (size_t)*d * (size_t)*d, at = 0;
  unsigned char *values = malloc(total);
  for (int value; (value = fgetc(file)) != EOF;) {
    int count = fgetc(file);
    assert_true(count >= 1 && (value == 0 || value == 1));
    assert_true(at + (size_t)count <= total);
    memset(values + at, value, (size_t)count);
    at += (size_t)count;
  }
  assert_int_equal(at, total);
  fclose(file);
  return values;
}

static void assert_near(double a, double b) {
  assert_true(fabs(a - b) <= 5e-9 * fabs(a) + 1e-300);
}

static void test_binvox(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {3};
  for (int round = 0; round < 40; round++) {
    vxm_context *context = context_with(1 + round % 2, 0, NULL, NULL);
    vxm_space space = random_space(&rng, 100, true);
    if (round % 3 == 0)
      space.dims[1] = space.dims[2] = space.dims[0];
    vxm_grid *grid = new_grid(context, space);
    fill_random(grid, &rng, round % KINDS);
    const char *path = path_in(folder, "g.binvox");
    write_grid(grid, path);

    int d;
    double translate[3], scale;
    unsigned char *values = plain_binvox_reader(path, &d, translate, &scale);
    vxm_grid *back = read_back(context, path);
    assert_int_equal(back->warnings.count, 0);
    assert_padding_clear(back);
    int64_t longest = 0;
    for (int a = 0; a < 3; a++) {
      longest = space.dims[a] > longest ? space.dims[a] : longest;
      assert_near(space.origin[a], translate[a]);
      assert_near(space.origin[a], back->space.origin[a]);
      assert_near(space.voxel_size[a], scale / d);
      assert_near(space.voxel_size[a], back->space.voxel_size[a]);
      assert_int_equal(back->space.dims[a], d);
    }
    assert_int_equal(d, longest);
    for (int x = 0; x < d; x++)
      for (int z = 0; z < d; z++)
        for (int y = 0; y < d; y++) {
          bool set = vxm_grid_get(grid, x, y, z);
          assert_int_equal(values[(x * d + z) * d + y], set);
          assert_int_equal(vxm_grid_get(back, x, y, z), set);
        }
    free(values);
    vxm_grid_destroy(back);
    vxm_grid_destroy(grid);
    vxm_context_destroy(context);
  }
  remove_folder(folder);
}

static vxm_grid *read_text(vxm_context *context, const char *folder, const char *name, const char *text,
                           size_t size) {
  save_file(path_in(folder, name), text, size);
  return read_back(context, path_in(folder, name));
}

#define TEXT(literal) (literal), sizeof(literal) - 1

static void test_binvox_tolerance(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);

  /* Keys in any order, comments, CRLF, no translate, an unknown key, a zero count, a byte too many. */
  vxm_grid *grid = read_text(context, folder, "a.binvox",
                             TEXT("#binvox 2\r\n# made by hand\r\nscale 4\r\ncolour red\r\ndim 2 2 2\r\n"
                                  "data\r\n\0\3\1\2\1\0\0\3\1"));
  assert_int_equal(vxm_grid_count(grid), 2);
  assert_true(vxm_grid_get(grid, 0, 1, 1) && vxm_grid_get(grid, 1, 0, 0));
  assert_true(grid->space.origin[0] == 0 && grid->space.voxel_size[2] == 2);
  assert_int_equal(vxm_grid_warning_count(grid), 3);
  vxm_grid_destroy(grid);

  /* Neither translate nor scale; content decides, not the name. */
  grid = read_text(context, folder, "b.npy", TEXT("#binvox 1\ndim 2 2 2\ndata\n\1\10"));
  assert_int_equal(vxm_grid_count(grid), 8);
  assert_true(grid->space.voxel_size[0] == 0.5);
  assert_int_equal(vxm_grid_warning_count(grid), 2);
  vxm_grid_destroy(grid);

  /* Different dims are x z y: one row of 3 along y in each of 2 planes of x. */
  grid = read_text(context, folder, "c.binvox",
                   TEXT("#binvox 1\ndim 2 1 3\ntranslate 1 2 3\nscale 6\ndata\n\0\3\1\1\0\2"));
  assert_int_equal(grid->space.dims[0], 2);
  assert_int_equal(grid->space.dims[1], 3);
  assert_int_equal(grid->space.dims[2], 1);
  assert_true(vxm_grid_get(grid, 1, 0, 0) && vxm_grid_count(grid) == 1);
  assert_true(grid->space.voxel_size[0] == 2 && grid->space.origin[2] == 3);
  assert_int_equal(vxm_grid_warning_count(grid), 1);
  vxm_grid_destroy(grid);

  /* As trimesh writes them; its places are told of, and not taken, since it hands on those of binvox too. */
  grid = read_text(
      context, folder, "d.binvox",
      TEXT("#binvox 1\n# generated in `trimesh`\ndim 2 2 2\ntranslate 1 2 3\nscale 6\ndata\n\1\10"));
  assert_true(grid->space.voxel_size[0] == 3 && grid->space.origin[2] == 3);
  assert_int_equal(vxm_grid_warning_count(grid), 1);
  assert_non_null(strstr(vxm_grid_warning(grid, 0), "trimesh"));
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  remove_folder(folder);
}

/* ---- Bytes ---- */

static void assert_file(const char *path, const char *bytes, size_t size) {
  size_t there;
  unsigned char *data = load_file(path, &there);
  assert_int_equal(there, size);
  assert_memory_equal(data, bytes, size);
  free(data);
}

/** Written out by hand: voxels (1,0,0), (2,1,0) and (0,1,1) of 3 x 2 x 2. */
static vxm_grid *tiny_grid(vxm_context *context) {
  vxm_grid *grid = new_grid(context, (vxm_space){{3, 2, 2}, {-1.5, 0.1, 2e-7}, {0.25, 0.25, 0.25}});
  vxm_grid_set(grid, 1, 0, 0, true);
  vxm_grid_set(grid, 2, 1, 0, true);
  vxm_grid_set(grid, 0, 1, 1, true);
  return grid;
}

static void test_expected_bytes(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_grid *grid = tiny_grid(context);
  write_grid(grid, path_in(folder, "t.binvox"));
  /* Padded to 3 x 3 x 3; y fastest, then z, then x: (0,1,1) is 4, (1,0,0) is 9, (2,1,0) is 19. */
  assert_file(path_in(folder, "t.binvox"),
              TEXT("#binvox 1\ndim 3 3 3\ntranslate -1.5 0.1 2e-07\nscale 0.75\ndata\n"
                   "\0\4\1\1\0\4\1\1\0\11\1\1\0\7"));
  write_grid(grid, path_in(folder, "t.raw"));
  /* x fastest: bits 1, 5 and 9 of 12. */
  assert_file(path_in(folder, "t.raw"), TEXT("\x22\x02"));
  assert_file(
      path_in(folder, "t.raw.json"),
      TEXT(
          "{\n  \"format\": \"voxmend raw\",\n  \"version\": 1,\n  \"dims\": [\n    3,\n    2,\n    2\n  ],\n"
          "  \"origin\": [\n    -1.5,\n    0.10000000000000001,\n    1.9999999999999999e-7\n  ],\n"
          "  \"voxel_size\": [\n    0.25,\n    0.25,\n    0.25\n  ],\n"
          "  \"order\": \"x fastest, then y, then z\",\n  \"bits\": \"least significant first\"\n}\n"));
  write_grid(grid, path_in(folder, "t.npy"));
  /* z fastest: (0,1,1) is 3, (1,0,0) is 4, (2,1,0) is 10. */
  assert_file(path_in(folder, "t.npy"),
              TEXT("\x93NUMPY\1\0\x76\0{'descr': '|b1', 'fortran_order': False, 'shape': (3, 2, 2), }"
                   "                                                       \n"
                   "\0\0\0\1\1\0\0\0\0\0\1\0"));
  write_grid(grid, path_in(folder, "t.rle"));
  assert_file(path_in(folder, "t.rle"),
              TEXT("VXMRLE1\n\3\0\0\0\0\0\0\0\2\0\0\0\0\0\0\0\2\0\0\0\0\0\0\0"
                   "\0\0\0\0\0\0\xf8\xbf\x9a\x99\x99\x99\x99\x99\xb9\x3f\x48\xaf\xbc\x9a\xf2\xd7\x8a\x3e"
                   "\0\0\0\0\0\0\xd0\x3f\0\0\0\0\0\0\xd0\x3f\0\0\0\0\0\0\xd0\x3f"
                   "\1\1\3\1\3\1\2"));
  write_grid(grid, path_in(folder, "t.nrrd"));
  assert_file(path_in(folder, "t.nrrd"),
              TEXT("NRRD0004\n# 1 where a voxel is set\ntype: uchar\ndimension: 3\nspace dimension: 3\n"
                   "sizes: 3 2 2\nspace directions: (0.25,0,0) (0,0.25,0) (0,0,0.25)\n"
                   "kinds: domain domain domain\ncenterings: cell cell cell\nencoding: raw\n"
                   "space origin: (-1.375,0.225,0.1250002)\nvoxmend_origin:=-1.5 0.1 2e-07\n\n"
                   "\0\1\0\0\0\1\0\0\0\1\0\0"));
  vxm_grid_destroy(grid);
  vxm_context_destroy(context);
  remove_folder(folder);
}

/** Runs of exactly 255, 256, 510 and 511 voxels, at the end and before it. */
static void test_long_runs(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  static const int64_t lengths[] = {254, 255, 256, 509, 510, 511};
  for (int l = 0; l < 6; l++)
    for (int tail = 0; tail < 2; tail++) {
      vxm_grid *grid = new_grid(context, unit_space(lengths[l] + tail, 1, 1));
      for (int64_t i = 0; i < lengths[l]; i++)
        vxm_grid_set(grid, i, 0, 0, true);
      const char *path = path_in(folder, "r.rle");
      write_grid(grid, path);
      size_t size;
      unsigned char *data = load_file(path, &size);
      /* No run of 0 first: a byte 0; then 255s, and the rest unless it is 0 and last. */
      size_t full = (size_t)(lengths[l] / 255), rest = (size_t)(lengths[l] % 255);
      assert_int_equal(size, 80 + 1 + full + (rest > 0 || tail) + (size_t)tail);
      free(data);
      assert_reads_back(grid, path);
      vxm_grid_destroy(grid);
    }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/* ---- npy ---- */

static void put_npy(const char *path, int version, const char *descr, bool fortran, const int64_t shape[3],
                    const void *data, size_t size) {
  char text[300];
  int length = snprintf(text, sizeof text,
                        "{'shape': (%" PRId64 ",%" PRId64 "L, %" PRId64
                        " ,),\"fortran_order\" : %s , 'descr': '%s'}  \n",
                        shape[0], shape[1], shape[2], fortran ? "True" : "False", descr);
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  fprintf(file, "\x93NUMPY%c%c%c%c", version, 0, length & 0xff, length >> 8);
  if (version > 1)
    fwrite("\0\0", 1, 2, file);
  fwrite(text, 1, (size_t)length, file);
  fwrite(data, 1, size, file);
  fclose(file);
}

/** All element types, both byte orders and both index orders, versions 1 to 3. */
static void test_npy_types(void **state) {
  (void)state;
  static const struct {
    const char *descr;
    size_t size;
  } types[] = {{"|b1", 1}, {"|u1", 1}, {"|i1", 1}, {"<i2", 2}, {">u2", 2}, {"<f2", 2}, {"<i4", 4},
               {"=u4", 4}, {"<f4", 4}, {">f4", 4}, {"<i8", 8}, {"<u8", 8}, {"<f8", 8}, {">f8", 8}};
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {4};
  for (size_t t = 0; t < sizeof types / sizeof types[0]; t++)
    for (int fortran = 0; fortran < 2; fortran++) {
      vxm_context *context = context_with(1 + fortran, 0, NULL, NULL);
      int64_t shape[3];
      for (int a = 0; a < 3; a++)
        shape[a] = random_side(&rng, 75);
      size_t count = (size_t)(shape[0] * shape[1] * shape[2]), size = types[t].size;
      unsigned char *data = calloc(count, size);
      bool is_float = types[t].descr[1] == 'f', big = types[t].descr[0] == '>';
      for (size_t e = 0; e < count; e++) {
        uint64_t choice = vxm_rng_below(&rng, 4);
        if (choice == 0)
          put_one(data + e * size, size, is_float, big);
        else if (choice == 1 && is_float) /* minus zero is zero */
          data[e * size + (big ? 0 : size - 1)] = 0x80;
      }
      const char *path = path_in(folder, "t.npy");
      put_npy(path, 1 + (int)(t % 3), types[t].descr, fortran, shape, data, count * size);
      vxm_grid *grid = read_back(context, path);
      assert_padding_clear(grid);
      assert_int_equal(vxm_grid_warning_count(grid), 1); /* no JSON */
      for (int64_t i = 0; i < shape[0]; i++)
        for (int64_t j = 0; j < shape[1]; j++)
          for (int64_t k = 0; k < shape[2]; k++) {
            int64_t e = fortran ? i + shape[0] * (j + shape[1] * k) : k + shape[2] * (j + shape[1] * i);
            bool set = false;
            for (size_t b = 0; b < size; b++) {
              unsigned char byte = data[(size_t)e * size + b];
              set |= is_float && b == (big ? 0 : size - 1) ? (byte & 0x7f) != 0 : byte != 0;
            }
            assert_int_equal(vxm_grid_get(grid, i, j, k), set);
          }
      free(data);
      vxm_grid_destroy(grid);
      vxm_context_destroy(context);
    }
  remove_folder(folder);
}

/** The JSON beside an array counts only if it is of this array. */
static void test_npy_sidecar(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_grid *grid = tiny_grid(context), *other = new_grid(context, unit_space(3, 2, 3));
  char path[80];
  snprintf(path, sizeof path, "%s/a.npy", folder);
  write_grid(grid, path);
  write_grid(other, path_in(folder, "b.npy"));
  static const char *const bad[] = {NULL, "{", "[]", "{\"format\": \"other\"}"};
  for (int b = -1; b < 4; b++) {
    if (b == -1)
      assert_int_equal(rename(path_in(folder, "b.npy.json"), path_in(folder, "a.npy.json")), 0);
    else if (bad[b])
      save_file(path_in(folder, "a.npy.json"), bad[b], strlen(bad[b]));
    else
      assert_int_equal(remove(path_in(folder, "a.npy.json")), 0);
    vxm_grid *back = read_back(context, path);
    assert_same_bits(grid, back);
    assert_true(back->space.origin[0] == 0 && back->space.voxel_size[0] == 1);
    assert_int_equal(vxm_grid_warning_count(back), 1);
    vxm_grid_destroy(back);
  }
  vxm_grid_destroy(grid);
  vxm_grid_destroy(other);
  vxm_context_destroy(context);
  remove_folder(folder);
}

/* ---- Choice of format ---- */

static void test_format_choice(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_grid *grid = tiny_grid(context);
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_gridio_write(grid, path_in(folder, "a.xyz"), NULL, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_gridio_write(grid, path_in(folder, "a"), NULL, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_gridio_write(grid, "-", NULL, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_gridio_write(grid, "-", "raw", &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(count_files(folder), 0);
  /* The format given wins over the extension, in any case. */
  assert_int_equal(vxm_gridio_write(grid, path_in(folder, "a.npy"), "RLE", &error), VXM_OK);
  assert_int_equal(count_files(folder), 1);
  assert_reads_back(grid, path_in(folder, "a.npy"));
  /* A raw grid whose voxels spell another format's first bytes is still a raw grid. */
  vxm_grid *spelt = new_grid(context, unit_space(64, 1, 1));
  memcpy(spelt->words, "VXMRLE1\n", 8);
  write_grid(spelt, path_in(folder, "s.RAW"));
  assert_reads_back(spelt, path_in(folder, "s.RAW"));
  vxm_grid_destroy(spelt);
  /* Voxels that are no cubes do not fit binvox; nothing is left behind. */
  empty_folder(folder);
  grid->space.voxel_size[1] *= 1 + 1e-8;
  assert_int_equal(vxm_gridio_write(grid, path_in(folder, "a.binvox"), NULL, &error), VXM_ERROR_ARGUMENT);
  assert_non_null(strstr(error.text, ".npy"));
  assert_int_equal(count_files(folder), 0);
  vxm_grid_destroy(grid);
  /* A rod would be padded without end. */
  vxm_grid *rod = new_grid(context, unit_space(VXM_DIM_MAX, 1, 1));
  assert_int_equal(vxm_gridio_write(rod, path_in(folder, "r.binvox"), NULL, &error), VXM_ERROR_RANGE);
  vxm_grid_destroy(rod);
  vxm_context_destroy(context);
  remove_folder(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_exact_round_trips),
      cmocka_unit_test(test_transforms_bit_for_bit),
      cmocka_unit_test(test_binvox),
      cmocka_unit_test(test_binvox_tolerance),
      cmocka_unit_test(test_expected_bytes),
      cmocka_unit_test(test_long_runs),
      cmocka_unit_test(test_npy_types),
      cmocka_unit_test(test_npy_sidecar),
      cmocka_unit_test(test_format_choice),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** The formats of games and artists: what .schem, .litematic and .vox hold comes back, whoever wrote it, and
 * hostile bytes end in an error. */
#include "grids.h"

#include "base/endian.h"
#include "config.h"
#include "gridio/common/format.h"
#include "gridio/formats/minecraft/block_colors.h"

#include <math.h>

#ifdef HAVE_ZLIB
#include <zlib.h>
static const vxm_grid_format *const formats[] = {&vxm_format_vox, &vxm_format_schem, &vxm_format_litematic};
#else
static const vxm_grid_format *const formats[] = {&vxm_format_vox};
#endif
enum { FORMATS = sizeof formats / sizeof formats[0] };

static const char *file_of(const char *folder, const vxm_grid_format *format) {
  char name[32];
  snprintf(name, sizeof name, "x.%s", format->name);
  return path_in(folder, name);
}

/* ---- Round trips ---- */

static void test_bits(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(2, 0, NULL, NULL);
  vxm_rng rng = {11};
  for (int round = 0; round < 60; round++) {
    vxm_space space = random_space(&rng, 40, false);
    if (round == 0) /* several models of .vox, and a last one of a voxel */
      space = (vxm_space){{513, 3, 257}, {1e9, -2.5, 1.0 / 3}, {0.1, 0.2, 1e-3}};
    vxm_grid *grid = new_grid(context, space);
    fill_random(grid, &rng, round % KINDS);
    for (int up = 0; up <= 3; up++)
      for (int f = 0; f < FORMATS; f++) {
        const char *path = file_of(folder, formats[f]);
        vxm_grid_write_options options = VXM_GRID_WRITE_OPTIONS_INIT;
        options.up = up;
        options.blocks = up == 1 ? "oak_log[axis=y,lit=true]" : NULL;
        vxm_error error = VXM_ERROR_INIT;
        if (vxm_gridio_write_with(grid, path, &options, &error) != VXM_OK)
          fail_msg("%s", error.text);
        assert_reads_back(grid, path);
      }
    vxm_grid_destroy(grid);
  }
  remove_folder(folder);
  vxm_context_destroy(context);
}

static vxm_field *make_field(vxm_context *context, const vxm_space *space, vxm_field_kind kind,
                             vxm_scalar scalar) {
  vxm_field *field;
  assert_int_equal(vxm_field_make(&field, context, space, kind, scalar, NULL), VXM_OK);
  field->about.is_declared = true;
  return field;
}

static void write_field(const vxm_field *field, const char *path) {
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_gridio_write_field(field, path, NULL, &error) != VXM_OK)
    fail_msg("%s", error.text);
}

static vxm_field *read_field(vxm_context *context, const char *path) {
  vxm_grid *grid;
  vxm_field *field;
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_gridio_read_either(&grid, &field, context, path, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_null(grid);
  assert_non_null(field);
  return field;
}

/** Up to as many labels as there are blocks; names and places come back, whichever type they had. */
static void test_labels(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_rng rng = {12};
  static const vxm_scalar scalars[] = {VXM_UINT8, VXM_UINT16, VXM_INT32, VXM_INT64};
  for (int round = 0; round < 24; round++) {
    vxm_space space = random_space(&rng, 24, false);
    vxm_field *field = make_field(context, &space, VXM_FIELD_LABELS, scalars[round % 4]);
    size_t size = vxm_scalar_bytes(field->scalar), count = vxm_field_count(field);
    memset(field->values, 0, count * size);
    for (size_t v = 0; v < count; v++) {
      uint64_t label = vxm_le64(vxm_rng_below(&rng, 2) ? vxm_rng_below(&rng, VXM_BLOCK_DYED + 1) : 0);
      memcpy(field->values + v * size, &label, size);
    }
    for (int label = 1; label <= 3; label++) {
      char name[32];
      snprintf(name, sizeof name, "part %d \xc3\xa4", label);
      assert_true(vxm_label_table_add(&field->about.table, context, name, 0));
    }
    field->style.up = round % 4;
    for (int f = 0; f < FORMATS; f++) {
      const char *path = file_of(folder, formats[f]);
      write_field(field, path);
      vxm_field *back = read_field(context, path);
      assert_int_equal(back->about.kind, VXM_FIELD_LABELS);
      assert_memory_equal(&back->space, &space, sizeof space);
      int64_t seen = 0;
      for (size_t v = 0; v < count; v++) {
        assert_int_equal(vxm_field_label(back, v), vxm_field_label(field, v));
        seen += vxm_field_label(back, v) == 2;
      }
      assert_int_equal(back->about.table.count, 3);
      assert_string_equal(vxm_label_table_name(&back->about.table, 2), "part 2 \xc3\xa4");
      assert_int_equal(back->about.table.voxels[1], seen);
      vxm_field_destroy(back);
    }
    vxm_field_destroy(field);
  }
  remove_folder(folder);
  vxm_context_destroy(context);
}

/** Colours of blocks are theirs exactly, and those of .vox are up to 255. */
static void test_colors(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_rng rng = {13};
  size_t blocks;
  const vxm_block_color *table = vxm_block_colors(&blocks);
  for (int round = 0; round < 12; round++) {
    vxm_space space = random_space(&rng, 24, false);
    vxm_field *field = make_field(context, &space, VXM_FIELD_COLORS, VXM_UINT8);
    size_t count = vxm_field_count(field);
    for (size_t v = 0; v < count; v++) {
      memcpy(field->values + 4 * v, table[vxm_rng_below(&rng, blocks)].rgb, 3);
      field->values[4 * v + 3] = vxm_rng_below(&rng, 3) ? 255 : 0;
    }
    for (int f = 0; f < FORMATS; f++) {
      const char *path = file_of(folder, formats[f]);
      write_field(field, path);
      vxm_field *back = read_field(context, path);
      assert_int_equal(back->about.kind, VXM_FIELD_COLORS);
      assert_memory_equal(&back->space, &space, sizeof space);
      for (size_t v = 0; v < count; v++) {
        const unsigned char *is = back->values + 4 * v, *was = field->values + 4 * v;
        assert_int_equal(is[3], was[3]);
        for (int c = 0; c < 3 && was[3]; c++) /* .vox makes one of colours that are much alike */
          assert_true(abs(is[c] - was[c]) <= (f == 0 ? 7 : 0));
      }
      vxm_field_destroy(back);
    }
    vxm_field_destroy(field);
  }
  remove_folder(folder);
  vxm_context_destroy(context);
}

/* ---- .vox of other programs ---- */

/** A file in the making. */
typedef struct bytes {
  unsigned char data[4096];
  size_t size;
} bytes;

static void put(bytes *b, const void *data, size_t size) {
  assert_true(b->size + size <= sizeof b->data);
  memcpy(b->data + b->size, data, size);
  b->size += size;
}

static void put_word(bytes *b, int32_t value) {
  for (int shift = 0; shift < 32; shift += 8)
    put(b, &(unsigned char){(unsigned char)((uint32_t)value >> shift)}, 1);
}

static void put_string(bytes *b, const char *text) {
  put_word(b, (int32_t)strlen(text));
  put(b, text, strlen(text));
}

static void put_chunk(bytes *b, const char *name, const bytes *content) {
  put(b, name, 4);
  put_word(b, (int32_t)content->size);
  put_word(b, 0);
  put(b, content->data, content->size);
}

static void put_model(bytes *b, const int size[3], const unsigned char (*voxels)[4], int count) {
  bytes c = {.size = 0};
  for (int a = 0; a < 3; a++)
    put_word(&c, size[a]);
  put_chunk(b, "SIZE", &c);
  c.size = 0;
  put_word(&c, count);
  put(&c, voxels, 4 * (size_t)count);
  put_chunk(b, "XYZI", &c);
}

static void put_transform(bytes *b, int number, int child, const char *turn, const char *step) {
  bytes c = {.size = 0};
  put_word(&c, number);
  put_word(&c, 1);
  put_string(&c, "_name");
  put_string(&c, "of another program");
  put_word(&c, child);
  put_word(&c, -1);
  put_word(&c, 0);
  put_word(&c, 1);
  put_word(&c, (turn != NULL) + (step != NULL));
  if (turn) {
    put_string(&c, "_r");
    put_string(&c, turn);
  }
  if (step) {
    put_string(&c, "_t");
    put_string(&c, step);
  }
  put_chunk(b, "nTRN", &c);
}

/** A group of these, or a shape of one model. */
static void put_node(bytes *b, const char *name, int number, const int *children, int count) {
  bytes c = {.size = 0};
  put_word(&c, number);
  put_word(&c, 0);
  put_word(&c, count);
  for (int i = 0; i < count; i++) {
    put_word(&c, children[i]);
    if (strcmp(name, "nSHP") == 0)
      put_word(&c, 0);
  }
  put_chunk(b, name, &c);
}

static bytes close_file_of(const bytes *chunks) {
  bytes file = {.size = 0};
  put(&file, "VOX ", 4);
  put_word(&file, 200);
  put(&file, "MAIN", 4);
  put_word(&file, 0);
  put_word(&file, (int32_t)chunks->size);
  put(&file, chunks->data, chunks->size);
  return file;
}

static vxm_status read_vox(vxm_grid **grid, vxm_field **field, vxm_context *context, const bytes *file,
                           vxm_error *error) {
  unsigned char *copy = malloc(file->size + 1); /* a block of this size, for sanitizers */
  memcpy(copy, file->data, file->size);
  vxm_input input = {.data = copy, .size = file->size, .name = "x.vox", .context = context};
  vxm_status status = grid ? vxm_format_vox.read(grid, &input, VXM_BITS_ANY, error)
                           : vxm_format_vox.read_field(field, &input, error);
  free(copy);
  return status;
}

/**
 * A bar along x, 3 x 1 x 1, that is turned a quarter about z (its x becomes y, its y becomes -x) and stands
 * at (10, 20, 30), beside one that is only moved, within a group that stands at (100, 0, 0).
 */
static bytes make_turned(void) {
  static const unsigned char bar[3][4] = {{0, 0, 0, 1}, {1, 0, 0, 1}, {2, 0, 0, 7}};
  bytes b = {.size = 0};
  put_model(&b, (const int[3]){3, 1, 1}, bar, 3);
  put_transform(&b, 0, 1, NULL, "100 0 0");
  put_node(&b, "nGRP", 1, (const int[]){2, 4}, 2);
  /* row 0 has its number in column 1, and it is -1; row 1 in column 0 */
  put_transform(&b, 2, 3, "17", "10 20 30");
  put_node(&b, "nSHP", 3, (const int[]){0}, 1);
  put_transform(&b, 4, 5, NULL, "0 0 0");
  put_node(&b, "nSHP", 5, (const int[]){0}, 1);
  return close_file_of(&b);
}

static void assert_color(const vxm_field *field, int x, int y, int z, const uint8_t expected[4]) {
  int64_t at[3] = {x, y, z};
  for (int a = 0; a < 3; a++)
    at[a] -= (int64_t)field->space.origin[a];
  assert_memory_equal(vxm_field_color(field, at[0], at[1], at[2]), expected, 4);
}

static void test_turns(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_field *field;
  bytes file = make_turned();
  assert_int_equal(read_vox(NULL, &field, context, &file, NULL), VXM_OK);
  /* Moved: the middle of 3 is 1, so that x is 99 to 101; y and z are 0. Turned: the voxel centres (-0.5,
   * 0.5, 1.5) - ... become y 19, 20 and 21 - 1/2 lower, and x, whose centre 1/2 becomes -1/2, is 109. */
  static const uint8_t first[4] = {255, 255, 255, 255}, seventh[4] = {255, 204, 255, 255},
                       none[4] = {0, 0, 0, 0};
  static const int size[3] = {11, 22, 31};
  for (int a = 0; a < 3; a++)
    assert_int_equal(field->space.dims[a], size[a]);
  assert_color(field, 99, 0, 0, first);
  assert_color(field, 101, 0, 0, seventh);
  assert_color(field, 109, 19, 30, first);
  assert_color(field, 109, 20, 30, first);
  assert_color(field, 109, 21, 30, seventh);
  assert_color(field, 108, 20, 30, none);
  int64_t voxels = 0;
  for (size_t v = 0; v < vxm_field_count(field); v++)
    voxels += field->values[4 * v + 3] != 0;
  assert_int_equal(voxels, 6);
  vxm_field_destroy(field);
  vxm_context_destroy(context);
}

/** Every turn of a model of three different sides keeps all voxels, in a box of these sides. */
static void test_all_turns(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  unsigned char voxels[2 * 3 * 4][4];
  int count = 0;
  for (int v = 0; v < 24; v++)
    if (v % 5 != 2) {
      const unsigned char voxel[4] = {(unsigned char)(v % 2), (unsigned char)(v / 2 % 3),
                                      (unsigned char)(v / 6), 9};
      memcpy(voxels[count++], voxel, 4);
    }
  for (int turn = 0; turn < 128; turn++) {
    int of[3] = {turn & 3, turn >> 2 & 3, 0}, sign[3];
    char text[16];
    bytes b = {.size = 0};
    vxm_grid *grid;
    snprintf(text, sizeof text, "%d", turn);
    put_model(&b, (const int[3]){2, 3, 4}, voxels, count);
    put_transform(&b, 0, 1, text, NULL);
    put_node(&b, "nSHP", 1, (const int[]){0}, 1);
    bytes file = close_file_of(&b);
    bool is_turn = of[0] < 3 && of[1] < 3 && of[0] != of[1];
    assert_int_equal(read_vox(&grid, NULL, context, &file, NULL), is_turn ? VXM_OK : VXM_ERROR_FORMAT);
    if (!is_turn)
      continue;
    of[2] = 3 - of[0] - of[1];
    for (int a = 0; a < 3; a++)
      sign[a] = turn >> (4 + a) & 1 ? -1 : 1;
    assert_int_equal(vxm_grid_count(grid), count);
    for (int v = 0; v < count; v++) {
      int64_t at[3];
      for (int a = 0; a < 3;
           a++) { /* by doubles: the centre about the middle, rounded down, which is turned */
        double centre = voxels[v][of[a]] + 0.5 - (2 + of[a]) / 2;
        at[a] = (int64_t)floor(sign[a] * centre) - (int64_t)grid->space.origin[a];
      }
      assert_true(vxm_grid_get(grid, at[0], at[1], at[2]));
    }
    vxm_grid_destroy(grid);
  }
  vxm_context_destroy(context);
}

static void expect_refused(vxm_context *context, const bytes *chunks, const char *why) {
  vxm_grid *grid;
  vxm_error error = VXM_ERROR_INIT;
  bytes file = close_file_of(chunks);
  vxm_status status = read_vox(&grid, NULL, context, &file, &error);
  if (status == VXM_OK || !strstr(error.text, why))
    fail_msg("\"%s\", not %s", error.text, why);
}

static void test_bad_scenes(void **state) {
  (void)state;
  static const unsigned char one[1][4] = {{0, 0, 0, 1}}, outside[1][4] = {{1, 0, 0, 1}};
  static const int unit[3] = {1, 1, 1};
  vxm_context *context = context_with(1, 64 << 20, NULL, NULL);
  bytes b = {.size = 0};
  expect_refused(context, &b, "no model");
  put_model(&b, unit, outside, 1);
  expect_refused(context, &b, "outside its model");
  b.size = 0;
  put_model(&b, unit, one, 1);
  size_t model = b.size;
  put_transform(&b, 0, 0, NULL, NULL);
  expect_refused(context, &b, "child of two, or of itself");
  b.size = model;
  put_transform(&b, 0, 5, NULL, NULL);
  expect_refused(context, &b, "not there");
  b.size = model;
  put_transform(&b, 0, 1, NULL, "9999999999 0 0");
  put_node(&b, "nSHP", 1, (const int[]){0}, 1);
  expect_refused(context, &b, "too far away");
  b.size = model;
  put_transform(&b, 0, 1, NULL, NULL);
  put_node(&b, "nSHP", 1, (const int[]){3}, 1);
  expect_refused(context, &b, "a model that is not there");
  b.size = model;
  put_node(&b, "nGRP", 0, (const int[]){1, 2}, 2); /* a box of 2^60 voxels for two */
  put_transform(&b, 1, 3, NULL, "-500000 -500000 -500000");
  put_transform(&b, 2, 4, NULL, "500000 500000 500000");
  put_node(&b, "nSHP", 3, (const int[]){0}, 1);
  put_node(&b, "nSHP", 4, (const int[]){0}, 1);
  expect_refused(context, &b, "");
  vxm_context_destroy(context);
}

/* ---- .glb ---- */

static uint32_t word_at(const unsigned char *data) {
  return (uint32_t)data[0] | (uint32_t)data[1] << 8 | (uint32_t)data[2] << 16 | (uint32_t)data[3] << 24;
}

/** The binary chunk: positions, normals, colours, indices. */
typedef struct surface {
  unsigned char *data;
  size_t quads;
  const unsigned char *positions, *normals, *indices;
  const char *text;
} surface;

static surface load_surface(const char *path, bool has_colors) {
  size_t size, each = 4 * (12 + 12 + (has_colors ? 8 : 0)) + 6 * 4;
  surface s = {.data = load_file(path, &size)};
  assert_memory_equal(s.data, "glTF", 4);
  assert_int_equal(word_at(s.data + 4), 2);
  assert_int_equal(word_at(s.data + 8), size);
  size_t text = word_at(s.data + 12);
  assert_int_equal(text % 4, 0);
  s.text = (const char *)s.data + 20;
  if (20 + text < size) {
    size_t length = word_at(s.data + 20 + text);
    assert_int_equal(20 + text + 8 + length, size);
    assert_int_equal(length % each, 0);
    s.quads = length / each;
    s.positions = s.data + 28 + text;
    s.normals = s.positions + s.quads * 4 * 12;
    s.indices = s.positions + length - s.quads * 6 * 4;
  }
  s.data[20 + text - 1] = '\0'; /* behind its last brace, or in place of it */
  return s;
}

/** The triangles of a part enclose as much as it has voxels, and turn as their normals say. */
static double measure(const surface *s, size_t begin, size_t end) {
  double volume = 0;
  for (size_t t = 2 * begin; t < 2 * end; t++) {
    double p[3][3], normal[3];
    for (int c = 0; c < 3; c++) {
      size_t vertex = 4 * begin + word_at(s->indices + 4 * (3 * t + (size_t)c));
      assert_true(vertex < 4 * end);
      for (size_t a = 0; a < 3; a++) {
        p[c][a] = vxm_load_f32(s->positions + 12 * vertex + 4 * a, vxm_must_swap(false));
        normal[a] = vxm_load_f32(s->normals + 12 * vertex + 4 * a, vxm_must_swap(false));
      }
    }
    double cross[3], toward = 0;
    for (int a = 0; a < 3; a++) {
      int b = (a + 1) % 3, c = (a + 2) % 3;
      cross[a] = (p[1][b] - p[0][b]) * (p[2][c] - p[0][c]) - (p[1][c] - p[0][c]) * (p[2][b] - p[0][b]);
      toward += cross[a] * normal[a];
      volume += cross[a] * p[0][a] / 6;
    }
    assert_true(toward > 0);
  }
  return volume;
}

static void test_glb(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_rng rng = {15};
  for (int round = 0; round < 30; round++) {
    vxm_space space = random_space(&rng, 20, false);
    vxm_grid *grid = new_grid(context, space);
    fill_random(grid, &rng, round % KINDS);
    const char *path = path_in(folder, "x.glb");
    write_grid(grid, path);
    surface s = load_surface(path, false);
    assert_int_equal(s.quads == 0, vxm_grid_count(grid) == 0);
    assert_float_equal(measure(&s, 0, s.quads), (double)vxm_grid_count(grid), 1e-6);
    free(s.data);
    vxm_field *field = make_field(context, &space, VXM_FIELD_COLORS, VXM_UINT8);
    for (size_t v = 0; v < vxm_field_count(field); v++) {
      const int64_t *n = space.dims;
      int64_t k = (int64_t)v % n[2], j = (int64_t)v / n[2] % n[1], i = (int64_t)v / n[2] / n[1];
      unsigned char *rgba = field->values + 4 * v;
      memset(rgba, 0, 4);
      if (vxm_grid_get(grid, i, j, k)) {
        rgba[vxm_rng_below(&rng, 3)] = 200;
        rgba[3] = 255;
      }
    }
    write_field(field, path);
    s = load_surface(path, true);
    assert_float_equal(measure(&s, 0, s.quads), (double)vxm_grid_count(grid), 1e-6);
    free(s.data);
    vxm_field_destroy(field);
    vxm_grid_destroy(grid);
  }
  remove_folder(folder);
  vxm_context_destroy(context);
}

/** The root's matrix has size, place and turn; labels are objects by name. */
static void test_glb_text(void **state) {
  (void)state;
  static const char *const matrices[] = {
      "[2.0,0.0,0.0,0.0,0.0,0.0,-4.0,0.0,0.0,8.0,0.0,0.0,10.0,30.0,-20.0,1.0]",
      "[0.0,2.0,0.0,0.0,0.0,0.0,4.0,0.0,8.0,0.0,0.0,0.0,30.0,10.0,20.0,1.0]",
      "[2.0,0.0,0.0,0.0,0.0,4.0,0.0,0.0,0.0,0.0,8.0,0.0,10.0,20.0,30.0,1.0]",
  };
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  const vxm_space space = {{3, 1, 1}, {10, 20, 30}, {2, 4, 8}};
  vxm_field *field = make_field(context, &space, VXM_FIELD_LABELS, VXM_UINT8);
  const unsigned char labels[3] = {2, 0, 1};
  memcpy(field->values, labels, sizeof labels);
  assert_true(vxm_label_table_add(&field->about.table, context, "the \"first\"", 0));
  for (int up = 0; up < 3; up++) {
    const char *path = path_in(folder, "x.glb");
    field->style.up = up;
    write_field(field, path);
    surface s = load_surface(path, false);
    assert_non_null(strstr(s.text, matrices[up]));
    assert_non_null(strstr(s.text, "\"name\":\"the \\\"first\\\"\""));
    assert_non_null(strstr(s.text, "\"name\":\"label 2\""));
    assert_int_equal(s.quads, 12);
    for (size_t part = 0; part < 2; part++)
      assert_float_equal(measure(&s, 6 * part, 6 * part + 6), 1, 1e-9);
    free(s.data);
  }
  vxm_field_destroy(field);
  remove_folder(folder);
  vxm_context_destroy(context);
}

/* ---- Hostile bytes ---- */

static vxm_status read_any(vxm_context *context, const vxm_grid_format *format, const unsigned char *data,
                           size_t size) {
  unsigned char *copy = malloc(size ? size : 1);
  memcpy(copy, data, size);
  vxm_input input = {.data = copy, .size = size, .name = "x", .context = context};
  vxm_grid *grid = NULL;
  vxm_field *field = NULL;
  vxm_error error = VXM_ERROR_INIT, other = VXM_ERROR_INIT;
  (void)(format->sniff && format->sniff(&input));
  vxm_status status = format->read(&grid, &input, VXM_BITS_ANY, &error);
  assert_int_equal(grid != NULL, status == VXM_OK);
  assert_int_equal(error.text[0] != '\0', status != VXM_OK);
  if (grid)
    assert_padding_clear(grid);
  vxm_status fields = format->read_field(&field, &input, &other);
  assert_int_equal(field != NULL, fields == VXM_OK);
  vxm_grid_destroy(grid);
  vxm_field_destroy(field);
  free(copy);
  return status;
}

static size_t mutate(unsigned char *data, size_t size, vxm_rng *rng) {
  for (uint64_t times = 1 + vxm_rng_below(rng, 4); times > 0; times--) {
    size_t at = vxm_rng_below(rng, size);
    switch (vxm_rng_below(rng, 4)) {
    case 0:
      data[at] ^= (unsigned char)(1u << vxm_rng_below(rng, 8));
      break;
    case 1:
      data[at] = (unsigned char)vxm_rng_next(rng);
      break;
    case 2: /* a huge length */
      for (size_t b = at; b < size && b < at + 4; b++)
        data[b] = vxm_rng_below(rng, 2) ? 0xff : 0x7f;
      break;
    default:
      size = size > 1 ? size - 1 - vxm_rng_below(rng, size / 2) : size;
    }
  }
  return size;
}

/** Cut at every byte, then changed anyhow. */
static void
attack(vxm_context *context, const vxm_grid_format *format, const unsigned char *data, size_t size,
       void (*pack)(unsigned char **packed, size_t *packed_size, const unsigned char *data, size_t size)) {
  enum { ROUNDS = 4000 };
  vxm_rng rng = {14};
  unsigned char *changed = malloc(size);
  for (size_t round = 0; round < size + ROUNDS; round++) {
    size_t left = round;
    memcpy(changed, data, size);
    if (round >= size)
      left = mutate(changed, size, &rng);
    unsigned char *packed = changed;
    size_t packed_size = left;
    if (pack)
      pack(&packed, &packed_size, changed, left);
    vxm_status status = read_any(context, format, packed, packed_size);
    assert_true(round >= size || status != VXM_OK);
    if (pack)
      free(packed);
  }
  free(changed);
}

#ifdef HAVE_ZLIB
static void pack_gzip(unsigned char **packed, size_t *packed_size, const unsigned char *data, size_t size) {
  z_stream z = {.next_in = (unsigned char *)data, .avail_in = (unsigned)size};
  assert_int_equal(deflateInit2(&z, 1, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
  size_t room = deflateBound(&z, size) + 64;
  z.next_out = *packed = malloc(room);
  z.avail_out = (unsigned)room;
  assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
  *packed_size = room - z.avail_out;
  deflateEnd(&z);
}

static unsigned char *unpack_gzip(const unsigned char *data, size_t size, size_t *out) {
  enum { MOST = 1 << 16 };
  unsigned char *plain = malloc(MOST);
  z_stream z = {
      .next_in = (unsigned char *)data, .avail_in = (unsigned)size, .next_out = plain, .avail_out = MOST};
  assert_int_equal(inflateInit2(&z, 15 + 32), Z_OK);
  assert_int_equal(inflate(&z, Z_FINISH), Z_STREAM_END);
  *out = MOST - z.avail_out;
  inflateEnd(&z);
  return plain;
}
#endif

static void test_hostile(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL), *bounded = context_with(1, 16 << 20, NULL, NULL);
  const vxm_space space = {{5, 4, 3}, {1, 2, 3}, {0.5, 0.5, 0.5}};
  vxm_field *field = make_field(context, &space, VXM_FIELD_LABELS, VXM_UINT8);
  for (size_t v = 0; v < 60; v++)
    field->values[v] = (unsigned char)(v % 4);
  assert_true(vxm_label_table_add(&field->about.table, context, "a part", 0));
  for (int f = 0; f < FORMATS; f++) {
    size_t size;
    const char *path = file_of(folder, formats[f]);
    write_field(field, path);
    unsigned char *data = load_file(path, &size);
    attack(bounded, formats[f], data, size, NULL);
#ifdef HAVE_ZLIB
    if (f > 0) { /* the tree within, packed again */
      size_t plain_size;
      unsigned char *plain = unpack_gzip(data, size, &plain_size);
      attack(bounded, formats[f], plain, plain_size, pack_gzip);
      free(plain);
    }
#endif
    free(data);
  }
  bytes turned = make_turned();
  attack(bounded, &vxm_format_vox, turned.data, turned.size, NULL);
  vxm_field_destroy(field);
  remove_folder(folder);
  vxm_context_destroy(bounded);
  vxm_context_destroy(context);
}

#ifdef HAVE_ZLIB
static void read_tree(vxm_context *context, const bytes *tree, vxm_status expected) {
  unsigned char *packed;
  size_t size;
  pack_gzip(&packed, &size, tree->data, tree->size);
  assert_int_equal(read_any(context, &vxm_format_schem, packed, size), expected);
  free(packed);
}

/** Lists in lists without end, elements without bytes, and little that unpacks to much. */
static void test_bombs(void **state) {
  (void)state;
  enum { ZEROS = 64 << 20 };
  vxm_context *context = context_with(1, 8 << 20, NULL, NULL);
  bytes tree = {.size = 0};
  put(&tree, "\x0a\0\0\x09\0\1x", 7);
  for (int depth = 0; depth < 600; depth++)
    put(&tree, "\x09\0\0\0\1", 5);
  read_tree(context, &tree, VXM_ERROR_FORMAT);
  tree.size = 0;
  put(&tree, "\x0a\0\0\x09\0\1x\0\x7f\xff\xff\xff\0", 13);
  read_tree(context, &tree, VXM_ERROR_FORMAT);
  tree.size = 0;
  put(&tree, "\x0a\0\0\x0b\0\1x\x7f\xff\xff\xff\0", 12);
  read_tree(context, &tree, VXM_ERROR_FORMAT);
  unsigned char *zeros = calloc(1, ZEROS), *packed;
  size_t size;
  memcpy(zeros, "\x0a\0\0", 3);
  pack_gzip(&packed, &size, zeros, ZEROS);
  assert_true(size < 1 << 20);
  assert_int_equal(read_any(context, &vxm_format_schem, packed, size), VXM_ERROR_MEMORY_LIMIT);
  free(packed);
  free(zeros);
  vxm_context_destroy(context);
}
#endif

/* ---- What is refused ---- */

static void test_refused(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(1, 0, NULL, NULL);
  vxm_space long_one = unit_space(70000, 1, 1), few = unit_space(2, 2, 2);
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid = new_grid(context, long_one);
  assert_int_equal(vxm_gridio_write(grid, path_in(folder, "x.schem"), NULL, &error), VXM_ERROR_RANGE);
  assert_non_null(strstr(error.text, "65535"));
  vxm_grid_destroy(grid);
  vxm_field *field = make_field(context, &few, VXM_FIELD_LABELS, VXM_UINT16);
  memset(field->values, 0, 16);
  field->values[1] = 4;
  assert_int_equal(vxm_gridio_write_field(field, path_in(folder, "x.vox"), NULL, &error), VXM_ERROR_RANGE);
  assert_non_null(strstr(error.text, "0 to 255"));
  static const char *const names[] = {"", "Stone", "stone,", "oak_log[axis", "minecraft:", "a b"};
  for (size_t n = 0; n < sizeof names / sizeof names[0]; n++) {
    vxm_grid_write_options options = VXM_GRID_WRITE_OPTIONS_INIT;
    options.blocks = names[n];
    vxm_status status = vxm_field_write(field, path_in(folder, "x.schem"), &options, &error);
    assert_int_equal(status, VXM_ERROR_ARGUMENT);
  }
  assert_int_equal(count_files(folder), 0);
  vxm_field_destroy(field);
  remove_folder(folder);
  vxm_context_destroy(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_bits),    cmocka_unit_test(test_labels),    cmocka_unit_test(test_colors),
      cmocka_unit_test(test_turns),   cmocka_unit_test(test_all_turns), cmocka_unit_test(test_bad_scenes),
      cmocka_unit_test(test_glb),     cmocka_unit_test(test_glb_text),  cmocka_unit_test(test_hostile),
#ifdef HAVE_ZLIB
      cmocka_unit_test(test_bombs),
#endif
      cmocka_unit_test(test_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

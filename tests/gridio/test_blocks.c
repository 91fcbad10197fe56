/* SPDX-License-Identifier: BSD-3-Clause */
/** The formats of games and artists: what .schem, .litematic and .vox hold comes back, whoever wrote it, and
 * hostile bytes end in an error. */
#include "vox_file.h"

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
  vox_bytes turned = make_turned();
  attack(bounded, &vxm_format_vox, turned.data, turned.size, NULL);
  vxm_field_destroy(field);
  remove_folder(folder);
  vxm_context_destroy(bounded);
  vxm_context_destroy(context);
}

#ifdef HAVE_ZLIB
static void read_tree(vxm_context *context, const vox_bytes *tree, vxm_status expected) {
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
  vox_bytes tree = {.size = 0};
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
      cmocka_unit_test(test_bits),    cmocka_unit_test(test_labels),
      cmocka_unit_test(test_colors),  cmocka_unit_test(test_hostile),
#ifdef HAVE_ZLIB
      cmocka_unit_test(test_bombs),
#endif
      cmocka_unit_test(test_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

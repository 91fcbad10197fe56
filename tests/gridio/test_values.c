/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers in files: they come back value for value, and become bits only where nothing is lost, or when told.
 */
#include "config.h"
#include "grids.h"

#include "gridio/common/format.h"
#include "gridio/gridio.h"

#include <math.h>
#ifdef HAVE_ZLIB
#include <zlib.h>
#endif

static const struct {
  vxm_scalar scalar;
  const char *name, *nrrd;
} types[] = {{VXM_FLOAT64, "f8", "double"}, {VXM_FLOAT32, "f4", "float"},  {VXM_FLOAT16, "f2", NULL},
             {VXM_UINT8, "u1", "uchar"},    {VXM_INT8, "i1", "int8"},      {VXM_UINT16, "u2", "ushort"},
             {VXM_INT16, "i2", "int16_t"},  {VXM_UINT32, "u4", "uint"},    {VXM_INT32, "i4", "signed int"},
             {VXM_UINT64, "u8", "uint64"},  {VXM_INT64, "i8", "long long"}};

enum { TYPES = sizeof types / sizeof types[0], NX = 37, NY = 41, NZ = 35, COUNT = NX * NY * NZ };

static const vxm_space space = {{NX, NY, NZ}, {-1.5, 0.1, 2e-7}, {0.25, 0.25, 0.25}};

/** Any bytes, but no number that is not one, which no comparison would find equal. */
static vxm_field *random_field(vxm_context *context, vxm_rng *rng, vxm_scalar scalar) {
  vxm_field *field;
  size_t size = vxm_scalar_bytes(scalar);
  unsigned char *values = malloc(COUNT * size);
  for (size_t b = 0; b < COUNT * size; b++)
    values[b] = (unsigned char)vxm_rng_next(rng);
  for (size_t v = 0; v < COUNT && vxm_scalar_is_float(scalar); v++)
    values[v * size + size - 1] &= 0xbf;
  assert_int_equal(vxm_field_create(&field, context, &space, VXM_FIELD_NUMBERS, scalar, values, NULL),
                   VXM_OK);
  free(values);
  return field;
}

static void assert_same_values(const vxm_field *a, const vxm_field *b) {
  assert_int_equal(a->scalar, b->scalar);
  assert_memory_equal(&a->space, &b->space, sizeof a->space);
  assert_memory_equal(a->values, b->values, vxm_field_count(a) * vxm_field_voxel_bytes(a));
}

/* ---- Files as other programs write them ---- */

/** The values as a file has them: x or z fastest, in either byte order; to be freed. */
static unsigned char *lay_out(const vxm_field *field, bool is_x_fast, bool is_big) {
  size_t size = vxm_scalar_bytes(field->scalar);
  unsigned char *out = malloc(COUNT * size);
  for (size_t x = 0; x < NX; x++)
    for (size_t y = 0; y < NY; y++)
      for (size_t z = 0; z < NZ; z++) {
        const unsigned char *from = field->values + ((x * NY + y) * NZ + z) * size;
        unsigned char *to = out + (is_x_fast ? (z * NY + y) * NX + x : (x * NY + y) * NZ + z) * size;
        for (size_t b = 0; b < size; b++)
          to[b] = from[is_big ? size - 1 - b : b];
      }
  return out;
}

static void put_file(const char *path, const char *head, size_t head_size, const void *data, size_t size) {
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(head, 1, head_size, file), head_size);
  assert_int_equal(fwrite(data, 1, size, file), size);
  assert_int_equal(fclose(file), 0);
}

static void put_npy(const char *path, const vxm_field *field, const char *type, bool is_fortran,
                    bool is_big) {
  unsigned char *data = lay_out(field, is_fortran, is_big);
  char head[200] = "\x93NUMPY\1\0\x96";
  memset(head + 10, ' ', 150);
  int length = snprintf(head + 10, 150, "{'descr': '%c%s', 'fortran_order': %s, 'shape': (%d, %d, %d)}",
                        is_big ? '>' : '<', type, is_fortran ? "True" : "False", NX, NY, NZ);
  head[10 + length] = ' ';
  put_file(path, head, 160, data, COUNT * vxm_scalar_bytes(field->scalar));
  free(data);
}

static void put_nrrd(const char *path, const vxm_field *field, const char *type, bool is_big,
                     bool is_packed) {
  size_t size = COUNT * vxm_scalar_bytes(field->scalar);
  unsigned char *data = lay_out(field, true, is_big);
  char head[400];
  int length = snprintf(head, sizeof head,
                        "NRRD0004\ntype: %s\ndimension: 3\nsizes: %d %d %d\nencoding: %s\nendian: %s\n"
                        "space directions: (0.25,0,0) (0,0.25,0) (0,0,0.25)\nspace origin: (0,0,0)\n"
                        "space units: \"mm\" \"mm\" \"mm\"\nmade by:=hand\n\n",
                        type, NX, NY, NZ, is_packed ? "gzip" : "raw", is_big ? "big" : "little");
#ifdef HAVE_ZLIB
  if (is_packed) {
    uLongf packed = compressBound(size);
    unsigned char *more = malloc(packed);
    assert_int_equal(compress(more, &packed, data, size), Z_OK);
    free(data);
    data = more;
    size = packed;
  }
#endif
  put_file(path, head, (size_t)length, data, size);
  free(data);
}

static void check_foreign(vxm_context *context, const char *path, const vxm_field *field) {
  vxm_field *back = read_field(context, path);
  vxm_grid *grid = NULL;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(back->scalar, field->scalar);
  assert_memory_equal(back->values, field->values, COUNT * vxm_scalar_bytes(field->scalar));
  assert_int_equal(vxm_gridio_read(&grid, context, path, &error), VXM_ERROR_NUMBERS);
  assert_non_null(strstr(error.text, vxm_scalar_name(field->scalar)));
  assert_non_null(strstr(error.text, "--threshold"));
  assert_non_null(strstr(error.text, "vxm_field_read"));
  assert_null(grid);
  vxm_field_destroy(back);
}

static void test_foreign(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {91};
  vxm_context *context = context_with(2, 0, NULL, NULL);
  for (int t = 0; t < TYPES; t++) {
    vxm_field *field = random_field(context, &rng, types[t].scalar);
    for (int form = 0; form < 4; form++) {
      put_npy(path_in(folder, "a.npy"), field, types[t].name, form & 1, form & 2);
      check_foreign(context, path_in(folder, "a.npy"), field);
    }
    for (int form = 0; form < (HAVE_ZLIB ? 4 : 2) && types[t].nrrd; form++) {
      put_nrrd(path_in(folder, "a.nrrd"), field, types[t].nrrd, form & 1, form & 2);
      check_foreign(context, path_in(folder, "a.nrrd"), field);
    }
    vxm_field_destroy(field);
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/* ---- There and back ---- */

static void test_round_trips(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {92};
  vxm_context *context = context_with(2, 0, NULL, NULL);
  for (int t = 0; t < TYPES; t++) {
    vxm_field *field = random_field(context, &rng, types[t].scalar);
    field->about.kind = VXM_FIELD_DISTANCE;
    field->about.is_declared = true;
    vxm_metadata_add(&field->about.pairs, context, "unit", 4, "mm", 2);
    write_field(field, path_in(folder, "a.npy"));
    vxm_field *npy = read_field(context, path_in(folder, "a.npy"));
    assert_same_values(field, npy);
    write_field(npy, path_in(folder, "a.nrrd"));
    vxm_field *nrrd = read_field(context, path_in(folder, "a.nrrd"));
    if (types[t].scalar != VXM_FLOAT16)
      assert_same_values(field, nrrd);
    else /* which NRRD does not have: floats of 32 bits, of the same value */
      for (size_t v = 0; v < COUNT; v++) {
        double was, is;
        vxm_field_doubles(&was, field, v, 1);
        vxm_field_doubles(&is, nrrd, v, 1);
        assert_true(was == is);
      }
    assert_int_equal(nrrd->about.kind, VXM_FIELD_DISTANCE);
    assert_string_equal(vxm_field_metadata_key(nrrd, 0), "unit");
    assert_string_equal(vxm_field_metadata_value(nrrd, 0), "mm");
    vxm_field_destroy(nrrd);
    vxm_field_destroy(npy);
    vxm_field_destroy(field);
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/** Whole numbers come back in their type from the floats of .vdb; what those do not hold is refused. */
static void test_vdb(void **state) {
  (void)state;
  const vxm_grid_format *vdb = &vxm_format_vdb;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {93};
  vxm_context *context = context_with(2, 0, NULL, NULL);
  vxm_error error = VXM_ERROR_INIT;
  if (vdb->writer->check(&space, "a.vdb", &error) == VXM_ERROR_UNAVAILABLE) {
    vxm_context_destroy(context);
    remove_folder(folder);
    skip();
  }
  for (int t = 0; t < TYPES; t++) {
    vxm_field *field = random_field(context, &rng, types[t].scalar);
    size_t size = vxm_scalar_bytes(types[t].scalar);
    if (size < 4 || types[t].scalar == VXM_FLOAT32) {
      for (size_t v = 0; v < COUNT && types[t].scalar == VXM_FLOAT16; v++) /* -0 is 0 where all around are */
        field->values[2 * v + 1] |= 1;
      write_field(field, path_in(folder, "a.vdb"));
      vxm_field *back = read_field(context, path_in(folder, "a.vdb"));
      assert_same_values(field, back);
      vxm_field_destroy(back);
    } else {
      assert_int_equal(vxm_gridio_write_field(field, path_in(folder, "no.vdb"), NULL, &error),
                       VXM_ERROR_RANGE);
      assert_non_null(strstr(error.text, "32-bit floats"));
      assert_true(access(path_in(folder, "no.vdb"), F_OK) != 0);
    }
    vxm_field_destroy(field);
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/** Labels in .binvox, of a box that is padded there: its dims come back from the .json. */
static void test_binvox(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {94};
  vxm_context *context = context_with(2, 0, NULL, NULL);
  vxm_field *field = random_field(context, &rng, VXM_UINT8);
  field->about.kind = VXM_FIELD_LABELS;
  assert_true(vxm_label_table_add(&field->about.table, context, "a \"name\"", 7));
  assert_true(vxm_label_table_add(&field->about.table, context, "", 0));
  write_field(field, path_in(folder, "a.binvox"));
  vxm_field *back = read_field(context, path_in(folder, "a.binvox"));
  assert_memory_equal(back->space.dims, space.dims, sizeof space.dims);
  assert_same_values(field, back);
  assert_int_equal(vxm_field_label_count(back), 2);
  assert_string_equal(vxm_field_label_name(back, 1), "a \"name\"");
  assert_string_equal(vxm_field_label_name(back, 3), "");
  vxm_field_destroy(back);
  assert_int_equal(remove(path_in(folder, "a.binvox.json")), 0);
  back = read_field(context, path_in(folder, "a.binvox"));
  assert_true(back->space.dims[0] == NY && back->space.dims[2] == NY);
  assert_int_equal(back->values[(5 * NY + 6) * NY + 7], field->values[(5 * NY + 6) * NZ + 7]);
  vxm_field_destroy(back);
  field->about.kind = VXM_FIELD_CONFIDENCE;
  assert_int_equal(vxm_gridio_write_field(field, path_in(folder, "b.binvox"), NULL, NULL),
                   VXM_ERROR_ARGUMENT);
  vxm_field_destroy(field);
  vxm_context_destroy(context);
  remove_folder(folder);
}

static void test_colors(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {95};
  vxm_context *context = context_with(2, 0, NULL, NULL);
  unsigned char *values = malloc(COUNT * 4);
  for (size_t b = 0; b < COUNT * 4; b++)
    values[b] = (unsigned char)vxm_rng_next(&rng);
  vxm_field *field;
  assert_int_equal(vxm_field_create(&field, context, &space, VXM_FIELD_COLORS, VXM_UINT8, values, NULL),
                   VXM_OK);
  free(values);
  for (int f = 0; f < 2; f++) {
    const char *path = path_in(folder, f == 0 ? "a.npy" : "a.nrrd");
    write_field(field, path);
    vxm_field *back = read_field(context, path);
    vxm_grid *grid;
    assert_int_equal(back->channels, 4);
    assert_same_values(field, back);
    assert_int_equal(vxm_gridio_read(&grid, context, path, NULL), VXM_ERROR_NUMBERS);
    vxm_field_destroy(back);
  }
  assert_int_equal(vxm_gridio_write_field(field, path_in(folder, "a.vdb"), NULL, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_gridio_write_field(field, path_in(folder, "a.rle"), NULL, NULL), VXM_ERROR_ARGUMENT);
  vxm_field_destroy(field);
  vxm_context_destroy(context);
  remove_folder(folder);
}

/* ---- What is bits ---- */

typedef struct mask {
  vxm_scalar scalar;
  vxm_field_kind kind;
  double values[3]; /**< that occur */
  bool is_any, is_stored;
} mask;

static const mask masks[] = {
    {VXM_UINT8, VXM_FIELD_NUMBERS, {0, 1, 1}, true, true},
    {VXM_UINT8, VXM_FIELD_NUMBERS, {1, 1, 1}, true, true},
    {VXM_UINT8, VXM_FIELD_NUMBERS, {0, 0, 0}, true, true},
    {VXM_UINT8, VXM_FIELD_NUMBERS, {0, 255, 255}, true, false},
    {VXM_UINT8, VXM_FIELD_NUMBERS, {255, 255, 255}, false, false},
    {VXM_UINT8, VXM_FIELD_NUMBERS, {0, 1, 255}, false, false},
    {VXM_UINT8, VXM_FIELD_NUMBERS, {0, 2, 2}, false, false},
    {VXM_UINT8, VXM_FIELD_LABELS, {0, 1, 1}, true, false},
    {VXM_UINT8, VXM_FIELD_COVERAGE, {0, 255, 255}, true, false},
    {VXM_UINT8, VXM_FIELD_COVERAGE, {0, 127, 255}, false, false},
    {VXM_UINT8, VXM_FIELD_CONFIDENCE, {0, 255, 255}, false, false},
    {VXM_INT8, VXM_FIELD_NUMBERS, {0, 1, 1}, true, false},
    {VXM_INT8, VXM_FIELD_NUMBERS, {0, -1, -1}, false, false},
    {VXM_UINT16, VXM_FIELD_NUMBERS, {0, 1, 1}, true, false},
    {VXM_UINT16, VXM_FIELD_NUMBERS, {0, 255, 255}, false, false},
    {VXM_INT64, VXM_FIELD_NUMBERS, {0, 1, 1}, true, false},
    {VXM_INT64, VXM_FIELD_NUMBERS, {0, -1, 1}, false, false},
    {VXM_FLOAT32, VXM_FIELD_NUMBERS, {0, 1, -0.0}, true, false},
    {VXM_FLOAT32, VXM_FIELD_NUMBERS, {0, 1, -1}, false, false},
    {VXM_FLOAT32, VXM_FIELD_NUMBERS, {0, 1, 0.5}, false, false},
    {VXM_FLOAT32, VXM_FIELD_NUMBERS, {0, 1, NAN}, false, false},
    {VXM_FLOAT32, VXM_FIELD_DISTANCE, {0, 1, 1}, false, false},
    {VXM_FLOAT64, VXM_FIELD_NUMBERS, {0, 1, 1}, true, false},
};

static void put_number(unsigned char *to, vxm_scalar scalar, double value) {
  float f = (float)value;
  int64_t whole = isnan(value) ? 0 : (int64_t)value;
  if (scalar == VXM_FLOAT32)
    memcpy(to, &f, 4);
  else if (scalar == VXM_FLOAT64)
    memcpy(to, &value, 8);
  else
    memcpy(to, &whole, vxm_scalar_bytes(scalar)); /* on machines whose first byte is the lowest */
}

static vxm_field *field_of(vxm_context *context, const mask *m) {
  const vxm_space small = unit_space(70, 3, 5);
  enum { SMALL = 70 * 3 * 5 };
  unsigned char values[SMALL * 8];
  vxm_field *field;
  for (size_t v = 0; v < SMALL; v++)
    put_number(values + v * vxm_scalar_bytes(m->scalar), m->scalar, m->values[v * v % 3]);
  put_number(values + (SMALL - 1) * vxm_scalar_bytes(m->scalar), m->scalar, m->values[2]);
  assert_int_equal(vxm_field_create(&field, context, &small, m->kind, m->scalar, values, NULL), VXM_OK);
  return field;
}

static void check_mask(vxm_context *context, const mask *m, size_t number, const char *path) {
  vxm_field *field = field_of(context, m), *back = NULL;
  vxm_grid *grid = NULL, *stored = NULL;
  write_field(field, path);
  vxm_status status = vxm_gridio_read(&grid, context, path, NULL);
  if (status != (m->is_any ? VXM_OK : VXM_ERROR_NUMBERS) || vxm_field_is_mask(field) != m->is_any)
    fail_msg("case %zu, %s: status %d", number, path, (int)status);
  for (size_t v = 0; v < vxm_field_count(field) && grid; v++) {
    double value;
    vxm_field_doubles(&value, field, v, 1);
    assert_int_equal(vxm_grid_get(grid, (int64_t)v / 15, (int64_t)v / 5 % 3, (int64_t)v % 5), value != 0);
  }
  assert_int_equal(vxm_gridio_read_either(&stored, &back, context, path, NULL), VXM_OK);
  if ((stored != NULL) != m->is_stored || (back != NULL) == m->is_stored)
    fail_msg("case %zu, %s: %s", number, path, stored ? "taken for bits" : "not taken for bits");
  vxm_grid_destroy(grid);
  vxm_grid_destroy(stored);
  vxm_field_destroy(back);
  vxm_field_destroy(field);
}

static void test_masks(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_context *context = context_with(2, 0, NULL, NULL);
  for (size_t m = 0; m < sizeof masks / sizeof masks[0]; m++) {
    check_mask(context, &masks[m], m, path_in(folder, "a.npy"));
    check_mask(context, &masks[m], m, path_in(folder, "a.nrrd"));
  }
  vxm_context_destroy(context);
  remove_folder(folder);
}

/* ---- The threshold ---- */

static void test_threshold(void **state) {
  (void)state;
  vxm_context *context = context_with(2, 0, NULL, NULL);
  const vxm_space row = unit_space(1, 1, 8);
  const float values[8] = {-1, -0.0f, 0, 0.5f, 1, INFINITY, -INFINITY, NAN};
  enum { WHOLE = sizeof(vxm_threshold_options) };
  static const struct {
    vxm_threshold_options options;
    unsigned bits; /**< of the values */
  } cases[] = {{{WHOLE, true, 0, false, 0}, 0x3c},         {{WHOLE, false, 0, true, 0}, 0x43},
               {{WHOLE, true, 0.5, false, 0}, 0x38},       {{WHOLE, false, 0, true, 0.5}, 0x47},
               {{WHOLE, true, -1, true, 1}, 0x0f},         {{WHOLE, true, 1, true, 1}, 0x00},
               {{WHOLE, true, -INFINITY, false, 0}, 0x7f}, {{WHOLE, false, 0, true, INFINITY}, 0x5f}};
  vxm_field *field;
  vxm_grid *grid;
  assert_int_equal(vxm_field_create(&field, context, &row, VXM_FIELD_DISTANCE, VXM_FLOAT32, values, NULL),
                   VXM_OK);
  for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
    assert_int_equal(vxm_field_threshold(&grid, field, &cases[c].options, NULL), VXM_OK);
    for (int64_t v = 0; v < 8; v++)
      if (vxm_grid_get(grid, 0, 0, v) != (cases[c].bits >> v & 1))
        fail_msg("case %zu, value %g", c, (double)values[v]);
    assert_int_equal(vxm_grid_warning_count(grid), 1); /* NaN */
    vxm_grid_destroy(grid);
  }
  vxm_threshold_options none = VXM_THRESHOLD_OPTIONS_INIT, nan = {1, true, NAN, false, 0};
  assert_int_equal(vxm_field_threshold(&grid, field, &none, NULL), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_field_threshold(&grid, field, &nan, NULL), VXM_ERROR_ARGUMENT);
  vxm_field_range range = VXM_FIELD_RANGE_INIT;
  assert_int_equal(vxm_field_measure(&range, field, NULL), VXM_OK);
  assert_true(range.min == -INFINITY && range.max == INFINITY && range.not_numbers == 1);
  vxm_field_destroy(field);
  vxm_context_destroy(context);
}

/** Neighbours of 2^53 and beyond, which a double rounds together; and bounds beyond all of them. */
static void test_long_threshold(void **state) {
  (void)state;
  vxm_context *context = context_with(1, 0, NULL, NULL);
  const vxm_space row = unit_space(1, 1, 5);
  const uint64_t whole[5] = {0, (UINT64_C(1) << 60) - 1, UINT64_C(1) << 60, (UINT64_C(1) << 60) + 1,
                             UINT64_MAX};
  const int64_t with_sign[5] = {INT64_MIN, -(INT64_C(1) << 60) - 1, -(INT64_C(1) << 60), 0, INT64_MAX};
  static const struct {
    double bound;
    unsigned whole, with_sign; /* those that are at least the bound */
  } cases[] = {{0x1p60, 0x1c, 0x10},    {-0x1p60, 0x1f, 0x1c}, {0.5, 0x1e, 0x10}, {-0.5, 0x1f, 0x18},
               {0x1p63, 0x10, 0},       {-0x1p63, 0x1f, 0x1f}, {0x1p64, 0, 0},    {INFINITY, 0, 0},
               {-INFINITY, 0x1f, 0x1f}, {-1e300, 0x1f, 0x1f}};
  vxm_field *fields[2];
  vxm_grid *grid;
  assert_int_equal(vxm_field_create(&fields[0], context, &row, VXM_FIELD_LABELS, VXM_UINT64, whole, NULL),
                   VXM_OK);
  assert_int_equal(vxm_field_create(&fields[1], context, &row, VXM_FIELD_LABELS, VXM_INT64, with_sign, NULL),
                   VXM_OK);
  for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++)
    for (int f = 0; f < 2; f++)
      for (int below = 0; below < 2; below++) {
        const vxm_threshold_options options = {sizeof(vxm_threshold_options), !below, cases[c].bound, below,
                                               cases[c].bound};
        unsigned bits = f == 0 ? cases[c].whole : cases[c].with_sign;
        assert_int_equal(vxm_field_threshold(&grid, fields[f], &options, NULL), VXM_OK);
        for (int64_t v = 0; v < 5; v++)
          if (vxm_grid_get(grid, 0, 0, v) != ((bits >> v & 1) != (unsigned)below))
            fail_msg("case %zu, field %d, value %lld", c, f, (long long)v);
        vxm_grid_destroy(grid);
      }
  vxm_field_destroy(fields[0]);
  vxm_field_destroy(fields[1]);
  vxm_context_destroy(context);
}

/* ---- Limits ---- */

/** From too little memory to enough: its own error, no file, and all is given back. */
static void test_memory_limit(void **state) {
  (void)state;
  char folder[64];
  make_folder(folder);
  vxm_rng rng = {96};
  vxm_context *writer = context_with(1, 0, NULL, NULL);
  vxm_field *field = random_field(writer, &rng, VXM_FLOAT32);
  write_field(field, path_in(folder, "a.npy"));
  vxm_field_destroy(field);
  int too_little = 0;
  for (uint64_t limit = 20 << 10, ok = 0; !ok; limit += 20 << 10) {
    vxm_context *context = context_with(1, limit, NULL, NULL);
    size_t left = vxm_memory_left(context);
    vxm_grid *grid = NULL;
    field = NULL;
    vxm_status status = vxm_gridio_read_either(&grid, &field, context, path_in(folder, "a.npy"), NULL);
    if (status == VXM_OK)
      status = vxm_gridio_write_field(field, path_in(folder, "b.nrrd"), NULL, NULL);
    ok = status == VXM_OK;
    too_little += !ok;
    assert_true(ok || status == VXM_ERROR_MEMORY_LIMIT);
    assert_int_equal(access(path_in(folder, "b.nrrd"), F_OK) == 0, (int)ok);
    vxm_field_destroy(field);
    assert_int_equal(vxm_memory_left(context), left);
    vxm_context_destroy(context);
  }
  assert_true(too_little > 5);
  vxm_context_destroy(writer);
  remove_folder(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_foreign),      cmocka_unit_test(test_round_trips),
      cmocka_unit_test(test_vdb),          cmocka_unit_test(test_binvox),
      cmocka_unit_test(test_colors),       cmocka_unit_test(test_masks),
      cmocka_unit_test(test_threshold),    cmocka_unit_test(test_long_threshold),
      cmocka_unit_test(test_memory_limit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

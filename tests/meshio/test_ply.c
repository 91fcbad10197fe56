/* SPDX-License-Identifier: BSD-3-Clause */
/** PLY: headers, layouts of every kind in text and both byte orders, strips, and damage. */
#include "meshio_test.h"

#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define LIST "property list uchar int vertex_indices\n"
#define HEADER "ply\nformat ascii 1.0\nelement vertex 4\n" XYZ "element face 2\n" LIST "end_header\n"
#define BODY "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 3 2 1 0\n"

static void expect_square(const vxm_soup *soup) {
  expect_counts(soup, 4, 2);
  expect_vertex(soup, 2, 1.0, 1.0, 0.0);
  expect_face(soup, 0, 3, 0, 1, 2);
  expect_face(soup, 1, 4, 3, 2, 1, 0);
}

/** Turns the line ends of a text into others. */
static char *with_newlines(const char *text, const char *newline) {
  bytes b = {0};
  for (; *text; text++)
    if (*text == '\n')
      bytes_text(&b, "%s", newline);
    else
      bytes_add(&b, text, 1);
  bytes_add(&b, "", 1);
  return (char *)b.data;
}

static void test_text(void **state) {
  (void)state;
  static const char *const texts[] = {
      HEADER BODY,
      "ply\ncomment format binary\nformat ascii 1.0\nobj_info element face 9\nelement vertex 4\n" XYZ
      "comment between\n\nelement face 2\nproperty list uint8 uint32 vertex_index\nend_header\n" BODY,
      /* Faces before vertices, an element before, between and behind. */
      "ply\nformat ascii 1.0\nelement a 2\nproperty list uchar float w\nproperty char c\nelement face "
      "2\n" LIST "element b 1\nproperty int i\nelement vertex 4\n" XYZ
      "element c 1\nproperty int i\nend_header\n"
      "2 .5 .6 7\n0 8\n3 0 1 2\n4 3 2 1 0\n9\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n7\n",
      /* Coordinates in another order, among other properties and lists. */
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty uchar red\nproperty double z\nproperty list int int "
      "l\n"
      "property double x\nproperty double y\nproperty float q\nelement face 2\nproperty uchar red\n"
      "property list uchar float uv\n" LIST "property list uchar float w\nproperty int k\nend_header\n"
      "9 0 0 0 0 5\n9 0 1 7 1 0 5\n9 0 2 7 8 1 1 5\n9 0 0 0 1 5\n7 1 .5 3 0 1 2 2 .1 .2 6\n7 0 4 3 2 1 0 0 "
      "6\n",
      /* Lines broken, and all on one line. */
      HEADER "0 0\n0 1 0\n0\n1 1 0 0 1 0\n3\n0 1 2 4\n3 2 1\n0\n",
      HEADER "0 0 0 1 0 0 1 1 0 0 1 0 3 0 1 2 4 3 2 1 0",
      HEADER "\n  0 0 0  \n\n1 0 0\n1 1 0\n0 1 0\n\n3 0 1 2 \n4 3 2 1 0",
      /* An element without properties takes no line. */
      "ply\nformat ascii 1.0\nelement none 5\nelement vertex 4\n" XYZ "element face 2\n" LIST
      "end_header\n" BODY,
  };
  static const char *const newlines[] = {"\n", "\r\n", "\r"};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    for (int k = 0; k < 3; k++) {
      char *text = with_newlines(texts[i], newlines[k]);
      vxm_soup *soup = read_text(text, "x.ply");
      expect_square(soup);
      expect_no_warnings(soup);
      assert_string_equal(soup->format, "ply ascii");
      vxm_soup_destroy(soup);
      free(text);
    }
}

static void test_damaged_text(void **state) {
  (void)state;
  vxm_soup *soup = read_text(HEADER "0 0 0\n1 zero 0\n1 1\n0 1 0\n3 0 1 2\n4 3 2 1\n", "x.ply");
  expect_counts(soup, 4, 1);
  expect_vertex(soup, 1, 1.0, (double)NAN, 0.0);
  expect_vertex(soup, 2, (double)NAN, (double)NAN, (double)NAN);
  expect_warning(soup, "line 11: coordinate is not a number");
  expect_warning(soup, "line 12: line has fewer values than the header says, 2 such lines");
  vxm_soup_destroy(soup);
  /* Values that the header does not know of. */
  soup = read_text(HEADER "0 0 0 9 9\n1 0 0 9 9\n1 1 0 9 9\n0 1 0 9 9\n3 0 1 2 7\n4 3 2 1 0 7\n", "x.ply");
  expect_square(soup);
  expect_warning(soup, "line 10: line has more values than the header says");
  vxm_soup_destroy(soup);
  soup = read_text("ply\nformat ascii 1.0\nelement vertex 3\n" XYZ "element face 6\n" LIST "end_header\n"
                   "0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n3 0 1 3\n3 0 -1 2\n2 0 1\n3 0 1 x\nx 1 2 3\nrest\n",
                   "x.ply");
  expect_counts(soup, 3, 1);
  expect_warning(soup, "line 14: face names a vertex that does not exist; skipped, 2 such");
  expect_warning(soup, "line 16: face has fewer than 3 corners");
  expect_warning(soup, "line 17: face is not a list of whole numbers; skipped, 2 such");
  expect_warning(soup, "line 19: more than announced; ignored (lines: 1)");
  vxm_soup_destroy(soup);
  soup = read_text(HEADER "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 3 2", "x.ply");
  expect_counts(soup, 4, 1);
  expect_warning(soup, "line 15: the file ends after 1 of 2 elements \"face\"");
  vxm_soup_destroy(soup);
  /* Faces first, then too few vertices for some of them. */
  soup = read_text("ply\nformat ascii 1.0\nelement face 2\n" LIST "element vertex 5\n" XYZ "end_header\n"
                   "3 0 1 2\n3 2 3 4\n0 0 0\n1 0 0\n1 1 0\n",
                   "x.ply");
  expect_counts(soup, 3, 1);
  expect_warning(soup, "vertices that are cut off; skipped (faces: 1)");
  vxm_soup_destroy(soup);
}

static void test_headers_that_fail(void **state) {
  (void)state;
  text_fails("ply\nformat ascii 1.0\nelement vertex 3\n", "x.ply", "x.ply:4: the PLY header never ends");
  text_fails("ply\n", "x.ply", "never ends");
  text_fails("ply\nformat ascii 1.0\nelement vertex 1\nproperty bool x\nend_header\n", "x.ply",
             "x.ply:4: unknown property type: \"bool\"");
  text_fails("ply\nformat ascii 1.0\nelement face 1\nproperty list float int vertex_indices\nend_header\n",
             "x.ply", "x.ply:4: unknown type of a list's length: \"float\"");
  text_fails("ply\nformat utf8 1.0\nend_header\n", "x.ply", "x.ply:2: unknown PLY format: \"utf8\"");
  text_fails("ply\nelement vertex 1\n" XYZ "end_header\n0 0 0\n", "x.ply", "no format line");
  text_fails("ply\nformat ascii 1.0\nelement vertex many\n" XYZ "end_header\n", "x.ply",
             "x.ply:3: the number of elements is not a whole number: \"many\"");
  text_fails("ply\nformat ascii 1.0\nproperty int x\nend_header\n", "x.ply",
             "x.ply:3: a property before any element");
  text_fails("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n", "x.ply",
             "x.ply:3: the vertices have no x and y");
  text_fails("ply\nformat ascii 1.0\nsurprise\nend_header\n", "x.ply", "x.ply:3: unknown word");
  text_fails(HEADER "0 0 0\n1 0 0\n", "x.ply", "the file ends after 2 of 4 elements \"vertex\"");
  text_fails("ply\nformat ascii 1.0\nelement vertex 2\n" XYZ LIST "end_header\n0 0 0\n1.5 0 0\n", "x.ply",
             "x.ply:10: the length of a list is not a whole number: \"1.5\"");
}

static void test_no_faces(void **state) {
  (void)state;
  vxm_soup *soup =
      read_text("ply\nformat ascii 1.0\nelement vertex 2\n" XYZ "end_header\n0 0 0\n1 0 0\n", "x.ply");
  expect_counts(soup, 2, 0);
  expect_warning(soup, "no faces");
  vxm_soup_destroy(soup);
  soup = read_text("ply\nformat ascii 1.0\nend_header\n", "x.ply");
  expect_counts(soup, 0, 0);
  expect_warning(soup, "no vertices");
  vxm_soup_destroy(soup);
  soup = read_text("ply\nformat ascii 1.0\nelement vertex 2\nproperty int x\nproperty int y\nelement face 1\n"
                   "property list uchar int corners\nend_header\n0 0\n1 0\n3 0 1 1\n",
                   "x.ply");
  expect_counts(soup, 2, 0);
  expect_warning(soup, "line 3: vertices have no z; taken as 0");
  expect_warning(soup, "line 6: faces have no list vertex_indices");
  vxm_soup_destroy(soup);
}

/* ---- Binary ---- */

typedef enum kind { I8, U8, I16, U16, I32, U32, I64, U64, F32, F64 } kind;

static const char *const names[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                       {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                       {"int64", "int64"},   {"uint64", "uint64"}, {"float", "float32"},
                                       {"double", "float64"}};
static const size_t sizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};

/** Appends a number, in the byte order asked for, whatever the machine's. */
static void add_number(bytes *b, kind type, double value, bool big) {
  uint64_t bits = 0;
  if (type == F32) {
    float f = (float)value;
    uint32_t word;
    memcpy(&word, &f, 4);
    bits = word;
  } else if (type == F64)
    memcpy(&bits, &value, 8);
  else
    bits = (uint64_t)(int64_t)value;
  for (size_t i = 0; i < sizes[type]; i++) {
    unsigned char byte = (unsigned char)(bits >> 8 * (big ? sizes[type] - 1 - i : i));
    bytes_add(b, &byte, 1);
  }
}

/** A property as the random files have it. */
typedef struct column {
  kind type, count_type;
  bool is_list;
  int axis; /**< 0 to 2 for x y z, 3 for the corners, -1 for none */
} column;

static void add_columns(bytes *b, vxm_rng *rng, const column *columns, size_t count) {
  for (size_t c = 0; c < count; c++) {
    const column *k = &columns[c];
    size_t family = (size_t)vxm_rng_below(rng, 2);
    bytes_text(b, "property ");
    if (k->is_list)
      bytes_text(b, "list %s ", names[k->count_type][family]);
    bytes_text(b, "%s ", names[k->type][family]);
    if (k->axis == 3)
      bytes_text(b, "%s\n", vxm_rng_below(rng, 2) ? "vertex_indices" : "vertex_index");
    else if (k->axis >= 0)
      bytes_text(b, "%c\n", 'x' + k->axis);
    else
      bytes_text(b, "extra%zu\n", c);
  }
}

/** Columns around those that matter; lists only where they are allowed. */
static size_t random_columns(vxm_rng *rng, column *columns, const column *wanted, size_t wanted_count,
                             bool lists) {
  size_t count = 0;
  for (size_t w = 0; w <= wanted_count; w++) {
    for (uint64_t extra = vxm_rng_below(rng, 3); extra > 1; extra--)
      columns[count++] = (column){(kind)vxm_rng_below(rng, 10), (kind)vxm_rng_below(rng, 6),
                                  lists && vxm_rng_below(rng, 2), -1};
    if (w < wanted_count)
      columns[count++] = wanted[w];
  }
  return count;
}

static void add_row(bytes *b, vxm_rng *rng, const column *columns, size_t count, const double *position,
                    const uint32_t *corners, size_t n, bool big) {
  for (size_t c = 0; c < count; c++) {
    const column *k = &columns[c];
    if (k->axis == 3) {
      add_number(b, k->count_type, (double)n, big);
      for (size_t i = 0; i < n; i++)
        add_number(b, k->type, (double)corners[i], big);
    } else if (k->axis >= 0)
      add_number(b, k->type, position[k->axis], big);
    else {
      size_t items = 1;
      if (k->is_list) {
        items = (size_t)vxm_rng_below(rng, 4);
        add_number(b, k->count_type, (double)items, big);
      }
      for (; items > 0; items--)
        add_number(b, k->type, (double)vxm_rng_below(rng, 100), big);
    }
  }
}

static kind coordinate_kind(vxm_rng *rng) {
  static const kind kinds[] = {F32, F32, F64, F64, I32, I8};
  return kinds[vxm_rng_below(rng, 6)];
}

/** The positions as a file of the given type holds them. */
static void round_positions(vxm_soup *soup, const column *axes) {
  for (size_t i = 0; i < 3 * soup->vertex_count; i++) {
    kind type = axes[i % 3].type;
    double *value = &soup->positions[i];
    if (type == F32)
      *value = (double)(float)*value;
    else if (type == I32)
      *value = (double)(int32_t)fmod(*value, 1e9);
    else if (type == I8)
      *value = (double)(int8_t)fmod(*value, 100.0);
  }
}

static void test_random_binary(void **state) {
  (void)state;
  static const kind index_kinds[] = {I32, U32, I32, U8, I8, U16, I16, I64, U64, F32, F64};
  vxm_rng rng = {10};
  for (int i = 0; i < 600; i++) {
    vxm_soup *soup =
        random_soup(&rng, 3 + (size_t)vxm_rng_below(&rng, 40), 1 + (size_t)vxm_rng_below(&rng, 40), 9);
    bool big = vxm_rng_below(&rng, 2), faces_first = vxm_rng_below(&rng, 4) == 0;
    bool same = vxm_rng_below(&rng, 2);
    kind first = coordinate_kind(&rng);
    column axes[3], vertex[16], face[16], passed[16];
    for (int a = 0; a < 3; a++)
      axes[a] = (column){same ? first : coordinate_kind(&rng), U8, false, a};
    round_positions(soup, axes);
    column corners = {index_kinds[vxm_rng_below(&rng, 11)],
                      vxm_rng_below(&rng, 2) ? U8 : (kind)vxm_rng_below(&rng, 8), true, 3};
    size_t vertex_columns = random_columns(&rng, vertex, axes, 3, vxm_rng_below(&rng, 4) == 0);
    size_t face_columns = random_columns(&rng, face, &corners, 1, vxm_rng_below(&rng, 2));
    size_t passed_columns = random_columns(&rng, passed, NULL, 0, vxm_rng_below(&rng, 2));
    bytes b = {0};
    bytes_text(&b, "ply\nformat binary_%s_endian 1.0\n", big ? "big" : "little");
    for (int pass = 0; pass < 2; pass++) {
      if ((pass == 0) == faces_first) {
        bytes_text(&b, "element face %zu\n", soup->face_count);
        add_columns(&b, &rng, face, face_columns);
      } else {
        bytes_text(&b, "element vertex %zu\n", soup->vertex_count);
        add_columns(&b, &rng, vertex, vertex_columns);
      }
      if (pass == 0) {
        bytes_text(&b, "element other 3\n");
        add_columns(&b, &rng, passed, passed_columns);
      }
    }
    bytes_text(&b, "end_header\n");
    for (int pass = 0; pass < 2; pass++) {
      if ((pass == 0) == faces_first)
        for (size_t f = 0; f < soup->face_count; f++) {
          size_t n;
          const uint32_t *corner = vxm_face(soup, f, &n);
          add_row(&b, &rng, face, face_columns, NULL, corner, n, big);
        }
      else
        for (size_t v = 0; v < soup->vertex_count; v++)
          add_row(&b, &rng, vertex, vertex_columns, vxm_position(soup, v), NULL, 0, big);
      for (int k = 0; pass == 0 && k < 3; k++)
        add_row(&b, &rng, passed, passed_columns, NULL, NULL, 0, big);
    }
    vxm_soup *back = read_data(b.data, b.size, "x.ply");
    expect_same(soup, back);
    expect_no_damage(back);
    assert_string_equal(back->format, big ? "ply binary_big_endian" : "ply binary_little_endian");
    vxm_soup_destroy(back);
    for (int k = 0; k < 10; k++) {
      vxm_error error = VXM_ERROR_INIT;
      if (read_bytes(&back, b.data, (size_t)vxm_rng_below(&rng, b.size), "x.ply", &error) == VXM_OK)
        vxm_soup_destroy(back);
    }
    vxm_soup_destroy(soup);
    bytes_free(&b);
  }
}

/** A square in little-endian binary behind a header whose lines end in any way. */
static bytes binary_square(const char *header, const char *newline, const char *last) {
  bytes b = {0};
  char *text = with_newlines(header, newline);
  bytes_text(&b, "%send_header%s", text, last);
  free(text);
  static const double positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (int v = 0; v < 4; v++)
    for (int c = 0; c < 3; c++)
      add_number(&b, F32, positions[v][c], false);
  static const int corners[] = {3, 0, 1, 2, 4, 3, 2, 1, 0};
  for (int i = 0; i < 9; i++)
    add_number(&b, i % 4 == 0 && i < 8 ? U8 : I32, (double)corners[i], false);
  return b;
}

static void test_binary_header_ends(void **state) {
  (void)state;
  static const char header[] =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\n" XYZ "element face 2\n" LIST;
  static const char *const ends[][2] = {
      {"\n", "\n"}, {"\r\n", "\r\n"}, {"\r", "\r"}, {"\n", "\r\n"}, {"\n", "  \n"}};
  for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
    bytes b = binary_square(header, ends[i][0], ends[i][1]);
    vxm_soup *soup = read_data(b.data, b.size, "x.ply");
    expect_square(soup);
    expect_no_warnings(soup);
    vxm_soup_destroy(soup);
    bytes_free(&b);
  }
  /* Behind CR alone a first byte of 10 belongs to the body. */
  bytes b = {0};
  bytes_text(&b,
             "ply\rformat binary_little_endian 1.0\relement vertex 1\rproperty uchar x\rproperty uchar y\r"
             "property uchar z\rend_header\r\n\n\n");
  vxm_soup *soup = read_data(b.data, b.size, "x.ply");
  expect_counts(soup, 1, 0);
  expect_vertex(soup, 0, 10.0, 10.0, 10.0);
  vxm_soup_destroy(soup);
  bytes_free(&b);
}

static void test_damaged_binary(void **state) {
  (void)state;
  static const char header[] =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\n" XYZ "element face 2\n" LIST;
  bytes b = binary_square(header, "\n", "\n");
  size_t body = b.size - 78; /* 48 bytes of vertices, 13 and 17 of faces */
  vxm_soup *soup = read_data(b.data, b.size - 1, "x.ply");
  expect_counts(soup, 4, 1);
  expect_warning(soup, "the file ends after 1 of 2 elements \"face\"");
  vxm_soup_destroy(soup);
  read_fails(b.data, body + 48, "x.ply", VXM_ERROR_FORMAT, "after 0 of 2 elements \"face\"");
  read_fails(b.data, body + 30, "x.ply", VXM_ERROR_FORMAT, "after 2 of 4 elements \"vertex\"");
  b.data[body + 48 + 1] = 4; /* the first corner of the first face */
  bytes_add(&b, "xx", 2);
  soup = read_data(b.data, b.size, "x.ply");
  expect_counts(soup, 4, 1);
  char note[64];
  snprintf(note, sizeof note, "byte %zu: face names a vertex that does not exist", body + 48);
  expect_warning(soup, note);
  expect_warning(soup, "more than announced; ignored (bytes: 2)");
  vxm_soup_destroy(soup);
  bytes_free(&b);
  /* Counts that no file could hold. */
  static const char *const absurd[] = {
      "ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\n" XYZ
      "end_header\n0123456789ab",
      "ply\nformat binary_little_endian 1.0\nelement none 18446744073709551615\nelement vertex 1\n" XYZ
      "end_header\n0123456789ab",
      "ply\nformat ascii 1.0\nelement vertex 9223372036854775807\n" XYZ "end_header\n0 0 0\n"};
  for (size_t i = 0; i < 3; i++) {
    soup = read_text(absurd[i], "x.ply");
    expect_counts(soup, 1, 0);
    vxm_soup_destroy(soup);
  }
}

static void test_strips(void **state) {
  (void)state;
  static const int strip[] = {0, 1, 2, 3, -1, 4, 3, 2, 2, 1, -1, 0, 9, 0, 1, 4};
  static const char header[] =
      "element vertex 5\n" XYZ "element tristrips 1\nproperty list int int vertex_indices\n"
      "end_header\n";
  for (int form = 0; form < 3; form++) {
    static const char *const forms[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    bytes b = {0};
    bytes_text(&b, "ply\nformat %s 1.0\n%s", forms[form], header);
    for (int v = 0; v < 5; v++)
      for (int c = 0; c < 3; c++)
        if (form)
          add_number(&b, F32, v + c, form == 2);
        else
          bytes_text(&b, "%d%c", v + c, c < 2 ? ' ' : '\n');
    if (form)
      add_number(&b, I32, 16, form == 2);
    else
      bytes_text(&b, "16");
    for (int i = 0; i < 16; i++)
      if (form)
        add_number(&b, I32, strip[i], form == 2);
      else
        bytes_text(&b, " %d", strip[i]);
    vxm_soup *soup = read_data(b.data, b.size, "x.ply");
    /* Degenerate triangles go, every second one is turned, and a wrong number breaks the strip. */
    expect_counts(soup, 5, 4);
    expect_face(soup, 0, 3, 0, 1, 2);
    expect_face(soup, 1, 3, 2, 1, 3);
    expect_face(soup, 2, 3, 4, 3, 2);
    expect_face(soup, 3, 3, 0, 1, 4);
    expect_warning(soup, "strip names a vertex that does not exist");
    vxm_soup_destroy(soup);
    bytes_free(&b);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_text),
                                     cmocka_unit_test(test_damaged_text),
                                     cmocka_unit_test(test_headers_that_fail),
                                     cmocka_unit_test(test_no_faces),
                                     cmocka_unit_test(test_random_binary),
                                     cmocka_unit_test(test_binary_header_ends),
                                     cmocka_unit_test(test_damaged_binary),
                                     cmocka_unit_test(test_strips)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

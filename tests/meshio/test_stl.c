/* SPDX-License-Identifier: BSD-3-Clause */
/** STL: text and binary, told apart by content, whole and damaged. */
#include "meshio_test.h"

#define FACET(a, b, c) \
  "facet normal 0 0 1\nouter loop\nvertex " a "\nvertex " b "\nvertex " c "\nendloop\nendfacet\n"
#define ONE FACET("0 0 0", "1 0 0", "0 1 0")

static void expect_one(const char *text) {
  vxm_soup *soup = read_text(text, "x.stl");
  expect_counts(soup, 3, 1);
  expect_vertex(soup, 1, 1.0, 0.0, 0.0);
  expect_face(soup, 0, 3, 0, 1, 2);
  assert_string_equal(soup->format, "stl ascii");
  assert_int_equal(soup->tag_count, 0);
  expect_no_warnings(soup);
  vxm_soup_destroy(soup);
}

static void test_text(void **state) {
  (void)state;
  expect_one("solid name\n" ONE "endsolid name\n");
  expect_one("solid\n" ONE "endsolid\n");
  expect_one("  \n solid name facet vertex\r\n" ONE "endsolid name vertex 1 2 3\n");
  expect_one("SOLID X\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVertex 1e0 0.0E+00 -0\nvERTEX 0 1 0\n"
             "ENDLOOP\nENDFACET\nENDSOLID\n");
  expect_one("solid x\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet "
             "endsolid");
  expect_one(
      "solid x\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n");
  expect_one(ONE "endsolid name\n");
  expect_one(
      "solid x\nfacet normal nan 1.#IND x\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
      "endfacet\nendsolid\n");
  expect_one("solid a\n" ONE "endsolid a\nsolid b\nendsolid b\n");
}

static void test_odd_beginnings(void **state) {
  (void)state;
  vxm_soup *soup = read_text("color 1 2 3\rsolid_name\n" ONE "endsolid name\n", "x.stl");
  expect_counts(soup, 3, 1);
  assert_string_equal(soup->format, "stl ascii");
  vxm_soup_destroy(soup);
  bytes b = {0};
  bytes_add(&b, "solid a\0b\0\n", 11);
  bytes_text(&b, ONE "endsolid\n");
  soup = read_data(b.data, b.size, "x.stl");
  expect_counts(soup, 3, 1);
  assert_string_equal(soup->format, "stl ascii");
  vxm_soup_destroy(soup);
  bytes_free(&b);
  soup = read_text("solid x\n" ONE, "x.stl");
  expect_counts(soup, 3, 1);
  expect_warning(soup, "line 9: the file ends without endsolid; it may be cut off");
  vxm_soup_destroy(soup);
  /* Some other text under this name is not taken for facets. */
  char text[500];
  memset(text, 'x', sizeof text);
  read_fails(text, sizeof text, "x.stl", VXM_ERROR_FORMAT, "nor binary: all of it is some other text");
}

static void test_solids(void **state) {
  (void)state;
  vxm_soup *soup =
      read_text("solid left part\n" ONE ONE "endsolid left part\nsolid\n" ONE "endsolid\nsolid empty\n"
                "endsolid\n",
                "x.stl");
  expect_counts(soup, 9, 3);
  assert_int_equal(soup->tag_count, 2);
  assert_string_equal(soup->tags[soup->face_tags[0]], "left part");
  assert_int_equal(soup->face_tags[1], soup->face_tags[0]);
  assert_string_equal(soup->tags[soup->face_tags[2]], "solid 2");
  vxm_soup_destroy(soup);
}

static void test_damaged_text(void **state) {
  (void)state;
  vxm_soup *soup =
      read_text("solid x\n" FACET("0 0 0", "1 0", "0 1 0") FACET("0 0 0", "1 0 0", "1.0e+ 0 0") ONE
                "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\n"
                "endloop foo\nendfacet bar\n"
                "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\n"
                "vertex 7 7 7\nendsolid\n",
                "x.stl");
  expect_counts(soup, 7, 2);
  expect_face(soup, 1, 4, 3, 4, 5, 6);
  expect_warning(soup, "line 2: facet has a coordinate that is not a number; skipped, 2 such");
  expect_warning(soup, "line 23: facet has more than 3 vertices; kept as a polygon");
  expect_warning(soup, "line 31: facet has fewer than 3 vertices; skipped");
  expect_warning(soup, "line 37: vertex outside of a facet");
  expect_warning(soup, "line 29: word that STL does not have; ignored, 2 such words");
  vxm_soup_destroy(soup);
  /* Cut off: a facet that has all three vertices counts. */
  soup = read_text("solid x\n" ONE "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 2",
                   "x.stl");
  expect_counts(soup, 3, 1);
  expect_warning(soup, "line 13: the file ends within a facet");
  vxm_soup_destroy(soup);
  /* A facet that is never closed ends where the next begins. */
  soup = read_text("solid x\nfacet\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n" ONE, "x.stl");
  expect_counts(soup, 6, 2);
  vxm_soup_destroy(soup);
  soup = read_text("solid x\nendsolid", "x.stl");
  expect_counts(soup, 0, 0);
  expect_warning(soup, "no faces");
  vxm_soup_destroy(soup);
}

/* ---- Binary ---- */

static void add_u32(bytes *b, uint32_t word) {
  unsigned char little[4] = {(unsigned char)word, (unsigned char)(word >> 8), (unsigned char)(word >> 16),
                             (unsigned char)(word >> 24)};
  bytes_add(b, little, 4);
}

static void add_float(bytes *b, float value) {
  uint32_t word;
  memcpy(&word, &value, 4);
  add_u32(b, word);
}

static void binary_file(bytes *b, const char *head, uint32_t announced, size_t facets) {
  char header[80] = {0};
  memcpy(header, head, strlen(head));
  bytes_add(b, header, sizeof header);
  add_u32(b, announced);
  for (size_t f = 0; f < facets; f++) {
    for (int c = 0; c < 12; c++)
      add_float(b, (float)f + 0.25f * (float)(c - 3));
    bytes_add(b, "\x01\x02", 2);
  }
}

static vxm_soup *read_binary(const char *head, uint32_t announced, size_t facets, size_t more,
                             const char *name) {
  bytes b = {0};
  binary_file(&b, head, announced, facets);
  for (size_t i = 0; i < more; i++)
    bytes_add(&b, "\n", 1);
  vxm_soup *soup = read_data(b.data, b.size, name);
  bytes_free(&b);
  assert_string_equal(soup->format, "stl binary");
  for (size_t f = 0; f < soup->face_count; f++) {
    expect_face(soup, f, 3, (int)(3 * f), (int)(3 * f + 1), (int)(3 * f + 2));
    expect_vertex(soup, 3 * f, (double)f, (double)f + 0.25, (double)f + 0.5);
    expect_vertex(soup, 3 * f + 2, (double)f + 1.5, (double)f + 1.75, (double)f + 2.0);
  }
  assert_int_equal(soup->vertex_count, 3 * soup->face_count);
  return soup;
}

static void test_binary(void **state) {
  (void)state;
  static const char *const heads[] = {"", "made by hand", "solid", "solid binary all the same\nfacet normal"};
  for (size_t i = 0; i < sizeof heads / sizeof *heads; i++) {
    vxm_soup *soup = read_binary(heads[i], 5, 5, 0, "x.bin");
    expect_counts(soup, 15, 5);
    expect_no_warnings(soup);
    vxm_soup_destroy(soup);
    soup = read_binary(heads[i], 5, 5, 1, "x.stl");
    expect_counts(soup, 15, 5);
    expect_warning(soup, "byte 334: more after the last facet; ignored (bytes: 1)");
    vxm_soup_destroy(soup);
  }
  vxm_soup *soup = read_binary("", 3000, 3000, 0, "x.stl"); /* more than one piece */
  expect_counts(soup, 9000, 3000);
  vxm_soup_destroy(soup);
}

static void test_binary_counts(void **state) {
  (void)state;
  vxm_soup *soup = read_binary("", 7, 5, 10, "x.stl");
  expect_counts(soup, 15, 5);
  expect_warning(soup, "byte 80: 7 facets are announced, but the file holds 5");
  vxm_soup_destroy(soup);
  soup = read_binary("solid", UINT32_MAX, 5, 0, "x.stl");
  expect_counts(soup, 15, 5);
  vxm_soup_destroy(soup);
  soup = read_binary("", 0, 5, 0, "x.stl");
  expect_counts(soup, 15, 5);
  expect_warning(soup, "0 facets are announced, but the file holds 5");
  vxm_soup_destroy(soup);
  soup = read_binary("", 0, 0, 1, "x.stl");
  expect_counts(soup, 0, 0);
  vxm_soup_destroy(soup);
  bytes b = {0};
  binary_file(&b, "", 3, 0);
  read_fails(b.data, b.size, "x.stl", VXM_ERROR_FORMAT, "3 facets are announced, but the file holds none");
  read_fails(b.data, 40, "x.stl", VXM_ERROR_FORMAT, "x.stl: byte 40: neither text");
  bytes_free(&b);
}

static void test_text_conversion(void **state) {
  (void)state;
  bytes b = {0};
  binary_file(&b, "", 5, 0);
  for (int i = 0; i < 100; i++)
    bytes_add(&b, "\xef\xbf\xbd?", 4);
  vxm_soup *soup = read_data(b.data, b.size, "x.stl");
  expect_warning(soup, "byte 84: looks ruined by a text conversion (100 times U+FFFD)");
  vxm_soup_destroy(soup);
  bytes_free(&b);
}

static void test_random_files(void **state) {
  (void)state;
  static const char *const newlines[] = {"\n", "\r\n", "\r", "\n\n   "};
  vxm_rng rng = {9};
  for (int i = 0; i < 300; i++) {
    size_t facets = 1 + (size_t)vxm_rng_below(&rng, 30);
    vxm_soup *soup = random_soup(&rng, 3 * facets, 0, 3);
    for (uint32_t f = 0; f < facets; f++)
      assert_int_equal(vxm_soup_add_face(soup, (uint32_t[]){3 * f, 3 * f + 1, 3 * f + 2}, 3, NULL), VXM_OK);
    bytes b = {0};
    const char *newline = newlines[vxm_rng_below(&rng, 4)];
    bytes_text(&b, "solid it%s", newline);
    for (size_t f = 0; f < facets; f++) {
      bytes_text(&b, "  facet normal 1 2 3%s    outer loop%s", newline, newline);
      for (size_t v = 3 * f; v < 3 * f + 3; v++)
        bytes_text(&b, "vertex   %.17g\t%.17g  %.17g %s", vxm_position(soup, v)[0], vxm_position(soup, v)[1],
                   vxm_position(soup, v)[2], newline);
      bytes_text(&b, "    endloop%s  endfacet%s", newline, newline);
    }
    bytes_text(&b, "endsolid");
    vxm_soup *back = read_data(b.data, b.size, "x.stl");
    expect_same(soup, back);
    expect_no_warnings(back);
    vxm_soup_destroy(back);
    for (int k = 0; k < 10; k++) {
      vxm_error error = VXM_ERROR_INIT;
      if (read_bytes(&back, b.data, (size_t)vxm_rng_below(&rng, b.size), "x.stl", &error) == VXM_OK)
        vxm_soup_destroy(back);
    }
    vxm_soup_destroy(soup);
    bytes_free(&b);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_text),
                                     cmocka_unit_test(test_odd_beginnings),
                                     cmocka_unit_test(test_solids),
                                     cmocka_unit_test(test_damaged_text),
                                     cmocka_unit_test(test_binary),
                                     cmocka_unit_test(test_binary_counts),
                                     cmocka_unit_test(test_text_conversion),
                                     cmocka_unit_test(test_random_files)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** OFF as people have it: glued headers, prefixes, comments, line ends, colours, broken lines, binary. */
#include "meshio_test.h"

#define TETRAHEDRON "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"

static void expect_tetrahedron(const char *text) {
  vxm_soup *soup = read_text(text, "x.off");
  expect_counts(soup, 4, 4);
  expect_vertex(soup, 3, 0.0, 0.0, 1.0);
  expect_face(soup, 0, 3, 0, 2, 1);
  expect_face(soup, 3, 3, 1, 2, 3);
  assert_string_equal(soup->format, "off");
  expect_no_warnings(soup);
  vxm_soup_destroy(soup);
}

static void test_headers(void **state) {
  (void)state;
  static const char *const heads[] = {
      "OFF\n4 4 6\n",
      "OFF 4 4 6\n",
      "OFF4 4 6\n",
      "off\n4 4 6\n",
      "\xef\xbb\xbfOFF\n4 4 6\n",
      "\n\n  OFF\n\n4 4 6\n",
      "# first\nOFF # word\n# then\n\n4 4 6 # counts\n\n# vertices\n",
      "\t      OFF4 4 6 # or nah\n",
      "OFF\n4 4\n",
      "OFF\n4\n4\n6\n",
      "OFF\n4\n4 6\n",
      "OFF\r\n4 4 6\r\n",
      "OFF\r4 4 6\r",
      "nOFF 3\n4 4 6\n",
      "nOFF\n3\n4 4 6\n",
  };
  for (size_t i = 0; i < sizeof heads / sizeof *heads; i++) {
    char text[512];
    snprintf(text, sizeof text, "%s" TETRAHEDRON, heads[i]);
    expect_tetrahedron(text);
  }
}

/** The third word of the counts' line is the number of edges, whatever it is: nothing is read from it. */
static void test_edge_counts(void **state) {
  (void)state;
  static const char *const silent[] = {"OFF\n4 4 -1\n", "OFF4 4 -1\n", "OFF\n4 4 0.0\n", "OFF\n4 4 x\n",
                                       "OFF 4 4 nan # edges\n"};
  static const char *const told[] = {"OFF\n4 4 0 99\n", "OFF\n4 4 -1 7 8 # more\n", "OFF\n4 4 0 1 2 3\n",
                                     "OFF\n4 4 6 0 0 0 0\n"};
  char text[512];
  for (size_t i = 0; i < sizeof silent / sizeof *silent; i++) {
    snprintf(text, sizeof text, "%s" TETRAHEDRON, silent[i]);
    expect_tetrahedron(text);
  }
  for (size_t i = 0; i < sizeof told / sizeof *told; i++) {
    snprintf(text, sizeof text, "%s" TETRAHEDRON, told[i]);
    vxm_soup *soup = read_text(text, "x.off");
    expect_counts(soup, 4, 4);
    expect_vertex(soup, 0, 0.0, 0.0, 0.0);
    expect_vertex(soup, 1, 1.0, 0.0, 0.0);
    expect_warning(soup, "line 2: more than three counts; the rest of the line is passed over");
    vxm_soup_destroy(soup);
  }
  text_fails("OFF\n3 1 0 99\n0 0 0 1 0 0 0 1 0\n3 0 1 2\n", "x.off",
             "x.off:2: more than three counts, and what follows them is no vertex");
}

static void test_missing_word(void **state) {
  (void)state;
  vxm_soup *soup = read_text("4 4 6\n" TETRAHEDRON, "x.off");
  expect_counts(soup, 4, 4);
  expect_warning(soup, "line 1: no OFF keyword; the file begins");
  vxm_soup_destroy(soup);
  soup = read_text("4 4 6\n" TETRAHEDRON, "-");
  expect_counts(soup, 4, 4);
  vxm_soup_destroy(soup);
}

/** Every legal prefix, with vertices that have what it announces, line by line and one number to a line. */
static void test_prefixes(void **state) {
  (void)state;
  for (int bits = 0; bits < 32; bits++)
    for (int broken = 0; broken < 2; broken++) {
      bytes text = {0};
      bool st = bits & 1, c = bits & 2, n = bits & 4, four = bits & 8, ndim = bits & 16;
      bytes_text(&text, "%s%s%s%s%sOFF\n%s3 1 0\n", st ? "ST" : "", c ? "C" : "", n ? "N" : "",
                 four ? "4" : "", ndim ? "n" : "", ndim ? "3\n" : "");
      int count = 3 + four + 3 * n + 4 * c + 2 * st;
      for (int v = 0; v < 3; v++)
        for (int k = 0; k < count; k++)
          bytes_text(&text, "%d%c", 10 * v + k, broken || k + 1 == count ? '\n' : ' ');
      bytes_text(&text, "3 2 1 0\n");
      vxm_soup *soup = read_data(text.data, text.size, "x.off");
      expect_counts(soup, 3, 1);
      expect_vertex(soup, 0, 0.0, 1.0, 2.0);
      expect_vertex(soup, 2, 20.0, 21.0, 22.0);
      expect_face(soup, 0, 3, 2, 1, 0);
      if (four)
        expect_warning(soup, "4 coordinates");
      else
        expect_no_warnings(soup);
      vxm_soup_destroy(soup);
      bytes_free(&text);
    }
}

static void test_dimensions(void **state) {
  (void)state;
  vxm_soup *soup = read_text("nOFF 2\n3 1 0\n0 1\n2 3\n4 5\n3 0 1 2\n", "x.off");
  expect_counts(soup, 3, 1);
  expect_vertex(soup, 1, 2.0, 3.0, 0.0);
  expect_warning(soup, "2 coordinates");
  vxm_soup_destroy(soup);
  soup = read_text("4nOFF 4 3 1 0\n0 1 2 3 4\n5 6 7 8 9\n1 1 1 1 1\n3 0 1 2\n", "x.off");
  expect_counts(soup, 3, 1);
  expect_vertex(soup, 1, 5.0, 6.0, 7.0);
  vxm_soup_destroy(soup);
}

static void test_colours(void **state) {
  (void)state;
  /* After the vertices: announced with three, four or no numbers, or not announced at all. */
  static const char *const vertices[] = {
      "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n0 1 0 255 0 0 255\n3 0 1 2\n",
      "COFF\n3 1 0\n0 0 0 .1 .2 .3\n1 0 0 .1 .2 .3\n0 1 0 .1 .2 .3\n3 0 1 2\n",
      "COFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
      "OFF\n3 1 0\n0 0 0 1 2 3\n1 0 0 4 5 6\n0 1 0 7 8 9\n3 0 1 2\n",
      "OFF\n3 1 0\n0 0 0 1 2 3 4\n1 0 0 4 5 6 7\n0 1 0 7 8 9 9\n3 0 1 2 7 7 7\n",
      "OFF\n3 1 0\n0 0 0 1 0 0 0 1 0\n3 0 1 2\n",
      "OFF 3 1 0 0 0 0 1 0 0 0 1 0 3 0 1 2",
  };
  for (size_t i = 0; i < sizeof vertices / sizeof *vertices; i++) {
    vxm_soup *soup = read_text(vertices[i], "x.off");
    expect_counts(soup, 3, 1);
    expect_vertex(soup, 1, 1.0, 0.0, 0.0);
    expect_vertex(soup, 2, 0.0, 1.0, 0.0);
    expect_face(soup, 0, 3, 0, 1, 2);
    vxm_soup_destroy(soup);
  }
  /* After the faces: any number of them. */
  static const char *const colours[] = {"", " 7", " 255 0 0", " 3 0 1 2", " .5 .5 .5 1.0", "   # none"};
  for (size_t i = 0; i < sizeof colours / sizeof *colours; i++) {
    char text[512];
    snprintf(text, sizeof text, "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2%s\n4 3 2 1 0%s\n3 1 2 3%s\n",
             colours[i], colours[i], colours[i]);
    vxm_soup *soup = read_text(text, "x.off");
    expect_counts(soup, 4, 3);
    expect_face(soup, 1, 4, 3, 2, 1, 0);
    expect_face(soup, 2, 3, 1, 2, 3);
    expect_no_warnings(soup);
    vxm_soup_destroy(soup);
  }
}

static void test_broken_lines(void **state) {
  (void)state;
  expect_tetrahedron("OFF\n4 4 0\n0\n0\n0\n1\n0 0\n0 1\n0\n0 0 1\n3\n0 2 1\n3\n0\n1\n3\n3 0\n3 2\n3 1 2\n3");
  expect_tetrahedron("OFF\n4 4 0\n0 0 0 1 0 0\n0 1 0 0 0 1\n3 0 2 1 3 0 1 3\n3 0 3 2 3 1 2 3\n");
  expect_tetrahedron("OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3\n0 2 1\n3\n0 1 3\n3\n0 3 2\n3\n1 2 3\n");
  /* Counts on lines of their own, before lines that would make faces too. */
  vxm_soup *soup = read_text(
      "OFF\n7 2 0\n0 0 0\n1 0 0\n2 1 0\n2 2 0\n1 3 0\n0 3 0\n1 1 1\n4\n3 4 5 6\n4\n3 1 0 2\n", "x.off");
  expect_counts(soup, 7, 2);
  expect_face(soup, 0, 4, 3, 4, 5, 6);
  expect_face(soup, 1, 4, 3, 1, 0, 2);
  vxm_soup_destroy(soup);
  /* A long polygon that is continued on the next line among faces that are not. */
  soup = read_text("OFF\n6 3 0\n0 0 0\n1 0 0\n2 1 0\n2 2 0\n1 3 0\n0 3 0\n3 0 1 2\n6 0 1 2\n3 4 5\n3 3 4 5\n",
                   "x.off");
  expect_counts(soup, 6, 3);
  expect_face(soup, 1, 6, 0, 1, 2, 3, 4, 5);
  expect_face(soup, 2, 3, 3, 4, 5);
  vxm_soup_destroy(soup);
}

static void test_damage(void **state) {
  (void)state;
  vxm_soup *soup = read_text("OFF\n4 7 0\n0 0 0\n1 zero 0\n0 1\n0 0 1\n"
                             "3 0 1 2\n3 0 1 4\n3 0 1 -1\n2 0 1\n4 0 1 2\n3 1 2 3\n3 a b c\nmore\n",
                             "x.off");
  expect_counts(soup, 4, 2);
  expect_vertex(soup, 1, 1.0, (double)NAN, 0.0);
  expect_vertex(soup, 2, 0.0, 1.0, (double)NAN);
  expect_vertex(soup, 3, 0.0, 0.0, 1.0);
  expect_face(soup, 0, 3, 0, 1, 2);
  expect_face(soup, 1, 3, 1, 2, 3);
  expect_warning(soup, "line 4: coordinate is not a number");
  expect_warning(soup, "line 5: vertex has too few coordinates");
  expect_warning(soup, "line 8: face names a vertex that does not exist; skipped");
  expect_warning(soup, "line 9: face is not a list of whole numbers; skipped, 2 such faces in all");
  expect_warning(soup, "line 10: face has fewer than 3 corners");
  expect_warning(soup, "line 11: face has fewer indices than it announces");
  expect_warning(soup, "line 14: more than announced; ignored (lines: 1)");
  vxm_soup_destroy(soup);
  soup = read_text("OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0", "x.off");
  expect_counts(soup, 4, 1);
  expect_warning(soup, "line 8: the file ends after 1 of 4 faces");
  vxm_soup_destroy(soup);
  soup = read_text("OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "x.off");
  expect_counts(soup, 3, 0);
  expect_warning(soup, "no faces");
  vxm_soup_destroy(soup);
}

static void test_failures(void **state) {
  (void)state;
  text_fails("OFF\n353535235358 6 0\n0 0 0\n1 0 0\n", "x.off",
             "x.off:2: 353535235358 vertices are announced");
  text_fails("OFF\n99999999999999999999999 6 0\n0 0 0\n", "x.off", "are announced");
  text_fails("OFF\n4 4 0\n0.000 0.000 0.000\n1.000 0.000 0.000\n", "x.off", "before any face");
  text_fails("OFF\n3 4 0\n0 0 0\n1 0 0\n0 1 0\n", "x.off", "after 0 of 4 faces");
  text_fails("OFF\n", "x.off", "ends before the number of vertices");
  text_fails("OFF\nfour 4 0\n", "x.off", "x.off:2: the number of vertices is not a whole number: \"four\"");
  text_fails("OFF\n-4 4 0\n", "x.off", "is not a whole number");
  text_fails("appearance {\n", "x.off", "x.off:1: no OFF header: \"appearance {\"");
  text_fails("nOFF 0\n3 1 0\n", "x.off", "0 dimensions");
  text_fails("nOFF 18446744073709551615\n3 1 0\n0 0 0\n", "x.off", "dimensions");
}

/* ---- Random files ---- */

/** A blank line, a comment, or nothing. */
static void random_gap(bytes *b, vxm_rng *rng, const char *newline) {
  if (vxm_rng_below(rng, 8) == 0)
    bytes_text(b, "%s", newline);
  if (vxm_rng_below(rng, 8) == 0)
    bytes_text(b, "# 3 0 1 2%s", newline);
}

static void random_space(bytes *b, vxm_rng *rng) {
  static const char *const blanks[] = {" ", " ", " ", "  ", "\t", " \t "};
  bytes_text(b, "%s", blanks[vxm_rng_below(rng, 6)]);
}

static void random_file(bytes *b, vxm_rng *rng, const vxm_soup *soup) {
  static const char *const newlines[] = {"\n", "\r\n", "\r"};
  const char *newline = newlines[vxm_rng_below(rng, 3)];
  bool colours = vxm_rng_below(rng, 2), face_colours = vxm_rng_below(rng, 2);
  random_gap(b, rng, newline);
  bytes_text(b, "%sOFF%s", colours ? "C" : "", vxm_rng_below(rng, 2) ? newline : " ");
  bytes_text(b, "%zu %zu%s%s", soup->vertex_count, soup->face_count, vxm_rng_below(rng, 2) ? " 0" : "",
             newline);
  for (size_t v = 0; v < soup->vertex_count; v++) {
    random_gap(b, rng, newline);
    for (size_t c = 0; c < 3; c++) {
      bytes_text(b, "%.17g", vxm_position(soup, v)[c]);
      if (c < 2 || colours)
        random_space(b, rng);
    }
    bytes_text(b, "%s%s", colours ? "1 2 3 4" : "", newline);
  }
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n);
    random_gap(b, rng, newline);
    bytes_text(b, "%zu", n);
    for (size_t c = 0; c < n; c++) {
      random_space(b, rng);
      bytes_text(b, "%u", corner[c]);
    }
    if (face_colours && vxm_rng_below(rng, 2))
      bytes_text(b, " 10 20 30");
    bytes_text(b, "%s", newline);
  }
}

static void test_random_files(void **state) {
  (void)state;
  vxm_rng rng = {7};
  for (int i = 0; i < 400; i++) {
    vxm_soup *soup =
        random_soup(&rng, 3 + (size_t)vxm_rng_below(&rng, 40), 1 + (size_t)vxm_rng_below(&rng, 40), 9);
    bytes text = {0};
    random_file(&text, &rng, soup);
    vxm_soup *back = read_data(text.data, text.size, "x.off");
    expect_same(soup, back);
    expect_no_warnings(back);
    vxm_soup_destroy(back);
    /* Any beginning of it is read as far as it goes, or refused in one line. */
    for (int k = 0; k < 10; k++) {
      vxm_error error = VXM_ERROR_INIT;
      size_t size = (size_t)vxm_rng_below(&rng, text.size);
      if (read_bytes(&back, text.data, size, "x.off", &error) == VXM_OK) {
        assert_true(back->face_count <= soup->face_count);
        vxm_soup_destroy(back);
      }
    }
    vxm_soup_destroy(soup);
    bytes_free(&text);
  }
}

/* ---- Binary ---- */

static void add_word(bytes *b, uint32_t word) {
  unsigned char big[4] = {(unsigned char)(word >> 24), (unsigned char)(word >> 16),
                          (unsigned char)(word >> 8), (unsigned char)word};
  bytes_add(b, big, 4);
}

static void add_float(bytes *b, float value) {
  uint32_t word;
  memcpy(&word, &value, 4);
  add_word(b, word);
}

static void binary_file(bytes *b, const char *head, size_t extras) {
  bytes_text(b, "%s", head);
  add_word(b, 4);
  add_word(b, 2);
  add_word(b, 5);
  for (int v = 0; v < 4; v++) {
    for (int c = 0; c < 3; c++)
      add_float(b, (float)(10 * v + c) + 0.5f);
    for (size_t e = 0; e < extras; e++)
      add_float(b, 1.0f);
  }
  add_word(b, 3);
  for (uint32_t c = 0; c < 3; c++)
    add_word(b, c);
  add_word(b, 0);
  add_word(b, 4);
  for (uint32_t c = 0; c < 4; c++)
    add_word(b, 3 - c);
  add_word(b, 4);
  for (int c = 0; c < 4; c++)
    add_float(b, 0.5f);
}

static void test_binary(void **state) {
  (void)state;
  static const struct {
    const char *head;
    size_t extras;
  } heads[] = {
      {"OFF BINARY\n", 0}, {"OFF BINARY\r\n", 0}, {"# c\nCOFF BINARY\n", 4}, {"STCNOFF BINARY\n", 9}};
  for (size_t i = 0; i < sizeof heads / sizeof *heads; i++) {
    bytes b = {0};
    binary_file(&b, heads[i].head, heads[i].extras);
    vxm_soup *soup = read_data(b.data, b.size, "x.off");
    assert_string_equal(soup->format, "off binary");
    expect_counts(soup, 4, 2);
    expect_vertex(soup, 2, 20.5, 21.5, 22.5);
    expect_face(soup, 1, 4, 3, 2, 1, 0);
    expect_no_warnings(soup);
    vxm_soup_destroy(soup);
    /* Cut off within the last face, and before any. */
    soup = read_data(b.data, b.size - 1, "x.off");
    expect_counts(soup, 4, 1);
    expect_warning(soup, "the file ends after 1 of 2 faces");
    vxm_soup_destroy(soup);
    read_fails(b.data, b.size - 60, "x.off", VXM_ERROR_FORMAT, "x.off: byte");
    bytes_add(&b, "tail", 4);
    soup = read_data(b.data, b.size, "x.off");
    expect_warning(soup, "more than announced; ignored (bytes: 4)");
    vxm_soup_destroy(soup);
    bytes_free(&b);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_headers),      cmocka_unit_test(test_edge_counts),
                                     cmocka_unit_test(test_missing_word), cmocka_unit_test(test_prefixes),
                                     cmocka_unit_test(test_dimensions),   cmocka_unit_test(test_colours),
                                     cmocka_unit_test(test_broken_lines), cmocka_unit_test(test_damage),
                                     cmocka_unit_test(test_failures),     cmocka_unit_test(test_random_files),
                                     cmocka_unit_test(test_binary)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

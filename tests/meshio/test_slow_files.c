/* SPDX-License-Identifier: BSD-3-Clause */
/** Files made to be slow: each would take minutes if any part of a reader were quadratic. */
#include "meshio_test.h"

#include <unistd.h>

enum { BYTES = 2 << 20, SECONDS_FOR_ALL = 100 };

#define XYZ "property float x\nproperty float y\nproperty float z\n"

/** `head`, then `piece` over and over. */
static bytes repeated(const char *head, const char *piece) {
  bytes b = {0};
  bytes_text(&b, "%s", head);
  while (b.size < BYTES)
    bytes_text(&b, "%s", piece);
  return b;
}

static void read_any(bytes *b, const char *name) {
  vxm_soup *soup;
  vxm_error error = VXM_ERROR_INIT;
  if (read_bytes(&soup, b->data, b->size, name, &error) == VXM_OK)
    vxm_soup_destroy(soup);
  bytes_free(b);
}

static void test_repeated_pieces(void **state) {
  (void)state;
  static const struct {
    const char *head, *piece, *name;
  } cases[] = {
      {"OFF\n1 100000 0\n0 0 0\n", "1000000 0 0\n", "a.off"},
      {"OFF\n1 100000 0\n0 0 0\n", "3 0 0 \n", "a.off"},
      {"OFF\n1 100000 0\n0 0 0\n3 0 0 0\n", "3 0\n# c\n", "a.off"},
      {"OFF 1 100000 0 0 0 0 ", "3 0 0 0 ", "a.off"},
      {"OFF\n300000 100000 0\n", "0 0 0 0 0 0 ", "a.off"},
      {"OFF\n# ", "#", "a.off"},
      {"", "C", "a.off"},
      {"v 0 0 0\nf", " 1", "a.obj"},
      {"v 0 0 0\nf", " \\\n1", "a.obj"},
      {"v 0 0 0\n", "f 1 1 9\n", "a.obj"},
      {"v 0 0 0\n", "f -1 -1 -2\n", "a.obj"},
      {"v 0 0 0\n", "f 1 1 ", "a.obj"},
      {"f 1 1 1\n", "v\n", "a.obj"},
      {"v 0 0 0\nf 1 1 1\n", "g a\nusemtl b\nf 1 1 1\ng b\nf 1 1 1\n", "a.obj"},
      {"v 0 0 0", "0", "a.obj"},
      {"solid ", "a", "a.stl"},
      {"solid a\n", "facet ", "a.stl"},
      {"solid a\nfacet\n", "vertex 0 0 0 ", "a.stl"},
      {"solid a\n", "facet vertex 0 0 0 vertex 0 0 0 vertex 0 0 0\n", "a.stl"},
      {"solid a\n", "solid b\nfacet vertex 0 0 0 vertex 0 0 0 vertex 0 0 0\n", "a.stl"},
      {"ply\nformat ascii 1.0\n", "element face 1\n", "a.ply"},
      {"ply\nformat ascii 1.0\n", "element face 9\nproperty list int int vertex_index\n", "a.ply"},
      {"ply\nformat ascii 1.0\nelement vertex 9\n", "property float x\n", "a.ply"},
      {"ply\nformat ascii 1.0\nelement vertex 1000000\n" XYZ "end_header\n", "0 0 0 1\n", "a.ply"},
      {"ply\nformat ascii 1.0\nelement vertex 1000000\n" XYZ "end_header\n", "0 0\n", "a.ply"},
      {"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty char x\nproperty char y\n"
       "element face 9000000\nproperty list uchar uchar vertex_index\nend_header\n12",
       "\x01", "a.ply"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    bytes b = repeated(cases[i].head, cases[i].piece);
    read_any(&b, cases[i].name);
  }
}

/** Many elements, each with a line that has too many values. */
static void test_many_elements(void **state) {
  (void)state;
  bytes b = {0};
  bytes_text(&b, "ply\nformat ascii 1.0\nelement vertex 1\n" XYZ);
  for (int i = 0; i < 40000; i++)
    bytes_text(&b, "element e 1\nproperty int i\n");
  bytes_text(&b, "end_header\n0 0 0 0\n");
  for (int i = 0; i < 40000; i++)
    bytes_text(&b, "1 2 3\n");
  vxm_soup *soup = read_data(b.data, b.size, "a.ply");
  expect_counts(soup, 1, 0);
  expect_warning(soup, "more values than the header says; the rest is ignored, 40001 such lines in all");
  vxm_soup_destroy(soup);
  bytes_free(&b);
}

/** A tag for nearly every face, each with a group and a material as long as they may be. */
static void test_long_tags(void **state) {
  (void)state;
  bytes b = {0};
  bytes_text(&b, "v 0 0 0\ng %0500d\n", 7);
  for (int i = 0; i < 50000; i++)
    bytes_text(&b, "usemtl %d\nf 1 1 1\n", i);
  vxm_soup *soup = read_data(b.data, b.size, "a.obj");
  expect_counts(soup, 1, 50000);
  assert_int_equal(soup->tag_count, 50000);
  assert_int_equal(strlen(soup->tags[12345]), 255 + 1 + 5);
  vxm_soup_destroy(soup);
  bytes_free(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_repeated_pieces),
                                     cmocka_unit_test(test_many_elements), cmocka_unit_test(test_long_tags)};
  alarm(SECONDS_FOR_ALL); /* a hang ends the program, and so fails */
  return cmocka_run_group_tests(tests, NULL, NULL);
}

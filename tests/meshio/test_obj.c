/* SPDX-License-Identifier: BSD-3-Clause */
/** OBJ: indices of all kinds, continuations, groups and materials, and what is passed over. */
#include "meshio_test.h"

#define QUAD "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

static void expect_quad(const char *faces) {
  char text[2048];
  snprintf(text, sizeof text, QUAD "%s", faces);
  vxm_soup *soup = read_text(text, "x.obj");
  expect_counts(soup, 4, 1);
  expect_vertex(soup, 2, 1.0, 1.0, 0.0);
  expect_face(soup, 0, 4, 0, 1, 2, 3);
  assert_string_equal(soup->format, "obj");
  expect_no_warnings(soup);
  vxm_soup_destroy(soup);
}

/* Statements that say nothing of the surface, one of them continued. */
#define PASSED_OVER                                                                              \
  "# f 1 2 3\n\n  f 1 2 3 4\nvn 0 0 1\nvt 0 0\nvp 1 2\ns off\nmtllib a.mtl\ncurv 1 2 \\\n 3 4\n" \
  "l 1 2\np 3\n"

static void test_faces(void **state) {
  (void)state;
  static const char *const faces[] = {
      "f 1 2 3 4\n",
      "f 1 2 3 4",
      "f   1\t2  3 4   \r\n",
      "f 1 2 3 4 # all\n",
      "f 1/1 2/2 3/3 4/4\n",
      "f 1//1 2//1 3//1 4//1\n",
      "f 1/1/1 2/2/2 3/3/3 4/4/4\n",
      "f 1// 2// 3// 4//\n",
      "f -4 -3 -2 -1\n",
      "f -4/-4/-4 2/-1 -2//-7 4\n",
      "f 1 2 \\\n3 4\n",
      "f \\\r\n1 2 3\\\n  4\n",
      "f\\\n1 2 3 4\n",
      "fo 1 2 3 4\n",
      PASSED_OVER,
      "vn 0 0 1\nvt 0.5 0.5 \\\n0\nf 1/1/1 2/1/1 3/1/1 4/1/1\n",
  };
  for (size_t i = 0; i < sizeof faces / sizeof *faces; i++)
    expect_quad(faces[i]);
}

static void test_vertices(void **state) {
  (void)state;
  vxm_soup *soup = read_text("v 1 2 3\nv 1 2 3 1.0\nv 1 2 3 .1 .2 .3\nv 1 2 3 1 .1 .2 .3\nv 1 2 3 # c\n"
                             "v\t1 \\\n 2 3\n  v 1e0 +2 .3e1\nf 1 2 3 4 5 6 7\n",
                             "x.obj");
  expect_counts(soup, 7, 1);
  for (size_t v = 0; v < 7; v++)
    expect_vertex(soup, v, 1.0, 2.0, 3.0);
  expect_no_warnings(soup);
  vxm_soup_destroy(soup);
  soup = read_text("v 1 2\nv 3 4\nv 5\nv\nv x 1.#IND nan\nv -inf 0 NaN\nf 1 2 3\n", "x.obj");
  expect_counts(soup, 6, 1);
  expect_vertex(soup, 1, 3.0, 4.0, 0.0);
  expect_vertex(soup, 2, 5.0, (double)NAN, (double)NAN);
  expect_vertex(soup, 3, (double)NAN, (double)NAN, (double)NAN);
  expect_vertex(soup, 4, (double)NAN, (double)NAN, (double)NAN);
  expect_vertex(soup, 5, -HUGE_VAL, 0.0, (double)NAN);
  expect_warning(soup, "line 1: vertex has two coordinates; z taken as 0, 2 such vertices in all");
  expect_warning(soup, "line 3: vertex has too few coordinates; taken as NaN, 2 such");
  expect_warning(soup, "line 5: coordinate is not a number; taken as NaN, 2 such");
  vxm_soup_destroy(soup);
}

static void test_damage(void **state) {
  (void)state;
  vxm_soup *soup = read_text("f 1 2 3\n" QUAD "f 0 1 2\nf 1 2 5\nf 1 2\nf\nf 1 two 3\nf -5 1 2\nf 2 3 4\n"
                             "f 1 2 99999999999999999999999\nf 0/1 2 3\nf 1 2 4.5\n",
                             "x.obj");
  expect_counts(soup, 4, 2);
  expect_face(soup, 0, 3, 0, 1, 2); /* before its vertices */
  expect_face(soup, 1, 3, 1, 2, 3);
  expect_warning(soup, "line 6: face names vertex 0 (numbering starts at 1); skipped, 2 such faces in all");
  expect_warning(soup, "line 7: face names a vertex that does not exist; skipped, 3 such");
  expect_warning(soup, "line 8: face has fewer than 3 corners; skipped, 2 such");
  expect_warning(soup, "line 10: face has a corner that is no vertex number; skipped, 2 such");
  assert_int_equal(soup->warnings.count, 4);
  vxm_soup_destroy(soup);
  soup = read_text(QUAD "l 1 2 3\n", "x.obj");
  expect_counts(soup, 4, 0);
  expect_warning(soup, "no faces, only 1 lines");
  vxm_soup_destroy(soup);
  text_fails("# nothing\n", "x.obj", "not a mesh");
  text_fails("g a\nusemtl b\n", "x.obj", "not a mesh");
}

static void expect_tag(const vxm_soup *soup, size_t face, const char *name) {
  assert_non_null(soup->face_tags);
  assert_string_equal(soup->tags[soup->face_tags[face]], name);
}

static void test_tags(void **state) {
  (void)state;
  vxm_soup *soup =
      read_text(QUAD "f 1 2 3\ng  left wing \nf 1 2 3\nusemtl red\nf 1 2 3\nf 1 2 4\ng right\nf 1 2 3\n"
                     "usemtl\nf 1 2 3\no left wing\nusemtl red\nf 1 2 3\ng\nf 1 2 3\ng unused\n",
                "x.obj");
  expect_counts(soup, 4, 8);
  expect_tag(soup, 0, "default");
  expect_tag(soup, 1, "left wing");
  expect_tag(soup, 2, "left wing/red");
  expect_tag(soup, 3, "left wing/red");
  expect_tag(soup, 4, "right/red");
  expect_tag(soup, 5, "right");
  expect_tag(soup, 6, "left wing/red");
  expect_tag(soup, 7, "default/red");
  assert_int_equal(soup->tag_count, 6);
  vxm_soup_destroy(soup);
  soup = read_text(QUAD "usemtl m\nf 1 2 3\n", "x.obj");
  assert_int_equal(soup->tag_count, 1);
  expect_tag(soup, 0, "default/m");
  vxm_soup_destroy(soup);
  soup = read_text(QUAD "g a\ng b\nf 1 2\n", "x.obj");
  assert_int_equal(soup->tag_count, 0);
  vxm_soup_destroy(soup);
  /* Faces that are dropped at the end take their tags with them, the others keep theirs. */
  soup = read_text(QUAD "g a\nf 1 2 3\ng b\nf 1 2 9\ng c\nf 2 3 4\n", "x.obj");
  expect_counts(soup, 4, 2);
  expect_tag(soup, 0, "a");
  expect_tag(soup, 1, "c");
  vxm_soup_destroy(soup);
}

static void test_many_tags(void **state) {
  (void)state;
  bytes text = {0};
  bytes_text(&text, QUAD);
  for (int i = 0; i < 20000; i++)
    bytes_text(&text, "g part%d\nf 1 2 3\n", i % 5000);
  bytes_text(&text, "g ");
  for (int i = 0; i < 600; i++)
    bytes_text(&text, "\xc3\xa4");
  bytes_text(&text, "\nf 1 2 3\n");
  vxm_soup *soup = read_data(text.data, text.size, "x.obj");
  expect_counts(soup, 4, 20001);
  assert_int_equal(soup->tag_count, 5001);
  expect_tag(soup, 17000, "part2000");
  assert_int_equal(strlen(soup->tags[5000]), 254); /* cut between characters */
  vxm_soup_destroy(soup);
  bytes_free(&text);
}

static void test_long_lines(void **state) {
  (void)state;
  bytes text = {0};
  size_t n = 200000;
  for (size_t v = 0; v < n; v++)
    bytes_text(&text, "v %zu 0 0\n", v);
  bytes_text(&text, "f");
  for (size_t v = 1; v <= n; v++)
    bytes_text(&text, " %zu%s", v, v % 1000 ? "" : " \\\n");
  vxm_soup *soup = read_data(text.data, text.size, "x.obj");
  expect_counts(soup, n, 1);
  assert_int_equal(soup->corner_count, n);
  for (size_t v = 0; v < n; v++)
    assert_int_equal(soup->indices[v], v);
  vxm_soup_destroy(soup);
  bytes_free(&text);
}

/* ---- Random files ---- */

static void random_file(bytes *b, vxm_rng *rng, const vxm_soup *soup) {
  static const char *const newlines[] = {"\n", "\r\n", "\r"};
  const char *newline = newlines[vxm_rng_below(rng, 3)];
  bool faces_first = vxm_rng_below(rng, 4) == 0, relative = !faces_first && vxm_rng_below(rng, 2);
  for (int pass = 0; pass < 2; pass++) {
    if ((pass == 0) != faces_first)
      for (size_t v = 0; v < soup->vertex_count; v++) {
        const double *p = vxm_position(soup, v);
        bytes_text(b, "v  %.17g\t%.17g %.17g%s", p[0], p[1], p[2], newline);
        if (vxm_rng_below(rng, 8) == 0)
          bytes_text(b, "# v 1 2 3%svn 0 0 1%svt 1 1%s", newline, newline, newline);
      }
    else
      for (size_t f = 0; f < soup->face_count; f++) {
        size_t n;
        const uint32_t *corner = vxm_face(soup, f, &n);
        bytes_text(b, "f");
        for (size_t c = 0; c < n; c++) {
          static const char *const behind[] = {"", "/1", "//2", "/3/4", "/-1/-1"};
          long long index = (long long)corner[c] + 1;
          if (relative && vxm_rng_below(rng, 2))
            index -= (long long)soup->vertex_count + 1;
          bytes_text(b, "%s%lld%s", vxm_rng_below(rng, 10) ? " " : " \\\n ", index,
                     behind[vxm_rng_below(rng, 5)]);
        }
        bytes_text(b, "%s", newline);
      }
  }
}

static void test_random_files(void **state) {
  (void)state;
  vxm_rng rng = {8};
  for (int i = 0; i < 400; i++) {
    vxm_soup *soup =
        random_soup(&rng, 3 + (size_t)vxm_rng_below(&rng, 40), 1 + (size_t)vxm_rng_below(&rng, 40), 9);
    bytes text = {0};
    random_file(&text, &rng, soup);
    vxm_soup *back = read_data(text.data, text.size, "x.obj");
    expect_same(soup, back);
    expect_no_damage(back);
    vxm_soup_destroy(back);
    for (int k = 0; k < 10; k++) {
      vxm_error error = VXM_ERROR_INIT;
      if (read_bytes(&back, text.data, (size_t)vxm_rng_below(&rng, text.size), "x.obj", &error) == VXM_OK)
        vxm_soup_destroy(back);
    }
    vxm_soup_destroy(soup);
    bytes_free(&text);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_faces),       cmocka_unit_test(test_vertices),
                                     cmocka_unit_test(test_damage),      cmocka_unit_test(test_tags),
                                     cmocka_unit_test(test_many_tags),   cmocka_unit_test(test_long_lines),
                                     cmocka_unit_test(test_random_files)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

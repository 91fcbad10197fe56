/* SPDX-License-Identifier: BSD-3-Clause */
/** Which reader is chosen, UTF-16, foreign files, the memory limit and cancelling. */
#include "meshio_test.h"

#include "meshio/external/external_formats.h"

#define OFF_TEXT "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
#define OBJ_TEXT "# made\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
#define STL_TEXT \
  "solid x\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"
#define PLY_TEXT                                                                                    \
  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" \
  "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"

static const struct {
  const char *text, *format;
} forms[] = {{OFF_TEXT, "off"}, {OBJ_TEXT, "obj"}, {STL_TEXT, "stl ascii"}, {PLY_TEXT, "ply ascii"}};

static void test_content_before_name(void **state) {
  (void)state;
  static const char *const files[] = {"a.off", "a.OBJ", "dir.x/a.stl", "a.ply", "a.txt", "a", "-", ""};
  for (size_t i = 0; i < 4; i++)
    for (size_t k = 0; k < sizeof files / sizeof *files; k++)
      for (int mark = 0; mark < 2; mark++) {
        char text[512];
        snprintf(text, sizeof text, "%s%s", mark ? "\xef\xbb\xbf" : "", forms[i].text);
        vxm_soup *soup = read_text(text, files[k]);
        assert_string_equal(soup->format, forms[i].format);
        expect_counts(soup, 3, 1);
        expect_no_warnings(soup);
        vxm_soup_destroy(soup);
      }
}

static void test_utf16(void **state) {
  (void)state;
  for (size_t i = 0; i < 4; i++)
    for (int big = 0; big < 2; big++) {
      bytes b = {0};
      const unsigned char *mark = (const unsigned char *)(big ? "\xfe\xff" : "\xff\xfe");
      bytes_add(&b, mark, 2);
      for (const char *p = forms[i].text; *p; p++) {
        unsigned char pair[2] = {0, 0};
        pair[big] = (unsigned char)*p;
        bytes_add(&b, pair, 2);
      }
      vxm_soup *soup = read_data(b.data, b.size, "a.x");
      assert_string_equal(soup->format, forms[i].format);
      expect_counts(soup, 3, 1);
      vxm_soup_destroy(soup);
      bytes_free(&b);
    }
  /* A name beyond ASCII, a pair of surrogates and half a pair: "g a ae U+1F600 lone". */
  static const unsigned char units[][2] = {{'g', 0},     {' ', 0},     {0xe4, 0},
                                           {0x3d, 0xd8}, {0x00, 0xde}, {0x00, 0xdc}};
  bytes b = {0};
  bytes_add(&b, "\xff\xfe", 2);
  for (const char *p = OBJ_TEXT; *p; p++)
    bytes_add(&b, (unsigned char[]){(unsigned char)*p, 0}, 2);
  bytes_add(&b, units, sizeof units);
  for (const char *p = "\nf 3 2 1\n"; *p; p++)
    bytes_add(&b, (unsigned char[]){(unsigned char)*p, 0}, 2);
  vxm_soup *soup = read_data(b.data, b.size, "a.obj");
  assert_int_equal(soup->tag_count, 2);
  assert_string_equal(soup->tags[1], "\xc3\xa4\xf0\x9f\x98\x80\xef\xbf\xbd");
  vxm_soup_destroy(soup);
  bytes_free(&b);
}

static void test_strangers(void **state) {
  (void)state;
  static const struct {
    const char *text, *part;
  } cases[] = {
      {"\x1f\x8b\x08\x01", "gzip"},
      {"PK\x03\x04xx", "zip"},
      {"<!DOCTYPE html>\n", "web page"},
      {"version https://git-lfs.github.com/spec/v1\n", "git lfs pull"},
      {"#binvox 1\n", "binvox"},
      {"what is this\n",
       "a.dat: not a known mesh format by content or extension; what is read here: off obj stl ply"}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    text_fails(cases[i].text, "dir/a.dat", cases[i].part);
  /* A zip archive by content, which is no use to unpack. */
  text_fails("PK\x03\x04xx", "a.usdz", "a.usdz: USD is not read: export it as .glb or .obj");
  text_fails("", "a.off", "a.off: the file is empty");
  text_fails("\xef\xbb\xbf", "a.off", "empty");
  text_fails("what is this\n", "a.obj", "not a mesh");
  text_fails("what is this\n", "a.stl", "neither text");
  text_fails("what is this\n", "a.off", "no OFF header");
  text_fails("what is this\n", "a.ply", "a.ply");
}

/** With a limit too small for the soup the read fails cleanly, at every size. */
static void test_memory_limit(void **state) {
  (void)state;
  for (size_t i = 0; i < 4; i++)
    for (uint64_t limit = 64; limit < 16384; limit += 64) {
      vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
      options.memory_limit = limit;
      vxm_context *context;
      vxm_soup *soup;
      vxm_error error = VXM_ERROR_INIT;
      assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
      vxm_status status = vxm_meshio_read(&soup, context, (const unsigned char *)forms[i].text,
                                          strlen(forms[i].text), "a", NULL, &error);
      if (status == VXM_OK)
        expect_counts(soup, 3, 1);
      else
        assert_int_equal(status, VXM_ERROR_MEMORY_LIMIT);
      assert_true(vxm_context_peak_bytes(context) <= limit);
      if (limit > 15000)
        assert_int_equal(status, VXM_OK);
      vxm_soup_destroy(soup);
      vxm_context_destroy(context);
    }
}

static int stop_after(const char *phase, double fraction, void *payload) {
  assert_string_equal(phase, "reading");
  assert_true(fraction >= 0.0 && fraction <= 1.0);
  return --*(int *)payload < 0;
}

static void test_cancel(void **state) {
  (void)state;
  /* Large enough for several reports on the way. */
  bytes b = {0};
  bytes_text(&b, "OFF\n1000000 0 0\n");
  for (int v = 0; v < 1000000; v++)
    bytes_text(&b, "%d 0.5 0.25\n", v);
  for (int calls = 0; calls < 4; calls++) {
    int left = calls;
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.progress = stop_after;
    options.payload = &left;
    vxm_context *context;
    vxm_soup *soup;
    vxm_error error = VXM_ERROR_INIT;
    assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
    assert_int_equal(vxm_meshio_read(&soup, context, b.data, b.size, "a.off", NULL, &error),
                     VXM_ERROR_CANCELLED);
    assert_null(soup);
    assert_int_equal(left, -1);
    vxm_context_destroy(context);
  }
  bytes_free(&b);
}

/** Whether a mesh may be said to be of this format: it is another failure that ends the reading of nonsense.
 */
static bool is_format_name(const char *word) {
  static const char nonsense[] = "what is this";
  vxm_mesh_read_options options = VXM_MESH_READ_OPTIONS_INIT;
  vxm_error error = VXM_ERROR_INIT;
  vxm_soup *soup;
  options.format = word;
  vxm_status status = vxm_meshio_read(&soup, NULL, (const unsigned char *)nonsense, strlen(nonsense),
                                      "<stdin>", &options, &error);
  assert_int_not_equal(status, VXM_OK);
  return status != VXM_ERROR_ARGUMENT;
}

/** The lists of what libraries are given name each extension of the table, and no other; each is a name. */
static void test_lists(void **state) {
  (void)state;
  static const char *const lists[] = {VXM_ASSIMP_FORMATS, VXM_OCCT_FORMATS};
  for (int l = 0; l < 2; l++) {
    char list[200], *next = NULL;
    snprintf(list, sizeof list, "%s", lists[l]);
    for (char *word = strtok_r(list, " ", &next); word; word = strtok_r(NULL, " ", &next)) {
      const vxm_external_format *format = vxm_external_format_by_extension(word);
      assert_non_null(format);
      assert_int_equal(format->is_cad, l == 1);
      assert_null(vxm_external_format_refusal(word));
      assert_true(is_format_name(word));
      for (int e = 0; e < VXM_EXTERNAL_EXTENSIONS && format->extensions[e]; e++)
        assert_non_null(strstr(lists[l], format->extensions[e]));
    }
  }
  assert_true(is_format_name("STLA"));
  assert_false(is_format_name("word"));
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_content_before_name),
                                     cmocka_unit_test(test_utf16),
                                     cmocka_unit_test(test_strangers),
                                     cmocka_unit_test(test_memory_limit),
                                     cmocka_unit_test(test_cancel),
                                     cmocka_unit_test(test_lists)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Files that end too early: at bytes all over each format, or with VOXMEND_TEST_CUTS in the environment at
 * all. Whole faces are read, nothing is taken from half a number without a word, and what is missing is told.
 */
#include "meshio_test.h"

/* A torus: closed, with indices of one to three digits and coordinates of many. */
enum { RING = 13, TUBE = 9, VERTICES = RING * TUBE, QUADS = VERTICES };

typedef struct shape {
  double at[VERTICES][3];
  int corner[QUADS][4];
} shape;

static shape torus(void) {
  const double turn = 6.283185307179586;
  shape s;
  for (int i = 0; i < RING; i++)
    for (int k = 0; k < TUBE; k++) {
      int v = i * TUBE + k, right = (i + 1) % RING, up = (k + 1) % TUBE;
      double a = turn * i / RING, b = turn * k / TUBE, r = 30 + 12.5 * cos(b);
      s.at[v][0] = r * cos(a), s.at[v][1] = r * sin(a), s.at[v][2] = 12.5 * sin(b);
      for (int c = 0; c < 3; c++) /* what six decimals bring back, and floats too */
        s.at[v][c] = round(s.at[v][c] * 64) / 64;
      s.corner[v][0] = v, s.corner[v][1] = right * TUBE + k;
      s.corner[v][2] = right * TUBE + up, s.corner[v][3] = i * TUBE + up;
    }
  return s;
}

/** A file, and where each face is whole in it. */
typedef struct file {
  bytes b;
  size_t face_end[QUADS];
  int corners;      /**< of each face */
  bool vertex_last; /**< faces come first, so that they need the end of the file */
  bool solid;       /**< something tells where the end is */
  bool counts;      /**< something tells how much should follow */
} file;

/* ---- The files ---- */

static void put_vertices(file *f, const shape *s, const char *head, const char *tail) {
  for (int v = 0; v < VERTICES; v++)
    bytes_text(&f->b, "%s%.6f %.6f %.6f%s", head, s->at[v][0], s->at[v][1], s->at[v][2], tail);
}

/** Faces as a count, indices with something behind each, and a tail. */
static void put_faces(file *f, const shape *s, const char *head, int first, const char *behind,
                      const char *tail) {
  for (int q = 0; q < QUADS; q++) {
    bytes_text(&f->b, "%s", head);
    for (int c = 0; c < f->corners; c++)
      bytes_text(&f->b, "%s%d%s", c || *head ? " " : "", s->corner[q][c] + first, behind);
    f->face_end[q] = f->b.size;
    bytes_text(&f->b, "%s", tail);
  }
}

static void make_off(file *f, const shape *s, int variant) {
  static const struct {
    const char *head, *after_vertex, *after_face;
  } variants[] = {
      {"OFF\n", "\n", "\n"}, {"OFF\r\n", "\r\n", "\r\n"},   {"COFF\n", " 255 0 0 255\n", " 3 10 200 30\n"},
      {"OFF ", " ", " "},    {"OFF\n", " 255 0 0\n", "\n"}, {"COFF\n", "\n255 0 0 255\n", "\n"}};
  bytes_text(&f->b, "%s%d %d 0%s", variants[variant].head, VERTICES, QUADS, variant == 3 ? " " : "\n");
  put_vertices(f, s, "", variants[variant].after_vertex);
  put_faces(f, s, f->corners == 4 ? "4" : "3", 0, "", variants[variant].after_face);
}

static void make_obj(file *f, const shape *s, int variant) {
  static const char *const behind[] = {"", "/12/345", "//17", ""};
  f->counts = false;
  f->vertex_last = variant == 3;
  if (variant != 3)
    put_vertices(f, s, "v ", "\n");
  put_faces(f, s, "f", 1, behind[variant], "\n");
  if (variant == 3)
    put_vertices(f, s, "v ", "\n");
}

static void make_ply(file *f, const shape *s, int variant) {
  const char *vertex = "element vertex %d\nproperty float x\nproperty float y\nproperty float z\n";
  const char *face = "element face %d\nproperty list uchar int vertex_indices\n";
  f->vertex_last = variant == 2;
  bytes_text(&f->b, "ply\nformat ascii 1.0\n");
  if (variant != 2)
    bytes_text(&f->b, vertex, VERTICES);
  bytes_text(&f->b, face, QUADS);
  if (variant == 1)
    bytes_text(&f->b, "property uchar red\n");
  if (variant == 2)
    bytes_text(&f->b, vertex, VERTICES);
  bytes_text(&f->b, "end_header\n");
  if (variant != 2)
    put_vertices(f, s, "", "\n");
  put_faces(f, s, f->corners == 4 ? "4" : "3", 0, "", variant == 1 ? " 128\n" : "\n");
  if (variant == 2)
    put_vertices(f, s, "", "\n");
}

static void make_stl(file *f, const shape *s, int variant) {
  (void)variant;
  f->corners = 3;
  f->solid = true;
  bytes_text(&f->b, "solid torus\n");
  for (int q = 0; q < QUADS; q++) {
    bytes_text(&f->b, "facet normal 0 0 1\nouter loop\n");
    for (int c = 0; c < 3; c++) {
      const double *p = s->at[s->corner[q][c]];
      bytes_text(&f->b, "vertex %.6f %.6f %.6f\n", p[0], p[1], p[2]);
    }
    f->face_end[q] = f->b.size;
    bytes_text(&f->b, "endloop\nendfacet\n");
  }
  bytes_text(&f->b, "endsolid torus\n");
}

static void add_float(bytes *b, double value) {
  float single = (float)value;
  bytes_add(b, &single, 4);
}

static void make_binary_stl(file *f, const shape *s, int variant) {
  char head[80] = "";
  uint32_t count = QUADS;
  snprintf(head, sizeof head, "%s", variant == 0 ? "made by hand" : variant == 1 ? "solid" : "OFF\n8 12 0\n");
  f->corners = 3;
  bytes_add(&f->b, head, sizeof head);
  bytes_add(&f->b, &count, 4);
  for (int q = 0; q < QUADS; q++) {
    for (int c = 0; c < 3; c++)
      add_float(&f->b, 0);
    for (int c = 0; c < 9; c++)
      add_float(&f->b, s->at[s->corner[q][c / 3]][c % 3]);
    bytes_add(&f->b, "\0", 2);
    f->face_end[q] = f->b.size;
  }
}

static void make_binary_ply(file *f, const shape *s, int variant) {
  (void)variant;
  bytes_text(&f->b,
             "ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
             "property float z\nelement face %d\nproperty list uchar int vertex_indices\nend_header\n",
             VERTICES, QUADS);
  for (int v = 0; v < VERTICES; v++)
    for (int c = 0; c < 3; c++)
      add_float(&f->b, s->at[v][c]);
  for (int q = 0; q < QUADS; q++) {
    unsigned char n = (unsigned char)f->corners;
    bytes_add(&f->b, &n, 1);
    bytes_add(&f->b, s->corner[q], 4 * (size_t)n);
    f->face_end[q] = f->b.size;
  }
}

/* ---- The cuts ---- */

static bool has_warning(const vxm_soup *soup, const char *part) {
  for (int n = 0; n < soup->warnings.count; n++)
    if (strstr(soup->warnings.text[n], part))
      return true;
  return false;
}

static bool is_face(const vxm_soup *soup, size_t face, const file *f, const shape *s) {
  size_t n;
  const uint32_t *corner = vxm_face(soup, face, &n);
  if (n != (size_t)f->corners)
    return false;
  for (size_t c = 0; c < n; c++)
    for (int a = 0; a < 3; a++)
      if (vxm_position(soup, corner[c])[a] != s->at[s->corner[face][c]][a])
        return false;
  return true;
}

static void check_cut(const file *f, const shape *s, const char *name, size_t size) {
  size_t whole = 0;
  vxm_soup *soup;
  vxm_error error = VXM_ERROR_INIT;
  while (whole < QUADS && f->face_end[whole] < size) /* with at least a line end behind it, in a text */
    whole++;
  vxm_status status = read_bytes(&soup, f->b.data, size, name, &error);
  if (status != VXM_OK && whole > 0 && !f->vertex_last)
    fail_msg("%s cut to %zu bytes has %zu whole faces, but is refused: %s", name, size, whole, error.text);
  if (status != VXM_OK)
    return;
  bool told = has_warning(soup, "may be cut off");
  for (size_t q = 0; q < soup->face_count && !f->vertex_last; q++)
    if (!is_face(soup, q, f, s) && !(told && q + 1 == soup->face_count))
      fail_msg("%s cut to %zu bytes has a wrong face %zu of %zu: \"%.*s\"", name, size, q, soup->face_count,
               20, (const char *)f->b.data + size - 20);
  if (f->vertex_last) /* which faces were kept depends on their vertices: whatever is used must be right */
    for (size_t c = 0; c < soup->corner_count; c++)
      for (int a = 0; a < 3; a++)
        if (vxm_position(soup, soup->indices[c])[a] != s->at[soup->indices[c]][a] && !told)
          fail_msg("%s cut to %zu bytes has a wrong vertex %u", name, size, soup->indices[c]);
  if (!f->vertex_last && soup->face_count < whole)
    fail_msg("%s cut to %zu bytes has %zu faces, not %zu", name, size, soup->face_count, whole);
  /* A text that lacks no more than its last line end, or the name behind endsolid, is whole. An OBJ whose
     vertices are all used, and that ends with a line, could be whole. */
  bool is_whole =
      size >= f->face_end[QUADS - 1] && soup->face_count == QUADS && (!f->solid || size + 7 >= f->b.size);
  bool could_be = !f->counts && soup->face_count + TUBE + 2 >= QUADS;
  if (soup->warnings.count == 0 && !is_whole && !could_be)
    fail_msg("%s cut to %zu of %zu bytes says nothing; %zu faces", name, size, f->b.size, soup->face_count);
  vxm_soup_destroy(soup);
}

typedef void make_fn(file *f, const shape *s, int variant);

static void cut_everywhere(make_fn *make, int variants, const char *name) {
  shape s = torus();
  for (int variant = 0; variant < variants; variant++)
    for (int corners = 3; corners <= 4; corners++) {
      file f = {.corners = corners, .counts = true};
      make(&f, &s, variant);
      if (f.corners != corners && corners == 4) { /* triangles only */
        bytes_free(&f.b);
        continue;
      }
      vxm_soup *soup = read_data(f.b.data, f.b.size, name);
      assert_int_equal(soup->face_count, QUADS);
      expect_no_warnings(soup);
      for (size_t q = 0; q < QUADS; q++)
        assert_true(is_face(soup, q, &f, &s));
      vxm_soup_destroy(soup);
      vxm_rng rng = {(uint64_t)variant};
      bool all = getenv("VOXMEND_TEST_CUTS") != NULL;
      for (size_t size = 0; size < f.b.size;) {
        check_cut(&f, &s, name, size);
        bool near = f.b.size - size < 100 || size < 100;
        size += all || near ? 1 : 1 + (size_t)vxm_rng_below(&rng, 13);
      }
      bytes_free(&f.b);
    }
}

static void test_off(void **state) {
  (void)state;
  cut_everywhere(make_off, 6, "x.off");
}

static void test_obj(void **state) {
  (void)state;
  cut_everywhere(make_obj, 4, "x.obj");
}

static void test_ply(void **state) {
  (void)state;
  cut_everywhere(make_ply, 3, "x.ply");
  cut_everywhere(make_binary_ply, 1, "x.ply");
}

static void test_stl(void **state) {
  (void)state;
  cut_everywhere(make_stl, 1, "x.stl");
  cut_everywhere(make_binary_stl, 3, "x.stl");
}

/* ---- Single cases ---- */

static void test_last_numbers(void **state) {
  (void)state;
  /* The last index is believed where no more could follow, or where a neighbour has the edge. */
  vxm_soup *soup = read_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2", "x.off");
  expect_counts(soup, 3, 1);
  expect_no_warnings(soup);
  vxm_soup_destroy(soup);
  /* Of four faces announced three are there; the third ends in what may be half a number. */
  soup = read_text("OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 1 2 3", "x.off");
  expect_counts(soup, 4, 2);
  expect_warning(soup, "line 9: the file ends after 2 of 4 faces");
  vxm_soup_destroy(soup);
  soup = read_text(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 3\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n"
      "3 0 1 2\n3 2 1 0",
      "x.ply");
  expect_counts(soup, 3, 1);
  expect_warning(soup, "line 14: the file ends after 1 of 3 elements \"face\"");
  vxm_soup_destroy(soup);
  soup = read_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nv 0.5 1.2", "x.obj");
  expect_counts(soup, 3, 1);
  expect_warning(soup, "line 5: the file ends within a vertex; skipped");
  vxm_soup_destroy(soup);
  soup = read_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nv 0.5 1.2 3", "x.obj");
  expect_warning(soup, "line 5: the file ends without a line end; its last line may be cut off");
  vxm_soup_destroy(soup);
  soup = read_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\n", "x.obj");
  expect_warning(soup, "line 6: the file may be cut off: no face uses 1 of its 4 vertices");
  vxm_soup_destroy(soup);
  soup = read_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1 2/2/1 3/3", "x.obj");
  expect_counts(soup, 3, 1);
  expect_warning(soup, "line 4: the file ends without a line end; its last line may be cut off");
  vxm_soup_destroy(soup);
  /* Lines use vertices too. */
  soup = read_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nl 3 4\n", "x.obj");
  expect_no_warnings(soup);
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_off), cmocka_unit_test(test_obj),
                                     cmocka_unit_test(test_ply), cmocka_unit_test(test_stl),
                                     cmocka_unit_test(test_last_numbers)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

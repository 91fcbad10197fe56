/* SPDX-License-Identifier: BSD-3-Clause */
/** What is written comes back: bit for bit from OFF, OBJ and PLY, as triangles of floats from STL; polygons
 * as they are where that is asked for, else as triangles. */
#include "meshio_test.h"

#include "mesh/triangulate.h"

#include <dirent.h>
#include <fcntl.h>
#include <float.h>
#include <unistd.h>

static char folder[] = "/tmp/voxmend-meshio-XXXXXX";

static const char *path_of(const char *name) {
  static char path[256];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  return path;
}

static void write_ok(const vxm_soup *soup, const char *name, const char *format, bool ascii) {
  vxm_error error = VXM_ERROR_INIT;
  unsigned how = (unsigned)VXM_WRITE_POLYGONS | (ascii ? VXM_WRITE_ASCII : 0u);
  if (vxm_meshio_write(soup, path_of(name), format, how, &error) != VXM_OK)
    fail_msg("%s", error.text);
}

static vxm_soup *read_file(const char *name) {
  vxm_context *context;
  vxm_input input;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_context_create(&context, NULL, &error), VXM_OK);
  assert_int_equal(vxm_input_open(&input, context, path_of(name), &error), VXM_OK);
  vxm_soup *soup = read_data(input.data, input.size, name);
  vxm_input_close(&input);
  vxm_context_destroy(context);
  return soup;
}

static size_t files_in_folder(void) {
  DIR *dir = opendir(folder);
  assert_non_null(dir);
  size_t count = 0;
  for (struct dirent *entry; (entry = readdir(dir)) != NULL;)
    count += entry->d_name[0] != '.';
  closedir(dir);
  return count;
}

static void test_round_trips(void **state) {
  (void)state;
  static const struct {
    const char *name;
    bool ascii;
    const char *format;
  } forms[] = {{"a.off", false, "off"},
               {"a.obj", false, "obj"},
               {"a.ply", false, "ply binary_little_endian"},
               {"b.PLY", true, "ply ascii"}};
  vxm_rng rng = {11};
  for (int i = 0; i < 40; i++) {
    /* Now and then polygons of more corners than a byte can count. */
    vxm_soup *soup = random_soup(&rng, 3 + (size_t)vxm_rng_below(&rng, 300),
                                 (size_t)vxm_rng_below(&rng, 300) + 1, i % 4 ? 12 : 400);
    for (size_t k = 0; k < sizeof forms / sizeof *forms; k++) {
      write_ok(soup, forms[k].name, NULL, forms[k].ascii);
      vxm_soup *back = read_file(forms[k].name);
      assert_string_equal(back->format, forms[k].format);
      expect_same(soup, back);
      expect_no_damage(back);
      vxm_soup_destroy(back);
      unlink(path_of(forms[k].name));
    }
    vxm_soup_destroy(soup);
  }
}

/** Without VXM_WRITE_POLYGONS the faces are the triangles that vxm_triangulate makes of them, in their order,
 * and have their tags; a face of two corners is none. */
static void test_triangles(void **state) {
  (void)state;
  static const char *const files[] = {"p.off", "p.obj", "p.ply"};
  vxm_rng rng = {31};
  vxm_soup *soup = random_soup(&rng, 60, 80, 9), *expected;
  for (size_t i = 0; i < 3 * soup->vertex_count; i++)
    soup->positions[i] = (double)vxm_rng_below(&rng, 1000) / 7;
  uint32_t tag, pair[2] = {0, 1};
  assert_int_equal(vxm_soup_add_face(soup, pair, 2, NULL), VXM_OK);
  assert_int_equal(vxm_soup_add_tag(soup, "part", 4, &tag, NULL), VXM_OK);
  assert_int_equal(vxm_soup_add_tag(soup, "other", 5, &tag, NULL), VXM_OK);
  soup->face_tags = vxm_alloc(soup->context, soup->face_count, sizeof *soup->face_tags, NULL);
  for (size_t f = 0; f < soup->face_count; f++)
    soup->face_tags[f] = (uint32_t)(f >= soup->face_count / 2);
  assert_int_equal(vxm_soup_create(&expected, soup->context, "", NULL), VXM_OK);
  for (size_t v = 0; v < soup->vertex_count; v++)
    assert_int_equal(vxm_soup_add_vertex(expected, vxm_position(soup, v)[0], vxm_position(soup, v)[1],
                                         vxm_position(soup, v)[2], NULL),
                     VXM_OK);
  vxm_triangulator tri;
  vxm_triangulator_open(&tri, soup->context);
  for (size_t f = 0, n; f < soup->face_count; f++) {
    const uint32_t *corner = vxm_face(soup, f, &n), *triangles;
    if (n < 3)
      continue;
    assert_int_equal(vxm_triangulate(&tri, soup->positions, corner, n, &triangles, NULL), VXM_OK);
    for (size_t t = 0; t + 2 < n; t++)
      assert_int_equal(vxm_soup_add_face(expected, triangles + 3 * t, 3, NULL), VXM_OK);
  }
  vxm_triangulator_close(&tri);
  for (int i = 0; i < 4; i++) {
    assert_int_equal(vxm_meshio_write(soup, path_of(files[i % 3]), NULL, i == 3 ? VXM_WRITE_ASCII : 0, NULL),
                     VXM_OK);
    vxm_soup *back = read_file(files[i % 3]);
    expect_counts(back, expected->vertex_count, expected->face_count);
    assert_memory_equal(back->indices, expected->indices, expected->corner_count * sizeof *back->indices);
    assert_memory_equal(back->positions, expected->positions, 24 * expected->vertex_count);
    if (i == 1) {
      assert_string_equal(back->tags[back->face_tags[0]], "part");
      assert_string_equal(back->tags[back->face_tags[back->face_count - 1]], "other");
    }
    vxm_soup_destroy(back);
    unlink(path_of(files[i % 3]));
  }
  vxm_soup_destroy(expected);
  vxm_soup_destroy(soup);
}

static void test_special_values(void **state) {
  (void)state;
  vxm_soup *soup = random_soup(&(vxm_rng){12}, 5, 4, 4);
  static const double values[] = {-0.0, HUGE_VAL, -HUGE_VAL, 5e-324, DBL_MAX, 0.1, 1e22, 1e23};
  memcpy(soup->positions, values, sizeof values);
  static const char *const files[] = {"v.off", "v.obj", "v.ply"};
  for (int i = 0; i < 3; i++) {
    write_ok(soup, files[i], NULL, i == 2);
    vxm_soup *back = read_file(files[i]);
    expect_same(soup, back);
    vxm_soup_destroy(back);
    soup->positions[9] = (double)NAN;
    write_ok(soup, files[i], NULL, i == 2);
    back = read_file(files[i]);
    assert_true(isnan(back->positions[9]));
    assert_true(back->positions[10] == soup->positions[10]);
    vxm_soup_destroy(back);
    soup->positions[9] = 1.0;
    unlink(path_of(files[i]));
  }
  vxm_soup_destroy(soup);
}

static void test_empty(void **state) {
  (void)state;
  vxm_soup *soup = random_soup(&(vxm_rng){13}, 4, 0, 3);
  static const char *const files[] = {"e.off", "e.obj", "e.ply", "e.stl"};
  for (int i = 0; i < 8; i++) {
    write_ok(soup, files[i / 2], NULL, i % 2);
    vxm_soup *back = read_file(files[i / 2]);
    expect_counts(back, i / 2 == 3 ? 0 : 4, 0);
    vxm_soup_destroy(back);
    unlink(path_of(files[i / 2]));
  }
  vxm_soup_destroy(soup);
}

static void test_tags(void **state) {
  (void)state;
  vxm_rng rng = {14};
  static const char *const names[] = {"default", "wing",      "wing/red", "a b/c d",
                                      "x/y/z",   "wing/blue", "default/m"};
  vxm_soup *soup = random_soup(&rng, 30, 200, 5);
  uint32_t tag;
  for (size_t t = 0; t < 7; t++)
    assert_int_equal(vxm_soup_add_tag(soup, names[t], strlen(names[t]), &tag, NULL), VXM_OK);
  soup->face_tags = vxm_alloc(soup->context, 200, sizeof *soup->face_tags, NULL);
  for (size_t f = 0; f < 200; f++)
    soup->face_tags[f] = (uint32_t)vxm_rng_below(&rng, 7);
  write_ok(soup, "t.obj", NULL, false);
  vxm_soup *back = read_file("t.obj");
  expect_same(soup, back);
  for (size_t f = 0; f < 200; f++)
    assert_string_equal(back->tags[back->face_tags[f]], names[soup->face_tags[f]]);
  vxm_soup_destroy(back);
  vxm_soup_destroy(soup);
  unlink(path_of("t.obj"));
}

static void test_stl(void **state) {
  (void)state;
  vxm_rng rng = {15};
  vxm_soup *soup = random_soup(&rng, 100, 300, 3);
  for (size_t i = 0; i < 300; i++)
    if (fabs(soup->positions[i]) > 1e30)
      soup->positions[i] = 1e30;
  for (int ascii = 0; ascii < 2; ascii++) {
    write_ok(soup, "s.stl", NULL, ascii);
    vxm_soup *back = read_file("s.stl");
    assert_string_equal(back->format, ascii ? "stl ascii" : "stl binary");
    expect_counts(back, 900, 300);
    for (size_t c = 0; c < 900; c++)
      for (size_t a = 0; a < 3; a++)
        assert_true(vxm_position(back, c)[a] == (double)(float)vxm_position(soup, soup->indices[c])[a]);
    vxm_soup_destroy(back);
  }
  unlink(path_of("s.stl"));
  /* The first value that no float holds, and the last that one does. */
  vxm_error error = VXM_ERROR_INIT;
  soup->positions[3 * 7 + 1] = -0x1.ffffffp127;
  assert_int_equal(vxm_meshio_write(soup, path_of("s.stl"), NULL, false, &error), VXM_ERROR_RANGE);
  assert_int_equal(error.element, 7);
  assert_non_null(strstr(error.text, "vertex 7: y"));
  soup->positions[3 * 7 + 1] = nextafter(-0x1.ffffffp127, 0.0);
  write_ok(soup, "s.stl", NULL, false);
  unlink(path_of("s.stl"));
  vxm_soup_destroy(soup);
}

static void test_failures(void **state) {
  (void)state;
  vxm_soup *soup = random_soup(&(vxm_rng){16}, 10, 10, 4);
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_meshio_write(soup, "-", NULL, false, &error), VXM_ERROR_ARGUMENT);
  assert_non_null(strstr(error.text, "off, obj, stl or ply"));
  assert_int_equal(vxm_meshio_write(soup, path_of("x.dae"), NULL, false, &error), VXM_ERROR_ARGUMENT);
  assert_non_null(strstr(error.text, "\"dae\""));
  assert_int_equal(vxm_meshio_write(soup, path_of("x.off"), "3ds", false, &error), VXM_ERROR_ARGUMENT);
  assert_int_equal(vxm_meshio_write(soup, path_of("no/such/x.off"), NULL, false, &error), VXM_ERROR_IO);
  assert_int_equal(files_in_folder(), 0);
  write_ok(soup, "x.dat", "Off", false);
  vxm_soup *back = read_file("x.dat");
  expect_same(soup, back);
  vxm_soup_destroy(back);
  unlink(path_of("x.dat"));
  if (access("/dev/full", W_OK) == 0)
    assert_int_equal(vxm_meshio_write(soup, "/dev/full", "ply", false, &error), VXM_ERROR_IO);
  vxm_soup_destroy(soup);
}

static void test_standard_output(void **state) {
  (void)state;
  vxm_soup *soup = random_soup(&(vxm_rng){19}, 10, 10, 4);
  vxm_error error = VXM_ERROR_INIT;
  fflush(stdout);
  int kept = dup(STDOUT_FILENO), file = open(path_of("out"), O_CREAT | O_WRONLY, 0666);
  assert_true(kept >= 0 && file >= 0 && dup2(file, STDOUT_FILENO) >= 0);
  vxm_status status = vxm_meshio_write(soup, "-", "ply", VXM_WRITE_POLYGONS, &error);
  assert_true(dup2(kept, STDOUT_FILENO) >= 0);
  close(kept);
  close(file);
  assert_int_equal(status, VXM_OK);
  vxm_soup *back = read_file("out");
  expect_same(soup, back);
  vxm_soup_destroy(back);
  vxm_soup_destroy(soup);
  unlink(path_of("out"));
}

static int stop(const char *phase, double fraction, void *payload) {
  assert_string_equal(phase, "writing");
  assert_true(fraction >= 0.0 && fraction <= 1.0);
  return --*(int *)payload < 0;
}

static void test_cancel(void **state) {
  (void)state;
  int calls = 1;
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.progress = stop;
  options.payload = &calls;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
  vxm_soup *soup;
  assert_int_equal(vxm_soup_create(&soup, context, "arrays", NULL), VXM_OK);
  for (int v = 0; v < 200000; v++)
    assert_int_equal(vxm_soup_add_vertex(soup, v, 0.5, 0.25, NULL), VXM_OK);
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_meshio_write(soup, path_of("c.off"), NULL, false, &error), VXM_ERROR_CANCELLED);
  assert_int_equal(files_in_folder(), 0);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

/* ---- Polygons into triangles ---- */

typedef struct polygon {
  size_t n;
  double position[3 * 2048];
  uint32_t corner[2048];
} polygon;

/** Lays a polygon given in the plane somewhere in space. */
static void place(polygon *p, vxm_rng *rng) {
  double u[3], v[3];
  for (int c = 0; c < 3; c++) {
    u[c] = vxm_rng_unit(rng) - 0.5;
    v[c] = vxm_rng_unit(rng) - 0.5;
  }
  for (size_t i = 0; i < p->n; i++) {
    double a = p->position[3 * i], b = p->position[3 * i + 1];
    for (int c = 0; c < 3; c++)
      p->position[3 * i + (size_t)c] = a * u[c] + b * v[c];
    p->corner[i] = (uint32_t)i;
  }
}

static void vector_area(const double *positions, const uint32_t *corners, size_t n, double area[3]) {
  area[0] = area[1] = area[2] = 0.0;
  const double *o = positions + 3 * (size_t)corners[0];
  for (size_t i = 1; i + 1 < n; i++) {
    const double *a = positions + 3 * (size_t)corners[i], *b = positions + 3 * (size_t)corners[i + 1];
    for (size_t c = 0; c < 3; c++) {
      size_t d = (c + 1) % 3, e = (c + 2) % 3;
      area[c] += (a[d] - o[d]) * (b[e] - o[e]) - (a[e] - o[e]) * (b[d] - o[d]);
    }
  }
}

/**
 * The triangles' boundary is the polygon's (each inner edge runs both ways), so if none is turned round they
 * cover the polygon once and nothing else.
 */
static void expect_covered(const polygon *p, vxm_triangulator *tri) {
  const uint32_t *triangles;
  assert_int_equal(vxm_triangulate(tri, p->position, p->corner, p->n, &triangles, NULL), VXM_OK);
  double whole[3], piece[3];
  vector_area(p->position, p->corner, p->n, whole);
  double size = sqrt(whole[0] * whole[0] + whole[1] * whole[1] + whole[2] * whole[2]);
  int *balance = calloc(p->n * p->n, sizeof *balance);
  assert_non_null(balance);
  for (size_t i = 0; i < p->n; i++)
    balance[i * p->n + (i + 1) % p->n]--;
  for (size_t t = 0; t + 2 < p->n; t++) {
    vector_area(p->position, triangles + 3 * t, 3, piece);
    assert_true(piece[0] * whole[0] + piece[1] * whole[1] + piece[2] * whole[2] > -1e-12 * size * size);
    for (size_t k = 0; k < 3; k++)
      balance[triangles[3 * t + k] * p->n + triangles[3 * t + (k + 1) % 3]]++;
  }
  for (size_t a = 0; a < p->n; a++)
    for (size_t b = 0; b < a; b++)
      assert_int_equal(balance[a * p->n + b], balance[b * p->n + a]);
  free(balance);
}

static void test_triangulate(void **state) {
  (void)state;
  static polygon p;
  vxm_rng rng = {17};
  vxm_triangulator tri;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, NULL, NULL), VXM_OK);
  vxm_triangulator_open(&tri, context);
  for (int i = 0; i < 1000; i++) {
    /* A star: every corner is seen from the middle. Turned either way. */
    p.n = 4 + (size_t)vxm_rng_below(&rng, 40);
    double way = i % 2 ? 1.0 : -1.0;
    for (size_t k = 0; k < p.n; k++) {
      double angle = 2.0 * 3.141592653589793 * (double)k / (double)p.n, radius = 0.1 + vxm_rng_unit(&rng);
      p.position[3 * k] = radius * cos(angle);
      p.position[3 * k + 1] = way * radius * sin(angle);
    }
    place(&p, &rng);
    expect_covered(&p, &tri);
  }
  for (int teeth = 1; teeth < 40; teeth++) {
    /* A comb. */
    p.n = 0;
    for (int k = 0; k <= 2 * teeth; k++) {
      p.position[3 * p.n] = k;
      p.position[3 * p.n++ + 1] = k % 2 ? 0.01 : 10.0;
    }
    p.position[3 * p.n] = 2 * teeth;
    p.position[3 * p.n++ + 1] = -1.0;
    p.position[3 * p.n] = 0.0;
    p.position[3 * p.n++ + 1] = -1.0;
    place(&p, &rng);
    expect_covered(&p, &tri);
  }
  /* A spiral of 200 corners. */
  p.n = 200;
  for (size_t k = 0; k < 100; k++) {
    double angle = 0.2 * (double)k, outer = 1.0 + 0.1 * angle, inner = outer - 0.3;
    p.position[3 * k] = outer * cos(angle);
    p.position[3 * k + 1] = outer * sin(angle);
    p.position[3 * (199 - k)] = inner * cos(angle);
    p.position[3 * (199 - k) + 1] = inner * sin(angle);
  }
  place(&p, &rng);
  expect_covered(&p, &tri);
  vxm_triangulator_close(&tri);
  vxm_context_destroy(context);
}

/** Polygons that no triangulation can get right still give n - 2 triangles, in time. */
static void test_triangulate_nonsense(void **state) {
  (void)state;
  static polygon p;
  vxm_rng rng = {18};
  vxm_triangulator tri;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, NULL, NULL), VXM_OK);
  vxm_triangulator_open(&tri, context);
  for (int i = 0; i < 300; i++) {
    p.n = i == 0 ? 2000 : 4 + (size_t)vxm_rng_below(&rng, 30);
    for (size_t k = 0; k < p.n; k++) {
      p.corner[k] = (uint32_t)vxm_rng_below(&rng, p.n);
      for (size_t c = 0; c < 3; c++)
        p.position[3 * k + c] = i % 3 == 0 ? vxm_rng_unit(&rng) : i % 3 == 1 ? 1.0 : (double)NAN;
    }
    const uint32_t *triangles;
    assert_int_equal(vxm_triangulate(&tri, p.position, p.corner, p.n, &triangles, NULL), VXM_OK);
    for (size_t t = 0; t < 3 * (p.n - 2); t++)
      assert_true(triangles[t] < p.n);
  }
  vxm_triangulator_close(&tri);
  vxm_context_destroy(context);
}

static void test_stl_polygons(void **state) {
  (void)state;
  vxm_soup *soup;
  assert_int_equal(vxm_soup_create(&soup, NULL, "arrays", NULL), VXM_OK);
  static const double corners[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (int i = 0; i < 6; i++)
    assert_int_equal(vxm_soup_add_vertex(soup, corners[i][0], corners[i][1], 5.0, NULL), VXM_OK);
  assert_int_equal(vxm_soup_add_face(soup, (uint32_t[]){2, 3, 4, 5, 0, 1}, 6, NULL), VXM_OK);
  assert_int_equal(vxm_soup_add_face(soup, (uint32_t[]){0, 1}, 2, NULL), VXM_OK);
  write_ok(soup, "p.stl", NULL, false);
  vxm_soup *back = read_file("p.stl");
  expect_counts(back, 12, 4);
  double area = 0.0;
  for (size_t f = 0; f < 4; f++) {
    double piece[3];
    vector_area(back->positions, back->indices + 3 * f, 3, piece);
    assert_true(piece[2] > 0.0);
    area += piece[2] / 2;
  }
  assert_true(area == 3.0);
  vxm_soup_destroy(back);
  vxm_soup_destroy(soup);
  unlink(path_of("p.stl"));
}

static int make_folder(void **state) {
  (void)state;
  return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state) {
  (void)state;
  return rmdir(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_round_trips),
                                     cmocka_unit_test(test_triangles),
                                     cmocka_unit_test(test_special_values),
                                     cmocka_unit_test(test_empty),
                                     cmocka_unit_test(test_tags),
                                     cmocka_unit_test(test_stl),
                                     cmocka_unit_test(test_failures),
                                     cmocka_unit_test(test_cancel),
                                     cmocka_unit_test(test_standard_output),
                                     cmocka_unit_test(test_triangulate),
                                     cmocka_unit_test(test_stl_polygons),
                                     cmocka_unit_test(test_triangulate_nonsense)};
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}

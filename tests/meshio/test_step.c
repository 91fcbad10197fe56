/* SPDX-License-Identifier: BSD-3-Clause */
/** STEP through OpenCASCADE: assemblies, units, deflection, and damage. */
#include "external_test.h"

#include <locale.h>

#include "scenes.h"

/** OpenCASCADE never frees its table of drivers (TPrsStd_DriverTable), nor means to. */
VXM_API const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void) {
  return "leak:libTK\n";
}

static const double bounds[6] = {-STOOL_WIDTH / 2.0, -STOOL_DEPTH / 2.0, 0,
                                 STOOL_WIDTH / 2.0,  STOOL_DEPTH / 2.0,  STOOL_LEG + STOOL_SEAT};
static const double seat_volume = (double)STOOL_WIDTH * STOOL_DEPTH * STOOL_SEAT;
static const double legs_volume =
    STOOL_LEGS * 3.14159265358979323846 * STOOL_RADIUS * STOOL_RADIUS * STOOL_LEG;

static bytes replaced(const bytes *whole, const char *what, const char *with) {
  bytes b = {0};
  const unsigned char *at = memmem(whole->data, whole->size, what, strlen(what));
  assert_non_null(at);
  bytes_add(&b, whole->data, (size_t)(at - whole->data));
  bytes_add(&b, with, strlen(with));
  at += strlen(what);
  bytes_add(&b, at, whole->size - (size_t)(at - whole->data));
  return b;
}

static vxm_soup *read_with(const bytes *b, const char *name, double deflection) {
  vxm_mesh_read_options options = VXM_MESH_READ_OPTIONS_INIT;
  vxm_error error = VXM_ERROR_INIT;
  vxm_soup *soup;
  options.deflection = deflection;
  if (vxm_meshio_read(&soup, NULL, b->data, b->size, name, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  check_invariants(soup);
  return soup;
}

/** Volume of the faces with a tag, which is closed by itself. */
static double tag_volume(const vxm_soup *soup, uint32_t tag) {
  double volume = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    if (soup->face_tags[f] != tag)
      continue;
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n);
    const double *a = vxm_position(soup, corner[0]), *b = vxm_position(soup, corner[1]),
                 *c = vxm_position(soup, corner[2]);
    volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0])) /
              6;
  }
  return volume;
}

static void test_stool(void **state) {
  (void)state;
  static const char *const tags[] = {"seat", "leg#1", "leg#2", "leg#3", "leg#4", NULL};
  static const char *const names[] = {"dir/stool.step", "STOOL.STP", "stool.txt", "stool"};
  if (!vxm_module_exists("occt"))
    skip();
  bytes b = scene_bytes(scene_write_step);
  for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
    vxm_soup *soup = read_with(&b, names[n], 0);
    assert_string_equal(soup->format, "step");
    expect_no_warnings(soup);
    expect_tags(soup, tags);
    vxm_census census = VXM_CENSUS_INIT;
    assert_int_equal(vxm_soup_census(&census, soup, NULL), VXM_OK);
    assert_true(census.watertight);
    assert_int_equal(census.components, 5);
    assert_int_equal(census.inconsistent_edges, 0);
    for (int i = 0; i < 6; i++)
      assert_true(fabs(census.bounds[i] - bounds[i]) < 1e-9);
    assert_true(fabs(tag_volume(soup, 0) - seat_volume) < 1e-6 * seat_volume);
    for (uint32_t t = 1; t <= STOOL_LEGS; t++)
      assert_true(fabs(tag_volume(soup, t) * STOOL_LEGS - legs_volume) < 0.01 * legs_volume);
    vxm_soup_destroy(soup);
  }
  bytes_free(&b);
}

/** A finer deflection comes nearer to the round legs, from inside, in a locale with a comma, too; the rule
 * for small ones is the angle. */
static void test_deflection(void **state) {
  (void)state;
  static const double deflections[] = {0.1, 1e-3, 1e-4, 1e-5};
  if (!vxm_module_exists("occt"))
    skip();
  bytes b = scene_bytes(scene_write_step);
  double error_before = INFINITY;
  size_t faces_before = 0;
  if (!setlocale(LC_NUMERIC, "de_DE.UTF-8"))
    print_message("no locale with a comma here\n");
  for (size_t d = 0; d < sizeof deflections / sizeof *deflections; d++) {
    vxm_soup *soup = read_with(&b, "a.step", deflections[d]);
    vxm_census census = VXM_CENSUS_INIT;
    assert_int_equal(vxm_soup_census(&census, soup, NULL), VXM_OK);
    assert_true(census.watertight);
    double missing = seat_volume + legs_volume - census.volume;
    assert_true(missing > 0 && missing <= error_before);
    assert_true(soup->face_count >= faces_before);
    if (d + 1 == sizeof deflections / sizeof *deflections) {
      /* The chords of a circle are no farther off than asked: that bounds the share of each leg's disc. */
      double diagonal = sqrt(pow(STOOL_WIDTH, 2) + pow(STOOL_DEPTH, 2) + pow(STOOL_LEG + STOOL_SEAT, 2));
      assert_true(missing < legs_volume * 2 * deflections[d] * diagonal / STOOL_RADIUS);
      assert_true(soup->face_count > 2 * faces_before);
    }
    error_before = missing;
    faces_before = soup->face_count;
    vxm_soup_destroy(soup);
  }
  setlocale(LC_NUMERIC, "C");
  bytes_free(&b);
}

static void test_units(void **state) {
  (void)state;
  if (!vxm_module_exists("occt"))
    skip();
  bytes b = scene_bytes(scene_write_step),
        metres = replaced(&b, "SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT($,.METRE.)");
  vxm_soup *soup = read_with(&metres, "a.step", 0);
  vxm_census census = VXM_CENSUS_INIT;
  assert_int_equal(vxm_soup_census(&census, soup, NULL), VXM_OK);
  assert_true(fabs(census.bounds[5] - 1000.0 * (STOOL_LEG + STOOL_SEAT)) < 1e-3);
  vxm_soup_destroy(soup);
  bytes_free(&metres);
  bytes_free(&b);
}

/** Reads the scene's file with some words in place of others. */
static void expect_names(const char *const changes[][2], size_t count, const char *const tags[]) {
  bytes b = scene_bytes(scene_write_step);
  for (size_t c = 0; c < count; c++) {
    bytes changed = replaced(&b, changes[c][0], changes[c][1]);
    bytes_free(&b);
    b = changed;
  }
  vxm_soup *soup = read_with(&b, "a.step", 0);
  expect_tags(soup, tags);
  vxm_soup_destroy(soup);
  bytes_free(&b);
}

/** The name of a use comes before that of the product, unless a program made it up. */
static void test_names(void **state) {
  (void)state;
  static const char *const tags[] = {"the seat", "leg#1", "left leg", "leg#2", "M\xc3\xbcller", NULL};
  if (!vxm_module_exists("occt"))
    skip();
  static const char *const changes[][2] = {
      {"('NAUO1','',", "('NAUO1','the seat',"},
      {"('NAUO2','',", "('NAUO2','NAUO2',"},
      {"('NAUO3','',", "('NAUO3','left leg',"},
      {"('NAUO5','',", "('NAUO5','M\\X2\\00FC\\X0\\ller',"},
  };
  expect_names(changes, sizeof changes / sizeof *changes, tags);
}

/** What a program counts uses by is no name, unless it stands where names do. */
static void test_counted_uses(void **state) {
  (void)state;
  static const char *const tags[] = {"seat", "leg#1", "7", "leg#2", "leg#3", NULL};
  static const char *const changes[][2] = {
      {"('NAUO1','',", "('9','',"},
      {"('NAUO2','',", "('10','10',"},
      {"('NAUO3','',", "('11','7',"},
  };
  if (!vxm_module_exists("occt"))
    skip();
  expect_names(changes, sizeof changes / sizeof *changes, tags);
}

/** The number of the entity whose text holds `part`, the `nth` of those. */
static int entity_with(const bytes *b, const char *part, int nth) {
  const char *text = (const char *)b->data, *at = text;
  for (int n = 0; n <= nth; n++) {
    at = strstr(n == 0 ? at : at + 1, part);
    assert_non_null(at);
  }
  while (*at != '#' || (at > text && at[-1] != '\n'))
    at--;
  return (int)strtol(at + 1, NULL, 10);
}

/** A product of two bodies: their names stand behind its own. */
static void test_bodies(void **state) {
  (void)state;
  static const char *const tags[] = {"seat/plank", "seat/rod", "leg#1", "leg#2", "leg#3", "leg#4", NULL};
  if (!vxm_module_exists("occt"))
    skip();
  bytes b = scene_bytes(scene_write_step);
  bytes_add(&b, "", 1); /* a text for strstr */
  char one[64], both[64];
  int plank = entity_with(&b, "MANIFOLD_SOLID_BREP", 0), rod = entity_with(&b, "MANIFOLD_SOLID_BREP", 1);
  snprintf(one, sizeof one, ",#%d),", plank);
  snprintf(both, sizeof both, ",#%d,#%d),", plank, rod);
  bytes joined = replaced(&b, one, both);
  bytes first = replaced(&joined, "MANIFOLD_SOLID_BREP('',", "MANIFOLD_SOLID_BREP('plank',");
  bytes second = replaced(&first, "MANIFOLD_SOLID_BREP('',", "MANIFOLD_SOLID_BREP('rod',");
  second.size--; /* the zero byte */
  vxm_soup *soup = read_with(&second, "a.step", 0);
  expect_tags(soup, tags);
  assert_true(fabs(tag_volume(soup, 0) - seat_volume) < 1e-6 * seat_volume);
  assert_true(fabs(tag_volume(soup, 1) * STOOL_LEGS - legs_volume) < 0.01 * legs_volume);
  vxm_soup_destroy(soup);
  bytes_free(&b);
  bytes_free(&joined);
  bytes_free(&first);
  bytes_free(&second);
}

static void test_not_step(void **state) {
  (void)state;
  if (!vxm_module_exists("occt"))
    skip();
  text_fails("ISO-10303-21;\nHEADER;\n", "a.dat", "a.dat: OpenCASCADE cannot read it: ");
  text_fails("what is this\n", "a.step", "a.step: OpenCASCADE cannot read it: ");
  text_fails("what is this\n", "a.iges", "a.iges: OpenCASCADE cannot read it: ");
  vxm_mesh_read_options options = VXM_MESH_READ_OPTIONS_INIT;
  vxm_error error = VXM_ERROR_INIT;
  vxm_soup *soup;
  bytes b = scene_bytes(scene_write_step);
  options.format = "step";
  assert_int_equal(vxm_meshio_read(&soup, NULL, b.data, b.size, "a.off", &options, &error), VXM_OK);
  vxm_soup_destroy(soup);
  options.format = "iges";
  assert_int_equal(vxm_meshio_read(&soup, NULL, b.data, b.size, "a.step", &options, &error),
                   VXM_ERROR_FORMAT);
  bytes_free(&b);
}

/** Under every memory limit the whole comes, or a message that tells of the limit: no face is left out. */
static void limit_memory(const bytes *b, double deflection) {
  enum { LEAST = 1 << 20, MOST = 256 << 20 };
  vxm_mesh_read_options options = VXM_MESH_READ_OPTIONS_INIT;
  options.deflection = deflection;
  vxm_soup *whole = read_with(b, "a.step", deflection);
  int refused = 0, reads = 0;
  for (size_t limit = LEAST; limit < MOST; limit += limit / 2) {
    vxm_context_options context_options = VXM_CONTEXT_OPTIONS_INIT;
    context_options.memory_limit = limit;
    vxm_context *context;
    vxm_error error = VXM_ERROR_INIT;
    vxm_soup *soup;
    assert_int_equal(vxm_context_create(&context, &context_options, NULL), VXM_OK);
    vxm_status status = vxm_meshio_read(&soup, context, b->data, b->size, "a.step", &options, &error);
    if (status == VXM_OK) {
      expect_no_warnings(soup);
      expect_counts(soup, whole->vertex_count, whole->face_count);
      vxm_soup_destroy(soup);
      reads++;
    } else if (status != VXM_ERROR_MEMORY_LIMIT)
      fail_msg("under a limit of %zu bytes: %s", limit, error.text);
    else
      refused++;
    vxm_context_destroy(context);
  }
  assert_true(refused > 0 && reads > 0);
  vxm_soup_destroy(whole);
}

static void test_memory_limits(void **state) {
  (void)state;
  if (!vxm_module_exists("occt") || SANITIZED)
    skip();
  bytes b = scene_bytes(scene_write_step);
  limit_memory(&b, 0);
  limit_memory(&b, 1e-6);
  bytes_free(&b);
}

static int stop(const char *phase, double fraction, void *payload) {
  (void)phase;
  (void)fraction;
  return ++*(int *)payload > 2;
}

static void test_cancel(void **state) {
  (void)state;
  if (!vxm_module_exists("occt"))
    skip();
  int calls = 0;
  vxm_context_options context_options = VXM_CONTEXT_OPTIONS_INIT;
  context_options.progress = stop;
  context_options.payload = &calls;
  vxm_mesh_read_options options = VXM_MESH_READ_OPTIONS_INIT;
  options.deflection = 1e-6; /* takes a while */
  vxm_context *context;
  vxm_error error = VXM_ERROR_INIT;
  vxm_soup *soup;
  bytes b = scene_bytes(scene_write_step);
  assert_int_equal(vxm_context_create(&context, &context_options, NULL), VXM_OK);
  assert_int_equal(vxm_meshio_read(&soup, context, b.data, b.size, "a.step", &options, &error),
                   VXM_ERROR_CANCELLED);
  assert_null(soup);
  vxm_context_destroy(context);
  bytes_free(&b);
}

static void test_damage(void **state) {
  (void)state;
  enum { TIMES = 30 / SLOWER };
  if (!vxm_module_exists("occt"))
    skip();
  bytes b = scene_bytes(scene_write_step);
  damage_many(&b, "a.step", TIMES);
  bytes_free(&b);
}

static void test_in_process(void **state) {
  (void)state;
  if (!vxm_module_exists("occt"))
    skip();
  bytes b = scene_bytes(scene_write_step);
  for (int times = 0; times < 2; times++)
    vxm_soup_destroy(read_in_process("occt", "step", &b));
  bytes_free(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_stool),        cmocka_unit_test(test_deflection),
                                     cmocka_unit_test(test_units),        cmocka_unit_test(test_names),
                                     cmocka_unit_test(test_cancel),       cmocka_unit_test(test_not_step),
                                     cmocka_unit_test(test_damage),       cmocka_unit_test(test_bodies),
                                     cmocka_unit_test(test_in_process),   cmocka_unit_test(test_counted_uses),
                                     cmocka_unit_test(test_memory_limits)};
  leave_signals_alone();
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "shared.h"

#include "mesh/census.h"

#include <math.h>

static vxm_census census_of(const vxm_soup *soup) {
  vxm_census census = VXM_CENSUS_INIT;
  assert_int_equal(vxm_soup_census(&census, soup, NULL), VXM_OK);
  return census;
}

/* ---- Against counting by hand ---- */

/** Counts of a soup with vertices on a small lattice, from the definitions, by comparing everything. */
typedef struct by_hand {
  uint32_t map[32];
  bool real[64]; /**< faces with three distinct corners */
} by_hand;

static void prepare(by_hand *h, const vxm_soup *soup) {
  for (uint32_t v = 0; v < soup->vertex_count; v++) {
    h->map[v] = v;
    for (uint32_t u = v; u-- > 0;)
      if (memcmp(vxm_position(soup, u), vxm_position(soup, v), 3 * sizeof(double)) == 0)
        h->map[v] = u;
  }
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count, distinct = 0;
    const uint32_t *face = vxm_face(soup, f, &count);
    for (size_t i = 0; i < count; i++) {
      bool seen = false;
      for (size_t j = 0; j < i; j++)
        seen |= h->map[face[i]] == h->map[face[j]];
      distinct += !seen;
    }
    h->real[f] = distinct >= 3;
  }
}

/** All corners on one line through the first, in whole numbers. */
static bool is_flat(const vxm_soup *soup, const uint32_t *face, size_t count) {
  const double *o = vxm_position(soup, face[0]);
  for (size_t i = 1; i + 1 < count; i++) {
    const double *p = vxm_position(soup, face[i]), *q = vxm_position(soup, face[i + 1]);
    double a[3], b[3];
    for (int axis = 0; axis < 3; axis++) {
      a[axis] = p[axis] - o[axis];
      b[axis] = q[axis] - o[axis];
    }
    for (int axis = 0; axis < 3; axis++)
      if (a[axis] * b[(axis + 1) % 3] != a[(axis + 1) % 3] * b[axis])
        return false;
  }
  return true;
}

static vxm_census count_edges_by_hand(const vxm_soup *soup, const by_hand *h) {
  vxm_census census = {0};
  bool odd = false, any = false;
  for (size_t f = 0; f < soup->face_count; f++)
    any |= h->real[f];
  for (uint32_t a = 0; a < soup->vertex_count; a++)
    for (uint32_t b = a + 1; b < soup->vertex_count; b++) {
      int sides = 0, forward = 0;
      for (size_t f = 0; f < soup->face_count; f++) {
        size_t count;
        const uint32_t *face = vxm_face(soup, f, &count);
        for (size_t i = 0; i < count && h->real[f]; i++) {
          uint32_t u = h->map[face[i]], v = h->map[face[(i + 1) % count]];
          sides += (u == a && v == b) || (u == b && v == a);
          forward += u == a && v == b;
        }
      }
      census.boundary_edges += sides == 1;
      census.nonmanifold_edges += sides > 2;
      census.inconsistent_edges += sides == 2 && forward != 1;
      odd |= sides % 2 == 1;
    }
  census.watertight = any && census.boundary_edges == 0 && census.nonmanifold_edges == 0;
  census.closed = any && !odd;
  return census;
}

static int64_t components_by_hand(const vxm_soup *soup, const uint32_t *map) {
  size_t label[64];
  for (size_t f = 0; f < soup->face_count; f++)
    label[f] = f;
  for (bool changed = true; changed;) {
    changed = false;
    for (size_t f = 0; f < soup->face_count; f++)
      for (size_t g = 0; g < f; g++) {
        size_t n, m;
        const uint32_t *a = vxm_face(soup, f, &n), *b = vxm_face(soup, g, &m);
        bool touch = false;
        for (size_t i = 0; i < n; i++)
          for (size_t j = 0; j < m; j++)
            touch |= map ? map[a[i]] == map[b[j]] : a[i] == b[j];
        if (touch && label[f] != label[g]) {
          label[f] = label[g] = label[f] < label[g] ? label[f] : label[g];
          changed = true;
        }
      }
  }
  int64_t count = 0;
  for (size_t f = 0; f < soup->face_count; f++)
    count += label[f] == f;
  return count;
}

static void equals_counting(void **state) {
  (void)state;
  vxm_rng rng = {31};
  vxm_context *context = context_of_threads(2);
  int closed = 0;
  for (int round = 0; round < 500; round++) {
    vxm_soup *soup = random_soup(context, &rng, 1 + (size_t)vxm_rng_below(&rng, 20),
                                 (size_t)vxm_rng_below(&rng, round % 4 ? 25 : 5), round % 2 ? 2 : 3, 6);
    static by_hand h;
    prepare(&h, soup);
    vxm_census census = census_of(soup), edges = count_edges_by_hand(soup, &h);
    int64_t degenerate = 0, triangles = 0, largest = 0, unused = 0;
    for (size_t f = 0; f < soup->face_count; f++) {
      size_t count;
      const uint32_t *face = vxm_face(soup, f, &count);
      degenerate += !h.real[f] || is_flat(soup, face, count);
      triangles += count > 2 ? (int64_t)count - 2 : 0;
      largest = (int64_t)count > largest ? (int64_t)count : largest;
    }
    for (size_t v = 0; v < soup->vertex_count; v++) {
      bool used = false;
      for (size_t c = 0; c < soup->corner_count; c++)
        used |= soup->indices[c] == v;
      unused += !used;
    }
    assert_int_equal(census.vertices, soup->vertex_count);
    assert_int_equal(census.faces, soup->face_count);
    assert_int_equal(census.degenerate_faces, degenerate);
    assert_int_equal(census.triangles, triangles);
    assert_int_equal(census.largest_face, largest);
    assert_int_equal(census.unused_vertices, unused);
    assert_int_equal(census.nonfinite_vertices, 0);
    assert_int_equal(census.boundary_edges, edges.boundary_edges);
    assert_int_equal(census.nonmanifold_edges, edges.nonmanifold_edges);
    assert_int_equal(census.inconsistent_edges, edges.inconsistent_edges);
    assert_int_equal(census.watertight, edges.watertight);
    assert_int_equal(census.closed, edges.closed);
    assert_int_equal(census.components, components_by_hand(soup, h.map));
    assert_int_equal(census.components_raw, components_by_hand(soup, NULL));
    closed += census.closed;
    vxm_soup_destroy(soup);
  }
  assert_true(closed > 5);
  vxm_context_destroy(context);
}

/* ---- Measures ---- */

static void assert_near(double value, double wanted, double relative) {
  if (!(fabs(value - wanted) <= relative * fabs(wanted)))
    fail_msg("%.17g is not %.17g", value, wanted);
}

static void cubes_of_any_size_and_place(void **state) {
  (void)state;
  static const double sizes[] = {1, 1e-100, 1e100, 1e-3, 12345};
  vxm_context *context = context_of_threads(2);
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
    for (int far = 0; far < 2; far++) {
      double s = sizes[i];
      vxm_soup *soup = new_soup(context);
      add_cube(soup, 0);
      for (size_t c = 0; c < 3 * soup->vertex_count; c++)
        soup->positions[c] = soup->positions[c] * s + (far ? 1e4 * s : 0);
      vxm_census census = census_of(soup);
      double side = soup->positions[3] - soup->positions[0];
      assert_near(census.area, 6 * side * side, 1e-10);
      assert_near(census.volume, side * side * side, 1e-10);
      assert_true(census.watertight && census.closed);
      assert_int_equal(census.degenerate_faces, 0);
      assert_int_equal(census.triangles, 12);
      assert_true(census.bounds[0] == (far ? 1e4 * s : 0) && census.bounds[3] == soup->positions[3]);
      /* turned inside out the volume changes its sign */
      for (size_t f = 0; f < 6; f++) {
        uint32_t *face = soup->indices + 4 * f, kept = face[1];
        face[1] = face[3];
        face[3] = kept;
      }
      assert_near(census_of(soup).volume, -side * side * side, 1e-10);
      vxm_soup_destroy(soup);
    }
  vxm_context_destroy(context);
}

static void measures_beyond_doubles(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(1);
  static const double sizes[] = {0x1p1023, 0x1p-1074, 0x1p-1060};
  for (size_t i = 0; i < 3; i++) {
    vxm_soup *soup = new_soup(context);
    add_cube(soup, 0);
    for (size_t c = 0; c < 3 * soup->vertex_count; c++)
      soup->positions[c] = (2 * soup->positions[c] - 1) * sizes[i];
    vxm_census census = census_of(soup);
    double measure = i == 0 ? (double)INFINITY : 0;
    assert_true(census.area == measure && census.volume == measure);
    assert_false(signbit(census.volume));
    assert_true(census.watertight);
    assert_int_equal(census.degenerate_faces, 0);
    assert_true(census.bounds[0] == -sizes[i] && census.bounds[5] == sizes[i]);
    vxm_soup_destroy(soup);
  }
  vxm_context_destroy(context);
}

static void not_finite_and_empty(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(2);
  vxm_soup *soup = new_soup(context);
  vxm_census census = census_of(soup), none = {0};
  assert_memory_equal(&census, &none, sizeof none);
  add_cube(soup, 0);
  vxm_census cube = census_of(soup);
  add_vertex(soup, NAN, 0, 0);
  add_vertex(soup, 0, -INFINITY, 0);
  add_vertex(soup, 100, 100, 100);
  add_triangle(soup, 0, 1, 8);
  add_triangle(soup, 0, 9, 1);
  census = census_of(soup);
  assert_int_equal(census.nonfinite_vertices, 2);
  assert_int_equal(census.unused_vertices, 1);
  assert_int_equal(census.degenerate_faces, 0);
  assert_int_equal(census.boundary_edges, 0);
  assert_int_equal(census.nonmanifold_edges, 0);
  assert_int_equal(census.components, 1);
  assert_true(census.watertight && census.closed);
  assert_true(census.area == cube.area && census.volume == cube.volume);
  assert_memory_equal(census.bounds, cube.bounds, sizeof cube.bounds);
  vxm_soup_destroy(soup);

  soup = new_soup(context);
  add_vertex(soup, NAN, NAN, NAN);
  for (int i = 0; i < 3; i++)
    add_triangle(soup, 0, 0, 0);
  add_face(soup, NULL, 0);
  census = census_of(soup);
  assert_int_equal(census.degenerate_faces, 1); /* the others are not finite */
  assert_int_equal(census.duplicate_faces, 0);
  assert_int_equal(census.components, 2);
  for (int i = 0; i < 6; i++)
    assert_true(census.bounds[i] == 0);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

/** Faces of a vertex that is not finite are as if they were not there, whichever vertex it is, and whether or
 * not others share positions. */
static void not_finite_opens(void **state) {
  (void)state;
  for (size_t v = 0; v < 16; v++) {
    vxm_context *context = context_of_threads(1);
    vxm_soup *soup = new_soup(context), *left = new_soup(context);
    add_cube(soup, 0);
    if (v >= 8) /* the same once more, to be welded, then to be open */
      add_cube(soup, 0);
    soup->positions[3 * v + v % 3] = v % 2 ? (double)NAN : (double)INFINITY;
    for (size_t i = 0; i < soup->vertex_count; i++)
      add_vertex(left, soup->positions[3 * i], soup->positions[3 * i + 1], soup->positions[3 * i + 2]);
    for (size_t f = 0; f < soup->face_count; f++) {
      size_t count, bad = 0;
      const uint32_t *corner = vxm_face(soup, f, &count);
      for (size_t c = 0; c < count; c++)
        bad += corner[c] == v;
      if (bad == 0)
        add_face(left, corner, count);
    }
    assert_true(left->face_count < soup->face_count);
    vxm_census census = census_of(soup), other = census_of(left);
    assert_int_equal(census.nonfinite_vertices, 1);
    assert_false(census.closed || census.watertight);
    assert_int_equal(census.boundary_edges, other.boundary_edges);
    assert_int_equal(census.nonmanifold_edges, other.nonmanifold_edges);
    assert_int_equal(census.degenerate_faces, other.degenerate_faces);
    assert_int_equal(census.duplicate_faces, other.duplicate_faces);
    assert_int_equal(census.components, other.components);
    assert_int_equal(census.components_raw, v < 8 ? 1 : 2);
    vxm_soup_destroy(left);
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
  }
}

static void same_for_any_threads(void **state) {
  (void)state;
  static const int threads[3] = {1, 2, 7};
  vxm_census first = VXM_CENSUS_INIT;
  for (int t = 0; t < 3; t++) {
    vxm_context *context = context_of_threads(threads[t]);
    vxm_soup *sheet = grid_sheet(context, 200);
    vxm_rng rng = {6};
    for (size_t c = 0; c < 3 * sheet->vertex_count; c++)
      sheet->positions[c] += vxm_rng_unit(&rng);
    vxm_census census = census_of(sheet);
    if (t == 0)
      first = census;
    assert_memory_equal(&census, &first, sizeof first);
    vxm_soup_destroy(sheet);
    vxm_context_destroy(context);
  }
}

/* ---- Limits ---- */

typedef struct countdown {
  int left;
} countdown;

static int stop_at_zero(const char *phase, double fraction, void *payload) {
  (void)phase;
  assert_true(fraction >= 0 && fraction <= 1);
  return ((countdown *)payload)->left-- == 0;
}

static void stops_at_limit_and_when_asked(void **state) {
  (void)state;
  int made = 0, refused = 0, cancelled = 0;
  for (int step = 0; step < 80; step++) {
    countdown count = {step < 20 ? step : -1};
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.memory_limit = step < 20 ? 0 : UINT64_C(30000) * (uint64_t)(step + 10);
    options.progress = stop_at_zero;
    options.payload = &count;
    vxm_context *context;
    assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
    vxm_soup *sheet = grid_sheet(context, 80);
    vxm_error error = VXM_ERROR_INIT;
    vxm_census census, none = {0};
    vxm_status status = vxm_soup_census(&census, sheet, &error);
    assert_int_equal(status, error.code);
    made += status == VXM_OK;
    refused += status == VXM_ERROR_MEMORY_LIMIT;
    cancelled += status == VXM_ERROR_CANCELLED;
    if (status != VXM_OK)
      assert_memory_equal(&census, &none, sizeof none);
    vxm_soup_destroy(sheet);
    vxm_context_destroy(context);
  }
  assert_int_equal(made + refused + cancelled, 80);
  assert_true(made > 2 && refused > 2 && cancelled > 3);
}

/* ---- Against the manifest of the shared meshes ---- */

typedef struct comparison {
  vxm_context *context;
  size_t differing;
} comparison;

static void compare_column(comparison *c, const shared_mesh *mesh, const char *column, int64_t value) {
  const char *wanted = shared_value(mesh, column);
  if (strcmp(wanted, "-") == 0 || strtoll(wanted, NULL, 10) == value)
    return;
  print_error("%s: %s is %lld, not %s\n", mesh->values[0], column, (long long)value, wanted);
  c->differing++;
}

static int64_t unused_by_notes(const shared_mesh *mesh) {
  const char *warnings = shared_value(mesh, "notes"), *found = strstr(warnings, " vertices used by no face");
  if (!found)
    return 0;
  while (found > warnings && found[-1] >= '0' && found[-1] <= '9')
    found--;
  return strtoll(found, NULL, 10);
}

static void compare_mesh(const shared_mesh *mesh, void *payload) {
  comparison *c = payload;
  vxm_soup *soup = read_soup(c->context, mesh->path);
  vxm_census census = census_of(soup);
  int64_t polygons = 0;
  for (size_t f = 0; f < soup->face_count; f++)
    polygons += soup->offsets[f + 1] - soup->offsets[f] > 3;
  compare_column(c, mesh, "n_vertices", census.vertices);
  compare_column(c, mesh, "n_faces", census.faces);
  compare_column(c, mesh, "n_faces_over_3_corners", polygons);
  compare_column(c, mesh, "components_merged", census.components);
  compare_column(c, mesh, "components_raw", census.components_raw);
  compare_column(c, mesh, "dup_faces_same", census.duplicate_faces);
  compare_column(c, mesh, "dup_faces_opposite", census.opposite_duplicate_faces);
  compare_column(c, mesh, "degenerate_faces", census.degenerate_faces);
  compare_column(c, mesh, "boundary_edges", census.boundary_edges);
  compare_column(c, mesh, "nonmanifold_edges", census.nonmanifold_edges);
  compare_column(c, mesh, "inconsistent_edges", census.inconsistent_edges);
  bool watertight = strcmp(shared_value(mesh, "watertight"), "yes") == 0;
  if (watertight != census.watertight || unused_by_notes(mesh) != census.unused_vertices) {
    print_error("%s: watertight %d, unused %lld\n", mesh->values[0], census.watertight,
                (long long)census.unused_vertices);
    c->differing++;
  }
  vxm_soup_destroy(soup);
}

static void equals_the_manifest(void **state) {
  (void)state;
  comparison c = {context_of_threads(2), 0};
  size_t count = for_each_shared_mesh(compare_mesh, &c);
  vxm_context_destroy(c.context);
  if (count == 0)
    skip();
  assert_int_equal(c.differing, 0);
  assert_true(count >= 140);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(equals_counting),
      cmocka_unit_test(cubes_of_any_size_and_place),
      cmocka_unit_test(measures_beyond_doubles),
      cmocka_unit_test(not_finite_and_empty),
      cmocka_unit_test(not_finite_opens),
      cmocka_unit_test(same_for_any_threads),
      cmocka_unit_test(stops_at_limit_and_when_asked),
      cmocka_unit_test(equals_the_manifest),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

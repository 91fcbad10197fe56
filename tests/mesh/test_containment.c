/* SPDX-License-Identifier: BSD-3-Clause */
#include "soups.h"

#include "mesh/components.h"
#include "mesh/containment.h"

#include <math.h>
#include <time.h>

typedef struct nested {
  vxm_containment nesting;
  uint32_t *labels;
  size_t count;
} nested;

static nested nest(vxm_soup *soup, const uint8_t *solid) {
  nested n;
  n.labels = malloc((soup->face_count + 1) * sizeof *n.labels);
  assert_non_null(n.labels);
  assert_int_equal(vxm_components(soup->context, soup, NULL, n.labels, &n.count, NULL), VXM_OK);
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_containment_build(&n.nesting, soup, n.labels, n.count, solid, &error) != VXM_OK)
    fail_msg("%s", error.text);
  assert_int_equal(n.nesting.count, n.count);
  return n;
}

static void nested_free(nested *n) {
  vxm_containment_destroy(&n->nesting);
  free(n->labels);
}

static void expect_parents(vxm_soup *soup, const uint32_t *parents, size_t count) {
  nested n = nest(soup, NULL);
  assert_int_equal(n.count, count);
  for (size_t i = 0; i < count; i++)
    if (n.nesting.parent[i] != parents[i])
      fail_msg("component %zu is in %u, not in %u", i, n.nesting.parent[i], parents[i]);
  nested_free(&n);
}

static void add_box(vxm_soup *soup, const double low[3], const double high[3], bool inward) {
  static const uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  uint32_t first = (uint32_t)soup->vertex_count;
  for (int v = 0; v < 8; v++)
    add_vertex(soup, v & 1 ? high[0] : low[0], v & 2 ? high[1] : low[1], v & 4 ? high[2] : low[2]);
  for (int f = 0; f < 6; f++) {
    uint32_t corners[4];
    for (int i = 0; i < 4; i++)
      corners[i] = first + faces[f][inward ? 3 - i : i];
    add_face(soup, corners, 4);
  }
}

static void add_cube_at(vxm_soup *soup, double x, double y, double z, double half, bool inward) {
  double low[3] = {x - half, y - half, z - half}, high[3] = {x + half, y + half, z + half};
  add_box(soup, low, high, inward);
}

/** A sphere of longitudes and latitudes; each face is left out or turned with a probability. */
static void add_sphere(vxm_soup *soup, double x, double radius, uint32_t rings, double missing, double turned,
                       vxm_rng *rng) {
  uint32_t first = (uint32_t)soup->vertex_count, around = 2 * rings;
  for (uint32_t j = 0; j <= rings; j++)
    for (uint32_t i = 0; i < around; i++) {
      double polar = acos(-1) * j / rings, azimuth = 2 * acos(-1) * i / around;
      add_vertex(soup, x + radius * sin(polar) * cos(azimuth), radius * sin(polar) * sin(azimuth),
                 radius * cos(polar));
    }
  for (uint32_t j = 0; j < rings; j++)
    for (uint32_t i = 0; i < around; i++) {
      uint32_t a = first + j * around + i, b = first + j * around + (i + 1) % around;
      uint32_t quad[2][3] = {{a, a + around, b + around}, {a, b + around, b}};
      for (int k = 0; k < 2; k++) {
        uint32_t *t = quad[k];
        if (vxm_rng_unit(rng) < missing)
          continue;
        if (vxm_rng_unit(rng) < turned)
          add_triangle(soup, t[0], t[2], t[1]);
        else
          add_triangle(soup, t[0], t[1], t[2]);
      }
    }
}

static void cubes_in_cubes(void **state) {
  (void)state;
  enum { LEVELS = 40 };
  vxm_context *context = context_of_threads(1);
  for (int order = 0; order < 2; order++) {
    vxm_soup *soup = new_soup(context);
    uint32_t parents[LEVELS];
    for (int i = 0; i < LEVELS; i++) {
      int level = order ? LEVELS - 1 - i : i;
      add_cube_at(soup, 5, -3, 7, 1 + level, i % 3 == 0);
      parents[i] = level == LEVELS - 1 ? VXM_NO_COMPONENT : (uint32_t)(order ? i - 1 : i + 1);
    }
    expect_parents(soup, parents, LEVELS);
    nested n = nest(soup, NULL);
    for (int i = 0; i < LEVELS; i++) {
      double half = 1 + (order ? LEVELS - 1 - i : i), volume = 8 * half * half * half;
      assert_true(fabs(n.nesting.volume[i] - (i % 3 == 0 ? -volume : volume)) < 1e-9 * volume);
    }
    nested_free(&n);
    vxm_soup_destroy(soup);
  }
  vxm_context_destroy(context);
}

static void spheres_side_by_side_and_interpenetrating(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(1);
  vxm_soup *soup = new_soup(context);
  vxm_rng rng = {1};
  add_sphere(soup, 0, 1, 20, 0, 0, &rng);
  add_sphere(soup, 3, 1, 20, 0, 0, &rng);       /* beside */
  add_sphere(soup, 3.5, 0.9, 20, 0, 0, &rng);   /* through the second */
  add_sphere(soup, 0.1, 0.8, 20, 0, 0, &rng);   /* in the first */
  add_sphere(soup, 3.2, 0.3, 20, 0, 0, &rng);   /* in the second and third, which is the smaller one */
  add_sphere(soup, 0.75, 0.24, 20, 0, 0, &rng); /* in the first, through the fourth */
  uint32_t parents[6] = {VXM_NO_COMPONENT, VXM_NO_COMPONENT, VXM_NO_COMPONENT, 0, 2, 0};
  expect_parents(soup, parents, 6);
  uint8_t solid[6] = {1, 1, 0, 0, 1, 1};
  nested n = nest(soup, solid);
  uint32_t with_solid[6] = {VXM_NO_COMPONENT, VXM_NO_COMPONENT, VXM_NO_COMPONENT, VXM_NO_COMPONENT, 1, 0};
  assert_memory_equal(n.nesting.parent, with_solid, sizeof with_solid);
  nested_free(&n);
  /* far away and tiny, or huge */
  static const double scales[4] = {1e-150, 1e-3, 1e6, 1e150};
  for (int s = 0; s < 4; s++) {
    vxm_soup *scaled;
    assert_int_equal(vxm_soup_copy(&scaled, soup, NULL), VXM_OK);
    for (size_t i = 0; i < 3 * scaled->vertex_count; i++)
      scaled->positions[i] *= scales[s];
    expect_parents(scaled, parents, 6);
    vxm_soup_destroy(scaled);
  }
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

/** A block with a bay, of polygons with up to 8 corners: as a letter U along y. */
static void add_u(vxm_soup *soup) {
  static const double outline[8][2] = {{0, 0}, {6, 0}, {6, 6}, {4, 6}, {4, 2}, {2, 2}, {2, 6}, {0, 6}};
  uint32_t first = (uint32_t)soup->vertex_count, caps[2][8];
  for (uint32_t i = 0; i < 8; i++) {
    add_vertex(soup, outline[i][0], 0, outline[i][1]);
    add_vertex(soup, outline[i][0], 4, outline[i][1]);
    caps[0][i] = first + 2 * i;
    caps[1][7 - i] = first + 2 * i + 1;
  }
  for (uint32_t i = 0; i < 8; i++) {
    uint32_t j = (i + 1) % 8, quad[4] = {first + 2 * i, first + 2 * i + 1, first + 2 * j + 1, first + 2 * j};
    add_face(soup, quad, 4);
  }
  add_face(soup, caps[0], 8);
  add_face(soup, caps[1], 8);
}

static void a_bay_is_outside(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(1);
  vxm_soup *soup = new_soup(context);
  add_u(soup);
  add_cube_at(soup, 3, 2, 4, 0.9, false);       /* in the bay */
  add_cube_at(soup, 1, 2, 4, 0.9, false);       /* in a leg */
  add_cube_at(soup, 3, 2, 1, 0.5, true);        /* in the foot */
  add_cube_at(soup, 3, 2, 4, 0.3, false);       /* in the one in the bay */
  add_cube_at(soup, 3.3, 2.3, 1.2, 0.1, false); /* in the one in the foot */
  uint32_t parents[6] = {VXM_NO_COMPONENT, VXM_NO_COMPONENT, 0, 0, 1, 3};
  expect_parents(soup, parents, 6);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

/** A tube whose ends are open is around a box whichever axis it stands along, and not around one beside it.
 */
static void tubes_without_ends(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(1);
  for (int along = 0; along < 3; along++) {
    vxm_soup *soup = new_soup(context);
    double at[3] = {0, 0, 0};
    for (int i = 0; i < 6; i++) { /* an L as seen along it */
      static const double outline[6][2] = {{0, 0}, {4, 0}, {4, 2}, {2, 2}, {2, 4}, {0, 4}};
      for (int end = 0; end < 2; end++) {
        at[along] = 4 * end;
        at[(along + 1) % 3] = outline[i][0];
        at[(along + 2) % 3] = outline[i][1];
        add_vertex(soup, at[0], at[1], at[2]);
      }
    }
    for (uint32_t i = 0; i < 6; i++) {
      uint32_t a = 2 * i, b = 2 * ((i + 1) % 6), quad[4] = {a, b, b + 1, a + 1};
      add_face(soup, quad, 4);
    }
    double in[3] = {1, 1, 1}, beside[3] = {3, 3, 3};
    in[along] = beside[along] = 2;
    add_cube_at(soup, in[0], in[1], in[2], 0.5, true);
    add_cube_at(soup, beside[0], beside[1], beside[2], 0.5, true);
    const uint32_t parents[3] = {VXM_NO_COMPONENT, 0, VXM_NO_COMPONENT};
    expect_parents(soup, parents, 3);
    vxm_soup_destroy(soup);
  }
  vxm_context_destroy(context);
}

static void missing_and_turned_faces_do_no_harm(void **state) {
  (void)state;
  enum { INNER = 60 };
  vxm_context *context = context_of_threads(1);
  vxm_rng rng = {7};
  int wrong = 0;
  for (int round = 0; round < 10; round++) {
    vxm_soup *soup = new_soup(context);
    add_sphere(soup, 0, 1, 40, 0.2, 0.3, &rng);
    uint32_t *labels = malloc(soup->face_count * sizeof *labels);
    assert_non_null(labels);
    size_t alone;
    assert_int_equal(vxm_components(context, soup, NULL, labels, &alone, NULL), VXM_OK);
    free(labels);
    bool in[INNER];
    for (int i = 0; i < INNER; i++) {
      double p[3], r = 0;
      for (int a = 0; a < 3; a++) {
        p[a] = 1.8 * vxm_rng_unit(&rng) - 0.9;
        r += p[a] * p[a];
      }
      add_cube_at(soup, p[0], p[1], p[2], 0.02, i % 2);
      in[i] = sqrt(r) < 0.95;
      if (fabs(sqrt(r) - 1) < 0.05) /* on the wall: anything will do */
        in[i] = sqrt(r) < 1;
    }
    nested n = nest(soup, NULL);
    assert_int_equal(n.count, alone + INNER);
    assert_true(n.nesting.volume[0] > 0);
    for (size_t i = 0; i < INNER; i++)
      wrong += (n.nesting.parent[alone + i] == 0) != in[i];
    nested_free(&n);
    vxm_soup_destroy(soup);
  }
  print_message("wrong in a sphere with a fifth of its faces missing: %d of %d\n", wrong, 10 * INNER);
  assert_true(wrong <= 10 * INNER / 20);
  vxm_context_destroy(context);
}

/** The sign of the volume under many turned faces, also where the box's middle is outside. */
static void volumes_of_turned_faces(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(1);
  vxm_rng rng = {11};
  for (int inward = 0; inward < 2; inward++) {
    vxm_soup *soup = new_soup(context);
    add_sphere(soup, 100, 1, 30, 0, inward ? 0.7 : 0.3, &rng);
    nested n = nest(soup, NULL);
    assert_int_equal(n.count, 1);
    double share = n.nesting.volume[0] / (4.0 / 3 * acos(-1));
    assert_true(inward ? share < -0.3 && share > -0.5 : share > 0.3 && share < 0.5);
    nested_free(&n);
    vxm_soup_destroy(soup);
  }
  vxm_context_destroy(context);
}

/** Trees of random boxes against the tree they were made as. */
static void random_trees_of_boxes(void **state) {
  (void)state;
  enum { BOXES = 300 };
  vxm_context *context = context_of_threads(1);
  vxm_rng rng = {5};
  for (int round = 0; round < 20; round++) {
    vxm_soup *soup = new_soup(context);
    double low[BOXES][3] = {{0}}, high[BOXES][3] = {{64, 64, 64}};
    uint32_t parents[BOXES] = {VXM_NO_COMPONENT};
    uint8_t used[BOXES] = {0};
    uint32_t count = 1;
    add_box(soup, low[0], high[0], false);
    /* each box holds at most eight others, one per octant, shrunk a little at random */
    for (uint32_t tries = 0; count < BOXES && tries < 20 * BOXES; tries++) {
      uint32_t p = (uint32_t)vxm_rng_below(&rng, count), octant = (uint32_t)vxm_rng_below(&rng, 8);
      if (used[p] >> octant & 1)
        continue;
      used[p] = (uint8_t)(used[p] | 1 << octant);
      for (int a = 0; a < 3; a++) {
        double middle = (low[p][a] + high[p][a]) / 2, part = (high[p][a] - low[p][a]) / 2;
        low[count][a] = (octant >> a & 1 ? middle : low[p][a]) + part * (0.05 + 0.1 * vxm_rng_unit(&rng));
        high[count][a] = (octant >> a & 1 ? high[p][a] : middle) - part * (0.05 + 0.1 * vxm_rng_unit(&rng));
      }
      parents[count] = p;
      add_box(soup, low[count], high[count], vxm_rng_below(&rng, 2));
      count++;
    }
    expect_parents(soup, parents, count);
    vxm_soup_destroy(soup);
  }
  vxm_context_destroy(context);
}

static double seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void many_in_one(void **state) {
  (void)state;
  enum { SIDE = 46, INNER = SIDE * SIDE * SIDE };
  vxm_context *context = context_of_threads(2);
  vxm_soup *soup = new_soup(context);
  vxm_rng rng = {1};
  add_sphere(soup, 0, 1, 500, 0, 0, &rng);
  /* all in the cube in the sphere */
  for (int i = 0; i < INNER; i++)
    add_cube_at(soup, 0.024 * (i % SIDE) - 0.54, 0.024 * (i / SIDE % SIDE) - 0.54,
                0.024 * (i / SIDE / SIDE) - 0.54, 0.01, i % 2);
  uint32_t *labels = malloc(soup->face_count * sizeof *labels);
  assert_non_null(labels);
  size_t count;
  assert_int_equal(vxm_components(context, soup, NULL, labels, &count, NULL), VXM_OK);
  assert_int_equal(count, INNER + 1);
  vxm_containment nesting;
  double start = seconds();
  assert_int_equal(vxm_containment_build(&nesting, soup, labels, count, NULL, NULL), VXM_OK);
  double took = seconds() - start;
  print_message("%d cubes in a sphere of %zu faces: %.3f s\n", INNER, soup->face_count - 6 * (size_t)INNER,
                took);
  for (size_t i = 0; i <= INNER; i++)
    assert_int_equal(nesting.parent[i], i == 0 ? VXM_NO_COMPONENT : 0);
  assert_true(took < 20); /* a bound for the slowest machine and sanitizers */
  vxm_containment_destroy(&nesting);
  free(labels);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

static void odd_input(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(1);
  vxm_soup *soup = new_soup(context);
  nested none = nest(soup, NULL);
  assert_int_equal(none.count, 0);
  nested_free(&none);
  add_cube_at(soup, 0, 0, 0, 1, false);
  uint32_t hole[3] = {0, 0, 0};
  add_face(soup, hole, 0); /* a component without a corner */
  add_cube_at(soup, 0, 0, 0, 0.5, false);
  for (int v = 0; v < 4; v++)
    add_vertex(soup, v == 0 ? NAN : 0.1 * v, 0.1, v == 1 ? INFINITY : 0.2);
  add_triangle(soup, 16, 17, 18);
  add_triangle(soup, 19, 18, 16);
  add_cube_at(soup, 0, 0, 0, 0.5, false); /* the same box as another one */
  for (int v = 0; v < 3; v++)
    add_vertex(soup, NAN, NAN, NAN);
  add_triangle(soup, 28, 29, 30);
  uint32_t parents[6] = {VXM_NO_COMPONENT, VXM_NO_COMPONENT, 0, VXM_NO_COMPONENT, 0, VXM_NO_COMPONENT};
  nested n = nest(soup, NULL);
  assert_int_equal(n.count, 6);
  for (int i = 0; i < 6; i++)
    if (i != 3) /* it has two finite corners, and nothing that could be sampled */
      assert_int_equal(n.nesting.parent[i], parents[i]);
  assert_true(n.nesting.volume[1] == 0 && n.nesting.volume[3] == 0 && n.nesting.volume[5] == 0);
  nested_free(&n);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

static void memory_may_run_out(void **state) {
  (void)state;
  vxm_context *roomy = context_of_threads(1);
  vxm_rng rng = {2};
  int failed = 0, passed = 0;
  for (uint64_t limit = 40000; passed == 0; limit += 700) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = 1;
    options.memory_limit = limit;
    vxm_context *context;
    assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
    vxm_soup *soup = new_soup(context);
    add_sphere(soup, 0, 1, 12, 0.1, 0, &rng);
    for (int i = 0; i < 4; i++)
      add_cube_at(soup, 0.1 * i, 0, 0.01 * i, 0.02, false);
    uint32_t labels[1000];
    size_t count;
    assert_true(soup->face_count <= 1000);
    if (vxm_components(context, soup, NULL, labels, &count, NULL) == VXM_OK) {
      vxm_containment nesting;
      vxm_error error = VXM_ERROR_INIT;
      vxm_status status = vxm_containment_build(&nesting, soup, labels, count, NULL, &error);
      if (status == VXM_OK)
        passed++;
      else {
        failed++;
        assert_int_equal(status, VXM_ERROR_MEMORY_LIMIT);
        assert_int_equal(error.code, VXM_ERROR_MEMORY_LIMIT);
        assert_null(nesting.parent);
        assert_null(nesting.volume);
      }
      vxm_containment_destroy(&nesting);
    }
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
  }
  assert_true(failed > 10);
  vxm_context_destroy(roomy);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cubes_in_cubes),
      cmocka_unit_test(spheres_side_by_side_and_interpenetrating),
      cmocka_unit_test(a_bay_is_outside),
      cmocka_unit_test(tubes_without_ends),
      cmocka_unit_test(missing_and_turned_faces_do_no_harm),
      cmocka_unit_test(volumes_of_turned_faces),
      cmocka_unit_test(random_trees_of_boxes),
      cmocka_unit_test(many_in_one),
      cmocka_unit_test(odd_input),
      cmocka_unit_test(memory_may_run_out),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

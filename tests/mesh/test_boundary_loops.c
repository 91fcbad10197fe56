/* SPDX-License-Identifier: BSD-3-Clause */
#include "shared.h"

#include "mesh/boundary_loops.h"

#include <math.h>
#include <time.h>

typedef struct found {
  vxm_edges edges;
  vxm_boundary_loops loops;
} found;

/** Every odd edge once, and walks that close. */
static found find_loops(const vxm_soup *soup) {
  found f;
  vxm_error error = VXM_ERROR_INIT;
  assert_int_equal(vxm_edges_build(&f.edges, soup->context, soup, NULL, &error), VXM_OK);
  if (vxm_boundary_loops_build(&f.loops, soup, &f.edges, &error) != VXM_OK)
    fail_msg("%s", error.text);
  uint8_t *seen = calloc(f.edges.count + 1, 1);
  assert_non_null(seen);
  size_t steps = 0;
  assert_int_equal(f.loops.begin[0], 0);
  for (size_t l = 0; l < f.loops.count; l++) {
    size_t begin = f.loops.begin[l], end = f.loops.begin[l + 1];
    assert_true(end >= begin + 3); /* two different edges cannot have the same two vertices */
    steps += end - begin;
    for (size_t s = begin; s < end; s++) {
      const vxm_edge *edge = &f.edges.edges[f.loops.edge[s]];
      uint32_t from = f.loops.vertex[s], to = f.loops.vertex[s + 1 < end ? s + 1 : begin];
      assert_true((edge->a == from && edge->b == to) || (edge->b == from && edge->a == to));
      assert_true(vxm_edge_is_odd(edge));
      assert_int_equal(seen[f.loops.edge[s]]++, 0);
    }
  }
  assert_int_equal(steps, f.edges.odd);
  free(seen);
  return f;
}

static void found_free(found *f) {
  vxm_boundary_loops_destroy(&f->loops);
  vxm_edges_destroy(&f->edges);
}

static size_t length_of(const found *f, size_t loop) {
  return f->loops.begin[loop + 1] - f->loops.begin[loop];
}

static void expect_lengths(const vxm_soup *soup, size_t loops, size_t length) {
  found f = find_loops(soup);
  assert_int_equal(f.loops.count, loops);
  for (size_t l = 0; l < loops; l++)
    assert_int_equal(length_of(&f, l), length);
  found_free(&f);
}

static void closed_soups_have_none(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(1);
  vxm_soup *soup = new_soup(context);
  expect_lengths(soup, 0, 0);
  add_cube(soup, 0);
  expect_lengths(soup, 0, 0);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

static void a_sheet_has_one(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(1);
  vxm_soup *soup = grid_sheet(context, 7);
  expect_lengths(soup, 1, 28);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

static uint32_t vertex_at(vxm_soup *soup, const double p[3]) {
  for (size_t v = 0; v < soup->vertex_count; v++)
    if (memcmp(vxm_position(soup, v), p, 3 * sizeof *p) == 0)
      return (uint32_t)v;
  add_vertex(soup, p[0], p[1], p[2]);
  return (uint32_t)soup->vertex_count - 1;
}

/** Side of the unit cube across an axis, as n x n squares that share vertices with what is there. */
static void add_side(vxm_soup *soup, int axis, double at, int n) {
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++) {
      uint32_t corners[4];
      for (int c = 0; c < 4; c++) {
        double p[3];
        p[axis] = at;
        p[(axis + 1) % 3] = (double)(i + (c == 1 || c == 2)) / n;
        p[(axis + 2) % 3] = (double)(j + (c >= 2)) / n;
        corners[at > 0 ? c : 3 - c] = vertex_at(soup, p);
      }
      add_face(soup, corners, 4);
    }
}

/** A panel that shares only its corners with finer neighbours: slits along its sides, never its own rim. */
static void slits_along_panels(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(1);
  for (int n = 2; n < 9; n++)
    for (int panels = 1; panels <= 6; panels++) {
      vxm_soup *soup = new_soup(context);
      /* opposite sides, then the sides between: a panel's neighbours may be panels too */
      for (int side = 0; side < 6; side++)
        add_side(soup, side / 2, side % 2, side < panels ? 1 : n);
      /* sides between a panel and a fine one; those between two panels are closed */
      static const size_t slits[7] = {0, 4, 8, 8, 8, 4, 0};
      expect_lengths(soup, slits[panels], (size_t)n + 1);
      vxm_soup_destroy(soup);
    }
  vxm_context_destroy(context);
}

/** Faces taken out of a sheet so that the holes touch in one vertex. */
static void holes_that_touch(void **state) {
  (void)state;
  enum { N = 12 };
  vxm_context *context = context_of_threads(1);
  vxm_rng rng = {1};
  for (int turn = 0; turn < 2; turn++) {
    vxm_soup *soup = new_soup(context);
    for (int j = 0; j <= N; j++)
      for (int i = 0; i <= N; i++)
        add_vertex(soup, i + 0.2 * vxm_rng_unit(&rng), j + 0.2 * vxm_rng_unit(&rng),
                   0.3 * vxm_rng_unit(&rng));
    size_t holes = 0;
    for (int j = 0; j < N; j++)
      for (int i = 0; i < N; i++) {
        uint32_t a = (uint32_t)(j * (N + 1) + i), up = N + 1, quad[4] = {a, a + 1, a + 1 + up, a + up};
        bool inner = i > 0 && j > 0 && i < N - 1 && j < N - 1;
        /* a checkerboard: all holes touch four others; or pairs of holes */
        if (inner && (turn ? (i + j) % 2 == 0 : (i % 4 == 1 && j % 4 == 1) || (i % 4 == 2 && j % 4 == 2)))
          holes++;
        else
          add_face(soup, quad, 4);
      }
    found f = find_loops(soup);
    size_t squares = 0;
    for (size_t l = 0; l < f.loops.count; l++)
      squares += length_of(&f, l) == 4;
    assert_int_equal(f.loops.count, holes + 1);
    assert_int_equal(squares, holes);
    found_free(&f);
    vxm_soup_destroy(soup);
  }
  vxm_context_destroy(context);
}

/** Whether the faces run along all edges of a loop one way, as they do around what was taken out of them. */
static bool runs_one_way(const found *f, size_t loop) {
  size_t forward = 0, length = length_of(f, loop);
  for (size_t s = f->loops.begin[loop]; s < f->loops.begin[loop + 1]; s++) {
    const vxm_edge *edge = &f->edges.edges[f->loops.edge[s]];
    forward += (edge->a == f->loops.vertex[s]) == (2 * edge->forward > edge->count);
  }
  return forward == 0 || forward == length;
}

/** Triangles taken out of a bumpy torus at random: however their holes touch, each rim can be closed by what
 * is wound as the torus is. */
static void rims_run_one_way(void **state) {
  (void)state;
  enum { N = 24, M = 12 };
  vxm_context *context = context_of_threads(1);
  vxm_rng rng = {5};
  size_t crossings = 0;
  for (int round = 0; round < 40; round++) {
    vxm_soup *soup = new_soup(context);
    for (int i = 0; i < N; i++)
      for (int j = 0; j < M; j++) {
        double u = 6.283185307179586 * i / N, v = 6.283185307179586 * j / M, r = 1 + vxm_rng_unit(&rng);
        add_vertex(soup, (5 + r * cos(v)) * cos(u), (5 + r * cos(v)) * sin(u), r * sin(v));
      }
    double removed = 0.6 * vxm_rng_unit(&rng);
    for (uint32_t i = 0; i < N; i++)
      for (uint32_t j = 0; j < M; j++) {
        uint32_t a = i * M + j, b = (i + 1) % N * M + j, c = (i + 1) % N * M + (j + 1) % M,
                 d = i * M + (j + 1) % M;
        if (vxm_rng_unit(&rng) >= removed)
          add_triangle(soup, a, b, c);
        if (vxm_rng_unit(&rng) >= removed)
          add_triangle(soup, a, c, d);
      }
    found f = find_loops(soup);
    uint32_t odd[N * M] = {0};
    for (size_t s = 0; s < f.loops.begin[f.loops.count]; s++)
      crossings += odd[f.loops.vertex[s]]++ == 1;
    for (size_t l = 0; l < f.loops.count; l++)
      assert_true(runs_one_way(&f, l));
    found_free(&f);
    vxm_soup_destroy(soup);
  }
  assert_true(crossings > 1000);
  vxm_context_destroy(context);
}

/** Two triangles that share a corner, with three edges along each other there: of two pairs that go together
 * as well that is joined along which the faces run one way, however the model is turned. */
static void faces_decide_about_edges_along_each_other(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(1);
  for (int mirrored = 0; mirrored < 8; mirrored++) {
    vxm_soup *soup = new_soup(context);
    static const double corners[][3] = {
        {0, 0, 0}, {1, 0, 0}, {0, 1, 0.25}, {1, 2e-6, 1e-6}, {1, -2e-6, 1e-6}};
    for (int v = 0; v < 5; v++) {
      double p[3];
      for (int a = 0; a < 3; a++)
        p[a] = mirrored >> a & 1 ? -corners[v][a] : corners[v][a];
      add_vertex(soup, p[0], p[1], p[2]);
    }
    add_face(soup, (uint32_t[]){0, 1, 2}, 3);
    add_face(soup, (uint32_t[]){0, 3, 4}, 3);
    found f = find_loops(soup);
    for (size_t l = 0; l < f.loops.count; l++)
      assert_true(runs_one_way(&f, l));
    found_free(&f);
    vxm_soup_destroy(soup);
  }
  vxm_context_destroy(context);
}

/** A cube whose least corner is at `low`, without one side. */
static void add_open_cube(vxm_soup *soup, double low, int lacking) {
  static const uint32_t sides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  uint32_t v[8];
  for (uint32_t c = 0; c < 8; c++)
    v[c] = vertex_at(soup, (double[3]){low + (c & 1), low + (c >> 1 & 1), low + (c >> 2)});
  for (int s = 0; s < 6; s++)
    if (s != lacking)
      add_face(soup, (uint32_t[]){v[sides[s][0]], v[sides[s][1]], v[sides[s][2]], v[sides[s][3]]}, 4);
}

/** Cubes that touch in a corner: each has a rim of its own, whether this passes the corner or not. */
static void bodies_that_touch(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(1);
  for (int turn = 0; turn < 72; turn++) {
    vxm_soup *soup = new_soup(context);
    add_open_cube(soup, turn % 2, turn / 2 % 6);
    add_open_cube(soup, 1 - turn % 2, turn / 12);
    expect_lengths(soup, 2, 4);
    vxm_soup_destroy(soup);
  }
  vxm_context_destroy(context);
}

/** A sheet that lies in a hole, hanging on a corner of its rim: the hole is what is left around it. */
static void a_sheet_in_a_hole(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(1);
  vxm_soup *soup = new_soup(context);
  add_open_cube(soup, 0, 5);
  uint32_t corner = vertex_at(soup, (double[3]){0, 0, 1});
  add_vertex(soup, 0.7, 0.3, 1);
  add_vertex(soup, 0.3, 0.7, 1);
  add_triangle(soup, corner, (uint32_t)soup->vertex_count - 2, (uint32_t)soup->vertex_count - 1);
  expect_lengths(soup, 1, 7);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

/** A torus without a ring of faces, where the two rims are pinched together at a vertex: one hole. */
static void a_hole_that_is_pinched(void **state) {
  (void)state;
  enum { N = 6, M = 8 };
  vxm_context *context = context_of_threads(1);
  vxm_soup *soup = new_soup(context);
  for (int i = 0; i < N; i++)
    for (int j = 0; j < M; j++) {
      double u = 6.283185307179586 * i / N, v = 6.283185307179586 * j / M, r = 3 + cos(v);
      add_vertex(soup, r * cos(u), r * sin(u), sin(v));
    }
  for (uint32_t i = 1; i < N; i++)
    for (uint32_t j = 0; j < M; j++) {
      uint32_t next = (i + 1) % N, up = (j + 1) % M;
      uint32_t quad[4] = {i * M + j, next * M + j, next * M + up, i * M + up};
      for (int c = 0; c < 4; c++)
        quad[c] = quad[c] == M ? 0 : quad[c];
      add_face(soup, quad, 4);
    }
  expect_lengths(soup, 1, 2 * M);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

static void random_soups(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(1);
  vxm_rng rng = {9};
  for (int round = 0; round < 300; round++) {
    vxm_soup *soup = random_soup(context, &rng, 1 + (size_t)vxm_rng_below(&rng, 60),
                                 (size_t)vxm_rng_below(&rng, 200), 9, 7);
    found f = find_loops(soup);
    found_free(&f);
    vxm_soup_destroy(soup);
  }
  static const size_t vertices[4] = {20, 300, 3000, 30000};
  for (int i = 0; i < 4; i++) {
    vxm_soup *soup = random_soup(context, &rng, vertices[i], 20000, 1000, 8);
    found f = find_loops(soup);
    found_free(&f);
    vxm_soup_destroy(soup);
  }
  vxm_context_destroy(context);
}

/** Triangles around a vertex that share nothing else; `wide` is the part of its place each one fills. */
static vxm_soup *fan(vxm_context *context, uint32_t triangles, double wide) {
  vxm_soup *soup = new_soup(context);
  add_vertex(soup, 1, 2, 3);
  double step = 2 * acos(-1) / triangles;
  for (uint32_t i = 0; i < triangles; i++) {
    add_vertex(soup, 1 + cos(step * i), 2 + sin(step * i), 2.7);
    add_vertex(soup, 1 + cos(step * (i + wide)), 2 + sin(step * (i + wide)), 2.7);
    add_triangle(soup, 0, 2 * i + 1, 2 * i + 2);
  }
  return soup;
}

static double seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/** The slits of a cut cone lead from each triangle to the next, so that they all become one walk. */
static void fans_of_many_edges(void **state) {
  (void)state;
  static const uint32_t triangles[6] = {3, 16, 17, 100, 5000, 50000};
  vxm_context *context = context_of_threads(1);
  for (int i = 0; i < 6; i++) {
    vxm_soup *soup = fan(context, triangles[i], 0.75);
    double start = seconds();
    found f = find_loops(soup);
    double took = seconds() - start;
    if (i == 5)
      print_message("%u triangles around a vertex: %.3f s\n", triangles[i], took);
    assert_true(took < 10);
    assert_int_equal(f.loops.count, 1);
    found_free(&f);
    vxm_soup_destroy(soup);
  }
  /* a single fan with many edges in it can only be joined with itself */
  vxm_soup *soup = new_soup(context);
  add_vertex(soup, 0, 0, 0);
  add_vertex(soup, 0, 0, 1);
  for (uint32_t i = 0; i < 1001; i++) {
    add_vertex(soup, cos(i), sin(i), 0);
    add_triangle(soup, 0, 1, i + 2);
  }
  found f = find_loops(soup);
  found_free(&f);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

static void count_loops(const shared_mesh *mesh, void *payload) {
  size_t *total = payload;
  vxm_context *context = context_of_threads(1);
  vxm_soup *soup = read_soup(context, mesh->path);
  if (soup->face_count < 100000) {
    found f = find_loops(soup);
    *total += f.loops.count;
    found_free(&f);
  }
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

static void real_meshes(void **state) {
  (void)state;
  size_t total = 0;
  if (for_each_shared_mesh(count_loops, &total) == 0)
    skip();
  print_message("%zu loops in all\n", total);
  assert_true(total > 1000);
}

static void memory_may_run_out(void **state) {
  (void)state;
  int failed = 0, passed = 0;
  for (uint64_t limit = 30000; passed == 0; limit += 500) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = 1;
    options.memory_limit = limit;
    vxm_context *context;
    assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
    vxm_soup *soup = fan(context, 100, 0.5);
    vxm_edges edges;
    if (vxm_edges_build(&edges, context, soup, NULL, NULL) == VXM_OK) {
      vxm_boundary_loops loops;
      vxm_error error = VXM_ERROR_INIT;
      vxm_status status = vxm_boundary_loops_build(&loops, soup, &edges, &error);
      if (status == VXM_OK)
        passed++;
      else {
        failed++;
        assert_int_equal(status, VXM_ERROR_MEMORY_LIMIT);
        assert_int_equal(error.code, VXM_ERROR_MEMORY_LIMIT);
        assert_null(loops.edge);
        assert_int_equal(loops.count, 0);
      }
      vxm_boundary_loops_destroy(&loops);
      vxm_edges_destroy(&edges);
    }
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
  }
  assert_true(failed > 10);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(closed_soups_have_none), cmocka_unit_test(a_sheet_has_one),
      cmocka_unit_test(slits_along_panels),     cmocka_unit_test(holes_that_touch),
      cmocka_unit_test(rims_run_one_way),       cmocka_unit_test(random_soups),
      cmocka_unit_test(fans_of_many_edges),     cmocka_unit_test(real_meshes),
      cmocka_unit_test(memory_may_run_out),     cmocka_unit_test(faces_decide_about_edges_along_each_other),
      cmocka_unit_test(bodies_that_touch),      cmocka_unit_test(a_sheet_in_a_hole),
      cmocka_unit_test(a_hole_that_is_pinched),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

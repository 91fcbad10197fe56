/* SPDX-License-Identifier: BSD-3-Clause */
#include "soups.h"

#include "mesh/edges.h"
#include "mesh/sort.h"

static vxm_edges build(const vxm_soup *soup, const uint32_t *map) {
  vxm_edges edges;
  assert_int_equal(vxm_edges_build_sides(&edges, soup->context, soup, map, NULL), VXM_OK);
  return edges;
}

/** The same without them, and sides that name the edge between their ends. */
static void check_sides(const vxm_edges *edges, const vxm_soup *soup, const uint32_t *map) {
  vxm_edges plain;
  assert_int_equal(vxm_edges_build(&plain, soup->context, soup, map, NULL), VXM_OK);
  assert_null(plain.sides);
  assert_int_equal(plain.count, edges->count);
  assert_memory_equal(plain.edges, edges->edges, plain.count * sizeof *plain.edges);
  vxm_edges_destroy(&plain);
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *face = vxm_face(soup, f, &count);
    for (size_t i = 0; i < count; i++) {
      uint32_t u = face[i], v = face[i + 1 < count ? i + 1 : 0], side = edges->sides[soup->offsets[f] + i];
      if (map)
        u = map[u], v = map[v];
      if (u == v || !vxm_face_has_three(face, count, map))
        assert_int_equal(side, VXM_NO_EDGE);
      else
        assert_int_equal(side, vxm_edges_find(edges, u, v));
    }
  }
}

/** Sides of the edge a-b over all faces, by trying every pair of corners. */
static vxm_edge count_sides(const vxm_soup *soup, const uint32_t *map, uint32_t a, uint32_t b) {
  vxm_edge edge = {.a = a, .b = b};
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count, distinct = 0;
    const uint32_t *face = vxm_face(soup, f, &count);
    for (size_t i = 0; i < count; i++) {
      bool seen = false;
      for (size_t j = 0; j < i; j++)
        seen |= (map ? map[face[i]] : face[i]) == (map ? map[face[j]] : face[j]);
      distinct += !seen;
    }
    for (size_t i = 0; i < count && distinct >= 3; i++) {
      uint32_t u = face[i], v = face[(i + 1) % count];
      if (map)
        u = map[u], v = map[v];
      edge.count += (u == a && v == b) || (u == b && v == a);
      edge.forward += u == a && v == b;
    }
  }
  return edge;
}

static void check_against_counting(const vxm_soup *soup, const uint32_t *map) {
  vxm_edges edges = build(soup, map);
  size_t next = 0, odd = 0, open = 0, crowded = 0, against = 0;
  check_sides(&edges, soup, map);
  for (uint32_t a = 0; a < soup->vertex_count; a++)
    for (uint32_t b = a + 1; b < soup->vertex_count; b++) {
      vxm_edge wanted = count_sides(soup, map, a, b);
      size_t place = vxm_edges_find(&edges, b, a);
      if (wanted.count == 0) {
        assert_int_equal(place, edges.count);
        continue;
      }
      assert_int_equal(place, next);
      assert_memory_equal(&edges.edges[next++], &wanted, sizeof wanted);
      odd += wanted.count % 2;
      open += wanted.count == 1;
      crowded += wanted.count > 2;
      against += wanted.count == 2 && wanted.forward != 1;
    }
  assert_int_equal(edges.count, next);
  assert_int_equal(edges.odd, odd);
  assert_int_equal(edges.open, open);
  assert_int_equal(edges.crowded, crowded);
  assert_int_equal(edges.against, against);
  vxm_edges_destroy(&edges);
}

static void edges_equal_counting(void **state) {
  (void)state;
  vxm_rng rng = {1};
  vxm_context *context = context_of_threads(2);
  for (int round = 0; round < 400; round++) {
    size_t vertices = 1 + (size_t)vxm_rng_below(&rng, 9);
    vxm_soup *soup = random_soup(context, &rng, vertices, (size_t)vxm_rng_below(&rng, 30), 3, 7);
    uint32_t map[16];
    for (uint32_t v = 0; v < vertices; v++)
      map[v] = v > 0 && vxm_rng_below(&rng, 3) == 0 ? map[vxm_rng_below(&rng, v)] : v;
    check_against_counting(soup, NULL);
    check_against_counting(soup, map);
    vxm_soup_destroy(soup);
  }
  vxm_context_destroy(context);
}

static void sheet_and_cube(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(2);
  enum { N = 150 };
  vxm_soup *sheet = grid_sheet(context, N);
  vxm_edges edges = build(sheet, NULL);
  assert_int_equal(edges.count, 3 * N * N + 2 * N);
  assert_int_equal(edges.odd, 4 * N);
  for (size_t e = 0; e < edges.count; e++) {
    assert_true(edges.edges[e].a < edges.edges[e].b);
    assert_true(edges.edges[e].count != 2 || edges.edges[e].forward == 1);
  }
  vxm_edges_destroy(&edges);
  vxm_soup_destroy(sheet);

  vxm_soup *cube = new_soup(context);
  add_cube(cube, 0);
  edges = build(cube, NULL);
  assert_int_equal(edges.count, 12);
  assert_int_equal(edges.odd, 0);
  vxm_edges_destroy(&edges);
  vxm_soup_destroy(cube);

  vxm_soup *nothing = new_soup(context);
  edges = build(nothing, NULL);
  assert_int_equal(edges.count, 0);
  vxm_edges_destroy(&edges);
  vxm_soup_destroy(nothing);
  vxm_context_destroy(context);
}

/** A large fan about one vertex, and one edge with very many faces: no bucket may cost its square. */
static void crowded_vertex_and_edge(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(2);
  enum { N = 200000 };
  vxm_soup *soup = new_soup(context);
  for (int v = 0; v < N + 2; v++)
    add_vertex(soup, v, 0, 0);
  for (uint32_t f = 1; f < N; f++)
    add_triangle(soup, 0, f, f + 1);
  for (uint32_t f = 2; f < N; f++)
    add_triangle(soup, 0, N + 1, f);
  vxm_edges edges = build(soup, NULL);
  check_sides(&edges, soup, NULL);
  assert_int_equal(edges.count, 2 * N - 1 + N - 1);
  size_t place = vxm_edges_find(&edges, 0, N + 1);
  assert_int_equal(edges.edges[place].count, N - 2);
  assert_int_equal(edges.edges[place].forward, N - 2);
  vxm_edges_destroy(&edges);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

/** Few faces on many vertices: the work must go with the faces. */
static void few_faces_on_many_vertices(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(2);
  enum { N = 300000 };
  vxm_soup *soup = new_soup(context);
  for (int v = 0; v < N; v++)
    add_vertex(soup, v, 0, 0);
  uint32_t corners[200];
  for (uint32_t i = 0; i < 200; i++)
    corners[i] = (uint32_t)((uint64_t)i * 123457 % N);
  add_face(soup, corners, 200);
  for (uint32_t i = 0; i + 2 < 200; i++)
    add_triangle(soup, corners[0], corners[i + 2], corners[i + 1]);
  vxm_edges edges = build(soup, NULL);
  check_sides(&edges, soup, NULL);
  assert_int_equal(edges.count, 200 + 197);
  assert_int_equal(edges.odd, 0);
  for (size_t e = 0; e < edges.count; e++) {
    assert_int_equal(edges.edges[e].count, 2);
    assert_int_equal(edges.edges[e].forward, 1);
    if (e > 0)
      assert_true(edges.edges[e].a > edges.edges[e - 1].a ||
                  (edges.edges[e].a == edges.edges[e - 1].a && edges.edges[e].b > edges.edges[e - 1].b));
  }
  vxm_edges_destroy(&edges);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

static void keys_are_sorted(void **state) {
  (void)state;
  enum { N = 40000 };
  static uint64_t keys[N], scratch[N];
  vxm_rng rng = {41};
  for (size_t count = 0; count <= N; count = count * 2 + 1)
    for (unsigned shift = 0; shift < 64; shift += 9) {
      uint64_t sum = 0;
      for (size_t i = 0; i < count; i++)
        sum += keys[i] = vxm_rng_next(&rng) << shift >> (shift / 2);
      vxm_sort_keys(keys, scratch, count);
      for (size_t i = 0; i < count; i++) {
        assert_true(i == 0 || keys[i - 1] <= keys[i]);
        sum -= keys[i];
      }
      assert_true(sum == 0);
    }
}

/** By their upper bits alone, with those that are alike in their order. */
static void keys_are_sorted_above(void **state) {
  (void)state;
  enum { N = 40000 };
  static uint64_t keys[N], scratch[N];
  vxm_rng rng = {42};
  for (size_t count = 0; count <= N; count = count * 2 + 1)
    for (unsigned shift = 0; shift < 64; shift += 9) {
      const unsigned number = shift < 16 ? 0 : 16; /* bits for it below those that are sorted by */
      for (size_t i = 0; i < count; i++)
        keys[i] = number ? (vxm_rng_next(&rng) & 7) << shift | i : vxm_rng_next(&rng);
      vxm_sort_keys_above(keys, scratch, count, shift);
      for (size_t i = 1; i < count; i++) {
        assert_true(keys[i - 1] >> shift <= keys[i] >> shift);
        if (number && keys[i - 1] >> shift == keys[i] >> shift)
          assert_true(keys[i - 1] < keys[i]);
      }
    }
}

static void same_for_any_threads(void **state) {
  (void)state;
  vxm_edges first = {0};
  vxm_soup *soups[3];
  static const int threads[3] = {1, 2, 7};
  for (int t = 0; t < 3; t++) {
    vxm_context *context = context_of_threads(threads[t]);
    vxm_rng rng = {99};
    soups[t] = random_soup(context, &rng, 5000, 60000, 40, 6);
    vxm_edges edges = build(soups[t], NULL);
    if (t > 0) {
      assert_int_equal(edges.count, first.count);
      assert_memory_equal(edges.edges, first.edges, first.count * sizeof *first.edges);
      vxm_edges_destroy(&edges);
    } else
      first = edges;
    vxm_context_destroy(context);
  }
  vxm_edges_destroy(&first);
  for (int t = 0; t < 3; t++)
    vxm_soup_destroy(soups[t]);
}

/** Under every limit the map is made or refused, never half made. */
static void memory_limit_is_kept(void **state) {
  (void)state;
  int made = 0, refused = 0;
  for (uint64_t limit = 3 << 20; limit < 20 << 20; limit += 1 << 18) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.memory_limit = limit;
    options.threads = 2;
    vxm_context *context;
    assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
    vxm_soup *sheet = grid_sheet(context, 150);
    vxm_error error = VXM_ERROR_INIT;
    vxm_edges edges;
    vxm_status status = vxm_edges_build(&edges, context, sheet, NULL, &error);
    assert_int_equal(status, error.code);
    assert_true(status == VXM_OK || status == VXM_ERROR_MEMORY_LIMIT);
    assert_true(vxm_context_peak_bytes(context) <= limit);
    made += status == VXM_OK;
    refused += status != VXM_OK;
    vxm_edges_destroy(&edges);
    vxm_soup_destroy(sheet);
    vxm_context_destroy(context);
  }
  assert_true(made > 0 && refused > 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(edges_equal_counting),    cmocka_unit_test(sheet_and_cube),
      cmocka_unit_test(crowded_vertex_and_edge), cmocka_unit_test(same_for_any_threads),
      cmocka_unit_test(memory_limit_is_kept),    cmocka_unit_test(few_faces_on_many_vertices),
      cmocka_unit_test(keys_are_sorted),         cmocka_unit_test(keys_are_sorted_above),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

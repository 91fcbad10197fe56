/* SPDX-License-Identifier: BSD-3-Clause */
#include "shared.h"

#include "mesh/components.h"

/* ---- Union-find, the oracle ---- */

static uint32_t find(uint32_t *parent, uint32_t v) {
  while (parent[v] != v)
    v = parent[v] = parent[parent[v]];
  return v;
}

/** Components numbered by first face; returns how many. */
static size_t by_union_find(const vxm_soup *soup, const uint32_t *map, uint32_t *labels) {
  uint32_t *parent = malloc((soup->vertex_count + 1) * sizeof *parent);
  uint32_t *number = malloc((soup->vertex_count + 1) * sizeof *number);
  assert_non_null(parent);
  assert_non_null(number);
  for (uint32_t v = 0; v < soup->vertex_count; v++) {
    parent[v] = v;
    number[v] = UINT32_MAX;
  }
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *face = vxm_face(soup, f, &count);
    for (size_t i = 1; i < count; i++)
      parent[find(parent, map ? map[face[i]] : face[i])] = find(parent, map ? map[face[0]] : face[0]);
  }
  size_t next = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *face = vxm_face(soup, f, &count);
    if (count == 0) {
      labels[f] = (uint32_t)next++;
      continue;
    }
    uint32_t root = find(parent, map ? map[face[0]] : face[0]);
    if (number[root] == UINT32_MAX)
      number[root] = (uint32_t)next++;
    labels[f] = number[root];
  }
  free(parent);
  free(number);
  return next;
}

static void check(vxm_context *context, const vxm_soup *soup, const uint32_t *map) {
  uint32_t *labels = malloc((soup->face_count + 1) * sizeof *labels);
  uint32_t *wanted = malloc((soup->face_count + 1) * sizeof *wanted);
  assert_non_null(labels);
  assert_non_null(wanted);
  size_t count, only_count;
  assert_int_equal(vxm_components(context, soup, map, labels, &count, NULL), VXM_OK);
  assert_int_equal(vxm_components(context, soup, map, NULL, &only_count, NULL), VXM_OK);
  assert_int_equal(count, by_union_find(soup, map, wanted));
  assert_int_equal(count, only_count);
  assert_memory_equal(labels, wanted, soup->face_count * sizeof *labels);
  free(labels);
  free(wanted);
}

static void random_soups(void **state) {
  (void)state;
  static const int threads[3] = {1, 2, 7};
  for (int t = 0; t < 3; t++) {
    vxm_context *context = context_of_threads(threads[t]);
    vxm_rng rng = {3};
    for (int round = 0; round < 200; round++) {
      size_t vertices = 1 + (size_t)vxm_rng_below(&rng, 300);
      vxm_soup *soup = random_soup(context, &rng, vertices, (size_t)vxm_rng_below(&rng, 120), 5, 5);
      uint32_t map[300];
      for (uint32_t v = 0; v < vertices; v++)
        map[v] = v > 0 && vxm_rng_below(&rng, 8) == 0 ? map[vxm_rng_below(&rng, v)] : v;
      check(context, soup, NULL);
      check(context, soup, map);
      vxm_soup_destroy(soup);
    }
    /* large enough to be cut into slices */
    vxm_soup *large = random_soup(context, &rng, 200000, 120000, 50, 4);
    check(context, large, NULL);
    vxm_soup_destroy(large);
    vxm_context_destroy(context);
  }
}

/** A strip of triangles: vertices numbered along it, against it, at random, or faces in random order too. */
static vxm_soup *strip(vxm_context *context, uint32_t triangles, int numbering) {
  vxm_soup *soup = new_soup(context);
  uint32_t vertices = triangles + 2;
  uint32_t *name = malloc(vertices * sizeof *name);
  assert_non_null(name);
  for (uint32_t v = 0; v < vertices; v++) {
    name[v] = numbering == 1 ? vertices - 1 - v : v;
    add_vertex(soup, v, v % 2, 0);
  }
  vxm_rng rng = {17};
  for (uint32_t v = vertices; numbering >= 2 && v > 1; v--) {
    uint32_t other = (uint32_t)vxm_rng_below(&rng, v), kept = name[v - 1];
    name[v - 1] = name[other];
    name[other] = kept;
  }
  /* a step without a common factor with the number of triangles visits all of them */
  uint32_t step = numbering == 3 ? 617341 : 1;
  for (uint32_t i = 0; i < triangles; i++) {
    uint32_t f = (uint32_t)((uint64_t)i * step % triangles);
    add_triangle(soup, name[f], name[f + 1], name[f + 2]);
  }
  free(name);
  return soup;
}

static void long_strips_take_few_rounds(void **state) {
  (void)state;
  enum { TRIANGLES = 1000000, LOG2 = 20 };
  for (int threads = 1; threads <= 7; threads += 6)
    for (int numbering = 0; numbering < 4; numbering++) {
      vxm_context *context = context_of_threads(threads);
      vxm_soup *soup = strip(context, TRIANGLES, numbering);
      uint32_t *labels = malloc(soup->vertex_count * sizeof *labels);
      assert_non_null(labels);
      int rounds;
      assert_int_equal(vxm_group_vertices(context, soup, NULL, labels, &rounds, NULL), VXM_OK);
      for (size_t v = 0; v < soup->vertex_count; v++)
        if (labels[v] != 0)
          fail_msg("vertex %zu has label %u", v, labels[v]);
      print_message("strip of 1e6, numbering %d, %d threads: %d rounds\n", numbering, threads, rounds);
      assert_true(rounds <= 2 * LOG2);
      free(labels);
      vxm_soup_destroy(soup);
      vxm_context_destroy(context);
    }
}

static int stop(const char *phase, double fraction, void *payload) {
  (void)phase;
  (void)fraction;
  return --*(int *)payload < 0;
}

static void can_be_cancelled(void **state) {
  (void)state;
  for (int after = 0; after < 2; after++) {
    int left = after;
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.progress = stop;
    options.payload = &left;
    vxm_context *context;
    assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
    vxm_soup *soup = strip(context, 50000, 2);
    size_t count;
    vxm_error error = VXM_ERROR_INIT;
    assert_int_equal(vxm_components(context, soup, NULL, NULL, &count, &error), VXM_ERROR_CANCELLED);
    assert_int_equal(count, 0);
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
  }
}

/* ---- The paper's models ---- */

static void check_paper_model(const shared_mesh *mesh, void *payload) {
  static const struct {
    const char *file;
    size_t components;
  } models[] = {{"paper/nau-al.obj", 21}, {"paper/common3d-teapot.obj", 4}};
  for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
    if (strcmp(mesh->values[0], models[i].file) != 0)
      continue;
    vxm_context *context = context_of_threads(2);
    vxm_soup *soup = read_soup(context, mesh->path);
    size_t count;
    assert_int_equal(vxm_components(context, soup, NULL, NULL, &count, NULL), VXM_OK);
    assert_int_equal(count, models[i].components);
    check(context, soup, NULL);
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
    ++*(int *)payload;
  }
}

/** Chen & Tu, Table 1: Al Capone has 21 parts and the teapot 4, by vertex index. */
static void models_of_the_paper(void **state) {
  (void)state;
  int found = 0;
  if (for_each_shared_mesh(check_paper_model, &found) == 0)
    skip();
  assert_int_equal(found, 2);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(random_soups),
      cmocka_unit_test(long_strips_take_few_rounds),
      cmocka_unit_test(can_be_cancelled),
      cmocka_unit_test(models_of_the_paper),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

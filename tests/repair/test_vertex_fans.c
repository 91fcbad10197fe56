/* SPDX-License-Identifier: BSD-3-Clause */
#include "../mesh/soups.h"

#include "repair/state/vertex_fans.h"

/** By the fans that are counted from a list of all edges. */
static bool has_one_fan_each(vxm_soup *soup) {
  vxm_repair_state state = {.context = soup->context, .soup = soup};
  uint8_t *fans;
  assert_int_equal(vxm_repair_state_edges(&state, NULL), VXM_OK);
  bool manifold = state.edges.crowded == 0 && state.edges.against == 0;
  assert_int_equal(vxm_vertex_fans_count(&fans, &state, NULL), VXM_OK);
  for (size_t v = 0; v < soup->vertex_count; v++)
    manifold = manifold && fans[v] <= 1;
  vxm_free(soup->context, fans);
  vxm_repair_state_touch(&state);
  return manifold;
}

static bool is_manifold(vxm_soup *soup, bool *paired) {
  vxm_repair_state state = {.context = soup->context, .soup = soup};
  bool manifold;
  assert_int_equal(vxm_is_manifold(&manifold, &state, NULL), VXM_OK);
  *paired = state.edges.adjacent != NULL;
  vxm_repair_state_touch(&state);
  return manifold;
}

/** A polygon, another one opposite, and sides of four corners. */
static void add_prism(vxm_soup *soup, uint32_t n) {
  uint32_t first = (uint32_t)soup->vertex_count, low[64] = {0}, high[64] = {0};
  for (uint32_t v = 0; v < n; v++) {
    add_vertex(soup, v, first, 0);
    add_vertex(soup, v, first, 1);
    low[n - 1 - v] = first + 2 * v;
    high[v] = first + 2 * v + 1;
  }
  add_face(soup, low, n);
  add_face(soup, high, n);
  for (uint32_t v = 0; v < n; v++) {
    uint32_t p = first + 2 * v, q = first + 2 * ((v + 1) % n), side[4] = {p, q, q + 1, p + 1};
    add_face(soup, side, 4);
  }
}

/** Bodies that are closed, and at times touch in a vertex, with themselves or each other; now and then a face
 * is gone or without area. */
static void bodies_that_touch(void **state) {
  (void)state;
  vxm_rng rng = {31};
  vxm_context *context = context_of_threads(2);
  int seen[2][2] = {{0}};
  for (int round = 0; round < 800; round++) {
    vxm_soup *soup = new_soup(context);
    for (uint64_t bodies = 1 + vxm_rng_below(&rng, 3); bodies > 0; bodies--)
      if (vxm_rng_below(&rng, 3) == 0)
        add_cube(soup, (double)bodies);
      else if (vxm_rng_below(&rng, 4) == 0)
        add_prism(soup, 3 + (uint32_t)vxm_rng_below(&rng, 60)); /* large faces, too */
      else
        add_bipyramid(soup, 3 + (uint32_t)vxm_rng_below(&rng, 9));
    for (uint64_t merges = vxm_rng_below(&rng, 3); merges > 0; merges--) {
      uint32_t from = (uint32_t)vxm_rng_below(&rng, soup->vertex_count);
      uint32_t to = (uint32_t)vxm_rng_below(&rng, soup->vertex_count);
      for (size_t c = 0; c < soup->corner_count; c++)
        soup->indices[c] = soup->indices[c] == from ? to : soup->indices[c];
    }
    if (vxm_rng_below(&rng, 6) == 0)
      soup->indices[0] = soup->indices[1];
    bool paired, manifold = is_manifold(soup, &paired);
    assert_int_equal(manifold, has_one_fan_each(soup));
    seen[paired][manifold]++;
    vxm_soup_destroy(soup);
  }
  print_message("%d and %d closed, %d of these manifold\n", seen[1][0] + seen[1][1], seen[0][0] + seen[0][1],
                seen[1][1]);
  assert_true(seen[1][0] > 100 && seen[1][1] > 100 && seen[0][0] > 30);
  vxm_context_destroy(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(bodies_that_touch)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** The edge map of a repair after faces were turned: it is that of the faces as they run now. */
#include "../mesh/soups.h"

#include "repair/state/repair_state.h"

static void reverse_face(vxm_soup *soup, size_t face) {
  size_t count;
  vxm_face(soup, face, &count);
  uint32_t *corner = soup->indices + soup->offsets[face], kept[32];
  memcpy(kept, corner, count * sizeof *kept);
  for (size_t i = 0; i < count; i++)
    corner[i] = kept[(count - i) % count];
}

static void assert_same_edges(const vxm_edges *found, const vxm_soup *soup) {
  vxm_edges wanted;
  assert_int_equal(vxm_edges_build_sides(&wanted, soup->context, soup, NULL, NULL), VXM_OK);
  assert_int_equal(found->count, wanted.count);
  assert_int_equal(found->odd, wanted.odd);
  assert_int_equal(found->open, wanted.open);
  assert_int_equal(found->crowded, wanted.crowded);
  assert_int_equal(found->against, wanted.against);
  for (size_t e = 0; e < wanted.count; e++) {
    assert_int_equal(found->edges[e].a, wanted.edges[e].a);
    assert_int_equal(found->edges[e].b, wanted.edges[e].b);
    assert_int_equal(found->edges[e].count, wanted.edges[e].count);
    assert_int_equal(found->edges[e].forward, wanted.edges[e].forward);
  }
  for (size_t c = 0; c < soup->corner_count; c++)
    assert_int_equal(found->sides[c], wanted.sides[c]);
  vxm_edges_destroy(&wanted);
}

static void random_soups(void **context) {
  vxm_rng rng = {3};
  int followed = 0;
  for (int round = 0; round < 1000; round++) {
    vxm_soup *soup = random_soup(*context, &rng, 3 + (size_t)vxm_rng_below(&rng, 10), 12, 3, 6);
    vxm_repair_state state = {.context = soup->context, .soup = soup};
    uint8_t turned[12];
    assert_int_equal(vxm_repair_state_count_edges(&state, NULL), VXM_OK);
    for (size_t f = 0; f < soup->face_count; f++) {
      turned[f] = vxm_rng_below(&rng, 2) == 0;
      if (turned[f])
        reverse_face(soup, f);
    }
    vxm_repair_state_turn(&state, turned);
    followed += state.has_edges;
    assert_int_equal(vxm_repair_state_edges(&state, NULL), VXM_OK);
    assert_same_edges(&state.edges, soup);
    vxm_repair_state_touch(&state);
    vxm_soup_destroy(soup);
  }
  assert_true(followed > 500);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(random_soups)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}

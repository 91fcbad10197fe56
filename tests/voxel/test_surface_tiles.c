/* SPDX-License-Identifier: BSD-3-Clause */
/** Many threads draw tiles, each of some triangles only: the same voxels as of one thread, which draws every
 * triangle into the window. */
#include "../mesh/soups.h"

#include "voxel/surface/surface_draw.h"

enum { SIDE = 100, ROW_WORDS = 2, WORDS = SIDE * SIDE * ROW_WORDS, TRIANGLES = 150, MANY = 64 };

/** Triangles of all sizes, some of which reach out of the grid. */
static vxm_soup *triangles_of_all_sizes(vxm_context *context, vxm_rng *rng) {
  static const double sizes[] = {0.4, 3, 12, 150};
  vxm_soup *soup = new_soup(context);
  for (uint32_t t = 0; t < TRIANGLES; t++) {
    double at[3], size = sizes[vxm_rng_below(rng, 4)];
    for (int a = 0; a < 3; a++)
      at[a] = (SIDE + 20) * vxm_rng_unit(rng) - 10;
    for (int c = 0; c < 3; c++)
      add_vertex(soup, at[0] + size * (vxm_rng_unit(rng) - 0.5), at[1] + size * (vxm_rng_unit(rng) - 0.5),
                 at[2] + size * (vxm_rng_unit(rng) - 0.5));
    add_triangle(soup, 3 * t, 3 * t + 1, 3 * t + 2);
  }
  return soup;
}

static uint64_t alone[WORDS], together[WORDS];

static void draw(uint64_t *words, const vxm_surface *surface, const vxm_window *shape, vxm_surface_kind kind,
                 bool is_fresh, uint64_t seed) {
  vxm_rng rng = {seed};
  vxm_window window = *shape;
  for (size_t w = 0; w < WORDS; w++) /* what is fresh is cleared, the rest stays */
    words[w] = is_fresh ? ~UINT64_C(0) : (uint64_t)1 << vxm_rng_below(&rng, 36);
  window.words = words;
  assert_int_equal(vxm_surface_add(surface, &window, kind, is_fresh, NULL), VXM_OK);
}

static void tiles_hold_what_the_window_does(void **state) {
  (void)state;
  static const vxm_layout layouts[] = {{0, 1, 2}, {2, 1, 0}, {1, 2, 0}};
  static const vxm_surface_kind kinds[] = {VXM_SURFACE_CONSERVATIVE, VXM_SURFACE_THIN};
  const vxm_space space = {{SIDE, SIDE, SIDE}, {0, 0, 0}, {1, 1, 1}};
  const vxm_lattice lattice = vxm_lattice_of(&space);
  vxm_context *contexts[2] = {context_of_threads(1), context_of_threads(MANY)};
  const vxm_surface_build *builds[3];
  size_t build_count = vxm_surface_builds(builds);
  for (int round = 0; round < 48; round++) {
    vxm_surface *surfaces[2];
    vxm_soup *soups[2];
    for (int i = 0; i < 2; i++) {
      vxm_rng rng = {(uint64_t)round};
      soups[i] = triangles_of_all_sizes(contexts[i], &rng);
      assert_int_equal(vxm_surface_create(&surfaces[i], soups[i], &lattice, NULL, NULL), VXM_OK);
    }
    int64_t begin = round % 2 ? 9 : 0, end = round % 2 ? 93 : SIDE;
    vxm_window shape = vxm_window_of(&space, layouts[round % 3], begin, end);
    vxm_surface_kind kind = kinds[round / 2 % 2];
    bool is_fresh = round / 4 % 2;
    vxm_surface_force(NULL);
    draw(alone, surfaces[0], &shape, kind, is_fresh, (uint64_t)round);
    vxm_surface_force(builds[(size_t)round / 8 % build_count]);
    draw(together, surfaces[1], &shape, kind, is_fresh, (uint64_t)round);
    assert_memory_equal(together, alone, sizeof alone);
    for (int i = 0; i < 2; i++) {
      vxm_surface_destroy(surfaces[i]);
      vxm_soup_destroy(soups[i]);
    }
  }
  vxm_surface_force(NULL);
  vxm_context_destroy(contexts[1]);
  vxm_context_destroy(contexts[0]);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(tiles_hold_what_the_window_does)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** Repair to be voxelized: in the place of the mesh as beside it, and what it says to have found out is so.
 */
#include "repair_test.h"

#include "mesh/components.h"
#include "mesh/edges.h"

#include <math.h>

/** The same faces, each with vertices of its own, as from an .stl. */
static vxm_soup *unshared(const vxm_soup *soup) {
  vxm_soup *out = new_soup(soup->context);
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    uint32_t corners[32];
    const uint32_t *corner = vxm_face(soup, f, &count);
    for (size_t i = 0; i < count; i++) {
      const double *p = vxm_position(soup, corner[i]);
      corners[i] = (uint32_t)out->vertex_count;
      add_vertex(out, p[0], p[1], p[2]);
    }
    add_face(out, corners, count);
  }
  return out;
}

/** Components and closedness, where they are told; counts how often. */
static void check_known(const vxm_soup *soup, int *told) {
  if (soup->component_count == 0) {
    assert_false(soup->is_closed);
    return;
  }
  size_t count;
  uint32_t labels[512];
  assert_int_equal(vxm_components(soup->context, soup, NULL, labels, &count, NULL), VXM_OK);
  assert_int_equal(soup->component_count, count);
  if (count > 1)
    assert_memory_equal(soup->components, labels, soup->face_count * sizeof *labels);
  vxm_edges edges;
  assert_int_equal(vxm_edges_build(&edges, soup->context, soup, NULL, NULL), VXM_OK);
  assert_int_equal(soup->is_closed, edges.odd == 0);
  told[0]++;
  told[1] += count > 1;
  told[2] += soup->is_closed;
  vxm_edges_destroy(&edges);
}

static void check(const vxm_soup *soup, int *told) {
  vxm_soup *kept, *own, *copy;
  vxm_repair_report beside = VXM_REPAIR_REPORT_INIT, in_place = VXM_REPAIR_REPORT_INIT;
  assert_int_equal(vxm_repair_prepare(&kept, &beside, soup, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_soup_copy(&copy, soup, NULL), VXM_OK);
  assert_int_equal(vxm_repair_prepare_owned(&own, &in_place, copy, NULL, NULL), VXM_OK);
  assert_same_soup(kept, own);
  assert_int_equal(beside.pass_count, in_place.pass_count);
  for (int i = 0; i < beside.pass_count; i++)
    assert_int_equal(beside.passes[i].count, in_place.passes[i].count);
  check_known(kept, told);
  check_known(own, told);
  vxm_soup_destroy(own);
  vxm_soup_destroy(kept);
}

static void in_place_or_beside(void **state) {
  vxm_rng rng = {8};
  int told[3] = {0};
  for (int round = 0; round < 600; round++) {
    vxm_soup *soup = random_soup(*state, &rng, 4 + (size_t)vxm_rng_below(&rng, 20),
                                 1 + (size_t)vxm_rng_below(&rng, 20), 3 + (unsigned)round % 5, 5);
    for (int cubes = round % 4; cubes > 0; cubes--) /* some of which touch */
      add_cube(soup, 3 * cubes + (double)vxm_rng_below(&rng, 3));
    if (round % 7 == 0)
      soup->positions[0] = INFINITY;
    vxm_soup *loose = unshared(soup);
    check(soup, told);
    check(loose, told);
    vxm_soup_destroy(loose);
    vxm_soup_destroy(soup);

    soup = new_soup(*state); /* closed bodies alone */
    for (int cubes = 1 + round % 3; cubes > 0; cubes--)
      add_cube(soup, 2 * cubes);
    loose = unshared(soup);
    check(loose, told);
    vxm_soup_destroy(loose);
    vxm_soup_destroy(soup);
  }
  assert_true(told[0] > 100 && told[1] > 100 && told[2] > 100);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(in_place_or_beside)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}

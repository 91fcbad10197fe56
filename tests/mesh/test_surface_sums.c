/* SPDX-License-Identifier: BSD-3-Clause */
#include "soups.h"

#include "mesh/surface_sums.h"

static vxm_surface_sums sums_of(const vxm_soup *soup) {
  uint8_t *used = malloc(soup->vertex_count + 1);
  assert_non_null(used);
  vxm_extent extent;
  vxm_extent_of(&extent, soup->context, soup, used);
  free(used);
  vxm_unit_scale frame = vxm_unit_scale_of(extent.bounds);
  vxm_surface_sums sums;
  assert_int_equal(vxm_surface_sums_of(&sums, soup, extent.bounds, &frame, NULL, NULL), VXM_OK);
  sums.area /= frame.scale * frame.scale;
  sums.vector_area.z /= frame.scale * frame.scale;
  return sums;
}

static void cubes_and_sheets(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(2);
  vxm_soup *soup = new_soup(context);
  vxm_surface_sums none = sums_of(soup);
  assert_true(none.area == 0 && none.volume == 0);
  add_cube(soup, 100);
  vxm_surface_sums cube = sums_of(soup);
  assert_true(cube.area == 6 && fabs(cube.volume - 1) < 1e-15);
  assert_true(cube.vector_area.x == 0 && cube.vector_area.y == 0 && cube.vector_area.z == 0);
  vxm_soup_destroy(soup);

  soup = grid_sheet(context, 120); /* more than one block of faces */
  vxm_surface_sums sheet = sums_of(soup);
  assert_true(sheet.area == 120 * 120 && sheet.vector_area.z == 120 * 120 && sheet.volume == 0);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

/** To the last bit as added up face after face, whoever looks at them. */
static void equals_one_loop(void **state) {
  (void)state;
  static const int threads[3] = {1, 2, 7};
  for (int t = 0; t < 3; t++) {
    vxm_context *context = context_of_threads(threads[t]);
    vxm_soup *soup = grid_sheet(context, 130);
    vxm_rng rng = {5};
    for (size_t c = 0; c < 3 * soup->vertex_count; c++)
      soup->positions[c] += 3 * vxm_rng_unit(&rng);
    soup->positions[3 * 77] = INFINITY; /* of faces that have no volume */
    double bounds[6] = {0, 0, 0, 128, 128, 2}, volume = 0, area = 0;
    vxm_unit_scale frame = vxm_unit_scale_of(bounds);
    for (size_t f = 0; f < soup->face_count; f++) {
      const uint32_t *corner = soup->indices + 3 * f;
      const double *p = vxm_position(soup, corner[0]);
      vxm_vec3 around = vxm_polygon_area(soup->positions, corner, 3, frame.scale);
      area += corner[0] == 77 || corner[1] == 77 || corner[2] == 77 ? 0 : vxm_vec3_length(around);
      vxm_vec3 first = {p[0] * frame.scale - 64 * frame.scale, p[1] * frame.scale - 64 * frame.scale,
                        p[2] * frame.scale - frame.scale};
      if (corner[0] != 77 && corner[1] != 77 && corner[2] != 77)
        volume += vxm_polygon_cone(first, around);
    }
    vxm_surface_sums sums;
    assert_int_equal(vxm_surface_sums_of(&sums, soup, bounds, &frame, NULL, NULL), VXM_OK);
    assert_true(sums.volume == volume / frame.scale / frame.scale / frame.scale);
    assert_false(sums.area == area); /* infinite, or not a number */
    soup->positions[3 * 77] = 0;
    vxm_surface_sums again;
    assert_int_equal(vxm_surface_sums_of(&again, soup, bounds, &frame, NULL, NULL), VXM_OK);
    assert_true(isfinite(again.area) && again.area > area);
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(cubes_and_sheets), cmocka_unit_test(equals_one_loop)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

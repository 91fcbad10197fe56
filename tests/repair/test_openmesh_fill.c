/* SPDX-License-Identifier: BSD-3-Clause */
/** The module for OpenMesh: holes in planes, spheres and tubes. */
#include "halfedges.h"
#include "outlines.h"

#include "repair/manifold/cut_nonmanifold.h"

/** Fills the open end of a prism over the outline: flat, covered once, closed. */
static void check_outline(vxm_context *context, outline o, vxm_rng *rng, double shift) {
  turning turn = random_turning(rng);
  double height = 0.5 + vxm_rng_unit(rng), area = outline_area(&o), sum, of_sum;
  vxm_soup *soup = open_prism(context, &o, height, &turn, shift);
  outcome out = fill(soup, 0);
  assert_int_equal(out.filled, 1);
  areas_from(out.soup, soup->face_count, &sum, &of_sum);
  double exact = 1e-9 * (1 + shift);
  if (fabs(sum / area - 1) > exact || fabs(of_sum / area - 1) > exact)
    fail_msg("%zu edges: area %.12g, faces %.12g, together %.12g", o.count, area, sum, of_sum);
  drop(soup, out);
  vxm_soup_destroy(soup);
  free(o.points);
}

static void flat_holes(void **state) {
  vxm_rng rng = {6};
  for (int i = 0; i < 20; i++) {
    check_outline(*state, l_shape(), &rng, i % 2 ? 1000 : 0);
    check_outline(*state, comb(1 + (size_t)i), &rng, 0);
    check_outline(*state, spiral(4 + 4 * (size_t)i, 0.5 + 0.2 * i), &rng, 0);
    check_outline(*state, star(&rng, 3 + 5 * (size_t)i, 0.9), &rng, 0);
  }
  for (int i = 0; i < 150; i++)
    check_outline(*state, cells_outline(&rng, 2 + (size_t)vxm_rng_below(&rng, 60)), &rng, i % 2 ? 1000 : 0);
}

/** Rims that are cut before they are filled. */
static void long_flat_holes(void **state) {
  vxm_rng rng = {7};
  check_outline(*state, star(&rng, 1500, 0), &rng, 0);
  check_outline(*state, star(&rng, 1200, 0.5), &rng, 0);
  check_outline(*state, comb(200), &rng, 0);
  check_outline(*state, spiral(600, 3), &rng, 0);
  check_outline(*state, cells_outline(&rng, 350), &rng, 0);
}

/** A sheet with holes in it: they are filled in its plane, its own rim is left. */
static void holes_in_a_sheet(void **state) {
  vxm_rng rng = {8};
  for (int i = 0; i < 60; i++) {
    size_t n = 8 + (size_t)vxm_rng_below(&rng, 8);
    vxm_soup *whole = grid_sheet(*state, n), *soup = new_soup(*state), *apart;
    for (size_t v = 0; v < whole->vertex_count; v++) {
      const double *p = vxm_position(whole, v);
      add_vertex(soup, p[0], p[1], p[2]);
    }
    for (size_t f = 0; f < whole->face_count; f++) {
      size_t count, column = f / 2 % n, row = f / 2 / n;
      const uint32_t *face = vxm_face(whole, f, &count);
      bool inside = column > 0 && row > 0 && column + 1 < n && row + 1 < n;
      if (!inside || vxm_rng_unit(&rng) > 0.25)
        add_face(soup, face, count);
    }
    int64_t split, stitched;
    assert_int_equal(vxm_cut_nonmanifold(&apart, &split, &stitched, soup, NULL), VXM_OK);
    outcome out = fill(apart, 0);
    double sum, of_sum;
    areas_from(out.soup, 0, &sum, &of_sum);
    if (inspected(apart).components == 1)
      assert_true(fabs(sum - (double)(n * n)) < 1e-9);
    assert_true(fabs(sum - of_sum) < 1e-9);
    drop(apart, out);
    vxm_soup_destroy(apart);
    vxm_soup_destroy(soup);
    vxm_soup_destroy(whole);
  }
}

/** A sphere with faces missing is closed again, with nearly its volume. */
static void holes_in_a_sphere(void **state) {
  vxm_rng rng = {9};
  for (int i = 0; i < 60; i++) {
    enum { RINGS = 24, AROUND = 48 };
    vxm_soup *soup = new_soup(*state), *apart;
    add_vertex(soup, 0, 0, 1);
    for (int j = 1; j < RINGS; j++)
      for (int k = 0; k < AROUND; k++)
        add_vertex(soup, sin(M_PI * j / RINGS) * cos(2 * M_PI * k / AROUND),
                   sin(M_PI * j / RINGS) * sin(2 * M_PI * k / AROUND), cos(M_PI * j / RINGS));
    add_vertex(soup, 0, 0, -1);
    double missing = 0.15 * vxm_rng_unit(&rng);
    for (uint32_t j = 0; j < RINGS; j++)
      for (uint32_t k = 0; k < AROUND; k++) {
        uint32_t next = (k + 1) % AROUND, up = 1 + (j - 1) * AROUND, down = 1 + j * AROUND;
        uint32_t quad[4] = {up + k, down + k, down + next, up + next};
        if (vxm_rng_unit(&rng) < missing)
          continue;
        if (j == 0)
          add_triangle(soup, 0, down + k, down + next);
        else if (j == RINGS - 1)
          add_triangle(soup, up + k, (RINGS - 1) * AROUND + 1, up + next);
        else
          add_face(soup, quad, 4);
      }
    int64_t split, stitched;
    assert_int_equal(vxm_cut_nonmanifold(&apart, &split, &stitched, soup, NULL), VXM_OK);
    outcome out = fill(apart, 0);
    if (inspected(apart).components == 1) {
      assert_int_equal(out.left, 0);
      assert_true(fabs(volume_of(out.soup) / (4 * M_PI / 3) - 1) < 0.05);
    }
    drop(apart, out);
    vxm_soup_destroy(apart);
    vxm_soup_destroy(soup);
  }
}

/** Tubes: both ends are filled, however short the tube and however wavy and long its ends. */
static void ends_of_tubes(void **state) {
  for (int i = 0; i < 6; i++) {
    uint32_t n = i < 4 ? 40 : 700;
    double height = i % 2 ? 0.05 : 5, waves = i < 2 ? 0 : 0.4;
    vxm_soup *soup = new_soup(*state);
    for (uint32_t k = 0; k < 2 * n; k++) {
      double angle = 2 * M_PI * k / n;
      add_vertex(soup, cos(angle), sin(angle), (k < n ? 0 : height) + waves * sin(5 * angle));
    }
    for (uint32_t k = 0; k < n; k++) {
      uint32_t next = (k + 1) % n, wall[4] = {k, next, n + next, n + k};
      add_face(soup, wall, 4);
    }
    outcome out = fill(soup, 0);
    assert_int_equal(out.filled, 2);
    /* a wavy end has fillings above and below its middle */
    assert_true(fabs(volume_of(out.soup) - M_PI * height) < 0.02 * M_PI * height + 6 * waves);
    drop(soup, out);
    vxm_soup_destroy(soup);
  }
}

int main(void) {
  if (open_openmesh() != 0)
    return 77;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(flat_holes),       cmocka_unit_test(long_flat_holes),
      cmocka_unit_test(holes_in_a_sheet), cmocka_unit_test(holes_in_a_sphere),
      cmocka_unit_test(ends_of_tubes),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}

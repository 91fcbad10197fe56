/* SPDX-License-Identifier: BSD-3-Clause */
/** Where vertices that touch go: away from what touches them, on whichever side of their faces that is. */
#include "repair_test.h"

#include "repair/manifold/contact_direction.h"

/** A prism between 0 and 1 along z over a polygon that is seen from its first corner all over. */
static void add_prism(vxm_soup *soup, const double (*profile)[2], uint32_t count) {
  uint32_t first = (uint32_t)soup->vertex_count;
  for (uint32_t i = 0; i < 2 * count; i++)
    add_vertex(soup, profile[i / 2][0], profile[i / 2][1], i % 2);
  for (uint32_t i = 0; i < count; i++) {
    uint32_t a = first + 2 * i, b = first + 2 * ((i + 1) % count);
    add_face(soup, (const uint32_t[]){a, b, b + 1}, 3);
    add_face(soup, (const uint32_t[]){a, b + 1, a + 1}, 3);
    if (i == 0 || i + 1 == count)
      continue;
    add_face(soup, (const uint32_t[]){first, b, a}, 3);
    add_face(soup, (const uint32_t[]){first + 1, a + 1, b + 1}, 3);
  }
}

static void turn_all(vxm_soup *soup) {
  for (size_t f = 0; f < soup->face_count; f++) {
    uint32_t *corner = soup->indices + soup->offsets[f], second = corner[1];
    corner[1] = corner[2];
    corner[2] = second;
  }
}

/** Asserts that the vertices at each common position go `sign` along the normals of all their faces. */
static void assert_apart(const vxm_soup *soup, int sign, int want) {
  uint32_t map[64], number[64];
  size_t count = 0;
  vxm_vec3 directions[64];
  assert_true(soup->vertex_count <= 64);
  assert_int_equal(vxm_weld_exact(soup->context, soup->positions, soup->vertex_count, map, NULL, NULL),
                   VXM_OK);
  for (uint32_t v = 0; v < soup->vertex_count; v++) {
    bool shared = map[v] != v;
    for (uint32_t w = v + 1; w < soup->vertex_count; w++)
      shared = shared || map[w] == v;
    number[v] = shared ? (uint32_t)count++ : VXM_NO_VERTEX;
  }
  assert_int_equal(count, want);
  assert_int_equal(vxm_contact_directions(directions, soup, map, number, count, NULL), VXM_OK);
  for (size_t c = 0; c < soup->corner_count; c++) {
    if (number[soup->indices[c]] == VXM_NO_VERTEX)
      continue;
    vxm_vec3 to = directions[number[soup->indices[c]]];
    vxm_vec3 normal = vxm_polygon_area(soup->positions, soup->indices + c / 3 * 3, 3, 1);
    assert_true(fabs(vxm_vec3_length(to) - 1) < 1e-12);
    if (!(sign * vxm_vec3_dot(to, normal) > 0.1 * vxm_vec3_length(normal)))
      fail_msg("vertex %u goes to %g %g %g", soup->indices[c], to.x, to.y, to.z);
  }
}

/** An edge in a notch: both go back into their solids, the notch away from where its faces have their
 * middles. Turned inside out, a ridge of what is empty touches a notch of it. */
static void edge_in_a_notch(void **state) {
  static const double notched[][2] = {{0, 0}, {0, 2}, {-2, 2}, {-2, -2}, {2, -2}, {2, 0}};
  static const double ridge[][2] = {{0, 0}, {2, 1}, {1, 2}};
  for (int turned = 0; turned < 2; turned++) {
    vxm_soup *soup = new_soup(*state);
    add_prism(soup, notched, 6);
    add_prism(soup, ridge, 3);
    if (turned)
      turn_all(soup);
    assert_apart(soup, turned ? 1 : -1, 4);
    vxm_soup_destroy(soup);
  }
}

static void corners_that_touch(void **state) {
  static const double left[][2] = {{0, 0}, {-2, 1}, {-2, -1}}, right[][2] = {{0, 0}, {2, -1}, {2, 1}};
  for (int turned = 0; turned < 2; turned++) {
    vxm_soup *soup = new_soup(*state);
    add_prism(soup, left, 3);
    add_prism(soup, right, 3);
    if (turned)
      turn_all(soup);
    assert_apart(soup, turned ? 1 : -1, 4);
    vxm_soup_destroy(soup);
  }
}

/** Four octants of space, each on the one before: no direction leaves all of their faces behind. */
static void saddle(void **state) {
  static const double ends[6][3] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, 0, -1}, {0, -1, 0}, {0, 0, 1}};
  vxm_soup *soup = new_soup(*state);
  add_vertex(soup, 0, 0, 0);
  for (uint32_t i = 0; i < 6; i++)
    add_vertex(soup, ends[i][0], ends[i][1], ends[i][2]);
  for (uint32_t i = 0; i < 6; i++)
    add_face(soup, (const uint32_t[]){0, 1 + (i + 1) % 6, 1 + i}, 3);
  const uint32_t none = VXM_NO_VERTEX, map[] = {0, 1, 2, 3, 4, 5, 6};
  const uint32_t number[] = {0, none, none, none, none, none, none};
  vxm_vec3 direction;
  assert_int_equal(vxm_contact_directions(&direction, soup, map, number, 1, NULL), VXM_OK);
  assert_true(vxm_vec3_length(direction) == 0);
  vxm_soup_destroy(soup);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(edge_in_a_notch),
      cmocka_unit_test(corners_that_touch),
      cmocka_unit_test(saddle),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}

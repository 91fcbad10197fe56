/* SPDX-License-Identifier: BSD-3-Clause */
#include "soups.h"

#include "mesh/components.h"
#include "mesh/duplicate_faces.h"
#include "mesh/patches.h"

/* ---- The definition, tried on all pairs ---- */

/** Whether a face has the edge a-b, and its sides are looked at (vxm_edges_build). */
static bool has_side(const vxm_soup *soup, size_t face, uint32_t a, uint32_t b) {
  size_t count;
  const uint32_t *corner = vxm_face(soup, face, &count);
  for (size_t i = 0; i < count && vxm_face_has_three(corner, count, NULL); i++) {
    uint32_t u = corner[i], v = corner[i + 1 < count ? i + 1 : 0];
    if (u != v && ((u == a && v == b) || (u == b && v == a)))
      return true;
  }
  return false;
}

/** How many sides of a face another one has, too; `*sides` becomes how many it has. */
static size_t shared_sides(const vxm_soup *soup, size_t face, size_t other, size_t *sides) {
  size_t count, shared = 0;
  const uint32_t *corner = vxm_face(soup, face, &count);
  *sides = 0;
  for (size_t i = 0; i < count; i++) {
    uint32_t u = corner[i], v = corner[i + 1 < count ? i + 1 : 0];
    if (u == v || !has_side(soup, face, u, v))
      continue;
    (*sides)++;
    shared += has_side(soup, other, u, v);
  }
  return shared;
}

/** Numbers patches by painting, again and again, what is next to what is painted. */
static size_t paint(const vxm_soup *soup, uint32_t *of_face, bool *may_repeat) {
  size_t next = 0, faces = soup->face_count, sides;
  *may_repeat = false;
  for (size_t f = 0; f < faces; f++)
    of_face[f] = UINT32_MAX;
  for (size_t first = 0; first < faces; first++) {
    if (of_face[first] != UINT32_MAX)
      continue;
    of_face[first] = (uint32_t)next;
    for (bool more = true; more;) {
      more = false;
      for (size_t f = 0; f < faces; f++)
        for (size_t g = 0; g < faces && of_face[f] == UINT32_MAX; g++)
          if (of_face[g] == next && shared_sides(soup, f, g, &sides) > 0) {
            of_face[f] = (uint32_t)next;
            more = true;
          }
    }
    next++;
  }
  for (size_t f = 0; f < faces; f++)
    for (size_t g = 0; g < f; g++)
      *may_repeat |= shared_sides(soup, f, g, &sides) == sides && sides > 0;
  return next;
}

static void check(const vxm_soup *soup, int *seen) {
  vxm_edges edges;
  assert_int_equal(vxm_edges_build_sides(&edges, soup->context, soup, NULL, NULL), VXM_OK);
  if (edges.crowded > 0) {
    vxm_edges_destroy(&edges);
    return;
  }
  vxm_patches patches;
  assert_int_equal(vxm_patches_build(&patches, soup, &edges, NULL), VXM_OK);
  uint32_t wanted[256];
  bool may_repeat, apart;
  assert_int_equal(patches.count, paint(soup, wanted, &may_repeat));
  assert_memory_equal(patches.of_face, wanted, soup->face_count * sizeof *wanted);
  assert_int_equal(patches.may_repeat, may_repeat);
  assert_int_equal(patches.is_closed, edges.odd == 0);

  vxm_duplicates found;
  assert_int_equal(vxm_duplicates_find(&found, soup->context, soup, NULL, NULL, NULL), VXM_OK);
  assert_true(patches.may_repeat || found.same + found.opposite_pairs == 0);
  size_t components;
  uint32_t labels[256];
  assert_int_equal(vxm_components(soup->context, soup, NULL, labels, &components, NULL), VXM_OK);
  assert_int_equal(vxm_patches_are_apart(&apart, &patches, soup, NULL), VXM_OK);
  assert_int_equal(apart, components == patches.count);
  if (apart)
    assert_memory_equal(patches.of_face, labels, soup->face_count * sizeof *labels);
  seen[0] += patches.count > 1;
  seen[1] += apart;
  seen[2] += !apart;
  seen[3] += may_repeat;
  seen[4] += patches.is_closed;
  vxm_patches_destroy(&patches);
  vxm_edges_destroy(&edges);
}

/** Pieces of a sheet in any order, some turned, some with their other side, some polygons. */
static vxm_soup *torn_sheet(vxm_context *context, vxm_rng *rng) {
  vxm_soup *sheet = grid_sheet(context, 1 + (size_t)vxm_rng_below(rng, 5)), *soup = new_soup(context);
  for (size_t v = 0; v < sheet->vertex_count; v++)
    add_vertex(soup, sheet->positions[3 * v], sheet->positions[3 * v + 1], 0);
  uint64_t kept = 1 + vxm_rng_below(rng, 4);
  for (size_t f = 0; f < sheet->face_count; f++) {
    const uint32_t *c = sheet->indices + 3 * f;
    if (vxm_rng_below(rng, 4) >= kept)
      continue;
    if (vxm_rng_below(rng, 2))
      add_triangle(soup, c[0], c[1], c[2]);
    else
      add_triangle(soup, c[0], c[2], c[1]);
    if (vxm_rng_below(rng, 12) == 0)
      add_triangle(soup, c[1], c[0], c[2]);
    if (vxm_rng_below(rng, 20) == 0)
      add_triangle(soup, c[1], c[1], c[2]);
  }
  vxm_soup_destroy(sheet);
  return soup;
}

static void equals_painting(void **state) {
  (void)state;
  vxm_rng rng = {11};
  vxm_context *context = context_of_threads(2);
  int seen[5] = {0};
  for (int round = 0; round < 3000; round++) {
    vxm_soup *soup = round % 2 ? torn_sheet(context, &rng)
                               : random_soup(context, &rng, 6 + (size_t)vxm_rng_below(&rng, 30),
                                             (size_t)vxm_rng_below(&rng, 10), 3, 6);
    check(soup, seen);
    vxm_soup_destroy(soup);
  }
  for (int i = 0; i < 5; i++)
    assert_true(seen[i] > 50);
  vxm_context_destroy(context);
}

static void cubes_and_pillows(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(2);
  int seen[5] = {0};
  vxm_soup *soup = new_soup(context);
  add_cube(soup, 0);
  add_cube(soup, 3);
  check(soup, seen);
  assert_int_equal(seen[4], 1); /* closed, two patches, apart, nothing repeated */
  assert_int_equal(seen[1], 1);
  assert_int_equal(seen[3], 0);
  for (size_t c = 24; c < 48; c++) /* the second one touches the first in a vertex */
    soup->indices[c] = soup->indices[c] == 8 ? 7 : soup->indices[c];
  check(soup, seen);
  assert_int_equal(seen[2], 1);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(equals_painting), cmocka_unit_test(cubes_and_pillows)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "soups.h"

#include "mesh/edges.h"
#include "mesh/face_adjacency.h"

/* ---- The definition, tried on all pairs of sides ---- */

typedef struct side {
  uint32_t from, to;
  size_t face;
} side;

enum { SIDES_MAX = 4096 };

/** Lists the side that begins at each corner; from = to where there is none. Returns how many there are. */
static size_t list_sides(const vxm_soup *soup, side *sides) {
  size_t found = 0;
  assert_true(soup->corner_count <= SIDES_MAX);
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    for (size_t i = 0; i < count; i++) {
      side *s = &sides[soup->offsets[f] + i];
      *s = (side){corner[i], corner[(i + 1) % count], f};
      if (!vxm_face_has_three(corner, count, NULL))
        s->to = s->from;
      found += s->from != s->to;
    }
  }
  return found;
}

/** Whether each side has one other along its edge, which runs the other way; its face goes to `wanted`. */
static bool pair_all(const side *sides, size_t corners, uint32_t *wanted) {
  bool paired = true;
  for (size_t c = 0; c < corners; c++) {
    size_t same = 0, opposite = 0;
    wanted[c] = VXM_NO_ADJACENT;
    for (size_t d = 0; d < corners && sides[c].from != sides[c].to; d++) {
      same += sides[d].from == sides[c].from && sides[d].to == sides[c].to;
      if (sides[d].from == sides[c].to && sides[d].to == sides[c].from) {
        opposite++;
        wanted[c] = (uint32_t)sides[d].face;
      }
    }
    paired = paired && (sides[c].from == sides[c].to || (same == 1 && opposite == 1));
  }
  return paired;
}

/** Returns whether it is paired. */
static bool check(const vxm_soup *soup) {
  static side sides[SIDES_MAX];
  static uint32_t wanted[SIDES_MAX];
  vxm_edges edges, listed;
  size_t count = list_sides(soup, sides);
  bool paired = pair_all(sides, soup->corner_count, wanted);
  assert_int_equal(vxm_edges_build_pairs(&edges, soup->context, soup, NULL), VXM_OK);
  assert_int_equal(vxm_edges_build_sides(&listed, soup->context, soup, NULL, NULL), VXM_OK);
  assert_int_equal(edges.adjacent != NULL, paired);
  assert_int_equal(edges.count, listed.count);
  assert_int_equal(edges.odd, listed.odd);
  assert_int_equal(edges.open, listed.open);
  assert_int_equal(edges.crowded, listed.crowded);
  assert_int_equal(edges.against, listed.against);
  if (paired) {
    assert_int_equal(2 * edges.count, count);
    assert_null(edges.edges);
    assert_null(edges.sides);
    assert_memory_equal(edges.adjacent, wanted, soup->corner_count * sizeof *wanted);
  } else {
    assert_memory_equal(edges.edges, listed.edges, edges.count * sizeof *edges.edges);
    assert_memory_equal(edges.sides, listed.sides, soup->corner_count * sizeof *edges.sides);
  }
  vxm_edges_destroy(&listed);
  vxm_edges_destroy(&edges);
  return paired;
}

/* ---- Soups that are closed, or nearly ---- */

/** Gives vertices other numbers, at times two the same one. */
static void shuffle(vxm_soup *soup, vxm_rng *rng, bool merges) {
  uint32_t number[256];
  size_t count = soup->vertex_count;
  assert_true(count <= 256);
  for (size_t v = 0; v < count; v++)
    number[v] = (uint32_t)v;
  for (size_t v = count; v-- > 1;) {
    size_t w = (size_t)vxm_rng_below(rng, v + 1);
    uint32_t kept = number[v];
    number[v] = number[w];
    number[w] = kept;
  }
  if (merges)
    number[vxm_rng_below(rng, count)] = number[vxm_rng_below(rng, count)];
  for (size_t c = 0; c < soup->corner_count; c++)
    soup->indices[c] = number[soup->indices[c]];
}

/** Damages a face, or adds one. */
static void damage(vxm_soup *soup, vxm_rng *rng) {
  size_t face = (size_t)vxm_rng_below(rng, soup->face_count), count;
  uint32_t copy[64];
  uint32_t *corner = soup->indices + soup->offsets[face];
  vxm_face(soup, face, &count);
  memcpy(copy, corner, count * sizeof *copy);
  switch (vxm_rng_below(rng, 5)) {
  case 0: /* turned */
    corner[0] = copy[1];
    corner[1] = copy[0];
    break;
  case 1: /* without area */
    corner[0] = corner[1];
    break;
  case 2: /* twice */
    add_face(soup, copy, count);
    break;
  case 3: /* another one, of fewer corners */
    add_face(soup, copy, 2);
    break;
  default: /* elsewhere */
    corner[0] = (uint32_t)vxm_rng_below(rng, soup->vertex_count);
  }
}

static void pairs_equal_counting(void **state) {
  (void)state;
  vxm_rng rng = {17};
  int paired = 0, others = 0;
  vxm_context *context = context_of_threads(2);
  for (int round = 0; round < 600; round++) {
    vxm_soup *soup = new_soup(context);
    for (uint64_t bodies = 1 + vxm_rng_below(&rng, 3); bodies > 0; bodies--)
      if (vxm_rng_below(&rng, 3) == 0)
        add_cube(soup, (double)bodies);
      else
        add_bipyramid(soup, 2 + (uint32_t)vxm_rng_below(&rng, vxm_rng_below(&rng, 4) ? 8 : 60));
    shuffle(soup, &rng, vxm_rng_below(&rng, 4) == 0);
    for (uint64_t times = vxm_rng_below(&rng, 3); times > 0; times--)
      damage(soup, &rng);
    if (check(soup))
      paired++;
    else
      others++;
    vxm_soup_destroy(soup);
  }
  print_message("%d paired, %d not\n", paired, others);
  assert_true(paired > 150 && others > 150);
  vxm_context_destroy(context);
}

static void nothing_is_paired(void **state) {
  (void)state;
  vxm_context *context = context_of_threads(1);
  vxm_soup *soup = new_soup(context);
  assert_true(check(soup));
  add_vertex(soup, 0, 0, 0);
  add_face(soup, (uint32_t[]){0, 0, 0}, 3);
  assert_true(check(soup));
  add_face(soup, NULL, 0);
  assert_true(check(soup));
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pairs_equal_counting),
      cmocka_unit_test(nothing_is_paired),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

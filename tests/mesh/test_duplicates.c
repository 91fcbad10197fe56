/* SPDX-License-Identifier: BSD-3-Clause */
#include "soups.h"

#include "mesh/duplicate_faces.h"

static size_t distinct_corners(const uint32_t *face, size_t count) {
  size_t distinct = 0;
  for (size_t i = 0; i < count; i++) {
    bool seen = false;
    for (size_t j = 0; j < i; j++)
      seen |= face[i] == face[j];
    distinct += !seen;
  }
  return distinct;
}

/** Whether one face is the other turned, and read backward if so asked; by trying every turn. */
static bool repeats(const uint32_t *a, const uint32_t *b, size_t count, bool backward) {
  for (size_t turn = 0; turn < count; turn++) {
    bool equal = true;
    for (size_t i = 0; i < count && equal; i++) {
      size_t j = backward ? (turn + count - i) % count : (turn + i) % count;
      equal = a[i] == b[j];
    }
    if (equal)
      return true;
  }
  return false;
}

static vxm_repeat kind_by_search(const vxm_soup *soup, size_t f) {
  size_t count, other;
  const uint32_t *face = vxm_face(soup, f, &count);
  bool opposite = false;
  if (distinct_corners(face, count) < 3)
    return VXM_REPEAT_NONE;
  for (size_t g = 0; g < f; g++) {
    const uint32_t *earlier = vxm_face(soup, g, &other);
    if (other != count)
      continue;
    if (repeats(face, earlier, count, false))
      return VXM_REPEAT_SAME;
    opposite |= repeats(face, earlier, count, true);
  }
  return opposite ? VXM_REPEAT_OPPOSITE : VXM_REPEAT_NONE;
}

static vxm_copies copies_by_search(const vxm_soup *soup, size_t f) {
  size_t count, other;
  const uint32_t *face = vxm_face(soup, f, &count);
  vxm_copies copies = {.first = SIZE_MAX};
  if (distinct_corners(face, count) < 3)
    return (vxm_copies){.first = f, .same = 1};
  for (size_t g = 0; g < soup->face_count; g++) {
    const uint32_t *second = vxm_face(soup, g, &other);
    bool same = other == count && repeats(face, second, count, false);
    bool opposite = !same && other == count && repeats(face, second, count, true);
    if ((same || opposite) && copies.first == SIZE_MAX) {
      copies.first = g;
      copies.turned = opposite;
    }
    copies.same += same;
    copies.opposite += opposite;
    copies.rank += same && g < f;
  }
  return copies;
}

/** Faces later than f that make pairs with it: used to count pairs of opposite faces greedily. */
static size_t pairs_by_search(const vxm_soup *soup) {
  bool taken[256] = {false};
  size_t pairs = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count, other;
    const uint32_t *face = vxm_face(soup, f, &count);
    if (taken[f] || distinct_corners(face, count) < 3)
      continue;
    for (size_t g = f + 1; g < soup->face_count; g++) {
      const uint32_t *later = vxm_face(soup, g, &other);
      if (taken[g] || other != count || repeats(face, later, count, false) ||
          !repeats(face, later, count, true))
        continue;
      taken[g] = true;
      pairs++;
      break;
    }
  }
  return pairs;
}

static void equals_search(void **state) {
  (void)state;
  vxm_rng rng = {12};
  vxm_context *context = context_of_threads(2);
  size_t seen[3] = {0};
  for (int round = 0; round < 600; round++) {
    size_t vertices = 1 + (size_t)vxm_rng_below(&rng, 7);
    vxm_soup *soup = random_soup(context, &rng, vertices, (size_t)vxm_rng_below(&rng, 60), 3, 8);
    uint8_t kinds[64];
    vxm_copies copies[64];
    vxm_duplicates found, counted;
    assert_int_equal(vxm_duplicates_find(&found, context, soup, kinds, copies, NULL), VXM_OK);
    assert_int_equal(vxm_duplicates_find(&counted, context, soup, NULL, NULL, NULL), VXM_OK);
    size_t same = 0;
    for (size_t f = 0; f < soup->face_count; f++) {
      assert_int_equal(kinds[f], kind_by_search(soup, f));
      vxm_copies wanted = copies_by_search(soup, f);
      assert_int_equal(copies[f].first, wanted.first);
      assert_int_equal(copies[f].rank, wanted.rank);
      assert_int_equal(copies[f].same, wanted.same);
      assert_int_equal(copies[f].opposite, wanted.opposite);
      assert_int_equal(copies[f].turned, wanted.turned);
      same += kinds[f] == VXM_REPEAT_SAME;
      seen[kinds[f]]++;
    }
    assert_int_equal(found.same, same);
    assert_int_equal(found.opposite_pairs, pairs_by_search(soup));
    assert_memory_equal(&found, &counted, sizeof found);
    vxm_soup_destroy(soup);
  }
  assert_true(seen[VXM_REPEAT_SAME] > 1000 && seen[VXM_REPEAT_OPPOSITE] > 300);
  vxm_context_destroy(context);
}

/** Very many copies of one face, and very large faces with long repetitions: linear time. */
static void crowds_and_large_faces(void **state) {
  (void)state;
  enum { COPIES = 300000, CORNERS = 200000 };
  vxm_context *context = context_of_threads(2);
  vxm_soup *soup = new_soup(context);
  for (int v = 0; v < 4; v++)
    add_vertex(soup, v, v * v, 0);
  for (int f = 0; f < COPIES; f++)
    f % 3 ? add_triangle(soup, 1, 2, 3) : add_triangle(soup, 2, 1, 3);
  vxm_duplicates found;
  assert_int_equal(vxm_duplicates_find(&found, context, soup, NULL, NULL, NULL), VXM_OK);
  assert_int_equal(found.same, COPIES - 2);
  assert_int_equal(found.opposite_pairs, COPIES / 3);
  vxm_soup_destroy(soup);

  soup = new_soup(context);
  for (int v = 0; v < 4; v++)
    add_vertex(soup, v, v * v, 0);
  uint32_t *corners = malloc(CORNERS * sizeof *corners);
  assert_non_null(corners);
  for (uint32_t face = 0; face < 3; face++) {
    /* 0 1 0 1 ... with one 2 3 in it, in other places and directions */
    for (uint32_t i = 0; i < CORNERS; i++)
      corners[i] = i % 2;
    uint32_t at = face * 30000;
    corners[at] = 2;
    corners[at + 1] = 3;
    if (face == 2)
      for (uint32_t i = 0; i < CORNERS / 2; i++) {
        uint32_t kept = corners[i];
        corners[i] = corners[CORNERS - 1 - i];
        corners[CORNERS - 1 - i] = kept;
      }
    add_face(soup, corners, CORNERS);
  }
  free(corners);
  uint8_t kinds[3];
  assert_int_equal(vxm_duplicates_find(&found, context, soup, kinds, NULL, NULL), VXM_OK);
  assert_int_equal(kinds[0], VXM_REPEAT_NONE);
  assert_int_equal(kinds[1], VXM_REPEAT_SAME);
  assert_int_equal(kinds[2], VXM_REPEAT_OPPOSITE);
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(equals_search),
      cmocka_unit_test(crowds_and_large_faces),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** What holds for the whole repair, on thousands of random soups. */
#include "../base/rounds.h"
#include "repair_test.h"

#include "mesh/census.h"
#include "mesh/edges.h"
#include "mesh/geometry.h"
#include "mesh/unit_scale.h"

#include <math.h>

/* ---- Faces as words ---- */

enum { WORD_MAX = 40 };

/** A face as a cyclic word of positions: vertices are replaced by the first one of the same position. */
typedef struct word {
  uint32_t letters[WORD_MAX];
  size_t length;
} word;

static uint32_t first_of_position(const vxm_soup *soup, uint32_t v) {
  for (uint32_t u = 0; u < v; u++)
    if (memcmp(vxm_position(soup, u), vxm_position(soup, v), 3 * sizeof(double)) == 0)
      return u;
  return v;
}

/** Reads a face of `soup` in the vertices of `names`, which has all positions. */
static word word_of(const vxm_soup *soup, size_t face, const vxm_soup *names) {
  word w = {.length = 0};
  const uint32_t *corners = vxm_face(soup, face, &w.length);
  for (size_t i = 0; i < w.length; i++) {
    uint32_t v = 0;
    while (memcmp(vxm_position(names, v), vxm_position(soup, corners[i]), 3 * sizeof(double)) != 0)
      v++;
    w.letters[i] = v;
  }
  return w;
}

static void drop_letter(word *w, size_t at) {
  memmove(w->letters + at, w->letters + at + 1, (--w->length - at) * sizeof *w->letters);
}

/** Removes a a -> a and a b a -> a, one at a time from anywhere, until nothing can be removed. */
static void reduce_word(word *w) {
  for (size_t i = 0; i < w->length;) {
    size_t n = w->length, next = (i + 1) % n, after = (i + 2) % n;
    if (n < 3) {
      w->length = 0;
    } else if (w->letters[i] == w->letters[next] || w->letters[i] == w->letters[after]) {
      drop_letter(w, next);
      i = 0;
    } else
      i++;
  }
}

static bool same_word(const word *a, const word *b, bool either_direction) {
  if (a->length != b->length)
    return false;
  for (size_t turn = 0; turn < a->length; turn++)
    for (int back = 0; back <= either_direction; back++) {
      bool equal = true;
      for (size_t i = 0; i < a->length && equal; i++)
        equal =
            a->letters[i] == b->letters[back ? (turn + a->length - i) % a->length : (turn + i) % a->length];
      if (equal)
        return true;
    }
  return false;
}

/* ---- The properties ---- */

static size_t odd_edges(const vxm_soup *soup, const uint32_t *map) {
  vxm_edges edges;
  assert_int_equal(vxm_edges_build(&edges, soup->context, soup, map, NULL), VXM_OK);
  size_t odd = edges.odd;
  vxm_edges_destroy(&edges);
  return odd;
}

/** Faces without area that are left must be needed: without one of them more edges are odd. */
static void check_flat_faces(const vxm_soup *out, const vxm_census *after) {
  vxm_unit_scale frame = vxm_unit_scale_of(after->bounds);
  size_t odd = odd_edges(out, NULL);
  int64_t flat = 0;
  for (size_t f = 0; f < out->face_count; f++) {
    if (!vxm_unit_scale_no_area(&frame, out, f))
      continue;
    flat++;
    vxm_soup *without = new_soup(out->context);
    for (size_t v = 0; v < out->vertex_count; v++)
      add_vertex(without, 0, 0, 0);
    for (size_t g = 0; g < out->face_count; g++) {
      size_t count;
      const uint32_t *face = vxm_face(out, g, &count);
      if (g != f)
        add_face(without, face, count);
    }
    assert_true(odd_edges(without, NULL) > odd);
    vxm_soup_destroy(without);
  }
  assert_int_equal(flat, after->degenerate_faces);
}

/** Whether the polygon has no area, from some corner: where it touches itself the first corner matters. */
static bool is_flat(const vxm_soup *names, const vxm_unit_scale *frame, const word *w) {
  bool flat = false;
  for (size_t turn = 0; turn < w->length; turn++) {
    uint32_t corners[WORD_MAX];
    for (size_t i = 0; i < w->length; i++)
      corners[i] = w->letters[(turn + i) % w->length];
    flat |= vxm_polygon_fan_area(names->positions, corners, w->length, frame->scale) <= frame->no_area;
  }
  return flat;
}

/** Every face of the result is its original's reduced word, in order; what is missing is empty, repeats an
 * earlier face that is there, or an even number of times others, or has no area. Faces that repeat others are
 * those that bodies share. */
static void check_faces(const vxm_soup *in, const vxm_soup *out, const vxm_repair_options *options,
                        int64_t shared) {
  size_t next = 0;
  int64_t repeated = 0;
  vxm_census before = VXM_CENSUS_INIT;
  assert_int_equal(vxm_soup_census(&before, in, NULL), VXM_OK);
  vxm_unit_scale frame = vxm_unit_scale_of(before.bounds);
  for (size_t f = 0; f < in->face_count; f++) {
    word wanted = word_of(in, f, in);
    reduce_word(&wanted);
    if (next < out->face_count && out->face_tags[next] == f) {
      word kept = word_of(out, next++, in);
      assert_true(wanted.length >= 3 && same_word(&kept, &wanted, !options->keep_orientation));
      bool repeats = false;
      for (size_t g = 0; g + 1 < next && !options->keep_duplicates; g++) {
        word other = word_of(out, g, in);
        repeats = repeats || same_word(&kept, &other, true);
      }
      repeated += repeats;
      continue;
    }
    bool explained = wanted.length == 0 || is_flat(in, &frame, &wanted);
    for (size_t g = 0; g < next && !options->keep_duplicates && !explained; g++) {
      word other = word_of(out, g, in);
      explained = same_word(&wanted, &other, true);
    }
    size_t like = 0;
    for (size_t g = 0; g < in->face_count && !options->keep_duplicates && !explained; g++) {
      word other = word_of(in, g, in);
      reduce_word(&other);
      like += same_word(&wanted, &other, true);
    }
    explained = explained || (like > 0 && like % 2 == 0);
    for (size_t g = next; g < out->face_count && !explained; g++) { /* or a later one that stays for it */
      word other = word_of(out, g, in);
      explained = same_word(&wanted, &other, true);
    }
    assert_true(explained);
  }
  assert_int_equal(repeated, shared);
  assert_int_equal(next, out->face_count);
}

static void check_counts(const vxm_soup *in, const vxm_soup *out, const vxm_repair_report *report,
                         bool triangles) {
  int64_t vertices = count_of(report, "nonfinite_vertices") + count_of(report, "exact_weld") +
                     count_of(report, "tolerant_weld") + count_of(report, "unused_vertices");
  assert_int_equal(in->vertex_count - out->vertex_count, vertices);
  int64_t faces = count_of(report, "repeated_corners") + count_of(report, "zero_area_faces") +
                  count_of(report, "duplicate_faces") + count_of(report, "opposite_duplicate_faces");
  if (triangles)
    assert_int_equal(in->face_count - out->face_count, faces);
  else
    assert_true((int64_t)(in->face_count - out->face_count) <= faces);
}

/** Returns whether edges were divided; then faces are others (test_t_junctions.c). */
static bool check_repair(const vxm_soup *in, const vxm_repair_options *options, bool triangles) {
  REPAIR_REPORT(report);
  vxm_soup *out = repaired(in, options, &report);
  bool divided = count_of(&report, "t_junctions") > 0;
  assert_repair_is_done(out, options);
  if (!divided) {
    check_counts(in, out, &report, triangles);
    check_faces(in, out, options, report.shared_faces);
  }
  check_flat_faces(out, report.after);
  assert_int_equal(report.after->unused_vertices, 0);
  assert_int_equal(report.after->components, report.after->components_raw);
  for (uint32_t v = 0; v < out->vertex_count; v++)
    assert_int_equal(first_of_position(out, v), v);
  if (options->keep_duplicates) {
    uint32_t map[64];
    assert_int_equal(vxm_weld_exact(in->context, in->positions, in->vertex_count, map, NULL, NULL), VXM_OK);
    assert_true(odd_edges(out, NULL) <= odd_edges(in, map));
  } else
    assert_int_equal(report.after->duplicate_faces + report.after->opposite_duplicate_faces,
                     report.shared_faces);
  vxm_soup_destroy(out);
  return divided;
}

static void random_soups(void **state) {
  (void)state;
  vxm_rng rng = {2024};
  vxm_context *context = context_of_threads(2);
  int divided = 0;
  for (int round = 0; round < ROUNDS(2500); round++) {
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.weld = round % 2 ? VXM_WELD_OFF : VXM_WELD_AUTO;
    options.keep_duplicates = round % 3 == 0;
    bool triangles = round % 4 == 0;
    vxm_soup *soup = new_soup(context);
    vxm_soup_destroy(soup);
    /* a lattice of two points a side makes closed sets often, one of five on a line many slivers */
    soup = random_soup(context, &rng, 1 + (size_t)vxm_rng_below(&rng, 24), (size_t)vxm_rng_below(&rng, 28),
                       2 + (unsigned)vxm_rng_below(&rng, 4), triangles ? 3 : 7);
    if (triangles)
      for (size_t f = 0; f < soup->face_count; f++)
        triangles &= soup->offsets[f + 1] - soup->offsets[f] == 3;
    for (size_t v = 0; v < soup->vertex_count && round % 5 == 0; v++)
      soup->positions[3 * v + 2] = 0;
    for (size_t v = 0; v < soup->vertex_count && round % 10 == 0; v++)
      soup->positions[3 * v + 1] = 0;
    tag_faces(soup);
    divided += check_repair(soup, &options, triangles);
    vxm_soup_destroy(soup);
  }
  assert_true(10 * divided < ROUNDS(2500));
  vxm_context_destroy(context);
}

/** Random coordinates, with what is not finite, near points and a given tolerance. */
static void random_tolerances(void **state) {
  (void)state;
  vxm_rng rng = {7};
  vxm_context *context = context_of_threads(2);
  int64_t merged = 0;
  for (int round = 0; round < ROUNDS(1500); round++) {
    vxm_soup *soup = random_soup(context, &rng, 1 + (size_t)vxm_rng_below(&rng, 24),
                                 (size_t)vxm_rng_below(&rng, 28), 3, 5);
    for (size_t c = 0; c < 3 * soup->vertex_count; c++) {
      soup->positions[c] += 0.3 * (vxm_rng_unit(&rng) - 0.5);
      if (vxm_rng_below(&rng, 200) == 0)
        soup->positions[c] = NAN;
    }
    vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
    options.weld = VXM_WELD_TOLERANCE;
    options.weld_tolerance = 0.1 * (double)vxm_rng_below(&rng, 4);
    options.keep_duplicates = round % 2;
    REPAIR_REPORT(report);
    vxm_soup *out = repaired(soup, &options, &report);
    assert_repair_is_done(out, &options);
    assert_int_equal(report.after->nonfinite_vertices, 0);
    merged += count_of(&report, "tolerant_weld");
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
  }
  assert_true(merged > ROUNDS(500));
  vxm_context_destroy(context);
}

static void same_for_any_threads(void **state) {
  (void)state;
  static const int threads[3] = {1, 2, 7};
  vxm_soup *first = NULL;
  for (int t = 0; t < 3; t++) {
    vxm_context *context = context_of_threads(threads[t]);
    vxm_rng rng = {55};
    vxm_soup *soup = random_soup(context, &rng, 30000, 60000, 24, 5);
    for (size_t c = 0; c < 3 * soup->vertex_count; c++)
      soup->positions[c] += (double)vxm_rng_below(&rng, 3) * 1e-6;
    vxm_soup *out = repaired(soup, NULL, NULL);
    if (first) {
      assert_same_soup(first, out);
      vxm_soup_destroy(out);
    } else
      first = out;
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
  }
  vxm_soup_destroy(first);
}

static int stop_at_zero(const char *phase, double fraction, void *payload) {
  (void)phase;
  assert_true(fraction >= 0 && fraction <= 1);
  return (*(int *)payload)-- == 0;
}

static void stops_at_limit_and_when_asked(void **state) {
  (void)state;
  int made = 0, refused = 0, cancelled = 0;
  vxm_context *unlimited = context_of_threads(2);
  vxm_rng first = {9};
  vxm_soup_destroy(random_soup(unlimited, &first, 2000, 4000, 10, 4));
  uint64_t least = vxm_context_peak_bytes(unlimited);
  vxm_context_destroy(unlimited);
  for (int step = 0; step < 120; step++) {
    int left = step < 40 ? step : -1;
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.memory_limit = step < 40 ? 0 : least + UINT64_C(20000) * (uint64_t)(step - 40);
    options.progress = stop_at_zero;
    options.payload = &left;
    vxm_context *context;
    assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
    vxm_rng rng = {9};
    vxm_soup *soup = random_soup(context, &rng, 2000, 4000, 10, 4), *out;
    vxm_error error = VXM_ERROR_INIT;
    REPAIR_REPORT(report);
    vxm_status status = vxm_repair_run(&out, step % 2 ? &report : NULL, soup, NULL, &error);
    assert_int_equal(status, error.code);
    assert_int_equal(status == VXM_OK, out != NULL);
    made += status == VXM_OK;
    refused += status == VXM_ERROR_MEMORY_LIMIT;
    cancelled += status == VXM_ERROR_CANCELLED;
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
  }
  assert_int_equal(made + refused + cancelled, 120);
  assert_true(made > 5 && refused > 5 && cancelled > 5);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(random_soups),
      cmocka_unit_test(random_tolerances),
      cmocka_unit_test(same_for_any_threads),
      cmocka_unit_test(stops_at_limit_and_when_asked),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

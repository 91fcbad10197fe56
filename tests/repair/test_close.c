/* SPDX-License-Identifier: BSD-3-Clause */
/** Closing of holes. */
#include "../base/rounds.h"
#include "repair_test.h"

#include "../mesh/shared.h"
#include "mesh/components.h"

#include <math.h>

static vxm_repair_options closing(void) {
  vxm_repair_options options = VXM_REPAIR_OPTIONS_INIT;
  options.fill_holes = -1;
  return options;
}

/** Odd edges per component by brute force: all sides, sorted. */
static int compare_words(const void *a, const void *b) {
  uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
  return p < q ? -1 : p > q;
}

static size_t odd_edges(const vxm_soup *soup) {
  uint64_t *sides = malloc((soup->corner_count + 1) * sizeof *sides);
  assert_non_null(sides);
  size_t count = 0, odd = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n);
    for (size_t c = 0; c < n; c++) {
      uint32_t a = corner[c], b = corner[(c + 1) % n];
      if (a != b)
        sides[count++] = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
    }
  }
  qsort(sides, count, sizeof *sides, compare_words);
  for (size_t i = 0, j = 0; i < count; i = j) {
    for (j = i; j < count && sides[j] == sides[i]; j++)
      ;
    odd += (j - i) % 2;
  }
  free(sides);
  return odd;
}

/** No vertex moved, every face of the repair without closing is still there, at most turned. */
static void check_kept(const vxm_soup *open, const vxm_soup *closed, bool turned) {
  assert_true(closed->vertex_count >= open->vertex_count && closed->face_count >= open->face_count);
  assert_memory_equal(open->positions, closed->positions, 3 * open->vertex_count * sizeof *open->positions);
  assert_memory_equal(open->offsets, closed->offsets, (open->face_count + 1) * sizeof *open->offsets);
  if (!turned)
    assert_memory_equal(open->indices, closed->indices, open->corner_count * sizeof *open->indices);
  for (size_t f = 0; f < open->face_count; f++) {
    size_t count;
    const uint32_t *p = vxm_face(open, f, &count), *q = vxm_face(closed, f, &count);
    for (size_t c = 0; c < count; c++)
      assert_true(q[c] == p[c] || q[c] == p[(count - c) % count]);
  }
  for (size_t f = open->face_count; f < closed->face_count; f++)
    assert_int_equal(closed->offsets[f + 1] - closed->offsets[f], 3);
}

/** Whether a second repair finds T-junctions that caps made: vertices of soups on a coarse lattice lie on
 * edges of many a cap. `voxmend repair` reads back what it writes, and tells. */
static bool caps_meet_vertices(const vxm_soup *closed, const vxm_repair_options *options) {
  vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
  vxm_soup_destroy(repaired(closed, options, &report));
  return count_of(&report, "t_junctions") > 0;
}

/** Repairs with closing and checks all that must hold; gives the report. `again` counts those with
 * T-junctions, NULL = there must be none. */
static vxm_repair_report check_closing(const vxm_soup *soup, vxm_soup **result, int *again) {
  vxm_repair_options options = closing();
  static vxm_census before, after; /* of the last report */
  vxm_repair_report report = VXM_REPAIR_REPORT_INIT;
  REPAIR_REPORT(plain);
  report.before = &before;
  report.after = &after;
  vxm_soup *open = repaired(soup, NULL, &plain), *closed = repaired(soup, &options, &report);
  check_kept(open, closed, true);
  assert_int_equal(report.after->faces - plain.after->faces, count_of(&report, "closing"));
  if (report.open_parts == 0) {
    assert_int_equal(odd_edges(closed), 0);
    assert_true(report.after->closed || closed->face_count == 0);
  } else
    assert_true(odd_edges(closed) > 0);
  assert_int_equal(report.after->duplicate_faces + report.after->opposite_duplicate_faces,
                   report.shared_faces);
  if (again && caps_meet_vertices(closed, &options))
    ++*again;
  else
    assert_repair_is_done(closed, &options);
  vxm_soup_destroy(open);
  if (result)
    *result = closed;
  else
    vxm_soup_destroy(closed);
  return report;
}

/** A sphere about a point; some of the faces are left out or turned. */
static vxm_soup *sphere(vxm_context *context, uint32_t rings, double missing, double turned, uint64_t seed) {
  vxm_soup *soup = new_soup(context);
  vxm_rng rng = {seed};
  uint32_t around = 2 * rings;
  add_vertex(soup, 0, 0, 1);
  for (uint32_t j = 1; j < rings; j++)
    for (uint32_t i = 0; i < around; i++) {
      double polar = M_PI * j / rings, azimuth = 2 * M_PI * i / around;
      add_vertex(soup, sin(polar) * cos(azimuth), sin(polar) * sin(azimuth), cos(polar));
    }
  add_vertex(soup, 0, 0, -1);
  uint32_t last = (uint32_t)soup->vertex_count - 1;
  for (uint32_t j = 0; j < rings; j++)
    for (uint32_t i = 0; i < around; i++) {
      uint32_t k = (i + 1) % around, up = 1 + (j - 1) * around, down = 1 + j * around;
      uint32_t quad[2][3] = {{up + i, down + i, down + k}, {up + i, down + k, up + k}};
      if (j == 0)
        quad[0][0] = 0;
      if (j == rings - 1)
        quad[1][1] = last;
      for (int t = 0; t < 2; t++) {
        if ((j == 0 && t == 1) || (j == rings - 1 && t == 0))
          continue;
        bool turn = vxm_rng_unit(&rng) < turned;
        if (vxm_rng_unit(&rng) >= missing)
          add_triangle(soup, quad[t][0], quad[t][turn ? 2 : 1], quad[t][turn ? 1 : 2]);
      }
    }
  return soup;
}

static void spheres_with_holes(void **state) {
  static const double missing[] = {0.001, 0.01, 0.05, 0.1, 0.2};
  static const double tolerance[] = {0.001, 0.003, 0.01, 0.03, 0.1};
  double whole = 4.0 / 3 * M_PI;
  for (size_t i = 0; i < 5; i++)
    for (int turned = 0; turned < 2; turned++) {
      vxm_soup *soup = sphere(*state, 40, missing[i], turned ? 0.3 : 0, i + 1);
      vxm_repair_report report = check_closing(soup, NULL, NULL);
      if (i < 3) {
        assert_true(report.after->closed);
        assert_int_equal(report.after->inconsistent_edges, 0);
      }
      assert_true(fabs(report.after->volume / whole - 1) < tolerance[i] + 0.003);
      /* the caps themselves fit their neighbours */
      vxm_repair_options options = closing();
      options.keep_orientation = true;
      vxm_soup_destroy(repaired(soup, &options, &report));
      if (!turned && i < 3)
        assert_int_equal(report.after->inconsistent_edges, 0);
      vxm_soup_destroy(soup);
    }
}

/** A cube without a side, at each resolution of the others. */
static void cubes_without_a_side(void **state) {
  for (uint32_t n = 1; n <= 40; n = n < 5 ? n + 1 : 2 * n) {
    vxm_soup *soup = new_soup(*state);
    for (int side = 0; side < 5; side++)
      for (uint32_t j = 0; j < n; j++)
        for (uint32_t i = 0; i < n; i++) {
          uint32_t corners[4];
          for (uint32_t c = 0; c < 4; c++) {
            double p[3];
            p[side / 2] = side % 2;
            p[(side / 2 + 1) % 3] = (double)(i + (c == 1 || c == 2)) / n;
            p[(side / 2 + 2) % 3] = (double)(j + (c >= 2)) / n;
            corners[side % 2 ? c : 3 - c] = (uint32_t)soup->vertex_count;
            add_vertex(soup, p[0], p[1], p[2]);
          }
          add_face(soup, corners, 4);
        }
    tag_faces(soup);
    vxm_soup *closed;
    vxm_repair_report report = check_closing(soup, &closed, NULL);
    assert_true(report.after->closed);
    assert_int_equal(report.after->inconsistent_edges, 0);
    assert_true(fabs(report.after->volume - 1) < 1e-12);
    assert_int_equal(count_of(&report, "closing"), n == 1 ? 2 : 4 * n);
    for (size_t f = closed->face_count - 4 * n; n > 1 && f < closed->face_count; f++)
      assert_true(closed->face_tags[f] < soup->face_count);
    vxm_soup_destroy(closed);
    vxm_soup_destroy(soup);
  }
}

static void sheets_stay_open(void **state) {
  vxm_soup *soup = grid_sheet(*state, 9);
  add_cube(soup, 20);
  vxm_repair_report report = check_closing(soup, NULL, NULL);
  assert_int_equal(report.open_parts, 1);
  assert_int_equal(count_of(&report, "closing"), 0);
  /* a cube without a side beside it is closed all the same */
  vxm_soup *more = grid_sheet(*state, 9);
  add_cube(more, 20);
  more->face_count--;
  more->corner_count -= 4;
  report = check_closing(more, NULL, NULL);
  assert_int_equal(report.open_parts, 1);
  assert_int_equal(count_of(&report, "closing"), 2);
  vxm_soup_destroy(more);
  vxm_soup_destroy(soup);
}

/** A side of a cube in one piece, its neighbours cut finer: the slits are closed without any volume. */
static void slits_of_panels(void **state) {
  for (uint32_t n = 2; n < 12; n++) {
    vxm_soup *soup = new_soup(*state);
    for (int side = 0; side < 6; side++) {
      uint32_t m = side == 5 ? 1 : n;
      for (uint32_t j = 0; j < m; j++)
        for (uint32_t i = 0; i < m; i++) {
          uint32_t corners[4];
          for (uint32_t c = 0; c < 4; c++) {
            double p[3];
            p[side / 2] = side % 2;
            p[(side / 2 + 1) % 3] = (double)(i + (c == 1 || c == 2)) / m;
            p[(side / 2 + 2) % 3] = (double)(j + (c >= 2)) / m;
            corners[side % 2 ? c : 3 - c] = (uint32_t)soup->vertex_count;
            add_vertex(soup, p[0], p[1], p[2]);
          }
          add_face(soup, corners, 4);
        }
    }
    vxm_repair_report report = check_closing(soup, NULL, NULL);
    assert_true(report.after->closed);
    assert_true(fabs(report.after->volume - 1) < 1e-9);
    assert_int_equal(report.open_parts, 0);
    vxm_soup_destroy(soup);
  }
}

/** A long crack across a sphere whose rims bulge apart: chords zip it, so that hardly any volume changes. */
static void long_cracks_are_cut(void **state) {
  enum { AROUND = 400, RINGS = 100 };
  vxm_soup *soup = new_soup(*state);
  for (uint32_t half = 0; half < 2; half++) {
    uint32_t first = (uint32_t)soup->vertex_count;
    for (uint32_t j = 0; j <= RINGS; j++)
      for (uint32_t i = 0; i < AROUND; i++) {
        double polar = M_PI / 2 * j / RINGS, azimuth = 2 * M_PI * i / AROUND;
        /* the rims are apart but for one vertex */
        double gap = j == RINGS && i > 0 ? 0.004 : 0, z = (j == RINGS ? 0 : cos(polar)) + gap;
        add_vertex(soup, sin(polar) * cos(azimuth), sin(polar) * sin(azimuth), half ? -z : z);
      }
    for (uint32_t j = 0; j < RINGS; j++)
      for (uint32_t i = 0; i < AROUND; i++) {
        uint32_t k = (i + 1) % AROUND, a = first + j * AROUND, b = a + AROUND;
        uint32_t quad[4] = {a + i, b + i, b + k, a + k};
        if (half)
          quad[1] = a + k, quad[3] = b + i;
        add_face(soup, quad, 4);
      }
  }
  /* the poles */
  for (size_t v = 0; v < soup->vertex_count; v++)
    if (v % ((RINGS + 1) * AROUND) < AROUND)
      for (int a = 0; a < 2; a++)
        soup->positions[3 * v + (size_t)a] = 0;
  vxm_repair_report report = check_closing(soup, NULL, NULL);
  assert_int_equal(report.after->components, 1);
  assert_true(report.after->closed);
  double area = report.after->area - report.before->area;
  print_message("a crack of %d edges: %lld triangles, area %.4f, volume %.5f of the sphere's\n", 2 * AROUND,
                (long long)count_of(&report, "closing"), area, report.after->volume / (4.0 / 3 * M_PI));
  assert_true(area < 0.1); /* a strip of 2 pi times 0.008 */
  assert_true(fabs(report.after->volume / (4.0 / 3 * M_PI) - 1) < 0.01);
  vxm_soup_destroy(soup);
}

static void random_soups(void **state) {
  vxm_rng rng = {4};
  int again = 0;
  for (int round = 0; round < ROUNDS(1500); round++) {
    vxm_soup *soup = random_soup(*state, &rng, 1 + (size_t)vxm_rng_below(&rng, 40),
                                 (size_t)vxm_rng_below(&rng, 60), 2 + (unsigned)vxm_rng_below(&rng, 30), 7);
    check_closing(soup, NULL, &again);
    vxm_soup_destroy(soup);
  }
  assert_true(again <= ROUNDS(1500) / 750);
}

/** Boxes on a coarse lattice that touch, lack faces and have others added: the middle of a rim is often
 * taken, even by a vertex of the rim. */
static void crowded_soups(void **state) {
  static const uint32_t sides[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                        {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  vxm_rng rng = {7};
  for (int round = 0; round < ROUNDS(4000); round++) {
    vxm_soup *soup = new_soup(*state);
    uint64_t boxes = 1 + vxm_rng_below(&rng, 3);
    for (uint32_t b = 0; b < boxes; b++) {
      double low[3], long_side = 1 + (double)vxm_rng_below(&rng, 2);
      for (int a = 0; a < 3; a++)
        low[a] = (double)vxm_rng_below(&rng, 3);
      for (uint32_t v = 0; v < 8; v++)
        add_vertex(soup, low[0] + (v & 1 ? long_side : 0), low[1] + (v >> 1 & 1), low[2] + (v >> 2));
      for (int f = 0; f < 12; f++)
        if (vxm_rng_below(&rng, 8) > 0)
          add_face(soup, (uint32_t[]){8 * b + sides[f][0], 8 * b + sides[f][1], 8 * b + sides[f][2]}, 3);
    }
    for (uint64_t extra = vxm_rng_below(&rng, 6); extra > 0; extra--) {
      uint32_t corner[3];
      for (int c = 0; c < 3; c++)
        corner[c] = (uint32_t)vxm_rng_below(&rng, soup->vertex_count);
      add_face(soup, corner, 3);
    }
    for (uint64_t moves = vxm_rng_below(&rng, 4); moves > 0; moves--)
      soup->positions[vxm_rng_below(&rng, 3 * soup->vertex_count)] += 0.5 * (double)vxm_rng_below(&rng, 3);
    check_closing(soup, NULL, NULL);
    vxm_soup_destroy(soup);
  }
}

static void same_for_any_threads(void **state) {
  (void)state;
  vxm_repair_options options = closing();
  vxm_soup *first = NULL;
  for (int threads = 1; threads <= 5; threads += 2) {
    vxm_context *context = context_of_threads(threads);
    vxm_soup *soup = sphere(context, 60, 0.1, 0.3, 6), *out = repaired(soup, &options, NULL);
    if (first)
      assert_same_soup(first, out);
    else
      assert_int_equal(vxm_soup_copy(&first, out, NULL), VXM_OK);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
  }
  vxm_soup_destroy(first);
}

static void close_real_mesh(const shared_mesh *mesh, void *payload) {
  int *counts = payload;
  vxm_context *context = context_of_threads(2);
  vxm_soup *soup = read_soup(context, mesh->path);
  if (soup->face_count < 15000) {
    vxm_repair_report report = check_closing(soup, NULL, NULL);
    counts[0]++;
    counts[1] += report.after->closed;
    counts[2] += count_of(&report, "closing") > 0;
    counts[3] += report.open_parts > 0;
  }
  vxm_soup_destroy(soup);
  vxm_context_destroy(context);
}

static void real_meshes(void **state) {
  (void)state;
  int counts[4] = {0};
  if (for_each_shared_mesh(close_real_mesh, counts) == 0)
    skip();
  print_message("%d meshes: %d closed in the end, %d by new faces, %d with sheets left\n", counts[0],
                counts[1], counts[2], counts[3]);
  assert_true(counts[1] + counts[3] >= counts[0]);
}

static void memory_may_run_out(void **state) {
  (void)state;
  bool passed = false;
  for (uint64_t limit = 60000; !passed; limit += 1500) {
    vxm_context_options context_options = VXM_CONTEXT_OPTIONS_INIT;
    context_options.threads = 1;
    context_options.memory_limit = limit;
    vxm_context *context;
    assert_int_equal(vxm_context_create(&context, &context_options, NULL), VXM_OK);
    vxm_soup *soup = sphere(context, 8, 0.1, 0.2, 2), *out;
    tag_faces(soup);
    vxm_repair_options options = closing();
    vxm_status status = vxm_repair_run(&out, NULL, soup, &options, NULL);
    passed = status == VXM_OK;
    assert_true(passed || status == VXM_ERROR_MEMORY_LIMIT);
    vxm_soup_destroy(out);
    vxm_soup_destroy(soup);
    vxm_context_destroy(context);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(spheres_with_holes),  cmocka_unit_test(cubes_without_a_side),
      cmocka_unit_test(sheets_stay_open),    cmocka_unit_test(slits_of_panels),
      cmocka_unit_test(long_cracks_are_cut), cmocka_unit_test(random_soups),
      cmocka_unit_test(crowded_soups),       cmocka_unit_test(same_for_any_threads),
      cmocka_unit_test(real_meshes),         cmocka_unit_test(memory_may_run_out),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}

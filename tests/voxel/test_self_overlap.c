/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Tubes along closed curves that cross themselves: their voxels against winding numbers that are summed up
 * from solid angles, whole, with holes, turned over and beside others; and all ways in which a solid is made.
 */
#include "../base/rounds.h"
#include "tubes.h"

#include "grid/bitgrid.h"
#include "voxel/model/model.h"
#include "voxel/winding/probe_lines.h"
#include "voxel/winding/self_overlap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const vxm_space space = {{WIDTH, WIDTH, WIDTH}, {0, 0, 0}, {1, 1, 1}};

/* ---- The oracle ---- */

/** The solid angle under which a point sees a triangle, of which 4 pi are all around (Van Oosterom and
 * Strackee, 1983). */
static double solid_angle(const vxm_soup *soup, const uint32_t *k, const double at[3]) {
  double p[3][3], length[3];
  for (int i = 0; i < 3; i++) {
    for (int a = 0; a < 3; a++)
      p[i][a] = vxm_position(soup, k[i])[a] - at[a];
    length[i] = sqrt(p[i][0] * p[i][0] + p[i][1] * p[i][1] + p[i][2] * p[i][2]);
  }
  double volume = 0, below = length[0] * length[1] * length[2];
  for (int a = 0; a < 3; a++) {
    int b = (a + 1) % 3, c = (a + 2) % 3;
    volume += p[0][a] * (p[1][b] * p[2][c] - p[1][c] * p[2][b]);
    below += p[0][a] * p[1][a] * length[2] + p[1][a] * p[2][a] * length[0] + p[2][a] * p[0][a] * length[1];
  }
  return volume == 0 && below <= 0 ? (double)NAN
                                   : 2 * atan2(volume, below); /* NaN: it lies on the triangle */
}

/** In place of the number of a point on the surface. */
enum { on_surface = 100 };

static int winding_number(const vxm_soup *soup, const double at[3]) {
  double sum = 0;
  for (size_t f = 0; f < soup->face_count; f++)
    sum += solid_angle(soup, soup->indices + soup->offsets[f], at);
  return isnan(sum) ? on_surface : (int)lround(sum / 12.566370614359172);
}

/** The winding number of every voxel; of a mesh that may have been turned inside out, by `sign`. */
static signed char *winding_numbers(const vxm_soup *soup, int sign) {
  signed char *number = malloc(WIDTH * WIDTH * WIDTH), *out = number;
  for (int x = 0; x < WIDTH; x++)
    for (int y = 0; y < WIDTH; y++)
      for (int z = 0; z < WIDTH; z++) {
        int w = winding_number(soup, (double[]){x + 0.5, y + 0.5, z + 0.5});
        *out++ = (signed char)(w == on_surface ? w : sign * w);
      }
  return number;
}

static bool is_set(const vxm_grid *grid, size_t i) {
  return vxm_grid_get(grid, (int64_t)(i / WIDTH / WIDTH), (int64_t)(i / WIDTH % WIDTH), (int64_t)(i % WIDTH));
}

/* ---- What is made ---- */

static const vxm_voxelize_options defaults = VXM_VOXELIZE_OPTIONS_INIT;

static vxm_grid *voxelize(const vxm_soup *soup, vxm_voxelize_options options, vxm_voxelize_report *report) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_space_options where = VXM_SPACE_OPTIONS_INIT;
  where.like = &space;
  vxm_grid *grid;
  if (vxm_voxelize(&grid, report, soup, &where, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return grid;
}

static vxm_grid *voxelize_centres(const vxm_soup *soup, vxm_voxelize_report *report) {
  vxm_voxelize_options options = defaults;
  options.thin = VXM_THIN_DROP;
  return voxelize(soup, options, report);
}

/** All voxels are inside that are wound around; some of them twice, as told. */
static void check(const vxm_soup *soup, int sign, int64_t parts) {
  signed char *number = winding_numbers(soup, sign);
  vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
  vxm_grid *grid = voxelize_centres(soup, &report);
  int twice = 0;
  for (size_t i = 0; i < WIDTH * WIDTH * WIDTH; i++) {
    if (number[i] != on_surface && is_set(grid, i) != (number[i] != 0))
      fail_msg("voxel %zu is wound around %d times, and %s", i, number[i],
               is_set(grid, i) ? "set" : "not set");
    twice += number[i] == 2;
  }
  assert_int_equal(report.self_overlapping_parts, parts);
  assert_int_equal(report.hollow_overlaps, 0);
  assert_true(parts == 0 || twice > 10);
  vxm_grid_destroy(grid);
  free(number);
}

static vxm_soup *random_tube(vxm_rng *rng) {
  vxm_soup *soup = shape_empty(context);
  turning turned = random_turning(rng);
  add_tube(soup, &turned, 0.4 * vxm_rng_unit(rng), 1.6 + 0.8 * vxm_rng_unit(rng));
  return soup;
}

static void test_wound_twice_is_inside(void **state) {
  (void)state;
  vxm_rng rng = {11};
  for (int round = 0; round < ROUNDS(12); round++) {
    vxm_soup *soup = random_tube(&rng);
    check(soup, 1, 1);
    for (size_t f = 0; f < soup->face_count; f++)
      reverse_face(soup, f);
    check(soup, -1, 1);
    vxm_soup_destroy(soup);
  }
}

static void test_beside_others(void **state) {
  (void)state;
  vxm_rng rng = {12};
  for (int round = 0; round < ROUNDS(6); round++) {
    vxm_soup *soup = random_tube(&rng);
    turning turned = random_turning(&rng);
    add_tube(soup, &turned, 0.3, 1.8);
    check(soup, 1, 2);
    turned = random_turning(&rng);
    add_tube(soup, &turned, 6, 1.2); /* which does not cross itself */
    check(soup, 1, 2);
    vxm_soup_destroy(soup);
  }
}

/** A hole is capped; its cap, which is flat, is part of what is wound around. */
static void test_with_holes(void **state) {
  (void)state;
  vxm_rng rng = {13};
  for (int round = 0; round < ROUNDS(12); round++) {
    vxm_soup *soup = random_tube(&rng);
    signed char *number = winding_numbers(soup, 1);
    size_t ring = RINGS / 4; /* far from where the branches cross */
    for (size_t f = ring * 2 * SIDES; f < ring * 2 * SIDES + 2; f++) {
      uint32_t *corner = soup->indices + soup->offsets[f];
      corner[1] = corner[2] = corner[0];
    }
    vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
    vxm_grid *grid = voxelize_centres(soup, &report);
    assert_int_equal(report.capped_parts, 1);
    assert_int_equal(report.self_overlapping_parts, 1);
    int wrong = 0;
    for (size_t i = 0; i < WIDTH * WIDTH * WIDTH; i++) {
      wrong += number[i] != on_surface && is_set(grid, i) != (number[i] != 0);
      assert_true(number[i] != 2 || is_set(grid, i));
    }
    assert_true(wrong <= 2);
    vxm_grid_destroy(grid);
    free(number);
    vxm_soup_destroy(soup);
  }
}

/** A loop that curls twice, as a band `low` to `high`, in the plane of two axes, extruded along the third:
 * small beside all of the part, of which a long arm tells the box. */
static void add_curl(vxm_soup *soup, int axis, double low, double high) {
  static const double loop[][2] = {{1, 1},     {18.5, 1},  {18.5, 2},  {2.2, 2},
                                   {2.2, 1.4}, {4.7, 1.4}, {4.7, 2.7}, {1, 2.7}};
  enum { CORNERS = sizeof loop / sizeof *loop };
  uint32_t v[2][CORNERS];
  for (int side = 0; side < 2; side++)
    for (int i = 0; i < CORNERS; i++) {
      double p[3];
      p[axis] = side ? high : low;
      p[(axis + 1) % 3] = loop[i][0];
      p[(axis + 2) % 3] = loop[i][1];
      v[side][i] = shape_vertex(soup, p[0], p[1], p[2]);
    }
  for (int i = 0; i < CORNERS; i++) {
    int next = (i + 1) % CORNERS;
    shape_triangle(soup, v[0][i], v[0][next], v[1][next]);
    shape_triangle(soup, v[0][i], v[1][next], v[1][i]);
  }
  for (int i = 1; i + 1 < CORNERS; i++) { /* fans, which the winding number counts with their signs */
    shape_triangle(soup, v[0][0], v[0][i + 1], v[0][i]);
    shape_triangle(soup, v[1][0], v[1][i], v[1][i + 1]);
  }
}

/** What lies at the rim of a part is found, whichever way the part lies, and what is wound backward is not
 * told to be filled. */
static void test_at_the_rim(void **state) {
  (void)state;
  for (int axis = 0; axis < 3; axis++)
    for (int turned = 0; turned < 2; turned++) {
      vxm_soup *soup = shape_empty(context);
      add_curl(soup, axis, 1.25, 18.75);
      for (size_t f = 0; turned && f < soup->face_count; f++)
        reverse_face(soup, f);
      signed char *number = winding_numbers(soup, turned ? -1 : 1);
      vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
      vxm_grid *grid = voxelize_centres(soup, &report);
      int twice = 0;
      for (size_t i = 0; i < WIDTH * WIDTH * WIDTH; i++) {
        twice += number[i] == 2;
        if (number[i] != on_surface && number[i] >= -1 && is_set(grid, i) != (number[i] != 0))
          fail_msg("axis %d: voxel %zu is wound around %d times, and %s", axis, i, number[i],
                   is_set(grid, i) ? "set" : "not set");
      }
      assert_true(twice > 0);
      assert_int_equal(report.self_overlapping_parts, 1);
      vxm_grid_destroy(grid);
      free(number);
      vxm_soup_destroy(soup);
    }
}

/** What does not run through itself, or cannot be told of, is left alone: as parity has it. */
static void test_others_are_left(void **state) {
  (void)state;
  vxm_rng rng = {14};
  for (int round = 0; round < ROUNDS(20); round++) {
    vxm_soup *soup = shape_empty(context);
    turning turned = random_turning(&rng);
    bool crossing = round % 2;
    if (crossing) {
      add_tube(soup, &turned, 0.2, 2);
      for (size_t f = 0; f < soup->face_count; f++) /* wound against one another */
        if (vxm_rng_unit(&rng) < 0.3)
          reverse_face(soup, f);
    } else {
      add_tube(soup, &turned, 6 + vxm_rng_unit(&rng), 1.2);
    }
    shape_torus(soup, 12, 8, 3 + vxm_rng_unit(&rng), 1, (double[]){9.3, 9.7, 10.1});
    shape_box(soup, (double[]){2, 3, 4}, (double[]){11, 12, 13});
    vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT;
    vxm_voxelize_options by_parity = defaults;
    by_parity.method = VXM_METHOD_X;
    vxm_grid *grid = voxelize_centres(soup, &report), *expected = voxelize(soup, by_parity, NULL);
    assert_int_equal(report.self_overlapping_parts, 0);
    assert_memory_equal(grid->words, expected->words, grid->word_count * sizeof *grid->words);
    vxm_grid_destroy(expected);
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
  }
}

/** Turns all faces of a ring of the tube over. */
static void turn_ring(vxm_soup *soup, size_t ring) {
  for (size_t f = ring * 2 * SIDES; f < (ring + 1) * 2 * SIDES; f++)
    reverse_face(soup, f);
}

/** How much of what a tube encloses it winds around twice. */
static double share_wound_twice(const vxm_soup *soup) {
  signed char *number = winding_numbers(soup, 1);
  int twice = 0, all = 0;
  for (size_t i = 0; i < WIDTH * WIDTH * WIDTH; i++) {
    twice += number[i] == 2;
    all += number[i] == 1 || number[i] == 2;
  }
  free(number);
  return (double)twice / all;
}

/** The share in percent that a warning tells of, or 0 if none does. */
static double share_told(const vxm_grid *grid) {
  for (int64_t w = 0; w < vxm_grid_warning_count(grid); w++) {
    const char *found = strstr(vxm_grid_warning(grid, w), " hollow there: ");
    if (found)
      return strtod(found + strlen(" hollow there: "), NULL);
  }
  return 0;
}

/** A tube with a ring of faces that are wound against the others stays as parity has it, and that is told. */
static void test_what_stays_hollow_is_told(void **state) {
  (void)state;
  vxm_rng rng = {17};
  for (int round = 0; round < ROUNDS(12); round++) {
    vxm_soup *soup = shape_empty(context);
    turning turned = random_turning(&rng);
    bool crossing = round % 3 != 0;
    add_tube(soup, &turned, crossing ? 0.3 * vxm_rng_unit(&rng) : 6, crossing ? 2 : 1.2);
    double share = share_wound_twice(soup);
    turn_ring(soup, RINGS / 4); /* far from where the branches cross */
    for (size_t f = 0; round % 2 && f < soup->face_count; f++)
      reverse_face(soup, f);
    vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT, other = VXM_VOXELIZE_REPORT_INIT;
    vxm_voxelize_options by_parity = defaults;
    by_parity.method = VXM_METHOD_X;
    vxm_grid *grid = voxelize_centres(soup, &report), *expected = voxelize(soup, by_parity, &other);
    assert_int_equal(report.self_overlapping_parts, 0);
    assert_int_equal(report.hollow_overlaps, crossing);
    assert_int_equal(other.hollow_overlaps, 0);
    assert_memory_equal(grid->words, expected->words, grid->word_count * sizeof *grid->words);
    if (fabs(share_told(grid) - 100 * share) > 4)
      fail_msg("%.3g %% is wound twice, and %.3g %% told", 100 * share, share_told(grid));
    assert_true(share_told(expected) == 0);
    vxm_grid_destroy(expected);
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
  }
}

/* ---- The same however it is made ---- */

static vxm_model *model_of(const vxm_soup *soup, vxm_voxelize_options options) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_model *model;
  if (vxm_model_create(&model, soup, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return model;
}

static void check_windows(vxm_model *model, const vxm_grid *whole, vxm_layout layout, vxm_rng *rng) {
  vxm_model_pass *pass;
  assert_int_equal(vxm_model_begin(&pass, model, &space, NULL, NULL, NULL), VXM_OK);
  uint64_t words[WIDTH * WIDTH];
  for (int64_t begin = 0, end; begin < WIDTH; begin = end) {
    end = vxm_min(begin + 1 + (int64_t)vxm_rng_below(rng, 8), WIDTH);
    vxm_window window = vxm_window_of(&space, layout, begin, end);
    assert_true(window.slice_words <= WIDTH);
    window.words = words;
    assert_int_equal(vxm_model_pass_fill(pass, &window, NULL), VXM_OK);
    int64_t p[3];
    for (p[layout.slow] = begin; p[layout.slow] < end; p[layout.slow]++)
      for (p[layout.middle] = 0; p[layout.middle] < WIDTH; p[layout.middle]++)
        for (p[layout.fast] = 0; p[layout.fast] < WIDTH; p[layout.fast]++) {
          const uint64_t *row = vxm_window_row(&window, p[layout.middle], p[layout.slow]);
          assert_int_equal(row[0] >> p[layout.fast] & 1, vxm_grid_get(whole, p[0], p[1], p[2]));
        }
  }
  vxm_model_close(model, pass);
}

static void check_octree(vxm_model *model, const vxm_grid *whole) {
  vxm_sparse *octree;
  vxm_grid *back;
  assert_int_equal(vxm_model_sparse(&octree, NULL, model, &space, NULL, NULL), VXM_OK);
  assert_int_equal(vxm_sparse_to_grid(&back, octree, NULL), VXM_OK);
  assert_memory_equal(back->words, whole->words, whole->word_count * sizeof *whole->words);
  vxm_grid_destroy(back);
  vxm_sparse_destroy(octree);
}

static void check_mirrored(vxm_model *model, const vxm_grid *whole) {
  static const double mirror[12] = {-1, 0, 0, WIDTH, 0, 1, 0, 0, 0, 0, 1, 0};
  vxm_grid *grid;
  assert_int_equal(vxm_grid_create(&grid, context, &space, NULL), VXM_OK);
  assert_int_equal(vxm_model_voxelize(grid, NULL, model, mirror, NULL), VXM_OK);
  for (int64_t x = 0; x < WIDTH; x++)
    for (int64_t y = 0; y < WIDTH; y++)
      for (int64_t z = 0; z < WIDTH; z++)
        assert_int_equal(vxm_grid_get(grid, WIDTH - 1 - x, y, z), vxm_grid_get(whole, x, y, z));
  vxm_grid_destroy(grid);
}

/** A voxel is full or empty where all of its sub-voxels are, which are the voxels of a grid twice as fine. */
static void check_coverage(vxm_model *model) {
  vxm_space fine = {{2 * WIDTH, 2 * WIDTH, 2 * WIDTH}, {0, 0, 0}, {0.5, 0.5, 0.5}};
  vxm_coverage_options options = VXM_COVERAGE_OPTIONS_INIT;
  options.subdivision = 2;
  float *share = malloc(WIDTH * WIDTH * WIDTH * sizeof *share), *at = share;
  vxm_grid *grid;
  assert_int_equal(vxm_model_coverage(share, NULL, model, &space, &options, NULL), VXM_OK);
  assert_int_equal(vxm_grid_create(&grid, context, &fine, NULL), VXM_OK);
  assert_int_equal(vxm_model_voxelize(grid, NULL, model, NULL, NULL), VXM_OK);
  for (int64_t x = 0; x < WIDTH; x++)
    for (int64_t y = 0; y < WIDTH; y++)
      for (int64_t z = 0; z < WIDTH; z++) {
        int set = 0;
        for (int i = 0; i < 8; i++)
          set += vxm_grid_get(grid, 2 * x + (i & 1), 2 * y + (i >> 1 & 1), 2 * z + (i >> 2));
        assert_true(*at++ == (float)set / 8);
      }
  vxm_grid_destroy(grid);
  free(share);
}

static void test_ways(void **state) {
  (void)state;
  static const vxm_layout layouts[3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}};
  vxm_rng rng = {15};
  for (int round = 0; round < ROUNDS(8); round++) {
    vxm_soup *soup = random_tube(&rng);
    if (round % 2)
      shape_torus(soup, 12, 8, 6, 1.5, (double[]){9.3, 9.7, 10.1});
    for (int thin = 0; thin < 2; thin++) {
      vxm_voxelize_options options = defaults;
      options.thin = thin ? VXM_THIN_KEEP : VXM_THIN_DROP;
      vxm_model *model = model_of(soup, options);
      vxm_grid *whole = voxelize(soup, options, NULL);
      for (int l = 0; l < 3; l++)
        check_windows(model, whole, layouts[l], &rng);
      check_octree(model, whole);
      if (!thin) {
        check_mirrored(model, whole);
        check_coverage(model);
      }
      vxm_grid_destroy(whole);
      vxm_model_destroy(model);
    }
    vxm_soup_destroy(soup);
  }
}

/** Where all agree, all is certain: also where the surface is entered twice. */
static void test_confidence(void **state) {
  (void)state;
  vxm_rng rng = {16};
  vxm_soup *soup = random_tube(&rng);
  vxm_voxelize_options options = defaults;
  options.thin = VXM_THIN_DROP;
  options.confidence = true;
  for (int capped = 0; capped < 2; capped++) {
    if (capped) { /* a second one, which voters are asked about */
      turning turned = random_turning(&rng);
      add_tube(soup, &turned, 9, 0.6);
      uint32_t *corner = soup->indices + soup->offsets[soup->face_count - 1];
      corner[1] = corner[2] = corner[0];
    }
    signed char *number = winding_numbers(soup, 1);
    vxm_grid *grid = voxelize(soup, options, NULL);
    const uint8_t *confidence = vxm_grid_confidence(grid);
    for (size_t i = 0; i < WIDTH * WIDTH * WIDTH; i++)
      if (number[i] > 1)
        assert_true(
            confidence[i / WIDTH / WIDTH + WIDTH * (i / WIDTH % WIDTH) + WIDTH * WIDTH * (i % WIDTH)] == 255);
    vxm_grid_destroy(grid);
    free(number);
  }
  vxm_soup_destroy(soup);
}

/** Extents and coordinates of which no lines can be laid, and many large triangles over one another. */
static void test_extremes(void **state) {
  (void)state;
  static const double sizes[] = {1e-320, 1e-150, 1e150, 1e300, 1.7e308};
  for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
    vxm_soup *soup = shape_empty(context);
    double a = sizes[s];
    shape_box(soup, (double[]){-a, -a, -a}, (double[]){a, a, a});
    shape_box(soup, (double[]){0, 0, 0}, (double[]){1, 1, 0});
    for (int layer = 0; layer < 2000; layer++) {
      uint32_t v[3] = {shape_vertex(soup, 0, 0, 0), shape_vertex(soup, 1, 9, layer),
                       shape_vertex(soup, 2, layer, 9)};
      shape_triangle(soup, v[0], v[1], v[2]);
      shape_triangle(soup, v[2], v[1], v[0]);
    }
    vxm_triangle_set triangles;
    vxm_self_overlap overlap;
    vxm_split_rule rule = {VXM_SPLIT_MODE_WHOLE, VXM_CAVITIES_AUTO, true};
    assert_int_equal(vxm_triangle_set_create(&triangles, soup, rule, NULL), VXM_OK);
    assert_int_equal(vxm_self_overlap_find(&overlap, &triangles, NULL), VXM_OK);
    vxm_self_overlap_destroy(&overlap);
    vxm_triangle_set_destroy(&triangles);
    vxm_soup_destroy(soup);
  }
}

/* ---- Where lines lie ---- */

enum { POINTS = 5000 };

/** Points that crowd in places, differently along each axis. */
static void random_points(vxm_rng *rng, double (*points)[3], size_t count) {
  for (size_t i = 0; i < count; i++)
    for (int a = 0; a < 3; a++)
      points[i][a] = 10 * pow(vxm_rng_unit(rng), a + 1) - 3;
}

/** Lines hang on where points are: not on how these are numbered, and a mirrored part has them mirrored. */
static void test_lines_lie_by_geometry_alone(void **state) {
  (void)state;
  vxm_rng rng = {21};
  static double points[POINTS][3], others[POINTS][3];
  static vxm_probe_cell cells[POINTS], other_cells[POINTS];
  static vxm_probe_places places[3], other_places[3];
  for (int round = 0; round < ROUNDS(20); round++) {
    size_t count = round % 2 ? POINTS : 40;
    int even = 2 + 2 * (round % 6), mirrored = round % 4, along,
        other_along; /* mirrored: an axis, or 3: none */
    random_points(&rng, points, count);
    for (size_t i = 0; i < count; i++) /* the other way round */
      for (int a = 0; a < 3; a++)
        others[count - 1 - i][a] = a == mirrored ? -points[i][a] : points[i][a];
    assert_true(vxm_probe_lines_lay(&along, places, cells, (const double(*)[3])points, count, even));
    assert_true(vxm_probe_lines_lay(&other_along, other_places, other_cells, (const double(*)[3])others,
                                    count, even));
    assert_int_equal(along, other_along);
    assert_int_equal(places[along].count, 0);
    for (int a = 0; a < 3; a++) {
      int last = places[a].count - 1;
      if (a == along)
        continue;
      assert_in_range(places[a].count, even, 2 * even);
      assert_int_equal(places[a].count, other_places[a].count);
      for (int i = 0; i <= last; i++) {
        double expected = a == mirrored ? -places[a].at[last - i] : places[a].at[i];
        assert_true(fabs(other_places[a].at[i] - expected) < 1e-9);
      }
      for (size_t i = 0; i < count; i++) {
        int below = 0;
        while (below <= last && places[a].at[below] < points[i][a])
          below++;
        assert_int_equal(vxm_probe_along(cells[i], a), below);
      }
    }
  }
}

/** The same parts are found, and the same voxels set, however faces are numbered. */
static void test_numbers_decide_nothing(void **state) {
  (void)state;
  vxm_rng rng = {22};
  for (int round = 0; round < ROUNDS(6); round++) {
    vxm_soup *soup = random_tube(&rng);
    vxm_voxelize_report report = VXM_VOXELIZE_REPORT_INIT, other = VXM_VOXELIZE_REPORT_INIT;
    vxm_grid *grid = voxelize_centres(soup, &report);
    for (size_t f = soup->face_count - 1; f > 0; f--) { /* triangles all */
      uint32_t kept[3], *p = soup->indices + 3 * f, *q = soup->indices + 3 * vxm_rng_below(&rng, f + 1);
      memcpy(kept, p, sizeof kept);
      memmove(p, q, sizeof kept);
      memcpy(q, kept, sizeof kept);
    }
    vxm_grid *shuffled = voxelize_centres(soup, &other);
    assert_int_equal(report.self_overlapping_parts, other.self_overlapping_parts);
    assert_memory_equal(grid->words, shuffled->words, grid->word_count * sizeof *grid->words);
    vxm_grid_destroy(shuffled);
    vxm_grid_destroy(grid);
    vxm_soup_destroy(soup);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_lines_lie_by_geometry_alone),
      cmocka_unit_test(test_numbers_decide_nothing),
      cmocka_unit_test(test_wound_twice_is_inside),
      cmocka_unit_test(test_beside_others),
      cmocka_unit_test(test_with_holes),
      cmocka_unit_test(test_at_the_rim),
      cmocka_unit_test(test_others_are_left),
      cmocka_unit_test(test_what_stays_hollow_is_told),
      cmocka_unit_test(test_ways),
      cmocka_unit_test(test_confidence),
      cmocka_unit_test(test_extremes),
  };
  return cmocka_run_group_tests(tests, setup, teardown);
}

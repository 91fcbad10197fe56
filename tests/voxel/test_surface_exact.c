/* SPDX-License-Identifier: BSD-3-Clause */
/* The surface, conservative and thin, against brute force in exact integers, however the work is divided. */
#include "../base/rounds.h"
#include "surface_oracle.h"
#include "surfaces.h"

#include "voxel/surface/surface_tiles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int thread_counts[3] = {1, 2, 7};
static vxm_context *contexts[3];
static const vxm_surface_build *builds[3];
static size_t build_count;

static int setup_all(void **state) {
  for (int i = 0; i < 3; i++) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = thread_counts[i];
    if (vxm_context_create(&contexts[i], &options, NULL) != VXM_OK)
      return 1;
  }
  build_count = vxm_surface_builds(builds);
  return setup(state);
}

static int teardown_all(void **state) {
  vxm_surface_force(NULL);
  for (int i = 0; i < 3; i++)
    vxm_context_destroy(contexts[i]);
  return teardown(state);
}

enum { MOST = 48 };

/** Triangles whose corners are given in lattice steps, on a lattice of any fineness. */
typedef struct scene {
  vxm_surface surface;
  vxm_point points[3 * MOST];
  int32_t narrow[3 * MOST][4];
  uint32_t corners[3 * MOST];
} scene;

static void scene_start(scene *s, const vxm_space *space, int bits) {
  *s = (scene){.surface = {.lattice = {bits, INT64_C(1) << bits, *space}}};
  s->surface.corners = s->corners;
  for (uint32_t c = 0; c < 3 * MOST; c++)
    s->corners[c] = c;
}

/** As vxm_surface_place: in 32 bits where all points fit. */
static void scene_end(scene *s) {
  s->surface.narrow = s->narrow;
  for (size_t p = 0; p < 3 * s->surface.triangle_count; p++)
    for (int a = 0; a < 3; a++) {
      s->narrow[p][a] = (int32_t)s->points[p].at[a];
      if (s->points[p].at[a] >= VXM_NARROW_MAX || s->points[p].at[a] <= -VXM_NARROW_MAX)
        s->surface.wide = s->points;
    }
}

static void window_fill(vxm_window *window, uint64_t value) {
  for (size_t i = 0; i < (size_t)(window->end - window->begin) * window->slice_words; i++)
    window->words[i] = value;
}

/* ---- Random triangles ---- */

/** Often on a border or a centre of voxels, or one step beside. */
static int64_t random_coordinate(vxm_rng *rng, int64_t unit, int64_t dim) {
  int64_t at = (int64_t)vxm_rng_below(rng, (uint64_t)((dim + 4) * unit)) - 2 * unit;
  switch (vxm_rng_below(rng, 6)) {
  case 0:
    return at & -unit;
  case 1:
    return (at & -unit) + unit / 2;
  case 2:
    return (at & -(unit / 4)) + (int64_t)vxm_rng_below(rng, 3) - 1;
  default:
    return at;
  }
}

enum {
  FLAT = 1,
  SLIVER = 4,
  SEGMENT,
  POINT,
  FAR,
  HUGE_ONE,
  SMALL,
  STRAIGHT,
  WIDE,
  TOUCHING,
  FEW,
  LIMIT,
  KINDS
};

/** @param largest differences of corners up to which boxes of four voxels and of two are tested in 32 bits */
static void random_triangle(vxm_rng *rng, const vxm_lattice *lattice, int kind, const int64_t largest[2],
                            vxm_point corner[3]) {
  const int64_t *dims = lattice->space.dims, unit = lattice->unit, most = VXM_LATTICE_MAX - 1;
  for (int c = 0; c < 3; c++)
    for (int a = 0; a < 3; a++)
      corner[c].at[a] = random_coordinate(rng, unit, dims[a]);
  int64_t factor = INT64_C(1) << vxm_rng_below(rng, 20);
  for (int a = 0; a < 3; a++) {
    int64_t *p = &corner[0].at[a], *q = &corner[1].at[a], *r = &corner[2].at[a];
    if (kind >= FLAT && kind < FLAT + 3 && a == kind - FLAT)
      *q = *r = *p;
    else if (kind == SLIVER)
      *r = *q + (int64_t)vxm_rng_below(rng, 5) - 2;
    else if (kind == SEGMENT) /* the third corner on the other two's line, between or beyond */
      *r = vxm_rng_below(rng, 2) ? 2 * *q - *p : *p;
    else if (kind == POINT)
      *q = *r = *p;
    else if (kind == FAR) { /* its plane passes through the grid, but not always the triangle */
      *q = *p + (*q - *p) * factor;
      *r = *p + (*r - *p) * factor;
    } else if (kind == HUGE_ONE) { /* around a point near the grid */
      int64_t d = (*q - *p) * factor, e = (*r - *p) * factor;
      *q = *p + d, *r = *p + e, *p = *p - d - e;
    } else if (kind == SMALL) {
      *q = *p + (int64_t)vxm_rng_below(rng, (uint64_t)unit) - unit / 2;
      *r = *p + (int64_t)vxm_rng_below(rng, (uint64_t)unit) - unit / 2;
    }
  }
  if (kind == WIDE) { /* long along two axes, with a border or a centre of the grid in the middle of a side */
    int64_t far = INT64_C(1) << vxm_rng_below(rng, 22);
    int kept = (int)vxm_rng_below(rng, 3);
    for (int a = 0; a < 3; a++) {
      int64_t reach = a == kept ? 1 : far,
              middle = 1 + (int64_t)vxm_rng_below(rng, (uint64_t)(2 * dims[a] - 1));
      int64_t away = (int64_t)vxm_rng_below(rng, (uint64_t)(2 * reach + 1)) - reach;
      int64_t third = (int64_t)vxm_rng_below(rng, (uint64_t)(a == kept ? 2 * dims[a] + 1 : 4 * far));
      corner[0].at[a] = (middle - away) * (unit / 2);
      corner[1].at[a] = (middle + away) * (unit / 2);
      corner[2].at[a] = (third - (a == kept ? 0 : 2 * far)) * (unit / 2);
    }
  }
  if (kind == TOUCHING) { /* around a corner of a voxel, which lies in its plane */
    int64_t reach = INT64_C(1) << (13 + vxm_rng_below(rng, 5));
    for (int a = 0; a < 3; a++) {
      int64_t p = (int64_t)vxm_rng_below(rng, (uint64_t)dims[a]) * unit;
      int64_t d = (int64_t)vxm_rng_below(rng, (uint64_t)(2 * reach)) - reach;
      int64_t e = (int64_t)vxm_rng_below(rng, (uint64_t)(2 * reach)) - reach;
      corner[0].at[a] = p + d;
      corner[1].at[a] = p + e;
      corner[2].at[a] = p - d - e;
    }
  }
  if (kind == FEW) { /* boxes of few voxels */
    int64_t reach = (1 + (int64_t)vxm_rng_below(rng, 4)) * unit / 2;
    for (int c = 1; c < 3; c++)
      for (int a = 0; a < 3; a++)
        corner[c].at[a] = corner[0].at[a] + (int64_t)vxm_rng_below(rng, (uint64_t)(2 * reach)) - reach;
  }
  if (kind == LIMIT) { /* numbers as large as differences of that size make them */
    vxm_point middle = corner[0];
    int64_t size = largest[vxm_rng_below(rng, 2)] + 2;
    for (int c = 0; c < 3; c++) {
      int64_t by = size - (int64_t)vxm_rng_below(rng, 4);
      corner[c] = middle;
      corner[c].at[c] += vxm_rng_below(rng, 2) ? by : -by;
    }
  }
  if (kind == STRAIGHT) { /* two of its sides along axes */
    int a = (int)vxm_rng_below(rng, 3), b = (a + 1) % 3;
    int64_t q = corner[1].at[a], r = corner[2].at[b];
    corner[1] = corner[2] = corner[0];
    corner[1].at[a] = q;
    corner[2].at[b] = r;
  }
  for (int c = 0; c < 3; c++)
    for (int a = 0; a < 3; a++)
      corner[c].at[a] = vxm_min(vxm_max(corner[c].at[a], -most), most);
}

static void check_voxels(const scene *s, const vxm_window *cover, const vxm_window *thin, int kind) {
  const vxm_lattice *lattice = &s->surface.lattice;
  const int64_t *dims = lattice->space.dims;
  int64_t v[3];
  for (v[2] = 0; v[2] < dims[2]; v[2]++)
    for (v[1] = 0; v[1] < dims[1]; v[1]++)
      for (v[0] = 0; v[0] < dims[0]; v[0]++) {
        bool has_voxels = false, on_thin = false;
        for (size_t t = 0; t < s->surface.triangle_count; t++) {
          has_voxels |= oracle_touches(s->points + 3 * t, v, lattice->unit);
          on_thin |= oracle_thin(s->points + 3 * t, v, lattice->unit);
        }
        bool cover_bit = window_get(cover, v), thin_bit = window_get(thin, v);
        if (cover_bit == has_voxels && thin_bit == on_thin && cover_bit >= thin_bit)
          continue;
        const vxm_point *p = s->points;
        fail_msg(
            "kind %d bits %d voxel %d %d %d: %d %d, should be %d %d; first triangle (%lld %lld %lld) (%lld "
            "%lld %lld) (%lld %lld %lld)",
            kind, lattice->bits, (int)v[0], (int)v[1], (int)v[2], cover_bit, thin_bit, has_voxels, on_thin,
            (long long)p[0].at[0], (long long)p[0].at[1], (long long)p[0].at[2], (long long)p[1].at[0],
            (long long)p[1].at[1], (long long)p[1].at[2], (long long)p[2].at[0], (long long)p[2].at[1],
            (long long)p[2].at[2]);
      }
}

/** In tiles, or as the size of the window says. */
static void draw_some_way(vxm_rng *rng, const vxm_surface *surface, const vxm_window *window,
                          vxm_surface_kind kind, bool is_fresh) {
  vxm_surface_pen pen = vxm_surface_pen_of(surface, window, kind);
  vxm_error error = VXM_ERROR_INIT;
  if (vxm_rng_below(rng, 2) || window->begin == window->end)
    draw(surface, window, kind, is_fresh);
  else if (vxm_surface_add_tiled(&pen, is_fresh, &error) != VXM_OK)
    fail_msg("%s", error.text);
}

/** @param only -1 = all in turn */
static void check_random(vxm_rng *rng, const vxm_space *space, int rounds, int only) {
  for (int round = 0; round < ROUNDS(rounds); round++) {
    scene s;
    int kind = only < 0 ? round % KINDS : only;
    vxm_surface_force(builds[vxm_rng_below(rng, build_count)]);
    scene_start(&s, space, 8 + (int)vxm_rng_below(rng, 9));
    s.surface.context = contexts[vxm_rng_below(rng, 3)];
    /* Few, or so many that lanes are filled, and some are left over. */
    s.surface.triangle_count = 1 + (size_t)vxm_rng_below(rng, vxm_rng_below(rng, 4) == 0 ? MOST : 2);
    vxm_layout layout = layouts[vxm_rng_below(rng, 6)];
    vxm_window cover = window_make(space, layout, 0, space->dims[layout.slow]);
    vxm_window thin = window_make(space, layout, 0, space->dims[layout.slow]);
    vxm_surface_pen pen = vxm_surface_pen_of(&s.surface, &thin, VXM_SURFACE_THIN);
    for (size_t t = 0; t < s.surface.triangle_count; t++)
      random_triangle(rng, &s.surface.lattice, t < 2 || t % 2 ? kind : SMALL,
                      (int64_t[]){pen.four_max, pen.two_max}, s.points + 3 * t);
    scene_end(&s);
    window_fill(&cover, ~UINT64_C(0)); /* fresh: whatever was there does not count */
    window_fill(&thin, 0);
    draw_some_way(rng, &s.surface, &cover, VXM_SURFACE_CONSERVATIVE, true);
    draw_some_way(rng, &s.surface, &thin, VXM_SURFACE_THIN, false);
    check_voxels(&s, &cover, &thin, kind);
    free(cover.words);
    free(thin.words);
  }
}

static void test_triangles_match_brute_force(void **state) {
  (void)state;
  vxm_rng rng = {1};
  vxm_space cube = unit_space(7, 6, 5), beam = unit_space(130, 3, 4), sheet = unit_space(20, 19, 2);
  check_random(&rng, &cube, 6000, -1);
  check_random(&rng, &cube, 3000, TOUCHING);
  check_random(&rng, &cube, 3000, FEW);
  check_random(&rng, &cube, 3000, LIMIT);
  check_random(&rng, &beam, 600, -1);
  check_random(&rng, &sheet, 1200, -1);
}

/* ---- Meshes in windows ---- */

static vxm_soup *random_mesh(vxm_rng *rng, const vxm_space *space) {
  vxm_soup *soup = shape_empty(context);
  const int64_t *d = space->dims;
  shape_torus(soup, 20, 12, 0.35 * (double)d[1], 0.13 * (double)d[1],
              (double[]){0.5 * (double)d[0], 0.5 * (double)d[1], 0.5 * (double)d[2]});
  for (int i = 0; i < 4; i++)
    shape_random_octahedron(soup, rng, -8, (int)(4 * d[1]) + 8);
  return soup;
}

static void assert_same_window(const vxm_window *whole, const vxm_window *part, const uint64_t *before) {
  size_t words = (size_t)(part->end - part->begin) * part->slice_words;
  const uint64_t *from = vxm_window_row(whole, 0, part->begin);
  for (size_t i = 0; i < words; i++)
    assert_true(part->words[i] == (from[i] | (before ? before[i] : 0)));
}

/** In every layout the same voxels; in every window, thread count and build the same words. */
static void test_windows_make_no_difference(void **state) {
  (void)state;
  vxm_rng rng = {2};
  vxm_space space = unit_space(70, 40, 33);
  vxm_lattice lattice = vxm_lattice_of(&space);
  vxm_soup *soup = random_mesh(&rng, &space);
  vxm_surface *surface = surface_of(soup, &lattice, NULL);
  vxm_context *own = surface->context;
  for (int kind = 0; kind < 2; kind++) {
    vxm_window first = window_make(&space, layouts[0], 0, 33);
    draw(surface, &first, (vxm_surface_kind)kind, true);
    for (int l = 0; l < 6; l++) {
      int64_t slices = space.dims[layouts[l].slow], v[3];
      vxm_surface_force(NULL);
      vxm_window whole = window_make(&space, layouts[l], 0, slices);
      draw(surface, &whole, (vxm_surface_kind)kind, true);
      for (v[2] = 0; v[2] < 33; v[2]++)
        for (v[1] = 0; v[1] < 40; v[1]++)
          for (v[0] = 0; v[0] < 70; v[0]++)
            assert_int_equal(window_get(&whole, v), window_get(&first, v));
      for (int64_t r = 0; r < slices * whole.middle_dim; r++) /* nothing behind the end of a row */
        assert_true((whole.words[(size_t)(r + 1) * whole.row_words - 1] & ~vxm_window_tail_mask(&whole)) ==
                    0);
      for (int round = 0; round < 18; round++) {
        int64_t begin = (int64_t)vxm_rng_below(&rng, (uint64_t)slices + 1);
        int64_t end = begin + (int64_t)vxm_rng_below(&rng, (uint64_t)(slices - begin) + 1);
        vxm_window part = window_make(&space, layouts[l], begin, end);
        size_t words = (size_t)(end - begin) * part.slice_words;
        uint64_t *before = malloc(words * sizeof *before + 1);
        bool is_fresh = round % 2;
        for (size_t i = 0; i < words; i++)
          part.words[i] = before[i] = vxm_rng_next(&rng) & vxm_rng_next(&rng);
        surface->context = contexts[round % 3];
        vxm_surface_force(builds[(size_t)round % build_count]);
        draw_some_way(&rng, surface, &part, (vxm_surface_kind)kind, is_fresh);
        assert_same_window(&whole, &part, is_fresh ? NULL : before);
        free(before);
        free(part.words);
      }
      surface->context = own;
      free(whole.words);
    }
    free(first.words);
  }
  vxm_surface_destroy(surface);
  vxm_soup_destroy(soup);
}

/** So many that all threads have some; the same bits from every build, in windows of threads and in tiles. */
static void test_many_small_triangles(void **state) {
  (void)state;
  enum { COUNT = 30000 };
  vxm_rng rng = {3};
  vxm_space space = unit_space(70, 40, 33);
  vxm_lattice lattice = vxm_lattice_of(&space);
  vxm_soup *soup = shape_empty(context);
  for (uint32_t i = 0; i < COUNT; i++) {
    double at[3] = {shape_quarter(&rng, -4, 284), shape_quarter(&rng, -4, 164), shape_quarter(&rng, -4, 136)};
    int size = i % 100 == 0 ? 40 : 1 + (int)(i % 9);
    for (int c = 0; c < 3; c++)
      shape_vertex(soup, at[0] + 0.37 * shape_quarter(&rng, -size, size),
                   at[1] + 0.37 * shape_quarter(&rng, -size, size),
                   at[2] + 0.37 * shape_quarter(&rng, -size, size));
    if (i % 7 == 0) /* few enough for parts of the grid to stay empty */
      shape_triangle(soup, 3 * i, 3 * i + 1, 3 * i + 2);
    else
      shape_triangle(soup, 3 * i, 3 * i, 3 * i + 2);
  }
  vxm_surface *surface = surface_of(soup, &lattice, NULL);
  vxm_context *own = surface->context;
  vxm_window first = window_make(&space, layouts[0], 0, 33), again = window_make(&space, layouts[0], 0, 33);
  size_t bytes = 33 * first.slice_words * sizeof *first.words;
  for (int kind = 0; kind < 2; kind++)
    for (size_t b = 0; b < build_count; b++)
      for (int i = 0; i < 6; i++) {
        vxm_error error = VXM_ERROR_INIT;
        surface->context = contexts[i % 3];
        vxm_surface_force(builds[b]);
        vxm_surface_pen pen = vxm_surface_pen_of(surface, &again, (vxm_surface_kind)kind);
        if (i < 3)
          draw(surface, &again, (vxm_surface_kind)kind, true);
        else
          assert_int_equal(vxm_surface_add_tiled(&pen, true, &error), VXM_OK);
        if (b == 0 && i == 0)
          memcpy(first.words, again.words, bytes);
        assert_memory_equal(first.words, again.words, bytes);
      }
  surface->context = own;
  free(first.words);
  free(again.words);
  vxm_surface_destroy(surface);
  vxm_soup_destroy(soup);
}

/** More triangles than are listed at once, each in every tile; each has its own columns. */
static void test_many_large_triangles(void **state) {
  (void)state;
  enum { COUNT = 20000, SIDE = 32, LENGTH = 1 << 16 };
  vxm_space space = unit_space(LENGTH, SIDE, SIDE);
  vxm_lattice lattice = vxm_lattice_of(&space);
  vxm_soup *soup = shape_empty(context);
  for (uint32_t i = 0; i < COUNT; i++) {
    double x = 3.25 * i;
    shape_vertex(soup, x, -200, -100);
    shape_vertex(soup, x + 1.5, 300, -100);
    shape_vertex(soup, x + 0.5, 16, 300);
    shape_triangle(soup, 3 * i, 3 * i + 1, 3 * i + 2);
  }
  vxm_surface *surface = surface_of(soup, &lattice, NULL);
  vxm_context *own = surface->context;
  vxm_window one = window_make(&space, layouts[0], 0, SIDE), seven = window_make(&space, layouts[0], 0, SIDE);
  surface->context = contexts[0];
  draw(surface, &one, VXM_SURFACE_THIN, true);
  surface->context = contexts[2];
  draw(surface, &seven, VXM_SURFACE_THIN, true);
  assert_memory_equal(one.words, seven.words, (size_t)SIDE * SIDE * LENGTH / 8);
  surface->context = own;
  free(one.words);
  free(seven.words);
  vxm_surface_destroy(surface);
  vxm_soup_destroy(soup);
}

/* ---- The rest ---- */

static void test_transform_moves_the_mesh(void **state) {
  (void)state;
  vxm_rng rng = {6};
  vxm_space space = unit_space(20, 20, 20);
  vxm_lattice lattice = vxm_lattice_of(&space);
  static const double transform[12] = {0, -0.5, 0, 12, 2, 0, 0.25, -5, 0, 0, 1, 3};
  vxm_soup *soup = shape_empty(context), *moved = shape_empty(context);
  shape_random_octahedron(soup, &rng, 4, 60);
  for (size_t v = 0; v < soup->vertex_count; v++) {
    const double *p = vxm_position(soup, v);
    shape_vertex(moved, 12 - 0.5 * p[1], 2 * p[0] + 0.25 * p[2] - 5, p[2] + 3);
  }
  for (size_t f = 0; f < soup->face_count; f++)
    shape_face(moved, soup->indices + 3 * f, 3);
  vxm_surface *a = surface_of(soup, &lattice, transform), *b = surface_of(moved, &lattice, NULL);
  assert_memory_equal(a->narrow, b->narrow, soup->vertex_count * sizeof *a->narrow);
  vxm_surface *again = surface_of(moved, &(vxm_lattice){8, 256, space}, NULL);
  assert_int_equal(vxm_surface_place(again, &lattice, NULL, NULL), VXM_OK);
  assert_memory_equal(again->narrow, b->narrow, soup->vertex_count * sizeof *again->narrow);
  vxm_surface_destroy(again);
  vxm_surface_destroy(a);
  vxm_surface_destroy(b);
  vxm_soup_destroy(soup);
  vxm_soup_destroy(moved);
}

static void test_positions_without_a_place(void **state) {
  (void)state;
  vxm_space space = unit_space(4, 4, 4);
  vxm_lattice lattice = vxm_lattice_of(&space);
  static const double bad[2] = {1e30, NAN};
  for (int i = 0; i < 2; i++) {
    vxm_soup *soup = shape_empty(context);
    shape_vertex(soup, bad[i], 0, 0); /* nobody uses it yet */
    for (int v = 0; v < 3; v++)
      shape_vertex(soup, v, v * v, 1);
    shape_triangle(soup, 1, 2, 3);
    vxm_surface_destroy(surface_of(soup, &lattice, NULL));
    shape_triangle(soup, 0, 2, 3);
    vxm_surface *surface;
    vxm_error error = VXM_ERROR_INIT;
    assert_int_equal(vxm_surface_create(&surface, soup, &lattice, NULL, &error), VXM_ERROR_RANGE);
    assert_null(surface);
    assert_int_equal(error.element, 0);
    vxm_soup_destroy(soup);
  }
}

static int refuse(const char *phase, double fraction, void *payload) {
  (void)payload;
  (void)phase;
  (void)fraction;
  return 1;
}

static void test_cancelling_and_running_out(void **state) {
  (void)state;
  vxm_rng rng = {7};
  vxm_space space = unit_space(64, 64, 64);
  vxm_lattice lattice = vxm_lattice_of(&space);
  vxm_window window = window_make(&space, layouts[0], 0, 64);
  for (int i = 0; i < 2; i++) {
    vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
    options.threads = 2;
    if (i == 0)
      options.progress = refuse;
    else
      options.memory_limit = 2000;
    vxm_context *strict;
    assert_int_equal(vxm_context_create(&strict, &options, NULL), VXM_OK);
    vxm_soup *soup = random_mesh(&rng, &space);
    vxm_surface *surface = surface_of(soup, &lattice, NULL);
    vxm_context *own = surface->context;
    surface->context = strict;
    vxm_error error = VXM_ERROR_INIT;
    assert_int_equal(vxm_surface_add(surface, &window, VXM_SURFACE_CONSERVATIVE, true, &error),
                     i == 0 ? VXM_ERROR_CANCELLED : VXM_ERROR_MEMORY_LIMIT);
    assert_int_equal(error.code, i == 0 ? VXM_ERROR_CANCELLED : VXM_ERROR_MEMORY_LIMIT);
    surface->context = own;
    vxm_surface_destroy(surface);
    vxm_soup_destroy(soup);
    vxm_context_destroy(strict);
  }
  free(window.words);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_triangles_match_brute_force), cmocka_unit_test(test_windows_make_no_difference),
      cmocka_unit_test(test_many_small_triangles),        cmocka_unit_test(test_many_large_triangles),
      cmocka_unit_test(test_transform_moves_the_mesh),    cmocka_unit_test(test_positions_without_a_place),
      cmocka_unit_test(test_cancelling_and_running_out),
  };
  return cmocka_run_group_tests(tests, setup_all, teardown_all);
}

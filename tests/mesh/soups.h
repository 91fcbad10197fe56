/* SPDX-License-Identifier: BSD-3-Clause */
/** Small and random soups for tests. */
#ifndef VXM_TESTS_SOUPS_H
#define VXM_TESTS_SOUPS_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/rng.h"
#include "mesh/soup.h"

static inline vxm_context *context_of_threads(int threads) {
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.threads = threads;
  vxm_context *context;
  assert_int_equal(vxm_context_create(&context, &options, NULL), VXM_OK);
  return context;
}

/** For cmocka_run_group_tests: the state of every test is a context. */
static inline int make_context(void **state) {
  *state = context_of_threads(2);
  return 0;
}

static inline int drop_context(void **state) {
  vxm_context_destroy(*state);
  return 0;
}

static inline vxm_soup *new_soup(vxm_context *context) {
  vxm_soup *soup;
  assert_int_equal(vxm_soup_create(&soup, context, "arrays", NULL), VXM_OK);
  return soup;
}

static inline void add_vertex(vxm_soup *soup, double x, double y, double z) {
  assert_int_equal(vxm_soup_add_vertex(soup, x, y, z, NULL), VXM_OK);
}

static inline void add_face(vxm_soup *soup, const uint32_t *corners, size_t count) {
  assert_int_equal(vxm_soup_add_face(soup, corners, count, NULL), VXM_OK);
}

static inline void add_triangle(vxm_soup *soup, uint32_t a, uint32_t b, uint32_t c) {
  uint32_t corners[3] = {a, b, c};
  add_face(soup, corners, 3);
}

/** A soup from plain arrays; the faces are lists of corners, each ended by -1. */
static inline vxm_soup *soup_of(vxm_context *context, const double (*positions)[3], size_t vertices,
                                const int *faces, size_t face_count) {
  vxm_soup *soup = new_soup(context);
  for (size_t v = 0; v < vertices; v++)
    add_vertex(soup, positions[v][0], positions[v][1], positions[v][2]);
  for (size_t f = 0; f < face_count; f++) {
    uint32_t corners[64];
    size_t count = 0;
    for (; *faces >= 0; faces++)
      corners[count++] = (uint32_t)*faces;
    faces++;
    add_face(soup, corners, count);
  }
  return soup;
}

/**
 * Vertices on a small integer lattice, so that many coincide, and faces of 0 to `corners_max` corners, half
 * of them triangles, so that repeated corners, repeated faces and faces without area come up all the time.
 */
static inline vxm_soup *random_soup(vxm_context *context, vxm_rng *rng, size_t vertices, size_t faces,
                                    unsigned lattice, size_t corners_max) {
  vxm_soup *soup = new_soup(context);
  for (size_t v = 0; v < vertices; v++)
    add_vertex(soup, (double)vxm_rng_below(rng, lattice), (double)vxm_rng_below(rng, lattice),
               (double)vxm_rng_below(rng, lattice));
  for (size_t f = 0; f < faces && vertices > 0; f++) {
    uint32_t corners[32];
    size_t count = vxm_rng_below(rng, 2) ? 3 : (size_t)vxm_rng_below(rng, corners_max + 1);
    for (size_t i = 0; i < count; i++)
      corners[i] = (uint32_t)vxm_rng_below(rng, vertices);
    /* now and then an earlier face again, turned and perhaps reversed */
    if (f > 0 && vxm_rng_below(rng, 4) == 0) {
      size_t other;
      const uint32_t *face = vxm_face(soup, (size_t)vxm_rng_below(rng, f), &other);
      size_t turn = other ? (size_t)vxm_rng_below(rng, other) : 0;
      uint64_t back = vxm_rng_below(rng, 2);
      count = other;
      for (size_t i = 0; i < count; i++)
        corners[i] = face[back ? (turn + count - i) % count : (turn + i) % count];
    }
    add_face(soup, corners, count);
  }
  return soup;
}

/** A regular grid of n x n squares, two triangles each, in the plane z = 0, counter-clockwise from above. */
static inline vxm_soup *grid_sheet(vxm_context *context, size_t n) {
  vxm_soup *soup = new_soup(context);
  for (size_t j = 0; j <= n; j++)
    for (size_t i = 0; i <= n; i++)
      add_vertex(soup, (double)i, (double)j, 0);
  for (size_t j = 0; j < n; j++)
    for (size_t i = 0; i < n; i++) {
      uint32_t a = (uint32_t)(j * (n + 1) + i), up = (uint32_t)(n + 1);
      add_triangle(soup, a, a + 1, a + 1 + up);
      add_triangle(soup, a, a + 1 + up, a + up);
    }
  return soup;
}

/** The unit cube of six quadrilaterals facing outward, shifted along x. */
static inline void add_cube(vxm_soup *soup, double x) {
  static const uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  uint32_t first = (uint32_t)soup->vertex_count;
  for (int v = 0; v < 8; v++)
    add_vertex(soup, x + (v & 1), v >> 1 & 1, v >> 2 & 1);
  for (int f = 0; f < 6; f++) {
    uint32_t corners[4];
    for (int i = 0; i < 4; i++)
      corners[i] = first + faces[f][i];
    add_face(soup, corners, 4);
  }
}

/** Two fans over one polygon. */
static inline void add_bipyramid(vxm_soup *soup, uint32_t n) {
  uint32_t first = (uint32_t)soup->vertex_count;
  for (uint32_t v = 0; v < n + 2; v++)
    add_vertex(soup, first + v, v, 0);
  for (uint32_t i = 0; i < n; i++) {
    uint32_t p = first + i, q = first + (i + 1) % n;
    add_triangle(soup, p, q, first + n);
    add_triangle(soup, q, p, first + n + 1);
  }
}

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Flags of unit squares that hang on bodies of unit cells. */
#ifndef VXM_TESTS_FINS_H
#define VXM_TESTS_FINS_H

#include "cells.h"

/** A flag of unit squares in a plane across an axis. */
typedef struct fin {
  int corner[3], axis, size[2];
  bool pierced; /**< one of its squares is left out */
} fin;

static inline void corner_of(const fin *f, int i, int j, int corner[3]) {
  memcpy(corner, f->corner, sizeof f->corner);
  corner[(f->axis + 1) % 3] += i;
  corner[(f->axis + 2) % 3] += j;
}

static inline void add_fin(vxm_soup *soup, const fin *f, const manner *how, vxm_rng *rng) {
  int corner[3];
  for (int i = 0; i < f->size[0]; i++)
    for (int j = 0; j < f->size[1]; j++) {
      corner_of(f, i, j, corner);
      if (!f->pierced || i != f->size[0] / 2 || j != f->size[1] / 2)
        add_square(soup, how, corner, f->axis, true, rng);
    }
}

/** Whether a body has a cell about a lattice point. */
static inline bool is_met(const body *b, const int point[3]) {
  for (int i = 0; i < 8; i++) {
    const int cell[3] = {point[0] - (i & 1), point[1] - (i >> 1 & 1), point[2] - (i >> 2)};
    if (has_cell(b, cell))
      return true;
  }
  return false;
}

enum { POINTS = (SIDE + 1) * (SIDE + 1) * (SIDE + 1) };

static inline size_t point_at(const int p[3]) {
  return (size_t)((p[2] * (SIDE + 1) + p[1]) * (SIDE + 1) + p[0]);
}

/** Whether the row `root` of the points of a fin lies on a body, the others on none, and none is taken. */
static inline bool is_free(const fin *f, int root, const body *b, const bool taken[POINTS]) {
  for (int i = 0; i <= f->size[0]; i++)
    for (int j = 0; j <= f->size[1]; j++) {
      int p[3];
      corner_of(f, i, j, p);
      for (int a = 0; a < 3; a++)
        if (p[a] < 0 || p[a] > SIDE)
          return false;
      if (taken[point_at(p)] || is_met(b, p) != (i == root))
        return false;
    }
  return true;
}

static inline void take(const fin *f, bool taken[POINTS]) {
  for (int i = 0; i <= f->size[0]; i++)
    for (int j = 0; j <= f->size[1]; j++) {
      int p[3];
      corner_of(f, i, j, p);
      taken[point_at(p)] = true;
    }
}

/** Adds flags of which each hangs on a row of edges of a body; some turn at a right angle. */
static inline void add_random_fins(vxm_soup *soup, const body *b, const manner *how, vxm_rng *rng) {
  bool taken[POINTS] = {false};
  int fins = 0;
  for (int tries = 0; tries < 400 && fins < 12; tries++) {
    int up = (int)vxm_rng_below(rng, 2), axis = (int)vxm_rng_below(rng, 3), next = (axis + 1) % 3;
    fin out = {.axis = axis, .size = {1 + (int)vxm_rng_below(rng, 3), 1 + (int)vxm_rng_below(rng, 3)}};
    out.pierced = out.size[0] == 3 && out.size[1] == 3;
    for (int a = 0; a < 3; a++)
      out.corner[a] = (int)vxm_rng_below(rng, SIDE);
    fin turned = {.axis = next, .size = {out.size[1], (int)vxm_rng_below(rng, 4)}};
    memcpy(turned.corner, out.corner, sizeof out.corner);
    turned.corner[next] += up ? out.size[0] : 0;
    turned.corner[axis] -= vxm_rng_below(rng, 2) ? turned.size[1] : 0;
    if (!is_free(&out, up ? 0 : out.size[0], b, taken) || !is_free(&turned, -1, b, taken))
      continue;
    add_fin(soup, &out, how, rng);
    add_fin(soup, &turned, how, rng);
    take(&out, taken);
    take(&turned, taken);
    fins++;
  }
}

/** Adds the faces of another soup from `begin` on. */
static inline void append(vxm_soup *soup, const vxm_soup *other, size_t begin) {
  size_t first = soup->vertex_count;
  for (size_t v = 0; v < other->vertex_count; v++)
    add_vertex(soup, other->positions[3 * v], other->positions[3 * v + 1], other->positions[3 * v + 2]);
  for (size_t f = begin; f < other->face_count; f++) {
    uint32_t corners[4];
    size_t count;
    const uint32_t *corner = vxm_face(other, f, &count);
    for (size_t c = 0; c < count; c++)
      corners[c] = (uint32_t)first + corner[c];
    add_face(soup, corners, count);
  }
}

/** The cells that a soup covers. */
static inline void find_covered(const vxm_soup *soup, bool covered[CELLS]) {
  memset(covered, 0, CELLS * sizeof *covered);
  if (soup->face_count == 0)
    return;
  vxm_space_options place = VXM_SPACE_OPTIONS_INIT;
  vxm_space space = {.dims = {SIDE, SIDE, SIDE}, .voxel_size = {1, 1, 1}};
  place.like = &space;
  vxm_soup *prepared;
  vxm_grid *grid;
  assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.thin = VXM_THIN_DROP;
  assert_int_equal(vxm_voxelize(&grid, NULL, prepared, &place, &options, NULL), VXM_OK);
  for (int64_t c = 0; c < CELLS; c++)
    covered[c] = vxm_grid_get(grid, c % SIDE, c / SIDE % SIDE, c / SIDE / SIDE);
  vxm_grid_destroy(grid);
  vxm_soup_destroy(prepared);
}

/** The solid of a body with sheets on its edges is to be what each covers by itself: a fold of a sheet may
 * cover a little. */
static inline int count_wrong_beside(const vxm_soup *soup, const vxm_soup *sheets, const body *b,
                                     const manner *how) {
  bool wanted[CELLS];
  vxm_soup *prepared;
  find_covered(sheets, wanted);
  for (size_t c = 0; c < CELLS; c++)
    wanted[c] = wanted[c] || b->cells[c];
  assert_int_equal(vxm_repair_prepare(&prepared, NULL, soup, NULL, NULL), VXM_OK);
  int wrong = count_wrong(prepared, how, wanted);
  vxm_soup_destroy(prepared);
  return wrong;
}

#endif

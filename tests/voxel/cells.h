/* SPDX-License-Identifier: BSD-3-Clause */
/** Bodies that are sets of unit cells: which cells are inside is known without any geometry. */
#ifndef VXM_TESTS_CELLS_H
#define VXM_TESTS_CELLS_H

#include "../base/rounds.h"
#include "../mesh/soups.h"

#include "repair/repair.h"
#include "voxmend/voxelize.h"

#include <math.h>

enum { SIDE = 6, CELLS = SIDE * SIDE * SIDE };

typedef struct body {
  bool cells[CELLS];
  bool turned;
  int copies;
} body;

static inline size_t cell_at(int x, int y, int z) {
  return (size_t)((z * SIDE + y) * SIDE + x);
}

static inline bool has_cell(const body *b, const int at[3]) {
  for (int a = 0; a < 3; a++)
    if (at[a] < 0 || at[a] >= SIDE)
      return false;
  return b->cells[cell_at(at[0], at[1], at[2])];
}

static inline void add_random_box(body *b, vxm_rng *rng) {
  int low[3], high[3];
  for (int a = 0; a < 3; a++) {
    low[a] = (int)vxm_rng_below(rng, SIDE);
    high[a] = low[a] + 1 + (int)vxm_rng_below(rng, (uint64_t)(SIDE - low[a]));
  }
  for (int z = low[2]; z < high[2]; z++)
    for (int y = low[1]; y < high[1]; y++)
      for (int x = low[0]; x < high[0]; x++)
        b->cells[cell_at(x, y, z)] = true;
}

/** How bodies become faces. */
typedef struct manner {
  bool triangles; /**< each square is cut in two, now this way and now that, so that faces that lie on each
                     other need not be equal */
  double turn[3][3];
  double unit; /**< what cells measure: coordinates that are no whole numbers are rounded */
} manner;

static const manner squares = {.turn = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .unit = 1};

static inline void add_corner(vxm_soup *soup, const manner *how, const int p[3]) {
  double q[3];
  for (int a = 0; a < 3; a++)
    q[a] = how->turn[a][0] * p[0] + how->turn[a][1] * p[1] + how->turn[a][2] * p[2];
  add_vertex(soup, how->unit * q[0], how->unit * q[1], how->unit * q[2]);
}

static inline void add_square(vxm_soup *soup, const manner *how, const int corner[3], int axis, bool outward,
                              vxm_rng *rng) {
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  uint32_t first = (uint32_t)soup->vertex_count, face[4];
  for (int c = 0; c < 4; c++) {
    int p[3] = {corner[0], corner[1], corner[2]};
    p[u] += c == 1 || c == 2;
    p[v] += c >= 2;
    add_corner(soup, how, p);
    face[outward ? c : 3 - c] = first + (uint32_t)c;
  }
  if (!how->triangles) {
    add_face(soup, face, 4);
    return;
  }
  size_t cut = (size_t)vxm_rng_below(rng, 2);
  add_triangle(soup, face[cut], face[cut + 1], face[cut + 2]);
  add_triangle(soup, face[cut], face[cut + 2], face[(cut + 3) % 4]);
}

/** Adds the unit squares between cells of the body and others, one in `part` left out (0: none). */
static inline void add_squares(vxm_soup *soup, const body *b, const manner *how, vxm_rng *rng, uint64_t part,
                               bool inward) {
  for (int z = 0; z < SIDE; z++)
    for (int y = 0; y < SIDE; y++)
      for (int x = 0; x < SIDE; x++)
        for (int side = 0; side < 6 && b->cells[cell_at(x, y, z)]; side++) {
          int axis = side / 2, up = side % 2, beside[3] = {x, y, z}, corner[3] = {x, y, z};
          beside[axis] += up ? 1 : -1;
          corner[axis] += up;
          if (!has_cell(b, beside) && (part == 0 || vxm_rng_below(rng, part) > 0))
            add_square(soup, how, corner, axis, (up == 1) != inward, rng);
        }
}

/** All of them, outward or, if the body is turned, inward. */
static inline void add_body(vxm_soup *soup, const body *b, const manner *how, vxm_rng *rng) {
  add_squares(soup, b, how, rng, 0, b->turned);
}

/** The cell that a point lies in well away from its sides, or CELLS beside all of them; -1 if it is too near
 * one. */
static inline int cell_of_point(const manner *how, const double p[3]) {
  int at[3];
  bool outside = false;
  for (int a = 0; a < 3; a++) { /* the inverse of a rotation is its transpose */
    double q = (how->turn[0][a] * p[0] + how->turn[1][a] * p[1] + how->turn[2][a] * p[2]) / how->unit;
    at[a] = (int)floor(q);
    if (q - at[a] < 0.05 || q - at[a] > 0.95)
      return -1;
    outside = outside || at[a] < 0 || at[a] >= SIDE;
  }
  return outside ? CELLS : (int)cell_at(at[0], at[1], at[2]);
}

/** Voxelizes, and counts voxels of the bodies that are clear and others that are set. */
static inline int count_wrong(const vxm_soup *soup, const manner *how, const bool wanted[CELLS]) {
  enum { FINE = 28 };
  vxm_space_options place = VXM_SPACE_OPTIONS_INIT;
  vxm_space space = {.dims = {SIDE, SIDE, SIDE}, .voxel_size = {how->unit, how->unit, how->unit}};
  for (int a = 0; a < 3 && how != &squares && !how->triangles; a++) {
    space.dims[a] = FINE;
    space.voxel_size[a] = 0.75 * how->unit;
    space.origin[a] = (-FINE / 2 * 0.75 + 0.01) * how->unit;
  }
  place.like = &space;
  vxm_grid *grid;
  vxm_error error = VXM_ERROR_INIT;
  int wrong = 0;
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.thin = VXM_THIN_DROP;
  if (vxm_voxelize(&grid, NULL, soup, &place, &options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  for (int64_t z = 0; z < space.dims[2]; z++)
    for (int64_t y = 0; y < space.dims[1]; y++)
      for (int64_t x = 0; x < space.dims[0]; x++) {
        const int64_t at[3] = {x, y, z};
        double p[3];
        for (int a = 0; a < 3; a++)
          p[a] = space.origin[a] + ((double)at[a] + 0.5) * space.voxel_size[a];
        int cell = cell_of_point(how, p);
        wrong += cell >= 0 && vxm_grid_get(grid, x, y, z) != (cell < CELLS && wanted[cell]);
      }
  vxm_grid_destroy(grid);
  return wrong;
}

static inline uint64_t rounds_of(uint64_t usual) {
  const char *rounds = getenv("VOXMEND_TEST_ROUNDS");
  return rounds ? (uint64_t)atoll(rounds) : ROUNDS(usual);
}

#endif

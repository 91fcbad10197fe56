/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A brute-force oracle for the voxels that hold thin parts together (voxel/thin/thin.h): every link, square
 * and cube of a small grid against every triangle, in 128-bit integers. It shares no code with them. Centres
 * are moved by (e, e^2, e^3), e infinitely small, so that none lies on a triangle.
 */
#ifndef TEST_VOXEL_THIN_ORACLE_H
#define TEST_VOXEL_THIN_ORACLE_H

#include "engine.h"
#include "surface_oracle.h"

#include "mesh/triangulate.h"

/** A triangle of a face. */
typedef struct thin_triangle {
  vxm_point at[3];
} thin_triangle;

typedef struct thin_mesh {
  vxm_lattice lattice;
  thin_triangle *triangles;
  size_t count;
} thin_mesh;

/** Polygons become the same triangles as everywhere (mesh/triangulate.h), but for those with two equal
 * corners. */
static inline thin_mesh thin_mesh_of(const vxm_soup *soup, const vxm_space *space) {
  thin_mesh mesh = {.lattice = vxm_lattice_of(space)};
  vxm_triangulator triangulator;
  vxm_triangulator_open(&triangulator, soup->context);
  mesh.triangles = calloc(3 * soup->corner_count + 1, sizeof *mesh.triangles);
  assert_non_null(mesh.triangles);
  for (size_t f = 0; f < soup->face_count; f++) {
    const uint32_t *corner = soup->indices + soup->offsets[f];
    size_t n = soup->offsets[f + 1] - soup->offsets[f];
    assert_int_equal(vxm_triangulate(&triangulator, soup->positions, corner, n, &corner, NULL), VXM_OK);
    for (size_t i = 0; i + 2 < n; i++, corner += 3) {
      if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
        continue;
      thin_triangle *t = &mesh.triangles[mesh.count++];
      for (int k = 0; k < 3; k++)
        assert_true(vxm_lattice_place(&mesh.lattice, soup->positions + 3 * (size_t)corner[k], &t->at[k]));
    }
  }
  vxm_triangulator_close(&triangulator);
  return mesh;
}

static inline void thin_mesh_free(thin_mesh *mesh) {
  free(mesh->triangles);
}

/* ---- Bits, a byte each, x fastest ---- */

static inline size_t thin_size(const vxm_space *space) {
  return (size_t)(space->dims[0] * space->dims[1] * space->dims[2]);
}

static inline size_t thin_at(const vxm_space *space, const int64_t v[3]) {
  return (size_t)((v[2] * space->dims[1] + v[1]) * space->dims[0] + v[0]);
}

static inline bool thin_inside(const vxm_space *space, const int64_t v[3]) {
  return v[0] >= 0 && v[0] < space->dims[0] && v[1] >= 0 && v[1] < space->dims[1] && v[2] >= 0 &&
         v[2] < space->dims[2];
}

static inline uint8_t *thin_bytes(const vxm_grid *grid) {
  const vxm_space *space = &grid->space;
  uint8_t *bytes = malloc(thin_size(space));
  assert_non_null(bytes);
  int64_t v[3];
  for (v[2] = 0; v[2] < space->dims[2]; v[2]++)
    for (v[1] = 0; v[1] < space->dims[1]; v[1]++)
      for (v[0] = 0; v[0] < space->dims[0]; v[0]++)
        bytes[thin_at(space, v)] = vxm_grid_get(grid, v[0], v[1], v[2]);
  return bytes;
}

static inline size_t thin_count(const uint8_t *bytes, size_t size) {
  size_t count = 0;
  for (size_t i = 0; i < size; i++)
    count += bytes[i];
  return count;
}

/** The 26-connected pieces. */
static inline int thin_pieces(const uint8_t *bytes, const vxm_space *space) {
  size_t size = thin_size(space), *stack = malloc(size * sizeof *stack);
  uint8_t *left = malloc(size);
  assert_true(left && stack);
  memcpy(left, bytes, size);
  int pieces = 0;
  for (size_t seed = 0; seed < size; seed++) {
    size_t depth = 0;
    if (!left[seed])
      continue;
    pieces++;
    left[seed] = 0;
    stack[depth++] = seed;
    while (depth > 0) {
      size_t at = stack[--depth];
      const int64_t nx = space->dims[0], ny = space->dims[1];
      const int64_t v[3] = {(int64_t)at % nx, (int64_t)at / nx % ny, (int64_t)at / nx / ny};
      for (int d = 0; d < 27; d++) {
        const int64_t to[3] = {v[0] + d % 3 - 1, v[1] + d / 3 % 3 - 1, v[2] + d / 9 - 1};
        if (!thin_inside(space, to) || !left[thin_at(space, to)])
          continue;
        left[thin_at(space, to)] = 0;
        stack[depth++] = thin_at(space, to);
      }
    }
  }
  free(stack);
  free(left);
  return pieces;
}

/* ---- Meetings ---- */

static inline exact thin_det(const exact a[3], const exact b[3], const exact c[3]) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/** Whether all of a triangle lies more than two voxels beyond a centre along an axis: no link reaches it. */
static inline bool thin_is_far(const thin_mesh *mesh, const thin_triangle *t, const int64_t from[3]) {
  const vxm_point *at = t->at;
  for (int a = 0; a < 3; a++) {
    int64_t low = vxm_lattice_centre(&mesh->lattice, from[a] - 2),
            high = vxm_lattice_centre(&mesh->lattice, from[a] + 2);
    if ((at[0].at[a] < low && at[1].at[a] < low && at[2].at[a] < low) ||
        (at[0].at[a] > high && at[1].at[a] > high && at[2].at[a] > high))
      return true;
  }
  return false;
}

/** Whether a triangle crosses the link from a voxel's centre over `step`, and how far along that, 0 to 1. */
static inline bool thin_crosses_link(const thin_mesh *mesh, const thin_triangle *t, const int64_t from[3],
                                     const int step[3], double *part) {
  exact way[3], corner[3][3];
  int sum = 0;
  if (thin_is_far(mesh, t, from))
    return false;
  for (int a = 0; a < 3; a++) {
    way[a] = step[a] * mesh->lattice.unit;
    for (int k = 0; k < 3; k++)
      corner[k][a] = t->at[k].at[a] - vxm_lattice_centre(&mesh->lattice, from[a]);
  }
  for (int k = 0; k < 3; k++) { /* the line passes all sides on the same hand */
    const exact *p = corner[k], *q = corner[(k + 1) % 3];
    exact side[3], move[3];
    for (int a = 0; a < 3; a++)
      side[a] = p[a] - q[a];
    oracle_cross(side, way, move);
    sum += exact_sign(thin_det(way, p, q), move[0], move[1], move[2]);
  }
  if (sum != 3 && sum != -3)
    return false;
  exact b[3], c[3], n[3], before = 0, along = 0;
  for (int a = 0; a < 3; a++) {
    b[a] = corner[1][a] - corner[0][a];
    c[a] = corner[2][a] - corner[0][a];
  }
  oracle_cross(b, c, n);
  for (int a = 0; a < 3; a++) {
    before -= n[a] * corner[0][a];
    along += n[a] * way[a];
  }
  *part = -(double)before / (double)along;
  return exact_sign(before, n[0], n[1], n[2]) != exact_sign(before + along, n[0], n[1], n[2]);
}

/** The axis along which a triangle's normal is longest, the lowest of equals. */
static inline int thin_dominant(const thin_triangle *t) {
  exact b[3], c[3], n[3];
  int longest = 0;
  for (int a = 0; a < 3; a++) {
    b[a] = t->at[1].at[a] - t->at[0].at[a];
    c[a] = t->at[2].at[a] - t->at[0].at[a];
  }
  oracle_cross(b, c, n);
  for (int a = 0; a < 3; a++) {
    n[a] = n[a] < 0 ? -n[a] : n[a];
    longest = n[a] > n[longest] ? a : longest;
  }
  return longest;
}

/** Where the line between two corners passes the moved plane of a voxel's centres across an axis: the last
 * moved centre before that along each other axis, and how far it lies from the middle of the square there.
 * False if it does not pass it. */
static inline bool thin_passes(const thin_mesh *mesh, const vxm_point *p, const vxm_point *q, int axis,
                               int64_t plane, int64_t lowest[3], double offset[3]) {
  if (p->at[axis] > q->at[axis]) {
    const vxm_point *swapped = p;
    p = q;
    q = swapped;
  }
  const int64_t unit = mesh->lattice.unit, centre = vxm_lattice_centre(&mesh->lattice, plane);
  if (p->at[axis] > centre || q->at[axis] <= centre)
    return false;
  const exact rise = q->at[axis] - p->at[axis];
  lowest[axis] = plane;
  for (int a = 0; a < 3; a++) {
    if (a == axis)
      continue;
    const exact slope = q->at[a] - p->at[a];
    exact at = (p->at[a] - unit / 2) * rise + slope * (centre - p->at[axis]); /* of rise, from centre 0 */
    exact voxel = at / (rise * unit), rest = at % (rise * unit);
    if (rest < 0) {
      voxel--;
      rest += rise * unit;
    }
    /* On a centre, that is moved by e^(a + 1), and where the line passes by slope / rise e^(axis + 1). */
    bool before = rest == 0 && !(a > axis && slope > 0);
    lowest[a] = (int64_t)voxel - before;
    offset[a] = (double)rest / (double)(rise * unit) + before - 0.5;
  }
  return true;
}

/** Whether a corner of a triangle lies in the cube of eight centres above a voxel. */
static inline bool thin_is_in_cube(const thin_mesh *mesh, const vxm_point *p, const int64_t lowest[3]) {
  for (int a = 0; a < 3; a++) {
    int64_t low = vxm_lattice_centre(&mesh->lattice, lowest[a]);
    if (p->at[a] <= low || p->at[a] > low + mesh->lattice.unit)
      return false;
  }
  return true;
}

/* ---- What is asked of the voxels ---- */

/** The half of all steps to neighbours: over faces, over edges, over corners. */
static const int thin_steps[13][3] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},  {1, 1, 0},  {-1, 1, 0},
                                      {1, 0, 1},  {-1, 0, 1}, {0, 1, 1},  {0, -1, 1}, {1, 1, 1},
                                      {-1, 1, 1}, {1, -1, 1}, {-1, -1, 1}};

/** The voxels about a square, or the cube if axis is 3, above `lowest`: whether all are in the grid, and one
 * is set. */
static inline bool thin_has_corner(const uint8_t *bytes, const vxm_space *space, const int64_t lowest[3],
                                   int axis, bool *inside) {
  bool any = false;
  *inside = true;
  for (int c = 0; c < 8; c++) {
    if (axis < 3 && (c >> axis & 1))
      continue;
    const int64_t v[3] = {lowest[0] + (c & 1), lowest[1] + (c >> 1 & 1), lowest[2] + (c >> 2 & 1)};
    bool here = thin_inside(space, v);
    *inside &= here;
    any |= here && bytes[thin_at(space, v)];
  }
  return any;
}

/** Fails unless every link that a face crosses has an end, if it lies in the grid. */
static inline void thin_assert_links(const thin_mesh *mesh, const uint8_t *kept, int directions) {
  const vxm_space *space = &mesh->lattice.space;
  int64_t v[3];
  for (v[2] = 0; v[2] < space->dims[2]; v[2]++)
    for (v[1] = 0; v[1] < space->dims[1]; v[1]++)
      for (v[0] = 0; v[0] < space->dims[0]; v[0]++)
        for (int d = 0; d < directions; d++) {
          const int *step = thin_steps[d];
          const int64_t to[3] = {v[0] + step[0], v[1] + step[1], v[2] + step[2]};
          if (!thin_inside(space, to) || kept[thin_at(space, v)] || kept[thin_at(space, to)])
            continue;
          for (size_t t = 0; t < mesh->count; t++) {
            double part;
            if (thin_crosses_link(mesh, &mesh->triangles[t], v, step, &part))
              fail_msg("triangle %zu crosses the link over %d %d %d from voxel %d %d %d, which has no voxel",
                       t, step[0], step[1], step[2], (int)v[0], (int)v[1], (int)v[2]);
          }
        }
}

/** The same of every square that an edge crosses and every cube that a corner lies in. */
static inline void thin_assert_squares_and_cubes(const thin_mesh *mesh, const uint8_t *kept) {
  const vxm_space *space = &mesh->lattice.space;
  for (size_t i = 0; i < mesh->count; i++) {
    const thin_triangle *t = &mesh->triangles[i];
    for (int k = 0; k < 3; k++) {
      int64_t lowest[3];
      double offset[3];
      bool inside;
      for (int axis = 0; axis < 3; axis++)
        for (int64_t plane = 0; plane < space->dims[axis]; plane++)
          if (thin_passes(mesh, &t->at[k], &t->at[(k + 1) % 3], axis, plane, lowest, offset) &&
              !thin_has_corner(kept, space, lowest, axis, &inside) && inside)
            fail_msg(
                "side %d of triangle %zu crosses the square across %d of voxel %d %d %d, which has no voxel",
                k, i, axis, (int)lowest[0], (int)lowest[1], (int)lowest[2]);
      for (int a = 0; a < 3; a++) {
        lowest[a] = vxm_lattice_last(&mesh->lattice, t->at[k].at[a]) - 1;
        lowest[a] += t->at[k].at[a] > vxm_lattice_centre(&mesh->lattice, lowest[a] + 1);
      }
      assert_true(thin_is_in_cube(mesh, &t->at[k], lowest));
      if (!thin_has_corner(kept, space, lowest, 3, &inside) && inside)
        fail_msg("corner %d of triangle %zu lies in the cube of voxel %d %d %d, which has no voxel", k, i,
                 (int)lowest[0], (int)lowest[1], (int)lowest[2]);
    }
  }
}

/** Fails unless nothing is lost, and each voxel that is new meets a face. */
static inline void thin_assert_added(const thin_mesh *mesh, const uint8_t *solid, const uint8_t *kept) {
  const vxm_space *space = &mesh->lattice.space;
  int64_t v[3];
  for (v[2] = 0; v[2] < space->dims[2]; v[2]++)
    for (v[1] = 0; v[1] < space->dims[1]; v[1]++)
      for (v[0] = 0; v[0] < space->dims[0]; v[0]++) {
        bool meets = kept[thin_at(space, v)] <= solid[thin_at(space, v)];
        if (solid[thin_at(space, v)] > kept[thin_at(space, v)])
          fail_msg("voxel %d %d %d is lost", (int)v[0], (int)v[1], (int)v[2]);
        for (size_t t = 0; t < mesh->count && !meets; t++)
          meets = oracle_touches(mesh->triangles[t].at, v, mesh->lattice.unit);
        if (!meets)
          fail_msg("voxel %d %d %d meets no face", (int)v[0], (int)v[1], (int)v[2]);
      }
}

/** All of that. */
static inline void thin_assert_contract(const thin_mesh *mesh, const uint8_t *solid, const uint8_t *kept,
                                        int directions) {
  thin_assert_added(mesh, solid, kept);
  thin_assert_links(mesh, kept, directions);
  thin_assert_squares_and_cubes(mesh, kept);
}

#endif

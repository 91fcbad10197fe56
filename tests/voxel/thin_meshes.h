/* SPDX-License-Identifier: BSD-3-Clause */
/** Meshes with thin parts, each of them connected, and the voxels that hold them together. */
#ifndef TEST_VOXEL_THIN_MESHES_H
#define TEST_VOXEL_THIN_MESHES_H

#include "engine.h"

#include "../base/rounds.h"

/** A turned frame: three directions at right angles, each of length 1. */
static inline void thin_frame(vxm_rng *rng, double frame[3][3]) {
  double q[4], size = 0;
  for (int i = 0; i < 4; i++) {
    q[i] = 2 * vxm_rng_unit(rng) - 1;
    size += q[i] * q[i];
  }
  size = size > 0 ? size : 1;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      int o = 3 - r - c; /* of a quaternion: the third axis, where they differ */
      double turn = r == c ? 0 : ((c - r + 3) % 3 == 1 ? -1 : 1) * q[0] * q[1 + o];
      double same = r == c ? q[0] * q[0] + q[1 + r] * q[1 + r] - size / 2 : q[1 + r] * q[1 + c];
      frame[r][c] = 2 * (same + turn) / size;
    }
}

static inline uint32_t thin_vertex(vxm_soup *soup, const double centre[3], double frame[3][3], double x,
                                   double y, double z) {
  double p[3];
  for (int a = 0; a < 3; a++)
    p[a] = centre[a] + x * frame[0][a] + y * frame[1][a] + z * frame[2][a];
  return shape_vertex(soup, p[0], p[1], p[2]);
}

/** A box by half its sides. */
static inline void thin_turned_box(vxm_soup *soup, const double centre[3], double frame[3][3],
                                   const double half[3]) {
  static const uint32_t quad[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                      {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  uint32_t first = (uint32_t)soup->vertex_count;
  for (int i = 0; i < 8; i++)
    thin_vertex(soup, centre, frame, i & 1 ? half[0] : -half[0], i & 2 ? half[1] : -half[1],
                i & 4 ? half[2] : -half[2]);
  for (int f = 0; f < 6; f++) {
    shape_triangle(soup, first + quad[f][0], first + quad[f][1], first + quad[f][2]);
    shape_triangle(soup, first + quad[f][0], first + quad[f][2], first + quad[f][3]);
  }
}

/** A cone of `sides` sides, closed by a disk, its tip at the end of the frame's z. */
static inline void thin_cone(vxm_soup *soup, const double centre[3], double frame[3][3], double radius,
                             double height, uint32_t sides) {
  uint32_t tip = thin_vertex(soup, centre, frame, 0, 0, height),
           foot = thin_vertex(soup, centre, frame, 0, 0, 0);
  for (uint32_t s = 0; s < sides; s++)
    thin_vertex(soup, centre, frame, radius * cos(6.283185307179586 * s / sides),
                radius * sin(6.283185307179586 * s / sides), 0);
  for (uint32_t s = 0; s < sides; s++) {
    uint32_t p = foot + 1 + s, q = foot + 1 + (s + 1) % sides;
    shape_triangle(soup, p, q, tip);
    shape_triangle(soup, q, p, foot);
  }
}

/** A ball of triangles. */
static inline void thin_ball(vxm_soup *soup, const double centre[3], double radius, uint32_t rings) {
  static double straight[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  uint32_t sides = 2 * rings, top = thin_vertex(soup, centre, straight, 0, 0, radius),
           bottom = thin_vertex(soup, centre, straight, 0, 0, -radius), first = bottom + 1;
  for (uint32_t r = 1; r < rings; r++)
    for (uint32_t s = 0; s < sides; s++) {
      double a = 3.141592653589793 * r / rings, b = 6.283185307179586 * s / sides;
      thin_vertex(soup, centre, straight, radius * sin(a) * cos(b), radius * sin(a) * sin(b),
                  radius * cos(a));
    }
  for (uint32_t s = 0; s < sides; s++) {
    uint32_t t = (s + 1) % sides, last = first + (rings - 2) * sides;
    shape_triangle(soup, top, first + s, first + t);
    shape_triangle(soup, bottom, last + t, last + s);
    for (uint32_t r = 0; r + 2 < rings; r++) {
      uint32_t p = first + r * sides;
      shape_triangle(soup, p + s, p + sides + s, p + sides + t);
      shape_triangle(soup, p + s, p + sides + t, p + t);
    }
  }
}

/** A strip of triangles that turns at random: open, and in part of itself. */
static inline void thin_strip(vxm_soup *soup, vxm_rng *rng, const double low[3], const double high[3],
                              uint32_t triangles) {
  uint32_t first = (uint32_t)soup->vertex_count;
  for (uint32_t v = 0; v < triangles + 2; v++) {
    double p[3];
    bool tie = vxm_rng_below(rng, 4) == 0;
    for (int a = 0; a < 3; a++) {
      p[a] = low[a] + vxm_rng_unit(rng) * (high[a] - low[a]);
      p[a] = tie ? floor(p[a]) + 0.5 : p[a];
    }
    shape_vertex(soup, p[0], p[1], p[2]);
  }
  for (uint32_t t = 0; t < triangles; t++)
    shape_triangle(soup, first + t, first + t + 1, first + t + 2);
}

/** A sheet of cuts x cuts squares that waves along z, each of two triangles. */
static inline void thin_wave(vxm_soup *soup, vxm_rng *rng, const vxm_space *space, uint32_t cuts) {
  uint32_t first = (uint32_t)soup->vertex_count;
  double phase = 6 * vxm_rng_unit(rng), size[3];
  for (int a = 0; a < 3; a++)
    size[a] = (double)space->dims[a];
  for (uint32_t j = 0; j <= cuts; j++)
    for (uint32_t i = 0; i <= cuts; i++) {
      double x = 0.1 + 0.8 * i / cuts, y = 0.1 + 0.8 * j / cuts, noise = 0.01 * vxm_rng_unit(rng);
      shape_vertex(soup, x * size[0], y * size[1],
                   (0.5 + 0.2 * sin(7 * x + phase) * cos(5 * y - phase)) * size[2] + noise);
    }
  for (uint32_t j = 0; j < cuts; j++)
    for (uint32_t i = 0; i < cuts; i++) {
      uint32_t p = first + j * (cuts + 1) + i, q = p + cuts + 1;
      shape_triangle(soup, p, p + 1, q + 1);
      shape_triangle(soup, p, q + 1, q);
    }
}

/** A letter U of a polygon of eight corners across an axis, turned to four sides: non-convex and flat. */
static inline void thin_letter(vxm_soup *soup, vxm_rng *rng, int axis, double at, double size,
                               const double corner[3]) {
  static const int outline[8][2] = {{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
  uint32_t face[8];
  int turn = (int)vxm_rng_below(rng, 4);
  for (int c = 0; c < 8; c++) {
    double uv[2] = {outline[c][0] * size / 3, outline[c][1] * size / 3}, p[3];
    if (turn & 1)
      uv[0] = size - uv[0];
    p[axis] = at;
    p[(axis + 1) % 3] = corner[(axis + 1) % 3] + uv[turn >> 1];
    p[(axis + 2) % 3] = corner[(axis + 2) % 3] + uv[1 - (turn >> 1)];
    face[c] = shape_vertex(soup, p[0], p[1], p[2]);
  }
  shape_face(soup, face, 8);
}

enum { THIN_KINDS = 9 };

/** A connected mesh in a grid, a voxel or more away from its border. */
static inline void thin_add_soup(vxm_soup *soup, vxm_rng *rng, int kind, const vxm_space *space) {
  uint32_t first = (uint32_t)soup->vertex_count;
  double frame[3][3], centre[3], low[3], high[3], room = 1e9;
  for (int a = 0; a < 3; a++) {
    double size = (double)space->dims[a];
    low[a] = 1.5;
    high[a] = size - 1.5;
    centre[a] = size / 2 + 2 * vxm_rng_unit(rng) - 1;
    room = fmin(room, size / 2 - 2.6);
  }
  thin_frame(rng, frame);
  double thin = vxm_rng_unit(rng) * 0.8, wide = room * 0.65 * vxm_rng_unit(rng);
  switch (kind) {
  case 0: /* a plate */
    thin_turned_box(soup, centre, frame, (double[3]){wide, room * 0.65, thin / 2});
    break;
  case 1: /* a rod */
    thin_turned_box(soup, centre, frame, (double[3]){thin / 2, 0.4 * vxm_rng_unit(rng), room * 0.8});
    break;
  case 2: /* a needle */
    thin_cone(soup, centre, frame, 0.6 * vxm_rng_unit(rng), room, 3 + (uint32_t)vxm_rng_below(rng, 5));
    break;
  case 3: /* a flat cone */
    thin_cone(soup, centre, frame, room * 0.9, thin, 3 + (uint32_t)vxm_rng_below(rng, 5));
    break;
  case 4: /* a tetrahedron */
    for (int v = 0; v < 4; v++)
      random_vertex(soup, rng, low, high);
    for (uint32_t f = 0; f < 4; f++)
      shape_triangle(soup, first + f, first + (f + 1 + f % 2) % 4, first + (f + 2 - f % 2) % 4);
    break;
  case 5: /* a ball, which may lie between centres */
    thin_ball(soup, centre, vxm_rng_below(rng, 2) ? room * vxm_rng_unit(rng) : 0.5 * vxm_rng_unit(rng), 4);
    break;
  case 6: /* an open sheet */
    thin_strip(soup, rng, low, high, 1 + (uint32_t)vxm_rng_below(rng, 6));
    break;
  case 7: /* a thread of small triangles, some of them on centres */
    for (int v = 0; v < 3 + (int)vxm_rng_below(rng, 9); v++) {
      for (int a = 0; a < 3; a++)
        centre[a] = fmin(fmax(centre[a] + 1.2 * vxm_rng_unit(rng) - 0.6, low[a]), high[a]);
      bool tie = vxm_rng_below(rng, 3) == 0;
      shape_vertex(soup, tie ? floor(4 * centre[0]) / 4 : centre[0],
                   tie ? floor(4 * centre[1]) / 4 : centre[1], tie ? floor(4 * centre[2]) / 4 : centre[2]);
    }
    for (uint32_t v = first; v + 2 < soup->vertex_count; v++)
      shape_triangle(soup, v, v + 1, v + 2);
    break;
  default: /* a box of quads, thinner than a voxel along one axis or two */
    for (int a = 0; a < 3; a++) {
      low[a] = 1.5 + vxm_rng_unit(rng) * (room - 0.5);
      high[a] = low[a] + (a == (int)vxm_rng_below(rng, 3) ? thin : vxm_rng_unit(rng) * room);
    }
    shape_box(soup, low, high);
  }
}

static inline vxm_soup *thin_soup(vxm_context *owner, vxm_rng *rng, int kind, const vxm_space *space) {
  vxm_soup *soup = shape_empty(owner);
  thin_add_soup(soup, rng, kind, space);
  return soup;
}

static inline vxm_grid *thin_grid(const vxm_soup *soup, const vxm_space *space, vxm_thin_parts thin,
                                  vxm_voxelize_report *report) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.thin = thin;
  return engine_solid(soup, space, &options, report);
}

#endif

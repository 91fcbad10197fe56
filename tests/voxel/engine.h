/* SPDX-License-Identifier: BSD-3-Clause */
/** What the tests of the solid voxelizer share: an exact oracle for any lattice, random soups, and grids. */
#ifndef TEST_VOXEL_ENGINE_H
#define TEST_VOXEL_ENGINE_H

#include "shapes.h"

#include "base/context_struct.h"
#include "grid/bitgrid.h"
#include "voxel/lattice/lattice.h"
#include "voxel/model/voxelize.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- An oracle ---- */

/* Differences of coordinates stay below 2^41, so that determinants of three fit 127 bits. */
__extension__ typedef __int128 exact;

/** The first of the numbers that is not 0 decides; there always is one where it is asked. */
static inline int exact_sign(exact value, exact first, exact second, exact third) {
  exact chosen = value ? value : first ? first : second ? second : third;
  return (chosen > 0) - (chosen < 0);
}

/** Whether a triangle has the moved centre of column (p[u], p[v]) inside its projection along w: the centre
 * is moved by (e, e^2, e^3), so what it gains on a side is told by the axes in order. */
static inline bool exact_covers(const vxm_point t[3], const int64_t p[3], int u, int v) {
  int sum = 0;
  for (int s = 0; s < 3; s++) {
    const int64_t *a = t[s].at, *b = t[(s + 1) % 3].at;
    exact du = b[u] - a[u], dv = b[v] - a[v];
    exact side = du * (p[v] - a[v]) - dv * (p[u] - a[u]);
    sum += u < v ? exact_sign(side, -dv, du, 0) : exact_sign(side, du, -dv, 0);
  }
  return sum == 3 || sum == -3;
}

/** Whether the moved point p lies beyond the plane of a triangle that is not parallel to w, along w. */
static inline bool exact_beyond(const vxm_point t[3], const int64_t p[3], int w) {
  exact n[3], height = 0;
  for (int a = 0; a < 3; a++) {
    int b = (a + 1) % 3, c = (a + 2) % 3;
    n[a] = (exact)(t[1].at[b] - t[0].at[b]) * (t[2].at[c] - t[0].at[c]) -
           (exact)(t[1].at[c] - t[0].at[c]) * (t[2].at[b] - t[0].at[b]);
  }
  for (int a = 0; a < 3; a++)
    height += n[a] * (p[a] - t[0].at[a]);
  return (exact_sign(height, n[0], n[1], n[2]) > 0) == (n[w] > 0);
}

/** Flips the voxels (a byte each, x fastest) that have the triangle before them along w. */
static inline void exact_flip(uint8_t *out, const vxm_lattice *lattice, const vxm_point t[3], int w) {
  const int64_t *dims = lattice->space.dims;
  size_t step[3] = {1, (size_t)dims[0], (size_t)(dims[0] * dims[1])};
  int u = (w + 1) % 3, v = (w + 2) % 3;
  int64_t i[3], p[3];
  for (i[u] = 0; i[u] < dims[u]; i[u]++)
    for (i[v] = 0; i[v] < dims[v]; i[v]++) {
      p[u] = vxm_lattice_centre(lattice, i[u]);
      p[v] = vxm_lattice_centre(lattice, i[v]);
      if (!exact_covers(t, p, u, v))
        continue;
      for (i[w] = 0; i[w] < dims[w]; i[w]++) {
        p[w] = vxm_lattice_centre(lattice, i[w]);
        out[(size_t)i[0] * step[0] + (size_t)i[1] * step[1] + (size_t)i[2] * step[2]] ^=
            exact_beyond(t, p, w);
      }
    }
}

/** Adds to `out` the voxels that have an odd number of the triangles face_begin..face_end-1 before them. */
static inline void exact_unite(uint8_t *out, const vxm_soup *soup, size_t face_begin, size_t face_end,
                               const vxm_space *space, int w) {
  vxm_lattice lattice = vxm_lattice_of(space);
  size_t count = (size_t)(space->dims[0] * space->dims[1] * space->dims[2]);
  uint8_t *parity = calloc(count, 1);
  assert_non_null(parity);
  for (size_t f = face_begin; f < face_end; f++) {
    size_t n;
    const uint32_t *corner = vxm_face(soup, f, &n);
    vxm_point t[3];
    assert_int_equal(n, 3);
    for (int k = 0; k < 3; k++)
      assert_true(vxm_lattice_place(&lattice, vxm_position(soup, corner[k]), &t[k]));
    exact_flip(parity, &lattice, t, w);
  }
  for (size_t i = 0; i < count; i++)
    out[i] |= parity[i];
  free(parity);
}

static inline void assert_grid_is(const vxm_grid *grid, const uint8_t *voxels) {
  const int64_t *dims = grid->space.dims;
  for (int64_t k = 0; k < dims[2]; k++)
    for (int64_t j = 0; j < dims[1]; j++)
      for (int64_t i = 0; i < dims[0]; i++)
        if (vxm_grid_get(grid, i, j, k) != voxels[(k * dims[1] + j) * dims[0] + i])
          fail_msg("voxel %lld %lld %lld of %lld x %lld x %lld differs", (long long)i, (long long)j,
                   (long long)k, (long long)dims[0], (long long)dims[1], (long long)dims[2]);
}

/* ---- Grids ---- */

static inline vxm_context *context_of(int threads, uint64_t limit) {
  vxm_context_options options = VXM_CONTEXT_OPTIONS_INIT;
  options.threads = threads;
  options.memory_limit = limit;
  vxm_context *made;
  assert_int_equal(vxm_context_create(&made, &options, NULL), VXM_OK);
  return made;
}

/** Leaves a context so many bytes; SIZE_MAX lifts the limit. */
static inline void leave_memory(vxm_context *owner, size_t left) {
  size_t used = atomic_load(&owner->used);
  owner->limit = left > SIZE_MAX - used ? SIZE_MAX : used + left;
}

static inline size_t memory_used(vxm_context *owner) {
  return atomic_load(&owner->used);
}

static inline vxm_space engine_space(int64_t nx, int64_t ny, int64_t nz) {
  return (vxm_space){{nx, ny, nz}, {0, 0, 0}, {1, 1, 1}};
}

static inline vxm_grid *engine_grid(vxm_context *owner, const vxm_space *space) {
  vxm_grid *grid;
  assert_int_equal(vxm_grid_create(&grid, owner, space, NULL), VXM_OK);
  return grid;
}

static inline vxm_model *engine_model(const vxm_soup *soup, const vxm_voxelize_options *options) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_model *model;
  if (vxm_model_create(&model, soup, options, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return model;
}

/** A grid of a new model. */
static inline vxm_grid *engine_solid(const vxm_soup *soup, const vxm_space *space,
                                     const vxm_voxelize_options *options, vxm_voxelize_report *report) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid;
  vxm_voxelize_options chosen = *options;
  vxm_space_options space_options = VXM_SPACE_OPTIONS_INIT;
  space_options.like = space;
  if (vxm_voxelize(&grid, report, soup, &space_options, &chosen, &error) != VXM_OK)
    fail_msg("%s", error.text);
  return grid;
}

/** Voxel centres by one method. */
static inline vxm_grid *engine_method(const vxm_soup *soup, const vxm_space *space, vxm_method method,
                                      vxm_split_mode parts, vxm_voxelize_report *report) {
  vxm_voxelize_options options = VXM_VOXELIZE_OPTIONS_INIT;
  options.method = method;
  options.split_mode = parts;
  options.thin = VXM_THIN_DROP;
  return engine_solid(soup, space, &options, report);
}

static inline void assert_equal_bits(const vxm_grid *a, const vxm_grid *b) {
  assert_memory_equal(a->space.dims, b->space.dims, sizeof a->space.dims);
  assert_memory_equal(a->words, b->words, a->word_count * sizeof *a->words);
  for (size_t w = a->row_words - 1; w < a->word_count; w += a->row_words)
    assert_int_equal(a->words[w] & ~vxm_grid_tail_mask(a), 0);
}

static inline void assert_equal_reports(const vxm_voxelize_report *a, const vxm_voxelize_report *b) {
  assert_int_equal(a->parts, b->parts);
  assert_int_equal(a->closed_parts, b->closed_parts);
  assert_int_equal(a->capped_parts, b->capped_parts);
  assert_int_equal(a->cavities, b->cavities);
  assert_int_equal(a->caps, b->caps);
  assert_int_equal(a->contested, b->contested);
  assert_int_equal(a->winding_decided, b->winding_decided);
  assert_int_equal(a->voxels, b->voxels);
  assert_true(a->hash == b->hash);
  assert_int_equal(a->empty_parts, b->empty_parts);
  assert_int_equal(a->outside_parts, b->outside_parts);
}

/* ---- Soups ---- */

/** A point of a box, sometimes at the centre of a voxel so that ties are met. */
static inline uint32_t random_vertex(vxm_soup *soup, vxm_rng *rng, const double low[3],
                                     const double high[3]) {
  double p[3];
  bool tie = vxm_rng_below(rng, 4) == 0;
  for (int a = 0; a < 3; a++) {
    p[a] = low[a] + vxm_rng_unit(rng) * (high[a] - low[a]);
    p[a] = tie ? floor(p[a]) + 0.5 : p[a];
  }
  return shape_vertex(soup, p[0], p[1], p[2]);
}

/** An octahedron's faces on random corners, without the last `missing` of them. */
static inline void random_octahedron(vxm_soup *soup, vxm_rng *rng, const double low[3], const double high[3],
                                     uint32_t missing) {
  uint32_t v[6];
  for (int i = 0; i < 6; i++)
    v[i] = random_vertex(soup, rng, low, high);
  for (uint32_t f = 0; f < 8 - missing; f++)
    shape_triangle(soup, v[4 + f / 4], v[f % 4], v[(f + 1) % 4]);
}

/** A box of twelve triangles, the last `missing` of them left out, turned inside out if asked. */
static inline void triangle_box(vxm_soup *soup, const double low[3], const double high[3], uint32_t missing,
                                bool inward) {
  static const int quad[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                 {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  uint32_t v[8];
  for (int i = 0; i < 8; i++)
    v[i] = shape_vertex(soup, i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]);
  for (uint32_t t = 0; t < 12 - missing; t++) {
    const int *q = quad[t / 2];
    uint32_t b = v[q[1 + t % 2]], c = v[q[2 + t % 2]];
    shape_triangle(soup, v[q[0]], inward ? c : b, inward ? b : c);
  }
}

enum { SOUP_KINDS = 8 };

/** Closed, open, many-part, nested and outlying soups about a grid of unit voxels. */
static inline vxm_soup *random_soup(vxm_context *owner, uint64_t seed, int kind, const vxm_space *space) {
  vxm_rng rng = {seed};
  vxm_soup *soup = shape_empty(owner);
  double n[3], low[3], high[3], out_low[3], out_high[3], centre[3];
  for (int a = 0; a < 3; a++) {
    n[a] = (double)space->dims[a];
    low[a] = 0.1 * n[a];
    high[a] = 0.9 * n[a];
    out_low[a] = -0.4 * n[a] - 2;
    out_high[a] = 1.4 * n[a] + 2;
    centre[a] = n[a] / 2;
  }
  double least = fmin(n[0], fmin(n[1], n[2]));
  switch (kind) {
  case 0: /* closed, mostly cutting through itself */
    random_octahedron(soup, &rng, low, high, 0);
    break;
  case 1: /* the same, reaching beyond the grid on all sides */
    for (int i = 0; i < 3; i++)
      random_octahedron(soup, &rng, out_low, out_high, 0);
    break;
  case 2: /* a body with a hole */
    shape_torus(soup, 18, 9, 0.3 * least, 0.15 * least, centre);
    soup->face_count -= 1 + vxm_rng_below(&rng, 4);
    soup->corner_count = soup->offsets[soup->face_count];
    break;
  case 3: /* open sheets, each of its own vertices or not */
    for (int v = 0; v < 12; v++)
      random_vertex(soup, &rng, out_low, out_high);
    for (int f = 0; f < 7; f++) {
      uint32_t a = (uint32_t)vxm_rng_below(&rng, 12);
      shape_triangle(soup, a, (a + 1 + (uint32_t)vxm_rng_below(&rng, 5)) % 12, (a + 6) % 12);
    }
    break;
  case 4: /* dozens of tiny parts, closed and open */
    for (int i = 0; i < 60; i++) {
      double at[3], end[3];
      for (int a = 0; a < 3; a++) {
        at[a] = vxm_rng_unit(&rng) * n[a] - 1;
        end[a] = at[a] + 0.5 + 3 * vxm_rng_unit(&rng);
      }
      random_octahedron(soup, &rng, at, end, i % 5 == 4 ? 2 : 0);
    }
    break;
  case 5: /* boxes in boxes, every other one a cavity by its winding, and an open one across them */
    for (int i = 0; i < 5; i++) {
      double at[3], end[3], inset = 0.45 * i / 5;
      for (int a = 0; a < 3; a++) {
        at[a] = inset * n[a] + 0.25;
        end[a] = (1 - inset) * n[a] - 0.25;
      }
      triangle_box(soup, at, end, 0, i % 2 != 0);
    }
    triangle_box(soup, low, (double[]){n[0] + 2, high[1], n[2] / 2}, 2, false);
    break;
  case 6: /* closed and open parts over each other */
    for (uint32_t i = 0; i < 6; i++)
      random_octahedron(soup, &rng, i % 2 ? low : out_low, i % 2 ? high : out_high,
                        i % 3 == 0 ? 1 + i / 3 : 0);
    break;
  default: /* one open part with a large hole, and one behind the grid */
    triangle_box(soup, low, high, 1 + (uint32_t)vxm_rng_below(&rng, 3), false);
    triangle_box(soup, (double[]){2 * n[0] + 3, 0, 0}, (double[]){2 * n[0] + 9, n[1], n[2]}, 0, false);
  }
  return soup;
}

#endif

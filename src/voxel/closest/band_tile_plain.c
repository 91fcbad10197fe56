/* SPDX-License-Identifier: BSD-3-Clause */
/** Tiles of distances for any processor. */
#include "base/neon.h"
#include "voxel/closest/band_tile.h"

#include <math.h>
#include <string.h>

#define LANES 2
#define WIDTH 4
#define ACROSS 2
#define DOWN 2
#define DEEP 1
#define BUILD(name) name##_plain

typedef float wide __attribute__((vector_size(4 * WIDTH)));
typedef float narrow __attribute__((vector_size(4 * LANES)));
typedef double lanes __attribute__((vector_size(8 * LANES)));
typedef int64_t lanes_int __attribute__((vector_size(8 * LANES)));
typedef double lanes_loaded __attribute__((vector_size(8 * LANES), aligned(8), may_alias));
typedef int32_t wide_mask __attribute__((vector_size(4 * WIDTH)));

#define INLINE static inline __attribute__((always_inline))
#define UNROLL _Pragma("GCC unroll 8")

typedef float eight __attribute__((vector_size(32)));
typedef float eight_stored __attribute__((vector_size(32), aligned(4), may_alias));
typedef int32_t eight_int __attribute__((vector_size(32)));

INLINE eight eight_choose(eight_int mask, eight a, eight b) {
  return (eight)((mask & (eight_int)a) | (~mask & (eight_int)b));
}

INLINE eight eight_max(eight a, eight b) {
  return eight_choose(a > b, a, b);
}

INLINE eight eight_min(eight a, eight b) {
  return eight_choose(a < b, a, b);
}

INLINE eight eight_root(eight x) {
  for (int n = 0; n < 8; n++)
    x[n] = sqrtf(x[n]);
  return x;
}

INLINE unsigned eight_bits(eight_int mask) {
  unsigned bits = 0;
  for (unsigned n = 0; n < 8; n++)
    bits |= (unsigned)(mask[n] & 1) << n;
  return bits;
}

INLINE float eight_least(eight x) {
  float least = x[0];
  for (int n = 1; n < 8; n++)
    least = x[n] < least ? x[n] : least;
  return least;
}

INLINE float eight_sum(eight x) {
  float sum = 0;
  for (int n = 0; n < 8; n++)
    sum += x[n];
  return sum;
}

/** Of eight points with a number to spare. */
INLINE void eight_columns(eight out[3], const float (*points)[4]) {
  for (int n = 0; n < 8; n++)
    for (int a = 0; a < 3; a++)
      out[a][n] = points[n][a];
}

/** Rows become columns. */
INLINE void eight_transpose(eight x[8]) {
  float rows[8][8];
  memcpy(rows, x, sizeof rows);
  for (int n = 0; n < 8; n++)
    for (int k = 0; k < 8; k++)
      x[n][k] = rows[k][n];
}

typedef double four __attribute__((vector_size(32)));
typedef int64_t four_mask __attribute__((vector_size(32)));

/** Three numbers, and zero. */
INLINE four four_load3(const double *from) {
  return (four){from[0], from[1], from[2], 0};
}

INLINE four four_max(four a, four b) {
  four_mask is_a = a > b;
  return (four)((is_a & (four_mask)a) | (~is_a & (four_mask)b));
}

INLINE four four_min(four a, four b) {
  four_mask is_a = a < b;
  return (four)((is_a & (four_mask)a) | (~is_a & (four_mask)b));
}

/** The greatest of the first three. */
INLINE double four_most(four x) {
  const double most = x[0] > x[1] ? x[0] : x[1];
  return most > x[2] ? most : x[2];
}

/** In floats. */
INLINE void four_store(float to[4], four x) {
  for (int n = 0; n < 4; n++)
    to[n] = (float)x[n];
}

INLINE wide wide_max(wide a, wide b) {
  wide_mask is_a = a > b;
  return (wide)((is_a & (wide_mask)a) | (~is_a & (wide_mask)b));
}

INLINE wide wide_min(wide a, wide b) {
  wide_mask is_a = a < b;
  return (wide)((is_a & (wide_mask)a) | (~is_a & (wide_mask)b));
}

INLINE wide wide_size(wide x) {
  return (wide)((wide_mask)x & INT32_MAX);
}

/** How far a number is beyond a half, which is not below 0: either way from 0. */
INLINE wide wide_beyond(wide x, wide half) {
  return wide_max(wide_size(x), half) - half;
}

INLINE wide wide_fma(wide a, wide b, wide c) {
  return a * b + c;
}

INLINE wide_mask wide_not_above(wide a, wide b) {
  return ~(a > b);
}

INLINE wide wide_choose(wide_mask mask, wide a, wide b) {
  return (wide)((mask & (wide_mask)a) | (~mask & (wide_mask)b));
}

/** On which side of a triangle's middle points lie. */
typedef wide_mask wide_side;

INLINE wide_side side_of(wide x) {
  return x < (wide){0};
}

/** What is so on that side: the first of two is for those that are not below. */
INLINE wide pick_side(wide_side side, const float sides[2]) {
  return wide_choose(side, sides[1] - (wide){0}, sides[0] - (wide){0});
}

INLINE unsigned wide_bits(wide_mask mask) {
#if defined(__SSE__) && defined(__GNUC__)
  return (unsigned)__builtin_ia32_movmskps((wide)mask);
#elif VXM_NEON
  return vxm_neon_signs4((int32x4_t)mask);
#else
  unsigned bits = 0;
  for (unsigned n = 0; n < WIDTH; n++)
    bits |= (unsigned)(mask[n] & 1) << n;
  return bits;
#endif
}

/** Puts the voxels of a brick that have a bit behind `count` others. */
INLINE void gather(vxm_band_gathered *to, size_t count, const wide q[3], int32_t first, unsigned bits) {
  for (; bits; bits &= bits - 1, count++) {
    const int lane = __builtin_ctz(bits);
    for (int a = 0; a < 3; a++)
      to->at[a][count] = q[a][lane];
    to->place[count] = first + lane;
  }
}

/** Puts a triangle and the voxels of a group that have a bit behind `count` other pairs; returns how many
 * there are then. Others come along, so that all lanes have the same triangle. */
INLINE size_t add_pairs(vxm_band_pairs *to, size_t count, int32_t triangle, const int32_t *place,
                        unsigned bits) {
  for (int n = 0; n < WIDTH; n += LANES) {
    memcpy(to->place + count, place + n, LANES * sizeof *place);
    to->triangle[count] = triangle;
    count += bits >> n & ((1U << LANES) - 1) ? LANES : 0;
  }
  return count;
}

/** Keeps two numbers of triangles from one that is a multiple of LANES on: those of each side by side. */
INLINE void lanes_put(double *to, size_t triangle, lanes a, lanes b) {
  to += 2 * triangle;
  for (int n = 0; n < LANES; n++, to += 2) {
    to[0] = a[n];
    to[1] = b[n];
  }
}

/** The two numbers of a triangle, which is the same in each lane. */
INLINE void lanes_pick(lanes out[2], const double *from, const int32_t *which) {
  for (int n = 0; n < 2; n++)
    out[n] = from[2 * which[0] + n] - (lanes){0};
}

INLINE wide wide_gather(const float *from, const int32_t *place) {
  return (wide){from[place[0]], from[place[1]], from[place[2]], from[place[3]]};
}

INLINE unsigned lanes_bits(lanes_int mask) {
  return (unsigned)(mask[0] & 1) | (unsigned)(mask[1] & 2);
}

INLINE lanes lanes_choose(lanes_int mask, lanes a, lanes b) {
  return (lanes)((mask & (lanes_int)a) | (~mask & (lanes_int)b));
}

INLINE lanes lanes_max(lanes a, lanes b) {
  return lanes_choose(a > b, a, b);
}

INLINE lanes lanes_min(lanes a, lanes b) {
  return lanes_choose(a < b, a, b);
}

INLINE lanes lanes_root(lanes x) {
#if VXM_NEON
  return (lanes)vsqrtq_f64((float64x2_t)x);
#else
  return (lanes){sqrt(x[0]), sqrt(x[1])};
#endif
}

/** Not all processors can store past the cache. */
INLINE void store_streaming(float *to, narrow x) {
  memcpy(to, &x, sizeof x);
}

INLINE void end_streaming(void) {
}

#include "voxel/closest/band_tile_body.inc"

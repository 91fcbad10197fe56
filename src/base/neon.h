/* SPDX-License-Identifier: BSD-3-Clause */
/** What kernels take of NEON by name, as they take SSE2 of x86; the rest are the compiler's own vectors, of
 * which it makes NEON by itself. Without NEON, and where lanes are numbered from the other end, VXM_NEON is
 * 0. */
#ifndef VXM_BASE_NEON_H
#define VXM_BASE_NEON_H

#if defined(__aarch64__) && defined(__ARM_NEON) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
#define VXM_NEON 1

#include <arm_neon.h>

/** Bit i is the highest bit of number i. */
static inline __attribute__((always_inline)) unsigned vxm_neon_signs4(int32x4_t numbers) {
  const int32x4_t places = {0, 1, 2, 3};
  return vaddvq_u32(vshlq_u32(vshrq_n_u32((uint32x4_t)numbers, 31), places));
}

static inline __attribute__((always_inline)) unsigned vxm_neon_signs2(int64x2_t numbers) {
  uint64x2_t bits = vshrq_n_u64((uint64x2_t)numbers, 63);
  return (unsigned)(vgetq_lane_u64(bits, 0) | vgetq_lane_u64(bits, 1) << 1);
}

/** Bit i is the lowest bit of number i of both, one behind the other. */
static inline __attribute__((always_inline)) unsigned vxm_neon_lowest16(int16x8_t low, int16x8_t high) {
  const int8x16_t places = {0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7};
  uint8x16_t bits = vreinterpretq_u8_s8(vcombine_s8(vmovn_s16(low), vmovn_s16(high)));
  bits = vshlq_u8(vandq_u8(bits, vdupq_n_u8(1)), places);
  return (unsigned)vaddv_u8(vget_low_u8(bits)) | (unsigned)vaddv_u8(vget_high_u8(bits)) << 8;
}

/** The first two of four ints as doubles, which hold them exactly. */
static inline __attribute__((always_inline)) float64x2_t vxm_neon_doubles(int32x4_t numbers) {
  return vcvtq_f64_s64(vmovl_s32(vget_low_s32(numbers)));
}

#else
#define VXM_NEON 0
#endif

#endif

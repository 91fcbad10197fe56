/* SPDX-License-Identifier: BSD-3-Clause */
/** Numbers of either byte order at any address. */
#ifndef VXM_MESHIO_BYTES_H
#define VXM_MESHIO_BYTES_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/** Whether numbers of the given byte order must be turned round on this machine. */
static inline bool vxm_must_swap(bool big_endian) {
  return big_endian != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
}

static inline uint16_t vxm_load_u16(const void *at, bool swap) {
  uint16_t value;
  memcpy(&value, at, sizeof value);
  return swap ? __builtin_bswap16(value) : value;
}

static inline uint32_t vxm_load_u32(const void *at, bool swap) {
  uint32_t value;
  memcpy(&value, at, sizeof value);
  return swap ? __builtin_bswap32(value) : value;
}

static inline uint64_t vxm_load_u64(const void *at, bool swap) {
  uint64_t value;
  memcpy(&value, at, sizeof value);
  return swap ? __builtin_bswap64(value) : value;
}

static inline float vxm_load_f32(const void *at, bool swap) {
  uint32_t bits = vxm_load_u32(at, swap);
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static inline double vxm_load_f64(const void *at, bool swap) {
  uint64_t bits = vxm_load_u64(at, swap);
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static inline void vxm_store_u32(void *at, uint32_t value, bool swap) {
  if (swap)
    value = __builtin_bswap32(value);
  memcpy(at, &value, sizeof value);
}

static inline void vxm_store_f32(void *at, float value, bool swap) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  vxm_store_u32(at, bits, swap);
}

static inline void vxm_store_f64(void *at, double value, bool swap) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  if (swap)
    bits = __builtin_bswap64(bits);
  memcpy(at, &bits, sizeof bits);
}

#endif

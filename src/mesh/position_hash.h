/* SPDX-License-Identifier: BSD-3-Clause */
/** A hash of three numbers, by their bits. */
#ifndef VXM_MESH_POSITION_HASH_H
#define VXM_MESH_POSITION_HASH_H

#include "base/hash.h"

#include <string.h>

/** The bits of a coordinate; adding 0.0 turns -0.0 into 0.0 and changes nothing else. */
static inline uint64_t vxm_coordinate_bits(double x) {
  double plain = x + 0.0;
  uint64_t bits;
  memcpy(&bits, &plain, sizeof bits);
  return bits;
}

/** Numbers that are equal have the same, whatever their signs of zero. One mixing serves all three, as it is
 * made for each vertex of a mesh. */
static inline uint64_t vxm_position_hash(double x, double y, double z) {
  uint64_t a = vxm_coordinate_bits(x) * UINT64_C(0x9e3779b97f4a7c15),
           b = vxm_coordinate_bits(y) * UINT64_C(0xc2b2ae3d27d4eb4f),
           c = vxm_coordinate_bits(z) * UINT64_C(0x165667b19e3779f9);
  return vxm_mix(a ^ (b << 21 | b >> 43) ^ (c << 42 | c >> 22));
}

#endif

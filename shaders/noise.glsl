/* SPDX-License-Identifier: BSD-3-Clause */
/* Perlin's noise in three dimensions (Perlin 2002): gradients to the middles of a cube's edges, blended by a curve of
   the fifth degree; chosen by a hash of the corner rather than by a table. src/voxel/labels/color.c has the same. */
float corner_gradient(ivec3 corner, vec3 p) {
  uint h = uint(corner.x) * 0x8da6b343u ^ uint(corner.y) * 0xd8163841u ^ uint(corner.z) * 0xcb1ab31fu;
  h ^= h >> 13;
  h *= 0x5bd1e995u;
  h ^= h >> 15;
  h %= 12u;
  float a = h < 8u ? p.x : p.y, b = h < 4u ? p.y : p.z;
  return ((h & 1u) != 0u ? -a : a) + ((h & 2u) != 0u ? -b : b);
}

/* -1 to 1; 0 where all three numbers are whole. */
float noise(vec3 p) {
  vec3 whole = floor(p), f = p - whole, w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
  ivec3 c = ivec3(whole);
  float value[8];
  for (int i = 0; i < 8; i++) {
    ivec3 d = ivec3(i & 1, (i >> 1) & 1, i >> 2);
    value[i] = corner_gradient(c + d, f - vec3(d));
  }
  float low = mix(mix(value[0], value[1], w.x), mix(value[2], value[3], w.x), w.y);
  float high = mix(mix(value[4], value[5], w.x), mix(value[6], value[7], w.x), w.y);
  return mix(low, high, w.z);
}

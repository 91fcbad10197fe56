/* SPDX-License-Identifier: BSD-3-Clause */
/* Flips the bits that the CPU found, for triangles beyond the numbers of the shaders. */
layout(local_size_x = 64) in;
layout(std430, binding = 3) buffer Bits {
  uint word[];
} bits;
layout(std430, binding = 4) readonly buffer Flips {
  uint bit[];
} flips;
layout(location = 0) uniform uint count;

void main() {
  uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  if (i < count)
    atomicXor(bits.word[flips.bit[i] >> 5], 1u << (flips.bit[i] & 31u));
}

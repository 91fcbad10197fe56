/* SPDX-License-Identifier: BSD-3-Clause */
/* Prefix XOR within rows of words: bits become the parity of all flips up to them. The flips are cleared. */
layout(local_size_x = 64) in;
layout(std430, binding = 3) buffer Flips {
  uint word[];
} flips;
layout(std430, binding = 5) buffer Inside {
  uint word[];
} inside;
layout(location = 0) uniform uvec4 shape; // rows, words of a row, words of it that hold voxels, bits of the last
layout(location = 1) uniform uint is_added; // OR into what is there

void main() {
  uint row = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  if (row >= shape.x)
    return;
  uint carry = 0u, at = row * shape.y;
  for (uint w = 0u; w < shape.y; w++, at++) {
    uint x = flips.word[at];
    if (x != 0u)
      flips.word[at] = 0u;
    x ^= x << 1;
    x ^= x << 2;
    x ^= x << 4;
    x ^= x << 8;
    x ^= x << 16;
    x ^= carry;
    carry = 0u - (x >> 31);
    if (w + 1u >= shape.z)
      x = w + 1u == shape.z ? x & shape.w : 0u;
    if (is_added == 0u)
      inside.word[at] = x;
    else if (x != 0u)
      inside.word[at] |= x;
  }
}

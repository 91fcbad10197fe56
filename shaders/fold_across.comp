/* SPDX-License-Identifier: BSD-3-Clause */
/* Prefix XOR from word to word, across rows or across slices. The flips are cleared. */
layout(local_size_x = 64) in;
layout(std430, binding = 3) buffer Flips {
  uint word[];
} flips;
layout(std430, binding = 5) buffer Inside {
  uint word[];
} inside;
layout(location = 0) uniform uvec4 shape; // lines, words side by side, from these to the next ones
layout(location = 1) uniform uint is_added;
layout(location = 2) uniform uvec4 line; // words of a line, from one to the next

void main() {
  uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  if (i >= shape.x)
    return;
  uint at = i / shape.y * shape.z + i % shape.y, x = 0u;
  for (uint k = 0u; k < line.x; k++, at += line.y) {
    uint flipped = flips.word[at];
    x ^= flipped;
    if (flipped != 0u)
      flips.word[at] = 0u;
    if (is_added == 0u)
      inside.word[at] = x;
    else if (x != 0u)
      inside.word[at] |= x;
  }
}

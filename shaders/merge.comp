/* SPDX-License-Identifier: BSD-3-Clause */
/* Adds the bits of a pass to what the passes before it made, and clears them. */
layout(local_size_x = 64) in;
layout(std430, binding = 3) buffer Pass {
  uint word[];
} pass_bits;
layout(std430, binding = 5) buffer Inside {
  uint word[];
} inside;
layout(location = 0) uniform uint count;
layout(location = 1) uniform uint is_added;

void main() {
  uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  if (i >= count)
    return;
  uint x = pass_bits.word[i];
  pass_bits.word[i] = 0u;
  inside.word[i] = is_added != 0u ? inside.word[i] | x : x;
}

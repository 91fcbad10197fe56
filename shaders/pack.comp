/* SPDX-License-Identifier: BSD-3-Clause */
/* Packs the presence of voxels in a few slices into bits: a word of 32 for each invocation. */
layout(local_size_x = 64) in;
#ifdef NORMALIZED
layout(binding = 0) uniform sampler2DArray presence;
#else
layout(binding = 0) uniform usampler2DArray presence;
#endif
layout(std430, binding = 3) buffer Bits {
  uint word[];
} bits;
layout(location = 0) uniform uvec4 shape;     // words; words of a row; rows of a slice; voxels along a row
layout(location = 1) uniform uvec4 places;    // which of u, v, w bits, rows and slices run along
layout(location = 2) uniform ivec4 first;     // what comes before the texture along u, v, w, in voxels of the slab
layout(location = 3) uniform ivec4 size;      // of the texture

void main() {
  uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  if (i >= shape.x)
    return;
  uint row = i / shape.y, found = 0u;
  ivec3 at;
  at[places.y] = int(row % shape.z);
  at[places.z] = int(row / shape.z);
  int begin = int(i % shape.y) * 32;
  at[places.x] = clamp(first[places.x], begin, begin + 31); // are these rows in the texture at all?
  if (any(lessThan(at, first.xyz)) || any(greaterThanEqual(at, first.xyz + size.xyz)))
    return;
  for (int b = 0; b < 32 && begin + b < int(shape.w); b++) {
    at[places.x] = begin + b;
    ivec3 texel = at - first.xyz;
    if (any(lessThan(texel, ivec3(0))) || any(greaterThanEqual(texel, size.xyz)))
      continue;
#ifdef NORMALIZED
    bool is_set = texelFetch(presence, texel, 0).x > 0.5;
#else
    bool is_set = (texelFetch(presence, texel, 0).x & 1u) != 0u;
#endif
    if (is_set)
      found |= 1u << b;
  }
  if (found != 0u)
    bits.word[i] |= found;
}

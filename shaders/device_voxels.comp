/* SPDX-License-Identifier: BSD-3-Clause */
/* Bits that stay on the device become texels: words of 32 voxels along x. */
layout(local_size_x = 64) in;
layout(std430, binding = 3) readonly buffer Bits {
  uint word[];
} bits;
layout(binding = 0) writeonly uniform uimage3D whole;
layout(binding = 1) writeonly uniform image3D real;
layout(location = 0) uniform uint count;
layout(location = 1) uniform uvec4 shape; // words of a row, rows of a slice, voxels of a row; 0 = packed, 1, 2 = floats

void main() {
  uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  if (i >= count)
    return;
  uint row = i / shape.x, column = 32u * (i % shape.x), word = bits.word[i];
  if (column >= shape.z)
    return;
  ivec3 at = ivec3(column / 32u, row % shape.y, row / shape.y);
  if (shape.w == 0u) {
    imageStore(whole, at, uvec4(word, 0u, 0u, 0u));
    return;
  }
  for (uint b = column; b < min(shape.z, column + 32u); b++) {
    uint voxel = word >> (b - column) & 1u;
    at.x = int(b);
    if (shape.w == 1u)
      imageStore(whole, at, uvec4(voxel, 0u, 0u, 0u));
    else
      imageStore(real, at, vec4(float(voxel), 0.0, 0.0, 0.0));
  }
}

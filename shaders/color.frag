/* SPDX-License-Identifier: BSD-3-Clause */
/* The colours of a slice across x: a fragment for each voxel, z along rows and y from row to row. The function
   color() is put before this. */
layout(std140, binding = 0) uniform Job {
  ivec4 dims;  // voxels along x, y, z; words of 32 in a row of bits
  ivec4 slice; // its number; whether there are parts
  vec4 origin; // of the grid; 1 / longest side
  vec4 size;   // of a voxel
} job;

layout(std430, binding = 3) readonly buffer Bits {
  uint word[];
} bits;
layout(std430, binding = 4) readonly buffer Parts {
  uint pair[]; // of the slice, 16 bits each
} parts;
layout(location = 0) out vec4 result;

void main() {
  ivec3 at = ivec3(job.slice.x, int(gl_FragCoord.y), int(gl_FragCoord.x));
  uint row = uint(at.y) + uint(job.dims.y) * uint(at.z);
  result = vec4(0.0);
  if ((bits.word[row * uint(job.dims.w) + uint(at.x >> 5)] >> (at.x & 31) & 1u) == 0u)
    return;
  uint i = uint(at.y * job.dims.z + at.z), part = 0u;
  if (job.slice.y != 0)
    part = parts.pair[i >> 1] >> (16u * (i & 1u)) & 0xffffu;
  vec3 from_origin = (vec3(at) + 0.5) * job.size.xyz;
  result = vec4(color(job.origin.xyz + from_origin, from_origin * job.origin.w, part), 1.0);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/* Bits that stay on the device become a byte or a float each: a work-item takes a word of 32. Of `shape` x is the words
   of a row, y its voxels; rows of results follow each other from element `first` on. */
__kernel void voxels_to_bytes(__global const uint *bits, __global uchar *out, const uint2 shape, const ulong first,
                         const ulong words) {
  ulong i = get_global_id(0);
  if (i >= words)
    return;
  uint column = 32 * (uint)(i % shape.x), word = bits[i];
  __global uchar *to = out + first + i / shape.x * shape.y;
  for (uint b = column; b < shape.y && b < column + 32; b++)
    to[b] = word >> (b - column) & 1;
}

__kernel void voxels_to_floats(__global const uint *bits, __global float *out, const uint2 shape, const ulong first,
                          const ulong words) {
  ulong i = get_global_id(0);
  if (i >= words)
    return;
  uint column = 32 * (uint)(i % shape.x), word = bits[i];
  __global float *to = out + first + i / shape.x * shape.y;
  for (uint b = column; b < shape.y && b < column + 32; b++)
    to[b] = word >> (b - column) & 1 ? 1.0f : 0.0f;
}

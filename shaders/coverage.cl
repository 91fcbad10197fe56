/* SPDX-License-Identifier: BSD-3-Clause */
/* How many voxels are set in each group of n x n x n (Schwarz & Seidel 2010, section 5.5): a work-item for each word of
   a row of groups. `shape`: words of a row, rows of groups in a slice of groups, groups of a row; `all`: work-items. */
__kernel void count_groups(__global const uint *words, __global ushort *counts, const uint4 shape, const uint n,
                           const uint all) {
  uint i = (uint)get_global_id(0);
  if (i >= all)
    return;
  uint w = i % shape.x, row = i / shape.x % shape.y, slice = i / shape.x / shape.y, per_word = 32 / n;
  uint found[16]; /* n is at least 2 */
  for (uint g = 0; g < 16; g++)
    found[g] = 0;
  uint mask = (1u << n) - 1;
  for (uint s = 0; s < n; s++)
    for (uint m = 0; m < n; m++) {
      uint word = words[((slice * n + s) * shape.y * n + row * n + m) * shape.x + w];
      for (uint g = 0; g < per_word && word != 0; g++, word >>= n)
        found[g] += (uint)popcount(word & mask);
    }
  ulong to = (ulong)(slice * shape.y + row) * shape.z;
  for (uint g = 0; g < per_word && w * per_word + g < shape.z; g++)
    counts[to + w * per_word + g] = (ushort)found[g];
}

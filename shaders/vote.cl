/* SPDX-License-Identifier: BSD-3-Clause */
/* Adds what the voters elect, and counts where they disagree: words of 32 voxels. The rule is 0 = all (and auto), 1 =
   majority, 2 = any. The tally is how many voxels are contested, and whether any was added. */
__kernel void vote(__global const uint *voter_x, __global const uint *voter_y, __global const uint *voter_z,
                   __global const uint *voter_t, __global uint *result, __global uint *tally,
                   const uint count, const uint rule) {
  __local uint contested, added;
  uint i = (uint)get_global_id(0);
  if (get_local_id(0) == 0) {
    contested = 0;
    added = 0;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (i < count) {
    uint x = voter_x[i], y = voter_y[i], z = voter_z[i], t = voter_t[i];
    uint some = x | y | z | t, every = x & y & z & t, before = result[i];
    uint elected = rule == 1 ? (x & y) | (z & (x | y)) : rule == 2 ? some : every;
    uint disagree = some & ~every & ~before;
    if ((elected & ~before) != 0) {
      result[i] = before | elected;
      atomic_or(&added, 1u);
    }
    if (disagree != 0)
      atomic_add(&contested, (uint)popcount(disagree));
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (get_local_id(0) == 0) {
    if (contested != 0)
      atomic_add(&tally[0], contested);
    if (added != 0)
      atomic_or(&tally[1], 1u);
  }
}

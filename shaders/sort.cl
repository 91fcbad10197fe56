/* SPDX-License-Identifier: BSD-3-Clause */
/* Prefix sums and a radix sort, of the usual shape: blocks by work-groups, sums of blocks by the same again. */
enum { SCAN_ITEMS = 8, SCAN_BLOCK = GROUP * SCAN_ITEMS, SORT_ROUNDS = 16, DIGITS = 16, MASKS = (GROUP + 31) / 32 };

/* Exclusive sums within blocks of data[from...]; the sum of each block to sums[to...]. */
__kernel void scan_blocks(__global uint *data, __global uint *sums, const uint from, const uint to,
                          const uint count) {
  __local uint total[GROUP];
  uint me = (uint)get_local_id(0), block = (uint)get_group_id(0) * SCAN_BLOCK;
  uint own[SCAN_ITEMS], sum = 0;
  for (uint i = 0; i < SCAN_ITEMS; i++) {
    uint at = block + me * SCAN_ITEMS + i;
    own[i] = sum;
    sum += at < count ? data[from + at] : 0;
  }
  total[me] = sum;
  for (uint step = 1; step < GROUP; step *= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    uint before = me >= step ? total[me - step] : 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    total[me] += before;
  }
  uint before = total[me] - sum;
  for (uint i = 0; i < SCAN_ITEMS; i++) {
    uint at = block + me * SCAN_ITEMS + i;
    if (at < count)
      data[from + at] = before + own[i];
  }
  if (me == GROUP - 1)
    sums[to + get_group_id(0)] = total[me];
}

/* Adds to each block what lies before it. */
__kernel void scan_add(__global uint *data, __global const uint *sums, const uint from, const uint to,
                       const uint count) {
  uint block = (uint)get_group_id(0) * SCAN_BLOCK, before = sums[to + get_group_id(0)];
  for (uint i = (uint)get_local_id(0); i < SCAN_BLOCK; i += GROUP)
    if (block + i < count)
      data[from + block + i] += before;
}

inline uint digit_of(ulong key, uint shift) {
  return (uint)(key >> shift) & (DIGITS - 1);
}

/* How often each digit occurs in the block of each group: counts[digit][group]. */
__kernel void sort_count(__global const ulong *keys, __global uint *counts, const uint shift, const uint count) {
  __local uint found[DIGITS];
  uint me = (uint)get_local_id(0), block = (uint)get_group_id(0) * GROUP * SORT_ROUNDS;
  for (uint d = me; d < DIGITS; d += GROUP)
    found[d] = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint round = 0; round < SORT_ROUNDS; round++) {
    uint at = block + round * GROUP + me;
    if (at < count)
      atomic_inc(&found[digit_of(keys[at], shift)]);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint d = me; d < DIGITS; d += GROUP)
    counts[d * (uint)get_num_groups(0) + (uint)get_group_id(0)] = found[d];
}

/* Puts keys and values where they belong by this digit, in the order in which they are: `starts` is the prefix sum of
   the counts. The rank among equals of a round is told by a mask of who has which digit. */
__kernel void sort_scatter(__global const ulong *keys, __global const uint *values, __global ulong *to_keys,
                           __global uint *to_values, __global const uint *starts, const uint shift,
                           const uint count) {
  __local uint next[DIGITS], who[DIGITS][MASKS];
  uint me = (uint)get_local_id(0), block = (uint)get_group_id(0) * GROUP * SORT_ROUNDS;
  for (uint d = me; d < DIGITS; d += GROUP)
    next[d] = starts[d * (uint)get_num_groups(0) + (uint)get_group_id(0)];
  for (uint round = 0; round < SORT_ROUNDS; round++) {
    uint at = block + round * GROUP + me;
    for (uint i = me; i < DIGITS * MASKS; i += GROUP)
      who[i / MASKS][i % MASKS] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    ulong key = at < count ? keys[at] : 0;
    uint digit = digit_of(key, shift);
    if (at < count)
      atomic_or(&who[digit][me / 32], 1u << (me % 32));
    barrier(CLK_LOCAL_MEM_FENCE);
    if (at < count) {
      uint to = next[digit] + (uint)popcount(who[digit][me / 32] & ((1u << (me % 32)) - 1));
      for (uint m = 0; m < me / 32; m++)
        to += (uint)popcount(who[digit][m]);
      to_keys[to] = key;
      to_values[to] = values[at];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint d = me; d < DIGITS; d += GROUP)
      for (uint m = 0; m < MASKS; m++)
        next[d] += (uint)popcount(who[d][m]);
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}

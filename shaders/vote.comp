/* SPDX-License-Identifier: BSD-3-Clause */
/* Adds what the voters elect, and counts where they disagree: words of 32 voxels. */
layout(local_size_x = 64) in;
layout(std430, binding = 3) readonly buffer VoterX {
  uint word[];
} voter_x;
layout(std430, binding = 4) readonly buffer VoterY {
  uint word[];
} voter_y;
layout(std430, binding = 5) buffer Result {
  uint word[];
} result;
layout(std430, binding = 6) readonly buffer VoterZ {
  uint word[];
} voter_z;
layout(std430, binding = 7) readonly buffer VoterT {
  uint word[];
} voter_t;
layout(location = 0) uniform uint count;
layout(location = 1) uniform uint rule; // 0 = all (and auto), 1 = majority, 2 = any
layout(std430, binding = 2) buffer Tally {
  uint contested, added;
} tally;

shared uint contested, added;

void main() {
  if (gl_LocalInvocationIndex == 0u) {
    contested = 0u;
    added = 0u;
  }
  barrier();
  uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  if (i < count) {
    uint x = voter_x.word[i], y = voter_y.word[i], z = voter_z.word[i], t = voter_t.word[i];
    uint some = x | y | z | t, every = x & y & z & t, before = result.word[i];
    uint elected = rule == 1u ? (x & y) | (z & (x | y)) : rule == 2u ? some : every;
    uint disagree = some & ~every & ~before;
    if ((elected & ~before) != 0u) {
      result.word[i] = before | elected;
      atomicOr(added, 1u);
    }
    if (disagree != 0u)
      atomicAdd(contested, uint(bitCount(disagree)));
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u) {
    if (contested != 0u)
      atomicAdd(tally.contested, contested);
    if (added != 0u)
      atomicOr(tally.added, 1u);
  }
}

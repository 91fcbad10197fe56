/* SPDX-License-Identifier: BSD-3-Clause */
/* Flips of a slab: a bit for each voxel. */
typedef __global uint Flips;

static inline void flip_bit(Flips *flips, const Job *job, int u, int v, int w) {
  if (w >= job->last[2] || (w < job->first[2] && !job->keep_before))
    return;
  uint bit = (uint)(u - job->first[0]) * job->step[0] + (uint)(v - job->first[1]) * job->step[1] +
             (uint)max(w - job->first[2], 0) * job->step[2];
  atomic_xor(&flips[bit >> 5], 1u << (bit & 31u));
}

/* SPDX-License-Identifier: BSD-3-Clause */
/* Solids, triangle by triangle (Schwarz & Seidel 2010, section 4.1): a work-item for each triangle flips a bit
   in each column that it covers; triangles of many columns are listed, and each gets a work-group of its own. */

__kernel void flip_columns(__global const int4 *points, __global const uint *corners,
                           __global const uint *order, __global uint *flips, __global uint *large,
                           const Job job) {
  uint i = (uint)get_global_id(0);
  Triangle t;
  if (i >= job.triangle_count)
    return;
  uint triangle = job.ordered ? order[job.triangle_first + i] : job.triangle_first + i;
  if (!load_triangle(&t, &job, points, corners, triangle))
    return;
  int4 area = columns_of(&t, &job);
  if (area.z <= area.x || area.w <= area.y)
    return;
  if ((long)(area.z - area.x) * (area.w - area.y) > job.few_columns) {
    large[1 + atomic_inc(&large[0])] = triangle;
    return;
  }
  flip_area(&t, &job, area, 0, 1, flips);
}

/* Work-groups take turns with the listed triangles; work-items with the rows of each. */
__kernel void flip_large(__global const int4 *points, __global const uint *corners, __global uint *flips,
                         __global const uint *large, const Job job) {
  uint count = large[0];
  for (uint i = (uint)get_group_id(0); i < count; i += (uint)get_num_groups(0)) {
    Triangle t;
    load_triangle(&t, &job, points, corners, large[1 + i]);
    flip_share(&t, &job, flips);
  }
}

/* Bits that the CPU found for triangles that reach far. */
__kernel void flip_bits(__global uint *flips, __global const uint *bits, const uint count) {
  uint i = (uint)get_global_id(0);
  if (i < count)
    atomic_xor(&flips[bits[i] >> 5], 1u << (bits[i] & 31u));
}

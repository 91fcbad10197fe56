/* SPDX-License-Identifier: BSD-3-Clause */
/* The voxels of an octree (Schwarz & Seidel 2010, sections 5.3 and 5.4): 64 bricks for each of its lowest
   nodes, in Morton order, voxel (x, y, z) of a brick bit 16 z + 4 y + x. */

enum { PART_MASK = 0x1fffffff /* of a triangle's number of part, above which is its role */ };

/* Whether a triangle has to be looked at: not to ask whether its part has a flip where it is known. */
static inline bool is_asked(__global const uint *parts, __global const uint *touched, uint triangle, uint asks) {
  return asks == 0 || touched[parts[triangle] & PART_MASK] == 0;
}

/* A triangle for each work-item; those of many columns are listed. Where it `asks`, nothing is flipped, and
   parts with a flip are noted; the parts of a pass flip other voxels each. */
__kernel void flip_bricks(__global const int4 *points, __global const uint *corners,
                          __global const uint *order, __global uint *bricks, __global const uint *cells,
                          __global const uint *before, __global const ulong *places, __global uint *large,
                          __global const uint *parts, __global uint *touched, const Job job,
                          const uint asks) {
  uint i = (uint)get_global_id(0);
  Triangle t;
  Flips flips = {bricks, cells, before, places, asks != 0, false};
  if (i >= job.triangle_count)
    return;
  uint triangle = job.ordered ? order[job.triangle_first + i] : job.triangle_first + i;
  if (!is_asked(parts, touched, triangle, asks) || !load_triangle(&t, &job, points, corners, triangle))
    return;
  int4 area = columns_of(&t, &job);
  if (area.z <= area.x || area.w <= area.y)
    return;
  if ((long)(area.z - area.x) * (area.w - area.y) > job.few_columns) {
    large[1 + atomic_inc(&large[0])] = triangle;
    return;
  }
  flip_area(&t, &job, area, 0, 1, &flips);
  if (flips.found)
    touched[parts[triangle] & PART_MASK] = 1;
}

/* Work-groups take turns with the listed triangles. */
__kernel void flip_bricks_large(__global const int4 *points, __global const uint *corners,
                                __global uint *bricks, __global const uint *cells,
                                __global const uint *before, __global const ulong *places,
                                __global const uint *large, __global const uint *parts,
                                __global uint *touched, const Job job, const uint asks) {
  uint count = large[0];
  for (uint i = (uint)get_group_id(0); i < count; i += (uint)get_num_groups(0)) {
    Triangle t;
    uint triangle = large[1 + i];
    Flips flips = {bricks, cells, before, places, asks != 0, false};
    if (!is_asked(parts, touched, triangle, asks))
      continue;
    load_triangle(&t, &job, points, corners, triangle);
    flip_share(&t, &job, &flips);
    if (flips.found)
      touched[parts[triangle] & PART_MASK] = 1;
  }
}

/* Carries flips along x through the bricks of nodes that follow each other, for each of the 4 x 4 rows of
   bricks; within a brick that is done. All columns of the grid agree where the nodes end. */
__kernel void fold_bricks(__global ulong *bricks, __global const uint *next, __global uint *exits,
                          const uint count) {
  size_t i = get_global_id(0);
  uint node = (uint)(i / 16), row = (uint)(i % 16);
  ulong carry = 0;
  if (node >= count || next[node] >> 31)
    return;
  const uint spread[4] = {0, 1, 8, 9};
  uint first = spread[row & 3] << 1 | spread[row >> 2] << 2;
  for (;;) {
    for (uint x = 0; x < 4; x++) {
      size_t at = 64 * (size_t)node + (first | spread[x]);
      ulong brick = bricks[at] ^ carry;
      bricks[at] = brick;
      carry = (brick >> 3 & 0x1111111111111111) * 15;
    }
    uint after = next[node] & 0x7fffffffu;
    bool is_last = after == 0x7fffffffu;
    if (row == 0)
      exits[node] = is_last ? (uint)carry & 1u : 0;
    if (is_last)
      return;
    node = after;
  }
}

/* What is inside by the parent is inside all over. `nodes`: how many, where their parents begin, whether they
   have any; and whether bricks stay, are moved to `united`, or added to it. */
__kernel void push_bricks(__global ulong *bricks, __global ulong *united, __global const ulong *codes,
                          __global const uint *parents, __global const uchar *inside, const uint4 nodes) {
  size_t i = get_global_id(0);
  uint node = (uint)(i / 64);
  if (node >= nodes.x)
    return;
  uint c = (uint)(codes[node] & 63), is_inside = 0;
  uint x = (c & 1) | (c >> 2 & 2), y = (c >> 1 & 1) | (c >> 3 & 2), z = (c >> 2 & 1) | (c >> 4 & 2);
  if (nodes.z)
    is_inside = inside[16 * (size_t)(nodes.y + parents[node]) + y + 4 * z] >> x & 1;
  ulong brick = bricks[i] ^ (is_inside ? ~(ulong)0 : 0);
  if (nodes.w == 0) {
    if (is_inside)
      bricks[i] = brick;
    return;
  }
  united[i] = nodes.w == 1 ? brick : united[i] | brick;
  bricks[i] = 0;
}

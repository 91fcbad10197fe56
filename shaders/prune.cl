/* SPDX-License-Identifier: BSD-3-Clause */
/* The octree in its canonical form (src/grid/octree.h): what is all empty or all full has no node, and voxels
   beyond the dimensions are clear. */

/* Coordinate of a code along an axis. */
inline uint along(ulong code, uint axis) {
  uint at = 0;
  code >>= axis;
  for (uint b = 0; code != 0; b++, code >>= 3)
    at |= (uint)(code & 1) << b;
  return at;
}

inline uint coordinate_of(uint child, uint axis) {
  return (child >> axis & 1) | (child >> (axis + 2) & 2);
}

/* Voxels of a brick that the space has: so many along each axis. */
inline ulong voxels_of(int x, int y, int z) {
  x = clamp(x, 0, 4);
  y = clamp(y, 0, 4);
  z = clamp(z, 0, 4);
  ulong slice = (ulong)(((1 << x) - 1) * 0x1111 & ((1 << (4 * y)) - 1));
  slice *= 0x0001000100010001;
  return z == 4 ? slice : slice & (((ulong)1 << (16 * z)) - 1);
}

/* Which bricks of nodes are mixed and which are full, 16 by a work-item. */
__kernel void prune_bricks(__global ulong *bricks, __global const ulong *codes, __global ushort *mixed,
                           __global ushort *full, const int4 dims, const uint count) {
  size_t i = get_global_id(0);
  if (i / 4 >= count)
    return;
  ulong code = codes[i / 4];
  int x = 16 * (int)along(code, 0), y = 16 * (int)along(code, 1), z = 16 * (int)along(code, 2);
  bool is_cut = x + 16 > dims.x || y + 16 > dims.y || z + 16 > dims.z;
  uint is_mixed = 0, is_full = 0;
  for (uint b = 0; b < 16; b++) {
    ulong brick = bricks[16 * i + b];
    if (is_cut) {
      uint child = 16 * (uint)(i % 4) + b;
      brick &= voxels_of(dims.x - x - 4 * (int)coordinate_of(child, 0),
                         dims.y - y - 4 * (int)coordinate_of(child, 1),
                         dims.z - z - 4 * (int)coordinate_of(child, 2));
      bricks[16 * i + b] = brick;
    }
    is_full |= (brick == ~(ulong)0 ? 1u : 0u) << b;
    is_mixed |= (brick != 0 && brick != ~(ulong)0 ? 1u : 0u) << b;
  }
  mixed[i] = (ushort)is_mixed;
  full[i] = (ushort)is_full;
}

/* The same of nodes whose children are nodes, which begin at `level.z`; a child is 2^`level.w` voxels wide.
   One that is not a node lies in the space or beyond it, as the border is made of nodes where it cuts
   something. */
__kernel void prune_nodes(__global const ulong *codes, __global const ulong *children,
                          __global const uint *firsts, __global const uchar *inside, __global ulong *mixed,
                          __global ulong *full, const int4 dims, const uint4 level) {
  uint i = (uint)get_global_id(0);
  if (i >= level.y)
    return;
  uint node = level.x + i;
  ulong mask = children[node], is_mixed = 0, is_full = 0;
  long x = 4 * (long)along(codes[node], 0), y = 4 * (long)along(codes[node], 1),
       z = 4 * (long)along(codes[node], 2);
  uint next = level.z + firsts[node];
  for (uint c = 0; c < 64; c++) {
    ulong bit = (ulong)1 << c;
    uint cx = coordinate_of(c, 0), cy = coordinate_of(c, 1), cz = coordinate_of(c, 2);
    if (mask & bit) {
      if (full[next] == ~(ulong)0)
        is_full |= bit;
      else if ((mixed[next] | full[next]) != 0)
        is_mixed |= bit;
      next++;
    } else if ((inside[16 * (size_t)node + cy + 4 * cz] >> cx & 1) && (x + cx) << level.w < dims.x &&
               (y + cy) << level.w < dims.y && (z + cz) << level.w < dims.z)
      is_full |= bit;
  }
  mixed[node] = is_mixed;
  full[node] = is_full;
}

inline bool stays(ulong mixed, ulong full) {
  return (mixed | full) != 0 && full != ~(ulong)0;
}

/* Counts the nodes of a level that stay or, where `of_children`, the mixed children of each. */
__kernel void count_kept(__global const ulong *mixed, __global const ulong *full, __global uint *kept,
                         const uint4 level, const uint of_children) {
  uint i = (uint)get_global_id(0);
  if (i >= level.y)
    return;
  ulong is_mixed = mixed[level.x + i];
  kept[i] = of_children ? (uint)popcount(is_mixed) : stays(is_mixed, full[level.x + i]) ? 1 : 0;
}

/* The nodes of a level, as the CPU has them: `kept` and `kept_below` count those that stay. `level.z`:
   whether children are bricks, `level.w`: whether it is the root, which stays in any case. */
__kernel void take_nodes(__global const ulong *mixed, __global const ulong *full, __global const uint *firsts,
                         __global const uint *kept, __global const uint *kept_below, __global ulong *taken,
                         const uint4 level) {
  uint i = (uint)get_global_id(0);
  if (i >= level.y)
    return;
  ulong is_mixed = mixed[level.x + i], is_full = full[level.x + i];
  if (level.w == 0 && !stays(is_mixed, is_full))
    return;
  size_t at = 3 * (size_t)kept[i];
  taken[at] = is_mixed;
  taken[at + 1] = is_full;
  taken[at + 2] = is_mixed == 0 ? 0 : kept_below[level.z ? i : firsts[level.x + i]];
}

/* The mixed bricks; `before` counts those of the nodes before. */
__kernel void take_bricks(__global const ulong *bricks, __global const ulong *mixed,
                          __global const uint *before, __global ulong *taken, const uint count) {
  size_t i = get_global_id(0), node = i / 64;
  if (node >= count)
    return;
  ulong mask = mixed[node], bit = (ulong)1 << (i % 64);
  if (mask & bit)
    taken[before[node] + (uint)popcount(mask & (bit - 1))] = bricks[i];
}

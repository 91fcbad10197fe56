/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The nodes of an octree above its cells (Schwarz & Seidel 2010, sections 5.2 and 5.4). A node has 4 x 4 x 4
 * children in Morton order, so that six bits of a code are one level. Nodes of all levels lie in one array,
 * level after level; `level` says for a kernel: where its nodes begin, how many there are, where those of the
 * level below or above begin.
 */

/* Counts the nodes of each level above: a node begins where the code without the bits below is another. */
__kernel void count_nodes(__global const ulong *codes, __global uint *counts, const uint count,
                          const uint levels) {
  uint i = (uint)get_global_id(0);
  if (i >= count)
    return;
  for (uint l = 1; l < levels; l++) {
    if (i > 0 && ((codes[i] ^ codes[i - 1]) >> (6 * l)) == 0)
      break;
    atomic_inc(&counts[l]);
  }
}

inline bool begins_parent(__global const ulong *codes, uint i) {
  return i == 0 || (codes[i] >> 6) != (codes[i - 1] >> 6);
}

__kernel void flag_parents(__global const ulong *codes, __global uint *flags, const uint4 level) {
  uint i = (uint)get_global_id(0);
  if (i < level.y)
    flags[i] = begins_parent(codes + level.x, i) ? 1 : 0;
}

/* `before` is the prefix sum of the flags; `level.z` is where the parents begin. */
__kernel void make_parents(__global ulong *codes, __global const uint *before, __global uint *parents,
                           __global ulong *children, __global uint *firsts, const uint4 level) {
  uint i = (uint)get_global_id(0);
  if (i >= level.y)
    return;
  __global const ulong *own = codes + level.x;
  bool is_first = begins_parent(own, i);
  uint parent = before[i] + (is_first ? 1 : 0) - 1;
  ulong mask = 0;
  parents[level.x + i] = parent;
  if (!is_first)
    return;
  for (uint k = i; k < level.y && (own[k] >> 6) == (own[i] >> 6); k++)
    mask |= (ulong)1 << (own[k] & 63);
  codes[level.z + parent] = own[i] >> 6;
  children[level.z + parent] = mask;
  firsts[level.z + parent] = i;
}

enum { NO_NODE = 0x7fffffff };

inline uint find_node(__global const ulong *codes, uint count, ulong code) {
  uint low = 0, high = count;
  while (low < high) {
    uint middle = low + (high - low) / 2;
    if (codes[middle] < code)
      low = middle + 1;
    else
      high = middle;
  }
  return low < count && codes[low] == code ? low : NO_NODE;
}

/* Finds the next node along x; the highest bit tells whether the node itself is the next one of another. */
__kernel void link_nodes(__global const ulong *codes, __global uint *next, const uint4 level) {
  uint i = (uint)get_global_id(0);
  if (i >= level.y)
    return;
  __global const ulong *own = codes + level.x;
  const ulong along_x = 0x1249249249249249;
  ulong code = own[i], x = code & along_x, rest = code & ~along_x;
  uint after = find_node(own, level.y, (((x | ~along_x) + 1) & along_x) | rest);
  bool follows = x != 0 && find_node(own, level.y, ((x - 1) & along_x) | rest) != NO_NODE;
  next[level.x + i] = after | (follows ? 1u << 31 : 0);
}

inline uint child_at(uint x, uint y, uint z) {
  const uint spread[4] = {0, 1, 8, 9};
  return spread[x] | spread[y] << 1 | spread[z] << 2;
}

/*
 * Carries flips along x through the children of nodes that follow each other, for each of the 4 x 4 rows: a
 * child is inside if they say so, and the row of nodes below that ends in it may change that for what
 * follows. All rows agree where the nodes end, as what follows is of one kind.
 */
__kernel void fold_nodes(__global const ulong *children, __global const uint *firsts,
                         __global const uint *next, __global uint *exits, __global uchar *inside,
                         const uint4 level) {
  size_t i = get_global_id(0);
  uint node = (uint)(i / 16), row = (uint)(i % 16), carry = 0;
  if (node >= level.y || next[level.x + node] >> 31)
    return;
  for (;;) {
    ulong mask = children[level.x + node];
    uint first = level.z + firsts[level.x + node], is_inside = 0;
    for (uint x = 0; x < 4; x++) {
      uint child = child_at(x, row & 3, row >> 2);
      is_inside |= carry << x;
      if ((mask >> child) & 1)
        carry ^= exits[first + (uint)popcount(mask & (((ulong)1 << child) - 1))];
    }
    inside[16 * (size_t)(level.x + node) + row] = (uchar)is_inside;
    uint after = next[level.x + node] & NO_NODE;
    if (row == 0)
      exits[level.x + node] = after == NO_NODE ? carry : 0;
    if (after == NO_NODE)
      return;
    node = after;
  }
}

/* Whether a node's parent says that it is inside. */
inline uint is_node_inside(__global const ulong *codes, __global const uint *parents,
                           __global const uchar *inside, uint node, uint above) {
  uint c = (uint)(codes[node] & 63);
  uint x = (c & 1) | (c >> 2 & 2), y = (c >> 1 & 1) | (c >> 3 & 2), z = (c >> 2 & 1) | (c >> 4 & 2);
  return inside[16 * (size_t)(above + parents[node]) + y + 4 * z] >> x & 1;
}

/* What is inside by the parent is inside all over; `level.z` is where the parents begin. */
__kernel void push_nodes(__global const ulong *codes, __global const uint *parents, __global uchar *inside,
                         const uint4 level) {
  size_t i = get_global_id(0);
  if (i / 16 >= level.y)
    return;
  uint node = level.x + (uint)(i / 16);
  if (is_node_inside(codes, parents, inside, node, level.z))
    inside[16 * (size_t)node + i % 16] ^= 15;
}

/* Adds what one pass has inside to all others, or puts it there. */
__kernel void unite_nodes(__global const uint *inside, __global uint *united, const uint words,
                          const uint is_added) {
  uint i = (uint)get_global_id(0);
  if (i < words)
    united[i] = is_added ? united[i] | inside[i] : inside[i];
}

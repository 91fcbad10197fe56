/* SPDX-License-Identifier: BSD-3-Clause */
/* Flips of an octree (Schwarz & Seidel 2010, section 5.3). Its lowest nodes are found by the bits of their
   cells and by how many are set before each word of them. */
typedef struct Flips {
  __global uint *bricks;
  __global const uint *cells, *before;
  __global const ulong *places; /* of x, then at step[0] of y, at step[1] of z */
  bool asks;                    /* only whether there is a flip */
  bool found;
} Flips;

/* Flips a voxel and those behind it in its row of four; columns run along x, u is y, v is z. */
inline void flip_bit(Flips *flips, const Job *job, int u, int v, int w) {
  if (w >= job->last[2])
    return;
  w = max(w, 0);
  ulong cell =
      flips->places[w >> 4] | flips->places[job->step[0] + (u >> 4)] | flips->places[job->step[1] + (v >> 4)];
  size_t word = (size_t)(cell >> 5);
  uint below = (1u << (uint)(cell & 31)) - 1;
  size_t node = flips->before[word] + (uint)popcount(flips->cells[word] & below);
  const uint spread[4] = {0, 1, 8, 9};
  uint brick = spread[w >> 2 & 3] | spread[u >> 2 & 3] << 1 | spread[v >> 2 & 3] << 2;
  uint row = 16 * (uint)(v & 3) + 4 * (uint)(u & 3), x = (uint)w & 3;
  __global uint *half_brick = flips->bricks + (64 * node + brick) * 2 + (row >> 5);
  if (!flips->asks) {
    atomic_xor(half_brick, (15u << x & 15u) << (row & 31u));
    return;
  }
  uint bits = *half_brick >> (row & 31u) & 15u;
  flips->found = flips->found || ((bits ^ bits << 1) >> x & 1u) != 0;
}

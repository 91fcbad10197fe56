/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The lowest nodes of an octree, cells of 16 x 16 x 16 voxels (Schwarz & Seidel 2010, section 5.1): those
 * that triangles meet once they are moved by half a voxel along x. A flip goes to the first voxel whose
 * centre lies at or beyond the crossing; so the moved triangle touches the voxel it flips, and it touches
 * every cell that it leaves neither empty nor full, also as a wall along x. There is a bit for each cell, in
 * Morton order without the bits of axes that all cells have clear.
 */
inline void mark_cell(__global uint *bits, __global const ulong *places, const SurfaceJob *job,
                      const int at[3]) {
  ulong cell = places[at[0]] | places[job->last[0] + at[1]] | places[job->last[0] + job->last[1] + at[2]];
  uint bit = 1u << (uint)(cell & 31);
  if ((bits[cell >> 5] & bit) == 0) /* most are set already */
    atomic_or(&bits[cell >> 5], bit);
}

inline void mark_column(const Shape *t, const SurfaceJob *job, int u, int v, __global uint *bits,
                        __global const ulong *places) {
  Column column;
  int at[3];
  if (!load_column(&column, t, job, u, v))
    return;
  at[t->u] = u;
  at[t->v] = v;
  for (int k = column.begin; k < column.end; k++)
    if (meets_voxel(&column, t, job, k)) {
      at[t->w] = k;
      mark_cell(bits, places, job, at);
    }
}

/* What lies before the grid flips its first voxels: cells there that the triangle has behind it along x. */
inline void mark_shadow(const Shape *t, const SurfaceJob *job, uint first, uint stride, __global uint *bits,
                        __global const ulong *places) {
  uint width = (uint)(t->end[1] - t->begin[1]), all = width * (uint)(t->end[2] - t->begin[2]);
  int unit = 1 << job->bits;
  for (uint i = first; i < all; i += stride) {
    int cell[3] = {0, t->begin[1] + (int)(i % width), t->begin[2] + (int)(i / width)};
    int at[3] = {0, cell[1] * unit + unit / 2, cell[2] * unit + unit / 2};
    if (meets_edges(t, job, at, 0))
      mark_cell(bits, places, job, cell);
  }
}

inline void mark_triangle(const Shape *t, const SurfaceJob *job, uint first, uint stride, __global uint *bits,
                          __global const ulong *places) {
  uint width = (uint)(t->end[t->u] - t->begin[t->u]), all = width * (uint)(t->end[t->v] - t->begin[t->v]);
  for (uint i = first; i < all; i += stride)
    mark_column(t, job, t->begin[t->u] + (int)(i % width), t->begin[t->v] + (int)(i / width), bits, places);
  if (min(min(t->corner[0][0], t->corner[1][0]), t->corner[2][0]) < 0)
    mark_shadow(t, job, first, stride, bits, places);
}

/* A triangle for each work-item; those of many columns are listed. `list`: first of the facets, whether they
   are looked up. */
__kernel void mark_cells(__global const int4 *points, __global const uint *corners,
                         __global const uint *order, __global uint *bits, __global const ulong *places,
                         __global uint *large, const SurfaceJob job, const uint2 list) {
  uint i = (uint)get_global_id(0);
  Shape t;
  if (i >= job.facet_count)
    return;
  uint facet = list.y ? order[list.x + i] : list.x + i;
  if (!load_shape(&t, &job, points, corners, facet))
    return;
  if ((long)(t.end[t.u] - t.begin[t.u]) * (t.end[t.v] - t.begin[t.v]) > job.few_columns)
    large[1 + atomic_inc(&large[0])] = facet;
  else
    mark_triangle(&t, &job, 0, 1, bits, places);
}

/* Work-groups take turns with the listed triangles. */
__kernel void mark_large(__global const int4 *points, __global const uint *corners, __global uint *bits,
                         __global const ulong *places, __global const uint *large, const SurfaceJob job) {
  uint count = large[0];
  for (uint i = (uint)get_group_id(0); i < count; i += (uint)get_num_groups(0)) {
    Shape t;
    load_shape(&t, &job, points, corners, large[1 + i]);
    mark_triangle(&t, &job, (uint)get_local_id(0), GROUP, bits, places);
  }
}

/* All cells of a box: first ones, and how many along each axis. */
__kernel void mark_box(__global uint *bits, __global const ulong *places, const SurfaceJob job,
                       const int4 first, const uint4 size) {
  size_t i = get_global_id(0);
  if (i >= (size_t)size.x * size.y * size.z)
    return;
  int at[3] = {first.x + (int)(i % size.x), first.y + (int)(i / size.x % size.y),
               first.z + (int)(i / size.x / size.y)};
  mark_cell(bits, places, &job, at);
}

__kernel void count_cells(__global const uint *bits, __global uint *before, const uint words) {
  uint w = (uint)get_global_id(0);
  if (w < words)
    before[w] = (uint)popcount(bits[w]);
}

/* Puts the bits of a cell's number where `axes` has ones. */
inline ulong code_of(ulong number, ulong axes) {
  ulong code = 0;
  for (; axes != 0 && number != 0; axes &= axes - 1, number >>= 1)
    if (number & 1)
      code |= axes & (0 - axes);
  return code;
}

__kernel void list_cells(__global const uint *bits, __global const uint *before, __global ulong *codes,
                         const ulong axes, const uint words) {
  uint w = (uint)get_global_id(0);
  if (w >= words)
    return;
  uint at = before[w];
  for (uint left = bits[w]; left != 0; left &= left - 1)
    codes[at++] = code_of(32 * (ulong)w + (ulong)popcount((left & (0 - left)) - 1), axes);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The lowest nodes of an octree, cells of 16 x 16 x 16 voxels (Schwarz & Seidel 2010, section 5.1): those
 * that triangles meet once they are moved by half a voxel along x. A flip goes to the first voxel whose
 * centre lies at or beyond the crossing; so the moved triangle touches the voxel it flips, and it touches
 * every cell that it leaves neither empty nor full, also as a wall along x. There is a bit for each cell, in
 * Morton order without the bits of axes that all cells have clear.
 */
static inline void mark_cell(const Voxels *cells, const SurfaceJob *job, int3 at) {
  ulong cell = cells->places[at.x] | cells->places[job->last[0] + at.y] |
               cells->places[job->last[0] + job->last[1] + at.z];
  uint bit = 1u << (uint)(cell & 31);
  if ((cells->bits[cell >> 5] & bit) == 0) /* most are set already */
    atomic_or(&cells->bits[cell >> 5], bit);
}

/* Back to x, y, z. */
static inline int3 turned_back(int3 p, int w) {
  return w == 0 ? (int3)(p.z, p.x, p.y) : w == 1 ? (int3)(p.y, p.z, p.x) : p;
}

static inline void set_voxel(const Voxels *cells, const Shape *t, const SurfaceJob *job, int u, int v, int w) {
  mark_cell(cells, job, turned_back((int3)(u, v, w), t->w));
}

/* What lies before the grid flips its first voxels: the cells there that have the triangle before them along
 * x. */
static inline void mark_shadow(const Shape *t, const SurfaceJob *job, const int3 corner[3], int first, int stride,
                        const Voxels *cells) {
  int3 begin = turned_back(t->begin, t->w), size = turned_back(t->end, t->w) - begin;
  long normal = t->w == 0 ? t->normal.z : t->w == 1 ? t->normal.y : t->normal.x;
  Line along_x[3];
  for (int e = 0; e < 3; e++) {
    int3 p = corner[e], q = corner[e == 2 ? 0 : e + 1];
    along_x[e] = line_of(job, p.y, p.z, q.y, q.z, normal, begin.y, begin.z);
  }
  for (int z = first; z < size.z; z += stride)
    for (int y = 0; y < size.y; y++)
      if ((value_at(&along_x[0], y, z) | value_at(&along_x[1], y, z) | value_at(&along_x[2], y, z)) >= 0)
        mark_cell(cells, job, (int3)(0, begin.y + y, begin.z + z));
}

/* By one work-item, or by a group. */
static inline void mark_triangle(const Shape *t, const SurfaceJob *job, bool is_shared, const Voxels *cells) {
  int3 corner[3];
  for (int c = 0; c < 3; c++)
    corner[c] = turned_back(t->corner[c], t->w);
  bool is_beyond = max(max(corner[0].x, corner[1].x), corner[2].x) < 0;
  if (!is_beyond && is_shared)
    set_share(t, job, cells);
  else if (!is_beyond)
    set_columns(t, job, 0, 1, 0, t->end.x - t->begin.x, cells);
  if (min(min(corner[0].x, corner[1].x), corner[2].x) < 0)
    mark_shadow(t, job, corner, is_shared ? (int)get_local_id(0) : 0, is_shared ? GROUP : 1, cells);
}

/* A triangle for each work-item; those of many columns are listed. `list`: first of the triangles, whether they
   are looked up. */
__kernel void mark_cells(__global const int4 *points, __global const uint *corners,
                         __global const uint *order, __global uint *bits, __global const ulong *places,
                         __global uint *large, const SurfaceJob job, const uint2 list) {
  uint i = (uint)get_global_id(0);
  Shape t;
  const Voxels cells = {bits, places, 0, 0};
  if (i >= job.triangle_count)
    return;
  uint triangle = list.y ? order[list.x + i] : list.x + i;
  if (!load_shape(&t, &job, points, corners, triangle))
    return;
  if ((long)(t.end.x - t.begin.x) * (t.end.y - t.begin.y) > job.few_columns)
    large[1 + atomic_inc(&large[0])] = triangle;
  else
    mark_triangle(&t, &job, false, &cells);
}

/* Work-groups take turns with the listed triangles. */
__kernel void mark_large(__global const int4 *points, __global const uint *corners, __global uint *bits,
                         __global const ulong *places, __global const uint *large, const SurfaceJob job) {
  uint count = large[0];
  const Voxels cells = {bits, places, 0, 0};
  for (uint i = (uint)get_group_id(0); i < count; i += (uint)get_num_groups(0)) {
    Shape t;
    load_shape(&t, &job, points, corners, large[1 + i]);
    mark_triangle(&t, &job, true, &cells);
  }
}

/* All cells of a box: first ones, and how many along each axis. */
__kernel void mark_box(__global uint *bits, __global const ulong *places, const SurfaceJob job,
                       const int4 first, const uint4 size) {
  size_t i = get_global_id(0);
  if (i >= (size_t)size.x * size.y * size.z)
    return;
  const Voxels cells = {bits, places, 0, 0};
  int x = (int)(i % size.x), y = (int)(i / size.x % size.y), z = (int)(i / size.x / size.y);
  mark_cell(&cells, &job, first.xyz + (int3)(x, y, z));
}

__kernel void count_cells(__global const uint *bits, __global uint *before, __global uint *total, const uint words) {
  __local uint all;
  uint w = (uint)get_global_id(0);
  if (get_local_id(0) == 0)
    all = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (w < words) {
    uint count = (uint)popcount(bits[w]);
    before[w] = count;
    if (count > 0)
      atomic_add(&all, count);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (get_local_id(0) == 0 && all > 0 && atomic_add(&total[0], all) > ~0u - all)
    atomic_inc(&total[1]);
}

/* Puts the bits of a cell's number where `axes` has ones. */
static inline ulong code_of(ulong number, ulong axes) {
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

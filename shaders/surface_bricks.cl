/* SPDX-License-Identifier: BSD-3-Clause */
/* The voxels of surfaces in an octree (Schwarz & Seidel 2010, section 5): each goes to its brick, of a node that
   cells.cl has marked for the same triangle. Bricks are those of bricks.cl. */
static inline void set_voxel(const Voxels *voxels, const Shape *t, const SurfaceJob *job, int u, int v, int w) {
  int x = t->w == 0 ? w : t->w == 1 ? v : u;
  int y = t->w == 0 ? u : t->w == 1 ? w : v;
  int z = t->w == 0 ? v : t->w == 1 ? u : w;
  ulong cell = voxels->places[x >> 4] | voxels->places[job->step[0] + (uint)(y >> 4)] |
               voxels->places[job->step[1] + (uint)(z >> 4)];
  uint cells = voxels->cells[cell >> 5], at = (uint)(cell & 31);
  if ((cells >> at & 1u) == 0) /* every cell that is touched has a node; none is written for another */
    return;
  size_t node = voxels->before[cell >> 5] + (uint)popcount(cells & ((1u << at) - 1));
  const uint spread[4] = {0, 1, 8, 9};
  uint brick = spread[x >> 2 & 3] | spread[y >> 2 & 3] << 1 | spread[z >> 2 & 3] << 2;
  uint bit = 16 * (uint)(z & 3) + 4 * (uint)(y & 3) + (uint)(x & 3);
  atomic_or(&voxels->bits[(64 * node + brick) * 2 + (bit >> 5)], 1u << (bit & 31u));
}

/* A triangle for each work-item; those of many columns are listed. */
__kernel void set_bricks(__global const int4 *points, __global const uint *corners, __global uint *bricks,
                         __global const ulong *places, __global const uint *cells, __global const uint *before,
                         __global uint *large, const SurfaceJob job) {
  uint i = (uint)get_global_id(0);
  Shape t;
  const Voxels voxels = {bricks, places, cells, before};
  if (i >= job.triangle_count || !load_shape(&t, &job, points, corners, i))
    return;
  int3 size = t.end - t.begin;
  if ((long)size.x * size.y > job.few_columns) {
    large[1 + atomic_inc(&large[0])] = i;
    return;
  }
  set_columns(&t, &job, 0, 1, 0, size.x, &voxels);
}

/* Work-groups take turns with the listed triangles. */
__kernel void set_bricks_large(__global const int4 *points, __global const uint *corners, __global uint *bricks,
                               __global const ulong *places, __global const uint *cells,
                               __global const uint *before, __global const uint *large, const SurfaceJob job) {
  uint count = large[0];
  const Voxels voxels = {bricks, places, cells, before};
  for (uint i = (uint)get_group_id(0); i < count; i += (uint)get_num_groups(0)) {
    Shape t;
    load_shape(&t, &job, points, corners, large[1 + i]);
    set_share(&t, &job, &voxels);
  }
}

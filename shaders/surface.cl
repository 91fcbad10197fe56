/* SPDX-License-Identifier: BSD-3-Clause */
/* The voxels of surfaces in a slab. */
static inline void set_voxel(const Voxels *voxels, const Shape *t, const SurfaceJob *job, int u, int v, int w) {
  uint bit = (uint)(u - t->first.x) * t->step.x + (uint)(v - t->first.y) * t->step.y +
             (uint)(w - t->first.z) * t->step.z;
  atomic_or(&voxels->bits[bit >> 5], 1u << (bit & 31u));
}

/* A triangle for each work-item; those of many columns are listed. */
__kernel void set_surface(__global const int4 *points, __global const uint *corners, __global uint *bits,
                          __global uint *large, const SurfaceJob job) {
  uint i = (uint)get_global_id(0);
  Shape t;
  Voxels voxels = {bits, 0, 0, 0};
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
__kernel void set_large(__global const int4 *points, __global const uint *corners, __global uint *bits,
                        __global const uint *large, const SurfaceJob job) {
  uint count = large[0];
  Voxels voxels = {bits, 0, 0, 0};
  for (uint i = (uint)get_group_id(0); i < count; i += (uint)get_num_groups(0)) {
    Shape t;
    load_shape(&t, &job, points, corners, large[1 + i]);
    set_share(&t, &job, &voxels);
  }
}

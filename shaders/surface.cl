/* SPDX-License-Identifier: BSD-3-Clause */
/* The voxels of surfaces: a bit for each. */

/* Sets what the triangle has in the column (u, v). */
inline void set_column(const Shape *t, const SurfaceJob *job, int u, int v, __global uint *bits) {
  Column column;
  if (!load_column(&column, t, job, u, v))
    return;
  uint base = (uint)(u - job->first[t->u]) * job->step[t->u] + (uint)(v - job->first[t->v]) * job->step[t->v];
  for (int k = column.begin; k < column.end; k++)
    if (meets_voxel(&column, t, job, k)) {
      uint bit = base + (uint)(k - job->first[t->w]) * job->step[t->w];
      atomic_or(&bits[bit >> 5], 1u << (bit & 31u));
    }
}

/* A triangle for each work-item; those of many columns are listed. */
__kernel void set_surface(__global const int4 *points, __global const uint *corners, __global uint *bits,
                          __global uint *large, const SurfaceJob job) {
  uint i = (uint)get_global_id(0);
  Shape t;
  if (i >= job.facet_count || !load_shape(&t, &job, points, corners, i))
    return;
  if ((long)(t.end[t.u] - t.begin[t.u]) * (t.end[t.v] - t.begin[t.v]) > job.few_columns) {
    large[1 + atomic_inc(&large[0])] = i;
    return;
  }
  for (int v = t.begin[t.v]; v < t.end[t.v]; v++)
    for (int u = t.begin[t.u]; u < t.end[t.u]; u++)
      set_column(&t, &job, u, v, bits);
}

/* Work-groups take turns with the listed triangles; work-items with the columns of each. */
__kernel void set_large(__global const int4 *points, __global const uint *corners, __global uint *bits,
                        __global const uint *large, const SurfaceJob job) {
  uint count = large[0];
  for (uint i = (uint)get_group_id(0); i < count; i += (uint)get_num_groups(0)) {
    Shape t;
    load_shape(&t, &job, points, corners, large[1 + i]);
    int width = t.end[t.u] - t.begin[t.u];
    ulong all = (ulong)width * (ulong)(t.end[t.v] - t.begin[t.v]);
    for (ulong c = get_local_id(0); c < all; c += GROUP)
      set_column(&t, &job, t.begin[t.u] + (int)(c % (ulong)width), t.begin[t.v] + (int)(c / (ulong)width),
                 bits);
  }
}

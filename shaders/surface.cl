/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Surfaces, triangle by triangle, in the integers and by the tests of the CPU (surface_draw.h, after Schwarz & Seidel
 * 2010, sections 3.1 and 3.4): the box, the plane, and the edges seen along each axis. A triangle is looked at along the
 * axis w that its normal leans to most, so that it has few voxels in each column. Differences are at most 2^20 and a
 * voxel 2^16 steps, so that all sums fit 63 bits.
 */
typedef struct SurfaceJob { /* vxm_tile_surface */
  int first[3], bits;
  int last[3], thin;
  uint step[4];
  uint facet_count, few_columns, unused[2];
} SurfaceJob;

typedef struct Shape {
  int corner[3][3]; /* of each corner x, y, z */
  long normal[3];
  int u, v, w;          /* axes, w the one looked along */
  int begin[3], end[3]; /* voxels whose closed boxes meet that of the triangle, within the tile */
} Shape;

inline bool load_shape(Shape *t, const SurfaceJob *job, __global const int4 *points, __global const uint *corners,
                       uint facet) {
  int low[3], high[3];
  for (int c = 0; c < 3; c++) {
    int4 p = points[corners[3 * facet + c]];
    if (p.w != 0)
      return false;
    t->corner[c][0] = p.x;
    t->corner[c][1] = p.y;
    t->corner[c][2] = p.z;
  }
  int unit = 1 << job->bits;
  bool is_some = true;
  for (int i = 0; i < 3; i++) {
    low[i] = min(min(t->corner[0][i], t->corner[1][i]), t->corner[2][i]);
    high[i] = max(max(t->corner[0][i], t->corner[1][i]), t->corner[2][i]);
    if (high[i] - low[i] > 1 << 20)
      return false;
    t->begin[i] = max(((low[i] + (unit - 1)) >> job->bits) - 1, job->first[i]);
    t->end[i] = min((high[i] >> job->bits) + 1, job->last[i]);
    is_some = is_some && t->begin[i] < t->end[i];
  }
  if (!is_some)
    return false;
  long size[3];
  for (int i = 0; i < 3; i++) {
    int j = i == 2 ? 0 : i + 1, k = i == 0 ? 2 : i - 1;
    t->normal[i] = (long)(t->corner[1][j] - t->corner[0][j]) * (t->corner[2][k] - t->corner[0][k]) -
                   (long)(t->corner[1][k] - t->corner[0][k]) * (t->corner[2][j] - t->corner[0][j]);
    size[i] = (long)abs(t->normal[i]);
  }
  if (size[0] == 0 && size[1] == 0 && size[2] == 0)
    for (int i = 0; i < 3; i++)
      size[i] = high[i] - low[i]; /* a line: along its longest side */
  t->w = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
  t->u = t->w == 2 ? 0 : t->w + 1;
  t->v = t->w == 0 ? 2 : t->w - 1;
  return true;
}

inline long reach_of(bool thin, long a, long b, long c) {
  a = (long)abs(a);
  b = (long)abs(b);
  c = (long)abs(c);
  return thin ? max(max(a, b), c) : a + b + c;
}

/* The three edges seen along axis w: whether the voxel with centre `at` meets all of them. */
inline bool meets_edges(const Shape *t, const SurfaceJob *job, const int at[3], int w) {
  int u = w == 2 ? 0 : w + 1, v = w == 0 ? 2 : w - 1;
  long half_unit = (1 << job->bits) / 2;
  for (int e = 0; e < 3; e++) {
    int next = e == 2 ? 0 : e + 1;
    long du = t->corner[next][u] - t->corner[e][u], dv = t->corner[next][v] - t->corner[e][v];
    long beside = du * (at[v] - t->corner[e][v]) - dv * (at[u] - t->corner[e][u]);
    if (t->normal[w] < 0)
      beside = -beside;
    if (beside + half_unit * reach_of(job->thin != 0, du, dv, 0) < 0)
      return false;
  }
  return true;
}

/* Sets what the triangle has in the column (u, v). */
inline void set_column(const Shape *t, const SurfaceJob *job, int u, int v, __global uint *bits) {
  int unit = 1 << job->bits, begin = t->begin[t->w], end = t->end[t->w], at[3];
  at[t->u] = u * unit + unit / 2;
  at[t->v] = v * unit + unit / 2;
  at[t->w] = t->corner[0][t->w];
  if (!meets_edges(t, job, at, t->w))
    return;
  long nw = t->normal[t->w];
  long reach = (unit / 2) * reach_of(job->thin != 0, t->normal[0], t->normal[1], t->normal[2]);
  long across = t->normal[t->u] * (at[t->u] - t->corner[0][t->u]) + t->normal[t->v] * (at[t->v] - t->corner[0][t->v]);
  if (nw != 0) { /* the plane passes at most 1.5 voxels from the centres of its voxels */
    float middle = -((float)across / (float)nw) / (float)unit + (float)(t->corner[0][t->w] & (unit - 1)) / (float)unit;
    int around = (int)floor(middle) + (t->corner[0][t->w] >> job->bits);
    begin = max(begin, around - 3);
    end = min(end, around + 4);
  }
  uint base = (uint)(u - job->first[t->u]) * job->step[t->u] + (uint)(v - job->first[t->v]) * job->step[t->v];
  for (int k = begin; k < end; k++) {
    at[t->w] = k * unit + unit / 2;
    long off = across + nw * (at[t->w] - t->corner[0][t->w]);
    if ((long)abs(off) > reach || !meets_edges(t, job, at, t->u) || !meets_edges(t, job, at, t->v))
      continue;
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
      set_column(&t, &job, t.begin[t.u] + (int)(c % (ulong)width), t.begin[t.v] + (int)(c / (ulong)width), bits);
  }
}

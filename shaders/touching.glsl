/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which voxels belong to the surface of a triangle, by rules.h: the box, the plane, and the edges seen along each axis,
 * in the integers of the CPU. A triangle is looked at along the axis w that its normal leans to most, so that it has
 * few voxels in each column. Differences are at most 2^20 and a voxel 2^16 steps, so that all sums fit 63 bits.
 */
layout(std140, binding = 0) uniform Job {
  ivec4 first;  // first voxel of the slab along x, y, z; bits of the lattice below a voxel
  ivec4 last;   // voxel behind the last one; whether the surface is thin
  uvec4 step;   // bits from a voxel to the next one along x, y, z
  uvec4 triangles; // how many; most columns that the first pass takes
  ivec4 view;   // first column of the viewport; its width and height
} job;

layout(std430, binding = 0) readonly buffer Points {
  ivec4 at[]; // the fourth number is not 0 where a point lies beyond 32 bits
} points;
layout(std430, binding = 1) readonly buffer Corners {
  uint corner[];
} corners;
layout(std430, binding = 3) buffer Bits {
  uint word[];
} bits;

struct Triangle {
  ivec3 corner[3]; // x, y, z
  i64vec3 normal;
  int u, v, w;          // axes, w the one looked along
  ivec3 begin, end;     // voxels whose closed boxes meet that of the triangle, within the slab
};

bool load_triangle(uint triangle, out ivec3 corner[3]) {
  ivec4 p[3];
  for (int c = 0; c < 3; c++) {
    p[c] = points.at[corners.corner[3u * triangle + uint(c)]];
    corner[c] = p[c].xyz;
  }
  if ((p[0].w | p[1].w | p[2].w) != 0)
    return false;
  ivec3 low = min(min(corner[0], corner[1]), corner[2]), high = max(max(corner[0], corner[1]), corner[2]);
  return all(lessThanEqual(high - low, ivec3(1 << 20)));
}

Triangle triangle_of(ivec3 corner[3]) {
  Triangle t;
  t.corner = corner;
  ivec3 a = corner[1] - corner[0], b = corner[2] - corner[0];
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    t.normal[i] = vxm_cross(a[j], a[k], b[j], b[k]);
  }
  ivec3 low = min(min(corner[0], corner[1]), corner[2]), high = max(max(corner[0], corner[1]), corner[2]);
  i64vec3 size = abs(t.normal);
  if (size.x == 0l && size.y == 0l && size.z == 0l)
    size = i64vec3(high - low); // a line: along its longest side
  t.w = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  t.u = (t.w + 1) % 3;
  t.v = (t.w + 2) % 3;
  int s = job.first.w, unit = 1 << s;
  for (int i = 0; i < 3; i++) {
    t.begin[i] = max(vxm_first_touched(low[i], unit, s), job.first[i]);
    t.end[i] = min(vxm_end_touched(high[i], s), job.last[i]);
  }
  return t;
}

/* The three edges seen along axis w: whether the voxel with centre `at` meets all of them. */
bool meets_edges(Triangle t, ivec3 at, int w) {
  int u = (w + 1) % 3, v = (w + 2) % 3;
  for (int e = 0; e < 3; e++) {
    ivec3 p = t.corner[e], q = t.corner[(e + 1) % 3];
    vxm_edge edge = vxm_edge_of(q[u] - p[u], q[v] - p[v], (1 << job.first.w) / 2, t.normal[w] >= 0l, job.last.w != 0);
    if (vxm_edge_value(edge, int64_t(at[u] - p[u]), int64_t(at[v] - p[v])) < 0l)
      return false;
  }
  return true;
}

void set_voxel(ivec3 voxel) {
  uvec3 at = uvec3(voxel - job.first.xyz);
  uint bit = at.x * job.step.x + at.y * job.step.y + at.z * job.step.z;
  atomicOr(bits.word[bit >> 5], 1u << (bit & 31u));
}

/* Sets what the triangle has in the column (u, v). */
void set_column(Triangle t, ivec2 column) {
  int s = job.first.w, unit = 1 << s, begin = t.begin[t.w], end = t.end[t.w];
  ivec3 at;
  at[t.u] = column.x * unit + unit / 2;
  at[t.v] = column.y * unit + unit / 2;
  at[t.w] = t.corner[0][t.w];
  if (!meets_edges(t, at, t.w))
    return;
  i64vec3 n = t.normal;
  int64_t reach = int64_t(unit / 2) * vxm_plane_reach(n.x, n.y, n.z, job.last.w != 0);
  int64_t across = n[t.u] * int64_t(at[t.u] - t.corner[0][t.u]) + n[t.v] * int64_t(at[t.v] - t.corner[0][t.v]);
  if (n[t.w] != 0l) { /* the plane passes at most 1.5 voxels from the centres of its voxels */
    float middle = -(float(across) / float(n[t.w])) / float(unit) + float(t.corner[0][t.w] & (unit - 1)) / float(unit);
    int around = int(floor(middle)) + (t.corner[0][t.w] >> s);
    begin = max(begin, around - 3);
    end = min(end, around + 4);
  }
  for (int k = begin; k < end; k++) {
    ivec3 voxel;
    voxel[t.u] = column.x;
    voxel[t.v] = column.y;
    voxel[t.w] = k;
    at[t.w] = k * unit + unit / 2;
    int64_t off = across + n[t.w] * int64_t(at[t.w] - t.corner[0][t.w]);
    if (abs(off) <= reach && meets_edges(t, at, t.u) && meets_edges(t, at, t.v))
      set_voxel(voxel);
  }
}

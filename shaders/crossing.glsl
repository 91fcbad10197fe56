/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a triangle flips in the columns of a slab, by rules.h: in the integers of the CPU. Differences are at most 2^20
 * and a voxel at most 2^16 steps, so that all products fit 63 bits.
 */
struct Triangle {
  ivec3 a;
  vxm_projected d;
};

bool make_triangle(ivec3 corner[3], out Triangle t) {
  ivec3 b = corner[1] - corner[0], c = corner[2] - corner[0];
  t.a = corner[0];
  t.d = vxm_project(b.x, b.y, b.z, c.x, c.y, c.z);
  return t.d.nw != 0l;
}

/* Whether it covers column p, relative to corner a. */
bool covers(Triangle t, ivec2 p) {
  int unit = 1 << job.axes.w;
  bool u_first = job.axes.x < job.axes.y;
  return (vxm_side_of(t.d, 0, p.x, p.y, unit, u_first).value | vxm_side_of(t.d, 1, p.x, p.y, unit, u_first).value |
          vxm_side_of(t.d, 2, p.x, p.y, unit, u_first).value) >= 0l;
}

/* The first voxel of column p whose centre lies beyond the triangle. */
int crossing(Triangle t, ivec2 p) {
  vxm_plane plane = vxm_plane_of(t.d, t.a.z, p.x, p.y, 1 << job.axes.w, job.axes.w, job.axes.x, job.axes.y);
  /* The quotient is below 2^13, so that an estimate in floats is off by less than one. */
  int quotient = int(floor(float(plane.across) / float(plane.step)));
  return plane.base + vxm_round_down(plane.across, plane.step, quotient);
}

/* Flips what the triangle flips in a column of the slab. */
void flip_column(Triangle t, ivec2 column) {
  int unit = 1 << job.axes.w;
  ivec2 p = column * unit + unit / 2 - t.a.xy;
  if (!covers(t, p))
    return;
  int voxel = crossing(t, p);
  if (voxel >= job.last.z || (voxel < job.first.z && job.first.w == 0))
    return;
  uvec3 at = uvec3(column - job.first.xy, max(voxel - job.first.z, 0));
  uint bit = at.x * job.step.x + at.y * job.step.y + at.z * job.step.z;
  atomicXor(bits.word[bit >> 5], 1u << (bit & 31u));
}

ivec2 first_centre(ivec2 at) {
  int unit = 1 << job.axes.w;
  return ivec2(vxm_first_centre(at.x, unit, job.axes.w), vxm_first_centre(at.y, unit, job.axes.w));
}

/* The columns of the slab among which are all that the triangle covers. */
bool columns_of(Triangle t, out ivec2 begin, out ivec2 end) {
  ivec2 b = ivec2(t.d.bu, t.d.bv), c = ivec2(t.d.cu, t.d.cv);
  ivec2 low = min(min(b, c), ivec2(0)) + t.a.xy, high = max(max(b, c), ivec2(0)) + t.a.xy;
  begin = max(first_centre(low), job.first.xy);
  end = min(first_centre(high), job.last.xy);
  return all(lessThan(begin, end));
}

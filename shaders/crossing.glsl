/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Where a triangle crosses a column, in the integers of the CPU: which columns it covers, which voxel it flips
 * in each, and what the perturbation of the lattice says of centres exactly on an edge or on the triangle.
 * Differences are at most 2^20 and a voxel at most 2^16 steps, so that all products fit 63 bits.
 */
struct Triangle {
  ivec3 a, b, c; // a corner, and the differences of the others to it, turned so that they run around to the left
  int64_t nw;    // twice the area of the projection, above 0
};

bool make_triangle(ivec3 corner[3], out Triangle t) {
  t.a = corner[0];
  t.b = corner[1] - t.a;
  t.c = corner[2] - t.a;
  t.nw = int64_t(t.b.x) * int64_t(t.c.y) - int64_t(t.b.y) * int64_t(t.c.x);
  if (t.nw < 0l) {
    ivec3 swap = t.b;
    t.b = t.c;
    t.c = swap;
    t.nw = -t.nw;
  }
  return t.nw != 0l;
}

/* Whether p lies to the left of the line from `from` to `to`. On it the perturbation decides: the axis that comes
   first has the larger one. */
bool is_left(ivec2 from, ivec2 to, ivec2 p) {
  ivec2 d = to - from, q = p - from;
  int64_t value = int64_t(d.x) * int64_t(q.y) - int64_t(d.y) * int64_t(q.x);
  bool on = job.axes.x < job.axes.y ? (d.y != 0 ? d.y < 0 : d.x > 0) : (d.x != 0 ? d.x > 0 : d.y < 0);
  return value > 0l || (value == 0l && on);
}

bool covers(Triangle t, ivec2 p) {
  return is_left(ivec2(0), t.b.xy, p) && is_left(t.b.xy, t.c.xy, p) && is_left(t.c.xy, ivec2(0), p);
}

/* The first voxel of column p (relative to corner a) whose centre lies beyond the triangle. */
int crossing(Triangle t, ivec2 p) {
  int64_t nu = int64_t(t.b.y) * int64_t(t.c.z) - int64_t(t.b.z) * int64_t(t.c.y);
  int64_t nv = int64_t(t.b.z) * int64_t(t.c.x) - int64_t(t.b.x) * int64_t(t.c.z);
  int64_t normal[3];
  normal[job.axes.x] = nu;
  normal[job.axes.y] = nv;
  normal[job.axes.z] = t.nw;
  bool on_is_beyond = (normal[0] != 0l ? normal[0] : normal[1] != 0l ? normal[1] : normal[2]) > 0l;
  int unit = 1 << job.axes.w, base = t.a.z >> job.axes.w;
  int64_t offset = t.nw * int64_t(unit / 2 - (t.a.z - base * unit)) + (on_is_beyond ? 1l : 0l);
  int64_t across = -nu * int64_t(p.x) - nv * int64_t(p.y) - offset, step = t.nw * int64_t(unit);
  /* The quotient is below 2^13, so that an estimate in floats is off by less than one; the rest tells. */
  int quotient = int(floor(float(across) / float(step)));
  int64_t rest = across - int64_t(quotient) * step;
  if (rest < 0l)
    quotient--;
  else if (rest >= step)
    quotient++;
  return base + 1 + quotient;
}

/* Flips what the triangle flips in a column of the tile. */
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

/* The columns of the tile among which are all that the triangle covers. */
bool columns_of(Triangle t, out ivec2 begin, out ivec2 end) {
  ivec2 low = min(min(t.b.xy, t.c.xy), ivec2(0)) + t.a.xy, high = max(max(t.b.xy, t.c.xy), ivec2(0)) + t.a.xy;
  begin = max(first_voxel(low), job.first.xy);
  end = min(first_voxel(high), job.last.xy);
  return all(lessThan(begin, end));
}

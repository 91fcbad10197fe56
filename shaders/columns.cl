/* SPDX-License-Identifier: BSD-3-Clause */
/* Solids, triangle by triangle (Schwarz & Seidel 2010, section 4.1): a work-item for each facet flips a bit in each
   column that it covers; facets of many columns are listed, and each gets a work-group of its own. */

inline void flip_bit(__global uint *flips, const Job *job, int u, int v, int w) {
  if (w >= job->last[2] || (w < job->first[2] && !job->keep_before))
    return;
  uint bit = (uint)(u - job->first[0]) * job->step[0] + (uint)(v - job->first[1]) * job->step[1] +
             (uint)max(w - job->first[2], 0) * job->step[2];
  atomic_xor(&flips[bit >> 5], 1u << (bit & 31u));
}

/* Flips what the triangle flips in rows of columns: those of `area` from row `first` on, every `stride`-th. */
inline void flip_area(const Triangle *t, const Job *job, int4 area, int first, int stride, __global uint *flips) {
  bool u_first = job->axes[0] < job->axes[1];
  int middle = (1 << job->bits) / 2;
  int pu = (area.x << job->bits) + middle - t->a.x, pv = ((area.y + first) << job->bits) + middle - t->a.y;
  Side s0 = side_of(0, 0, t->b.x, t->b.y, pu, pv, job->bits, u_first);
  Side s1 = side_of(t->b.x, t->b.y, t->c.x - t->b.x, t->c.y - t->b.y, pu, pv, job->bits, u_first);
  Side s2 = side_of(t->c.x, t->c.y, -t->c.x, -t->c.y, pu, pv, job->bits, u_first);
  if (area.z - area.x == 1 && area.w - area.y == 1 && (s0.value | s1.value | s2.value) < 0)
    return; /* most triangles of a fine mesh */
  Plane plane = plane_of(t, job, pu, pv);
  for (int v = area.y + first; v < area.w; v += stride) {
    long i0 = s0.value, i1 = s1.value, i2 = s2.value, across = plane.across;
    for (int u = area.x; u < area.z; u++) {
      if ((i0 | i1 | i2) >= 0)
        flip_bit(flips, job, u, v, crossing(&plane, across));
      i0 += s0.u_step;
      i1 += s1.u_step;
      i2 += s2.u_step;
      across += plane.u_step;
    }
    s0.value += s0.v_step * stride;
    s1.value += s1.v_step * stride;
    s2.value += s2.v_step * stride;
    plane.across += plane.v_step * stride;
  }
}

__kernel void flip_columns(__global const int4 *points, __global const uint *corners, __global const uint *order,
                           __global uint *flips, __global uint *large, const Job job) {
  uint i = (uint)get_global_id(0);
  Triangle t;
  if (i >= job.facet_count)
    return;
  uint facet = job.ordered ? order[job.facet_first + i] : job.facet_first + i;
  if (!load_triangle(&t, &job, points, corners, facet))
    return;
  int4 area = columns_of(&t, &job);
  if (area.z <= area.x || area.w <= area.y)
    return;
  if ((long)(area.z - area.x) * (area.w - area.y) > job.few_columns) {
    large[1 + atomic_inc(&large[0])] = facet;
    return;
  }
  flip_area(&t, &job, area, 0, 1, flips);
}

/* Work-groups take turns with the listed facets; work-items with the rows of each. */
__kernel void flip_large(__global const int4 *points, __global const uint *corners, __global uint *flips,
                         __global const uint *large, const Job job) {
  uint count = large[0];
  for (uint i = (uint)get_group_id(0); i < count; i += (uint)get_num_groups(0)) {
    Triangle t;
    load_triangle(&t, &job, points, corners, large[1 + i]);
    int4 area = columns_of(&t, &job);
    int first = (int)get_local_id(0);
    /* Low and wide ones are shared by columns. */
    int rows = area.w - area.y, parts = max(1, GROUP / max(rows, 1)), width = area.z - area.x;
    int share = (width + parts - 1) / parts, row = first / parts, part = first % parts;
    int4 mine = (int4)(area.x + part * share, area.y, min(area.x + (part + 1) * share, area.z), area.w);
    if (row < GROUP / parts && mine.x < mine.z)
      flip_area(&t, &job, mine, row, GROUP / parts, flips);
  }
}

/* Bits that the CPU found for facets that reach far. */
__kernel void flip_bits(__global uint *flips, __global const uint *bits, const uint count) {
  uint i = (uint)get_global_id(0);
  if (i < count)
    atomic_xor(&flips[bits[i] >> 5], 1u << (bits[i] & 31u));
}

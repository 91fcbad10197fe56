/* SPDX-License-Identifier: BSD-3-Clause */
/* The columns that a triangle covers, and what it flips in each; another file says what Flips are and what
   flip_bit does. */

/* Flips what the triangle flips in rows of columns: those of `area` from row `first` on, every `stride`-th.
 */
static inline void flip_area(const Triangle *t, const Job *job, int4 area, int first, int stride, Flips *flips) {
  int middle = (1 << job->bits) / 2;
  int pu = (area.x << job->bits) + middle - t->a.x, pv = ((area.y + first) << job->bits) + middle - t->a.y;
  vxm_side s0 = side_of(t, job, 0, pu, pv), s1 = side_of(t, job, 1, pu, pv), s2 = side_of(t, job, 2, pu, pv);
  if (area.z - area.x == 1 && area.w - area.y == 1 && (s0.value | s1.value | s2.value) < 0)
    return; /* most triangles of a fine mesh */
  vxm_plane plane = plane_of(t, job, pu, pv);
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

/* The share of one work-item where its group flips all that a triangle does: rows of columns. */
static inline void flip_share(const Triangle *t, const Job *job, Flips *flips) {
  int4 area = columns_of(t, job);
  int first = (int)get_local_id(0);
  /* Low and wide ones are shared by columns. */
  int rows = area.w - area.y, parts = max(1, GROUP / max(rows, 1)), width = area.z - area.x;
  int share = (width + parts - 1) / parts, row = first / parts, part = first % parts;
  int4 mine = (int4)(area.x + part * share, area.y, min(area.x + (part + 1) * share, area.z), area.w);
  if (row < GROUP / parts && mine.x < mine.z)
    flip_area(t, job, mine, row, GROUP / parts, flips);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/* What one pass over the triangles of a slab works on: vxm_slab_columns. Axes are named u and v across the columns,
   and w along them; 64-bit integers hold all products, as differences of near triangles are at most 2^20. */
typedef struct Job {
  int axes[3], bits;         /* numbers of u, v, w; bits of the lattice below a voxel */
  int first[3], keep_before; /* first voxel along u, v, w; whether flips before it along w count for it */
  int last[3], unused;       /* voxel behind the last one */
  uint step[4];              /* bits from a voxel to the next one along u, v, w */
  uint triangle_first, triangle_count, ordered, few_columns;
} Job;

/* A triangle along u, v, w: a corner, and the others by their differences to it. */
typedef struct Triangle {
  int3 a;
  vxm_projected d;
} Triangle;

static inline int part_of(int4 p, int axis) {
  return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

/* False if the triangle covers no column by its area, or is one of those that the CPU does: their points are marked or
   lie too far apart. */
static inline bool load_triangle(Triangle *t, const Job *job, __global const int4 *points, __global const uint *corners,
                          uint triangle) {
  int4 p = points[corners[3 * triangle]], q = points[corners[3 * triangle + 1]], r = points[corners[3 * triangle + 2]];
  int4 low = min(min(p, q), r), size = max(max(p, q), r) - low;
  if ((p.w | q.w | r.w) != 0 || size.x > 1 << 20 || size.y > 1 << 20 || size.z > 1 << 20)
    return false;
  q -= p;
  r -= p;
  t->a = (int3)(part_of(p, job->axes[0]), part_of(p, job->axes[1]), part_of(p, job->axes[2]));
  t->d = vxm_project(part_of(q, job->axes[0]), part_of(q, job->axes[1]), part_of(q, job->axes[2]),
                     part_of(r, job->axes[0]), part_of(r, job->axes[1]), part_of(r, job->axes[2]));
  return t->d.nw != 0;
}

/* A side with its value, and the plane, at the column whose centre lies at (pu, pv) from corner a. */
static inline vxm_side side_of(const Triangle *t, const Job *job, int side, int pu, int pv) {
  return vxm_side_of(t->d, side, pu, pv, 1 << job->bits, job->axes[0] < job->axes[1]);
}

static inline vxm_plane plane_of(const Triangle *t, const Job *job, int pu, int pv) {
  return vxm_plane_of(t->d, t->a.z, pu, pv, 1 << job->bits, job->bits, job->axes[0], job->axes[1]);
}

/* The first voxel of a column beyond the triangle. Within the triangle the quotient is below 2^13, so that an estimate
   in floats is off by less than one. */
static inline int crossing(const vxm_plane *plane, long across) {
  int quotient = (int)floor((float)across / (float)plane->step);
  return plane->base + vxm_round_down(across, plane->step, quotient);
}

/* The columns of the slab among which are all that the triangle covers: u in x and z, v in y and w; none if z <= x or
   w <= y. */
static inline int4 columns_of(const Triangle *t, const Job *job) {
  int u0 = t->a.x + min(min(t->d.bu, t->d.cu), 0), u1 = t->a.x + max(max(t->d.bu, t->d.cu), 0);
  int v0 = t->a.y + min(min(t->d.bv, t->d.cv), 0), v1 = t->a.y + max(max(t->d.bv, t->d.cv), 0);
  int unit = 1 << job->bits;
  return (int4)(max(vxm_first_centre(u0, unit, job->bits), job->first[0]),
                max(vxm_first_centre(v0, unit, job->bits), job->first[1]),
                min(vxm_first_centre(u1, unit, job->bits), job->last[0]),
                min(vxm_first_centre(v1, unit, job->bits), job->last[1]));
}

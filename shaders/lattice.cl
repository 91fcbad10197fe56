/* SPDX-License-Identifier: BSD-3-Clause */
/* What one pass over the facets of a tile works on: vxm_tile_columns. Axes are named u and v across the columns,
   and w along them; 64-bit integers hold all products, as differences of near facets are at most 2^20. */
typedef struct Job {
  int axes[3], bits;         /* numbers of u, v, w; bits of the lattice below a voxel */
  int first[3], keep_before; /* first voxel along u, v, w; whether flips before it along w count for it */
  int last[3], unused;       /* voxel behind the last one */
  uint step[4];              /* bits from a voxel to the next one along u, v, w */
  uint facet_first, facet_count, ordered, few_columns;
} Job;

/* A triangle along u, v, w: a corner, and the differences of the others to it, turned so that they run around to
   the left. */
typedef struct Triangle {
  int3 a, b, c;
  long nw; /* twice the area of the projection, above 0 */
} Triangle;

inline int part_of(int4 p, int axis) {
  return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

/* False if the facet covers no column by its area, or is one of those that the CPU does: their points are marked or
   lie too far apart. */
inline bool load_triangle(Triangle *t, const Job *job, __global const int4 *points, __global const uint *corners,
                          uint facet) {
  int4 p = points[corners[3 * facet]], q = points[corners[3 * facet + 1]], r = points[corners[3 * facet + 2]];
  int4 low = min(min(p, q), r), size = max(max(p, q), r) - low;
  if ((p.w | q.w | r.w) != 0 || size.x > 1 << 20 || size.y > 1 << 20 || size.z > 1 << 20)
    return false;
  q -= p;
  r -= p;
  t->a = (int3)(part_of(p, job->axes[0]), part_of(p, job->axes[1]), part_of(p, job->axes[2]));
  t->b = (int3)(part_of(q, job->axes[0]), part_of(q, job->axes[1]), part_of(q, job->axes[2]));
  t->c = (int3)(part_of(r, job->axes[0]), part_of(r, job->axes[1]), part_of(r, job->axes[2]));
  t->nw = (long)t->b.x * t->c.y - (long)t->b.y * t->c.x;
  if (t->nw < 0) {
    int3 swap = t->b;
    t->b = t->c;
    t->c = swap;
    t->nw = -t->nw;
  }
  return t->nw != 0;
}

/* One side of the projected triangle: a column lies inside where the value is 0 or more. */
typedef struct Side {
  long value, u_step, v_step;
} Side;

/* The side from (u0, v0) by (du, dv), with its value at column (pu, pv). On the line itself the perturbation decides:
   the axis that comes first has the larger one. */
inline Side side_of(int u0, int v0, int du, int dv, int pu, int pv, int bits, bool u_first) {
  bool on = u_first ? (dv != 0 ? dv < 0 : du > 0) : (du != 0 ? du > 0 : dv < 0);
  Side side;
  side.value = (long)du * (pv - v0) - (long)dv * (pu - u0) - (on ? 0 : 1);
  side.u_step = -((long)dv << bits);
  side.v_step = (long)du << bits;
  return side;
}

/* Where columns cross a triangle's plane: the first centre beyond it has number base + 1 + floor (across / step). */
typedef struct Plane {
  long across, u_step, v_step, step;
  int base;
} Plane;

inline Plane plane_of(const Triangle *t, const Job *job, int pu, int pv) {
  long nu = (long)t->b.y * t->c.z - (long)t->b.z * t->c.y, nv = (long)t->b.z * t->c.x - (long)t->b.x * t->c.z;
  /* A centre on the plane lies beyond it if the perturbation moves it along the normal: its first component in the
     order x, y, z that is not 0 decides. */
  int ou = job->axes[0], ov = job->axes[1];
  long first = ou == 0 ? nu : ov == 0 ? nv : t->nw, second = ou == 1 ? nu : ov == 1 ? nv : t->nw;
  long third = ou == 2 ? nu : ov == 2 ? nv : t->nw;
  bool on_is_beyond = (first != 0 ? first : second != 0 ? second : third) > 0;
  int unit = 1 << job->bits;
  Plane plane;
  plane.base = t->a.z >> job->bits;
  long offset = t->nw * (unit / 2 - (t->a.z - plane.base * unit)) + (on_is_beyond ? 1 : 0);
  plane.across = -nu * pu - nv * pv - offset;
  plane.u_step = -(nu << job->bits);
  plane.v_step = -(nv << job->bits);
  plane.step = t->nw << job->bits;
  return plane;
}

/* The first voxel of a column beyond the triangle. Within the triangle the quotient is below 2^13, so that an estimate
   in floats is off by less than one; the rest tells. */
inline int crossing(const Plane *plane, long across) {
  int quotient = (int)floor((float)across / (float)plane->step);
  long rest = across - quotient * plane->step;
  return plane->base + 1 + quotient - (rest < 0 ? 1 : 0) + (rest >= plane->step ? 1 : 0);
}

/* First voxel whose centre lies at or beyond a coordinate. */
inline int first_voxel(int at, int bits) {
  return (at + ((1 << bits) / 2 - 1)) >> bits;
}

/* The columns of the tile among which are all that the triangle covers: u in x and z, v in y and w; none if z <= x or
   w <= y. */
inline int4 columns_of(const Triangle *t, const Job *job) {
  int u0 = t->a.x + min(min(t->b.x, t->c.x), 0), u1 = t->a.x + max(max(t->b.x, t->c.x), 0);
  int v0 = t->a.y + min(min(t->b.y, t->c.y), 0), v1 = t->a.y + max(max(t->b.y, t->c.y), 0);
  return (int4)(max(first_voxel(u0, job->bits), job->first[0]), max(first_voxel(v0, job->bits), job->first[1]),
                min(first_voxel(u1, job->bits), job->last[0]), min(first_voxel(v1, job->bits), job->last[1]));
}

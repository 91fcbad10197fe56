/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Surfaces, triangle by triangle, by rules.h: the box, the plane, and the edges seen along each axis, in the integers
 * of the CPU. A triangle is looked at along the axis w that its normal leans to most, so that it has few voxels in each
 * column. Differences are at most 2^20 steps, as is a voxel, so that all sums stay below 5 x 2^60 and fit 63 bits.
 */
typedef struct SurfaceJob { /* vxm_slab_surface */
  int first[3], bits;
  int last[3], thin;
  uint step[4];
  uint triangle_count, few_columns;
  int shift, shadow; /* along x: by how much points are moved; whether what lies before the first voxel counts
                        for it */
} SurfaceJob;

/* Where the voxels go: a bit for each. */
typedef struct Voxels {
  __global uint *bits;
  __global const ulong *places;         /* of cells, and of bricks */
  __global const uint *cells, *before; /* of bricks only */
} Voxels;

/* A side seen along an axis: a voxel meets it where the value is 0 or more. It belongs to the first voxel of
   the box and changes from voxel to voxel along the two other axes. */
typedef struct Line {
  long at, p_step, q_step;
} Line;

/* A triangle along u, v, w: axes in cyclic order, of which w is the one looked along. */
typedef struct Shape {
  int3 corner[3];
  long3 normal;
  int3 begin, end; /* voxels whose closed boxes meet that of the triangle, within the slab */
  int3 first;      /* voxel of the slab */
  uint3 step;
  int w; /* number of the axis */
} Shape;

/* Takes a voxel of the triangle. */
static inline void set_voxel(const Voxels *voxels, const Shape *t, const SurfaceJob *job, int u, int v, int w);

static inline int3 turned(int x, int y, int z, int w) {
  return w == 0 ? (int3)(y, z, x) : w == 1 ? (int3)(z, x, y) : (int3)(x, y, z);
}

/* False if it has no voxel of the slab, or is one of those that the CPU does. */
static inline bool load_shape(Shape *t, const SurfaceJob *job, __global const int4 *points,
                       __global const uint *corners, uint triangle) {
  int4 a = points[corners[3 * triangle]], b = points[corners[3 * triangle + 1]], c = points[corners[3 * triangle + 2]];
  a.x += job->shift;
  b.x += job->shift;
  c.x += job->shift;
  int4 low = min(min(a, b), c), high = max(max(a, b), c), size = high - low;
  int unit = 1 << job->bits;
  if ((a.w | b.w | c.w) != 0 || size.x > 1 << 20 || size.y > 1 << 20 || size.z > 1 << 20)
    return false;
  int3 begin = (int3)(max(vxm_first_touched(low.x, unit, job->bits), job->first[0]),
                      max(vxm_first_touched(low.y, unit, job->bits), job->first[1]),
                      max(vxm_first_touched(low.z, unit, job->bits), job->first[2]));
  int3 end = (int3)(min(vxm_end_touched(high.x, job->bits), job->last[0]),
                    min(vxm_end_touched(high.y, job->bits), job->last[1]),
                    min(vxm_end_touched(high.z, job->bits), job->last[2]));
  if (job->shadow != 0)
    end.x = max(end.x, 1);
  if (begin.x >= end.x || begin.y >= end.y || begin.z >= end.z)
    return false;
  int4 p = b - a, q = c - a;
  long nx = vxm_cross(p.y, p.z, q.y, q.z), ny = vxm_cross(p.z, p.x, q.z, q.x);
  long nz = vxm_cross(p.x, p.y, q.x, q.y);
  long lean_x = (long)abs(nx), lean_y = (long)abs(ny), lean_z = (long)abs(nz);
  if ((lean_x | lean_y | lean_z) == 0) { /* a line: along its longest side */
    lean_x = size.x;
    lean_y = size.y;
    lean_z = size.z;
  }
  int w = lean_x >= lean_y && lean_x >= lean_z ? 0 : lean_y >= lean_z ? 1 : 2;
  t->w = w;
  t->corner[0] = turned(a.x, a.y, a.z, w);
  t->corner[1] = turned(b.x, b.y, b.z, w);
  t->corner[2] = turned(c.x, c.y, c.z, w);
  t->normal = w == 0 ? (long3)(ny, nz, nx) : w == 1 ? (long3)(nz, nx, ny) : (long3)(nx, ny, nz);
  t->begin = turned(begin.x, begin.y, begin.z, w);
  t->end = turned(end.x, end.y, end.z, w);
  t->first = turned(job->first[0], job->first[1], job->first[2], w);
  t->step = w == 0   ? (uint3)(job->step[1], job->step[2], job->step[0])
            : w == 1 ? (uint3)(job->step[2], job->step[0], job->step[1])
                     : (uint3)(job->step[0], job->step[1], job->step[2]);
  return true;
}

/* The side from (p0, q0) to (p1, q1), of a triangle with this component of the normal along the axis looked
   along, at voxel (p, q). */
static inline Line line_of(const SurfaceJob *job, int p0, int q0, int p1, int q1, long normal, int p, int q) {
  int middle = (1 << job->bits) / 2;
  vxm_edge edge = vxm_edge_of(p1 - p0, q1 - q0, middle, normal >= 0, job->thin != 0);
  Line line;
  line.at = vxm_edge_value(edge, (p << job->bits) + middle - p0, (q << job->bits) + middle - q0);
  line.p_step = edge.p << job->bits;
  line.q_step = edge.q << job->bits;
  return line;
}

static inline long value_at(const Line *line, int p, int q) {
  return line->at + p * line->p_step + q * line->q_step;
}

/* Sets what the triangle has in some columns: of the rows from `v_first` on every `v_stride`-th, from u_begin
   to u_end - 1, all of them counted from the box's first. */
static inline void set_columns(const Shape *t, const SurfaceJob *job, int v_first, int v_stride, int u_begin,
                        int u_end, const Voxels *voxels) {
  int bits_below = job->bits, unit = 1 << bits_below, middle = unit / 2;
  Line along_u[3], along_v[3], along_w[3];
  for (int e = 0; e < 3; e++) {
    int3 p = t->corner[e], q = t->corner[e == 2 ? 0 : e + 1];
    along_w[e] = line_of(job, p.x, p.y, q.x, q.y, t->normal.z, t->begin.x, t->begin.y);
    along_u[e] = line_of(job, p.y, p.z, q.y, q.z, t->normal.x, t->begin.y, t->begin.z);
    along_v[e] = line_of(job, p.z, p.x, q.z, q.x, t->normal.y, t->begin.z, t->begin.x);
  }
  long3 n = t->normal;
  long reach = middle * vxm_plane_reach(n.x, n.y, n.z, job->thin != 0);
  long to_u = (t->begin.x << bits_below) + middle - t->corner[0].x,
       to_v = (t->begin.y << bits_below) + middle - t->corner[0].y;
  float down = (float)(t->corner[0].z & (unit - 1)) / (float)unit;
  for (int v = v_first; v < t->end.y - t->begin.y; v += v_stride) {
    long e0 = value_at(&along_w[0], u_begin, v), e1 = value_at(&along_w[1], u_begin, v);
    long e2 = value_at(&along_w[2], u_begin, v);
    for (int u = u_begin; u < u_end; u++) {
      bool meets = (e0 | e1 | e2) >= 0;
      e0 += along_w[0].p_step;
      e1 += along_w[1].p_step;
      e2 += along_w[2].p_step;
      if (!meets)
        continue;
      long across = n.x * (to_u + ((long)u << bits_below)) + n.y * (to_v + ((long)v << bits_below));
      int begin = t->begin.z, end = t->end.z;
      if (n.z != 0) { /* the plane passes at most 1.5 voxels from the centres of its voxels */
        int around =
            (int)floor(down - ((float)across / (float)n.z) / (float)unit) + (t->corner[0].z >> bits_below);
        begin = max(begin, around - 3);
        end = min(end, around + 4);
      }
      for (int k = begin; k < end; k++) {
        long off = across + n.z * ((k << bits_below) + middle - t->corner[0].z);
        int w = k - t->begin.z;
        if ((long)abs(off) > reach ||
            (value_at(&along_u[0], v, w) | value_at(&along_u[1], v, w) | value_at(&along_u[2], v, w)) < 0 ||
            (value_at(&along_v[0], w, u) | value_at(&along_v[1], w, u) | value_at(&along_v[2], w, u)) < 0)
          continue;
        set_voxel(voxels, t, job, u + t->begin.x, v + t->begin.y, k);
      }
    }
  }
}

/* The share of one work-item where its group does a triangle: rows, and parts of rows where these are few. */
static inline void set_share(const Shape *t, const SurfaceJob *job, const Voxels *voxels) {
  int3 size = t->end - t->begin;
  int parts = max(1, GROUP / size.y), share = (size.x + parts - 1) / parts;
  int row = (int)get_local_id(0) / parts, part = (int)get_local_id(0) % parts;
  if (row < GROUP / parts)
    set_columns(t, job, row, GROUP / parts, part * share, min((part + 1) * share, size.x), voxels);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The rules that say which voxels a triangle has, for the CPU, OpenGL and OpenCL alike: this file is C, GLSL
 * with GL_ARB_gpu_shader_int64 and OpenCL C at once, as NanoVDB's PNanoVDB.h is several languages. Functions
 * take numbers and give numbers, without pointers or arrays.
 *
 * In C it is included once for each type of products; see src/voxel/lattice/rules.h. There are said before:
 *   RULE(name)      what functions and structs are called
 *   RULE_WIDE       the type of products: differences up to 2^20 steps and voxels of up to 2^16 need 64 bits
 *   RULE_STEP       the type of coordinates, of their differences and of the numbers of voxels
 *   RULE_QUOTIENT   the type of what is left of a division
 *   RULE_TO_WIDE, RULE_ABS, RULE_MAX, RULE_FUNCTION and RULE_TYPE, as below
 *   RULE_EDGES_ONLY for vectors, of which C asks no conditions (src/voxel/surface/surface_i64.inc)
 */
#if defined(GL_core_profile)
#define RULE(name) name
#define RULE_TYPE(name)
#define RULE_FUNCTION
#define RULE_WIDE int64_t
#define RULE_STEP int
#define RULE_QUOTIENT int
#define RULE_TO_WIDE(x) int64_t(x)
#define RULE_ABS(x) abs(x)
#define RULE_MAX(a, b) max(a, b)
#elif defined(__OPENCL_C_VERSION__) || defined(__OPENCL_VERSION__)
#define RULE(name) name
#define RULE_TYPE(name) typedef struct name name;
#define RULE_FUNCTION static inline
#define RULE_WIDE long
#define RULE_STEP int
#define RULE_QUOTIENT int
#define RULE_TO_WIDE(x) ((long)(x))
#define RULE_ABS(x) ((long)abs(x))
#define RULE_MAX(a, b) max(a, b)
#endif

#ifndef RULE_EDGES_ONLY
/* Twice the area, with its sign, between (ap, aq) and (bp, bq): above 0 where b lies to the left of a. For
   two sides of a triangle, p and q being the axes behind axis r (y and z behind x, x and y behind z), it is
   component r of the normal. */
RULE_FUNCTION RULE_WIDE RULE(vxm_cross)(RULE_STEP ap, RULE_STEP aq, RULE_STEP bp, RULE_STEP bq) {
  return RULE_TO_WIDE(ap) * RULE_TO_WIDE(bq) - RULE_TO_WIDE(aq) * RULE_TO_WIDE(bp);
}

/*
 * Crossing: the columns along an axis w that a triangle covers, and the voxel that it flips in each, the
 * first one the centre of which lies beyond it. u and v are the other axes, in any order. Voxel i has its
 * centre at i * unit + unit / 2. Centres on a side or on the plane are told apart by the perturbation of the
 * lattice (src/voxel/lattice/lattice.h), which moves them by (e, e^2, e^3) along x, y, z, e infinitely small.
 */

/* The first voxel whose centre lies at or beyond a coordinate. A triangle covers at most the columns from
   that of its least coordinate on up to the one before that of its greatest. */
RULE_FUNCTION RULE_STEP RULE(vxm_first_centre)(RULE_STEP at, RULE_STEP unit, int bits) {
  return (at + (unit / 2 - 1)) >> bits;
}

/* A triangle by the differences of corners b and c to corner a, which change places where that makes it run
   around to the left, seen along w. */
struct RULE(vxm_projected) {
  RULE_STEP bu, bv, bw, cu, cv, cw;
  RULE_WIDE nw; /* twice the area of the projection: 0 or more, and with 0 no column is covered */
};
RULE_TYPE(RULE(vxm_projected))

RULE_FUNCTION RULE(vxm_projected)
    RULE(vxm_project)(RULE_STEP bu, RULE_STEP bv, RULE_STEP bw, RULE_STEP cu, RULE_STEP cv, RULE_STEP cw) {
  RULE(vxm_projected) t;
  RULE_WIDE nw = RULE(vxm_cross)(bu, bv, cu, cv);
  bool turned = nw < RULE_TO_WIDE(0);
  t.bu = turned ? cu : bu;
  t.bv = turned ? cv : bv;
  t.bw = turned ? cw : bw;
  t.cu = turned ? bu : cu;
  t.cv = turned ? bv : cv;
  t.cw = turned ? bw : cw;
  t.nw = turned ? -nw : nw;
  return t;
}

/* A side of the projection: a column lies to the left of it, inside, where `value` is 0 or more. That changes
   by u_step and v_step from column to column. */
struct RULE(vxm_side) {
  RULE_WIDE value, u_step, v_step;
};
RULE_TYPE(RULE(vxm_side))

/* Side 0 from a to b, 1 from b to c, 2 from c to a; its value in the column whose centre lies at (pu, pv)
 * from a. */
RULE_FUNCTION RULE(vxm_side) RULE(vxm_side_of)(RULE(vxm_projected) t, int side, RULE_STEP pu, RULE_STEP pv,
                                               RULE_STEP unit, bool u_first) {
  RULE_STEP u0 = side == 0 ? 0 : side == 1 ? t.bu : t.cu, v0 = side == 0 ? 0 : side == 1 ? t.bv : t.cv;
  RULE_STEP u1 = side == 0 ? t.bu : side == 1 ? t.cu : 0, v1 = side == 0 ? t.bv : side == 1 ? t.cv : 0;
  RULE_STEP du = u1 - u0, dv = v1 - v0;
  /* On the line itself the perturbation (eu, ev) decides: it adds du ev - dv eu, and the axis that comes
     first has the larger one. */
  bool inside = u_first ? (dv != 0 ? dv < 0 : du > 0) : (du != 0 ? du > 0 : dv < 0);
  RULE(vxm_side) line;
  line.value = RULE(vxm_cross)(du, dv, pu - u0, pv - v0) - RULE_TO_WIDE(inside ? 0 : 1);
  line.u_step = -RULE_TO_WIDE(dv) * RULE_TO_WIDE(unit);
  line.v_step = RULE_TO_WIDE(du) * RULE_TO_WIDE(unit);
  return line;
}

/* The plane of a triangle as columns cross it: voxel number base + floor (across / step) is flipped. `across`
   changes by u_step and v_step from column to column. */
struct RULE(vxm_plane) {
  RULE_WIDE across, u_step, v_step, step;
  RULE_STEP base;
};
RULE_TYPE(RULE(vxm_plane))

/* The plane where a column's centre lies at (pu, pv) from a, which is at a_w along w; u and v are numbers of
 * axes. */
RULE_FUNCTION RULE(vxm_plane) RULE(vxm_plane_of)(RULE(vxm_projected) t, RULE_STEP a_w, RULE_STEP pu,
                                                 RULE_STEP pv, RULE_STEP unit, int bits, int u, int v) {
  RULE_WIDE nu = RULE(vxm_cross)(t.bv, t.bw, t.cv, t.cw), nv = RULE(vxm_cross)(t.bw, t.bu, t.cw, t.cu);
  RULE_WIDE nx = u == 0 ? nu : v == 0 ? nv : t.nw, ny = u == 1 ? nu : v == 1 ? nv : t.nw;
  RULE_WIDE nz = u == 2 ? nu : v == 2 ? nv : t.nw;
  /* A centre on the plane lies beyond it if the perturbation moves it along the normal: the first component
     that is not 0 decides. */
  bool beyond = (nx != RULE_TO_WIDE(0) ? nx : ny != RULE_TO_WIDE(0) ? ny : nz) > RULE_TO_WIDE(0);
  /* From corner a up to the centre of its voxel. Centre k voxels further on lies beyond the plane where
     nw (up + k unit) + nu pu + nv pv > 0, or is 0 and moved beyond. */
  RULE_STEP up = unit / 2 - (a_w & (unit - 1));
  RULE(vxm_plane) plane;
  plane.across = -nu * RULE_TO_WIDE(pu) - nv * RULE_TO_WIDE(pv) -
                 (t.nw * RULE_TO_WIDE(up) + RULE_TO_WIDE(beyond ? 1 : 0));
  plane.u_step = -nu * RULE_TO_WIDE(unit);
  plane.v_step = -nv * RULE_TO_WIDE(unit);
  plane.step = t.nw * RULE_TO_WIDE(unit);
  plane.base = (a_w >> bits) + 1;
  return plane;
}

/* floor (t / d), d > 0, of an estimate that is off by one at most: the rest tells. */
RULE_FUNCTION RULE_QUOTIENT RULE(vxm_round_down)(RULE_WIDE t, RULE_WIDE d, RULE_QUOTIENT estimate) {
  RULE_WIDE rest = t - RULE_TO_WIDE(estimate) * d;
  return estimate - (rest < RULE_TO_WIDE(0) ? 1 : 0) + (rest >= d ? 1 : 0);
}

/*
 * Touching: the voxels of a triangle's surface, by the tests of Schwarz & Seidel 2010
 * (src/voxel/surface/surface_draw.h): the box, the plane, and in each projection the edges. All are closed.
 */

/* The voxels whose closed extents meet a range of coordinates: those from the one of its least on, up to the
   one before that of its greatest. */
RULE_FUNCTION RULE_STEP RULE(vxm_first_touched)(RULE_STEP least, RULE_STEP unit, int bits) {
  return ((least + (unit - 1)) >> bits) - 1;
}

RULE_FUNCTION RULE_STEP RULE(vxm_end_touched)(RULE_STEP greatest, int bits) {
  return (greatest >> bits) + 1;
}

/* A voxel meets the plane with normal n where |n . (centre - corner)| is at most half a voxel's width times
   this: for the conservative surface so far does a voxel reach, for the thin one (section 3.4) the octahedron
   in it. */
RULE_FUNCTION RULE_WIDE RULE(vxm_plane_reach)(RULE_WIDE nx, RULE_WIDE ny, RULE_WIDE nz, bool thin) {
  RULE_WIDE x = RULE_ABS(nx), y = RULE_ABS(ny), z = RULE_ABS(nz);
  return thin ? RULE_MAX(RULE_MAX(x, y), z) : x + y + z;
}
#endif

/* An edge seen along an axis: its normal in the projection, which points inward, and the reach of a voxel
 * along it. */
struct RULE(vxm_edge) {
  RULE_WIDE p, q, reach;
};
RULE_TYPE(RULE(vxm_edge))

/* The edge along (dp, dq). `left`: the triangle lies to its left. That is so where the component of the
   triangle's normal along the axis is 0 or more and p, q and the axis are x, y, z turned around. */
RULE_FUNCTION RULE(vxm_edge)
    RULE(vxm_edge_of)(RULE_STEP dp, RULE_STEP dq, RULE_STEP half_unit, bool left, bool thin) {
  RULE(vxm_edge) edge;
  edge.p = RULE_TO_WIDE(left ? -dq : dq);
  edge.q = RULE_TO_WIDE(left ? dp : -dp);
  RULE_WIDE p = RULE_ABS(edge.p), q = RULE_ABS(edge.q);
  edge.reach = RULE_TO_WIDE(half_unit) * (thin ? RULE_MAX(p, q) : p + q);
  return edge;
}

/* A voxel whose centre lies at (p, q) from the edge's first corner meets the edge where this is 0 or more. */
RULE_FUNCTION RULE_WIDE RULE(vxm_edge_value)(RULE(vxm_edge) edge, RULE_WIDE p, RULE_WIDE q) {
  return edge.p * p + edge.q * q + edge.reach;
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/bits.h"
#include "voxel/thin/meetings.h"

#include <math.h>
#include <stdlib.h>

/** The last voxel whose centre lies before a point that is numerator / denominator lattice steps beyond the
 * centre of voxel 0; denominator > 0.
 *
 * @param beyond whether a point on a centre lies beyond it: elsewhere it lies before it, as the centres'
 * perturbation has it */
static int64_t voxel_before(vxm_int128 numerator, vxm_int128 denominator, int64_t unit, bool beyond) {
  vxm_int128 step = denominator * unit, quotient = numerator / step, rest = numerator % step;
  return (int64_t)(quotient - (rest < 0 || (rest == 0 && !beyond)));
}

/** A segment and the squares across one axis. */
typedef struct segment {
  int64_t from[3],
      rise[3]; /**< lattice steps from the centre of voxel 0; `rise` along the axis is positive */
  double part; /**< 1 / rise along the axis */
  int axis;
} segment;

static inline segment segment_of(const vxm_lattice *lattice, const vxm_point *p, const vxm_point *q,
                                 int axis) {
  segment s = {.axis = axis, .part = 1.0 / (double)(q->at[axis] - p->at[axis])};
  for (int a = 0; a < 3; a++) {
    s.from[a] = p->at[a] - lattice->unit / 2;
    s.rise[a] = q->at[a] - p->at[a];
  }
  return s;
}

/** Where it passes through the plane of a voxel's centres, along another axis: the last voxel before that,
 * and how far it is behind its centre, in parts of a voxel. The plane is moved, too: by more than centres are
 * along a later axis, so that there a point on a centre follows the segment. */
static inline int64_t pass_plane(const segment *s, int64_t plane, int64_t unit, double inverse, int a,
                                 double *rest) {
  int64_t along = plane * unit - s->from[s->axis];
  double at = ((double)s->from[a] + (double)s->rise[a] * ((double)along * s->part)) * inverse;
  int64_t voxel = (int64_t)at;
  voxel -= (double)voxel > at; /* the conversion rounds toward zero */
  *rest = at - (double)voxel;
  const double doubt = 1e-6; /* of a voxel; the error is less, but far out */
  const int64_t near = (VXM_DIM_MAX << 2) * unit;
  if (*rest > doubt && *rest < 1 - doubt && llabs(s->from[a]) < near && llabs(s->rise[a]) < near)
    return voxel;
  voxel = voxel_before((vxm_int128)s->from[a] * s->rise[s->axis] + (vxm_int128)s->rise[a] * along,
                       s->rise[s->axis], unit, a > s->axis && s->rise[a] > 0);
  *rest = at - (double)voxel;
  return voxel;
}

/** Whether a square has a voxel set. */
static bool is_filled(const vxm_view *view, const int64_t lowest[3], int axis, bool *held) {
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (lowest[u] >= view->begin[u] && lowest[u] + 1 < view->end[u] && lowest[v] >= view->begin[v] &&
      lowest[v] + 1 < view->end[v]) { /* `axis` is that of a plane in the view */
    int64_t bit = vxm_view_bit(view, lowest);
    *held = true;
    return vxm_view_bit_set(view, bit) || vxm_view_bit_set(view, bit + view->step[u]) ||
           vxm_view_bit_set(view, bit + view->step[v]) ||
           vxm_view_bit_set(view, bit + view->step[u] + view->step[v]);
  }
  int64_t ends[8][3];
  int count = vxm_dual_ends(ends, VXM_DUAL_SQUARE + axis, lowest);
  return vxm_view_any_set(view, (const int64_t(*)[3])ends, count, held);
}

static void look_at_square(vxm_meetings *meetings, const vxm_thin_job *job, const int64_t lowest[3], int axis,
                           const double (*offsets)[3], int count) {
  bool held;
  if (is_filled(&job->view, lowest, axis, &held) || !held)
    return;
  vxm_meetings_put(meetings, &job->view, VXM_DUAL_SQUARE + axis, lowest, offsets, count);
}

/* Two numbers at a time: along the two axes of a plane. */
typedef double two __attribute__((vector_size(16)));
typedef int64_t two_masks __attribute__((vector_size(16)));

/** floor, for numbers below 2^51. */
static inline two floor_two(two x) {
  const two shift = {0x1.8p52, 0x1.8p52}, one = {1, 1};
  two nearest = (x + shift) - shift;
  return nearest - (two)((two_masks)(nearest > x) & (two_masks)one);
}

static inline bool any(two_masks masks) {
  return (masks[0] | masks[1]) != 0;
}

static inline two size_of(two x) {
  const two_masks sign = {INT64_MIN, INT64_MIN};
  return (two)((two_masks)x & ~sign);
}

/** The corners of a triangle in voxels from the centre of voxel 0: across a plane, and in it. */
typedef struct corners {
  double across[3];
  two in[3];
} corners;

/** A corner of a triangle and two others on the same side of it along an axis: sections between the sides to
 * them become longer from the corner on. */
typedef struct tip {
  int corner, ends[2];
  int64_t begin, end, step; /**< planes */
} tip;

/** A section: the voxels before its ends along both axes of its plane, and how far behind their centres they
 * lie. */
typedef struct section {
  int64_t before[2][2];
  double rest[2][2];
} section;

/** The same exactly. */
static section exact_section(const vxm_lattice *lattice, const vxm_point points[3], const tip *t,
                             int64_t plane, int axis) {
  const int u = axis == 0, v = 2 - (axis == 2);
  double inverse = 1.0 / (double)lattice->unit;
  section out;
  for (int i = 0; i < 2; i++) {
    segment side = t->step > 0 ? segment_of(lattice, &points[t->corner], &points[t->ends[i]], axis)
                               : segment_of(lattice, &points[t->ends[i]], &points[t->corner], axis);
    out.before[i][0] = pass_plane(&side, plane, lattice->unit, inverse, u, &out.rest[i][0]);
    out.before[i][1] = pass_plane(&side, plane, lattice->unit, inverse, v, &out.rest[i][1]);
  }
  return out;
}

/** A triangle whose sections are looked at. */
typedef struct looked {
  const vxm_thin_job *job;
  vxm_meetings *meetings;
  vxm_link_frame *frames; /**< NULL: links are looked at elsewhere */
  const vxm_point *points;
  bool is_far; /**< a corner lies so far out that doubles are not enough */
} looked;

/**
 * The links along the last axis, counted from that across the plane, which a section crosses: in each of the
 * lines of centres along it that lie between the section's ends.
 */
static void cross_lines(const looked *l, const section *s, int64_t plane, int axis) {
  const int across = axis == 2 ? 0 : axis + 1, along = axis == 0 ? 2 : axis - 1, lane = axis == 1;
  const vxm_view *view = &l->job->view;
  const vxm_link_frame *f = &l->frames[along];
  int64_t begin = vxm_min(s->before[0][lane], s->before[1][lane]) + 1,
          end = vxm_max(s->before[0][lane], s->before[1][lane]) + 1;
  begin = vxm_max(begin, view->begin[across]);
  end = vxm_min(end, view->end[across]);
  if (begin >= end)
    return;
  double p[2], q[2]; /* the ends, across the lines and along them */
  for (int k = 0; k < 2; k++) {
    int of = k == 0 ? lane : 1 - lane;
    p[k] = (double)s->before[0][of] + s->rest[0][of];
    q[k] = (double)s->before[1][of] + s->rest[1][of];
  }
  double slope = (q[1] - p[1]) / (q[0] - p[0]);
  bool is_steep = !(fabs(slope) < 500); /* so that what the ends are off by matters */
  int64_t bit = view->origin + plane * view->step[axis] + begin * view->step[across];
  for (int64_t line = begin; line < end; line++, bit += view->step[across]) {
    double at = p[1] + slope * ((double)line - p[0]);
    int64_t to = is_steep ? 0 : (int64_t)at;
    to -= (double)to > at; /* the conversion rounds toward zero */
    double rest = at - (double)to;
    const double doubt = 1e-6;
    int64_t column_u = f->u == axis ? plane : line, column_v = f->u == axis ? line : plane;
    if (is_steep || rest < doubt || rest > 1 - doubt)
      to = vxm_link_voxel(f, l->points, column_u, column_v, &rest);
    else
      to++;
    bool inside = to > view->begin[along] && to < view->end[along];
    if (!inside || !(vxm_view_bit_set(view, bit + to * view->step[along]) ||
                     vxm_view_bit_set(view, bit + (to - 1) * view->step[along])))
      vxm_meet_link(f, column_u, column_v, to, rest - 0.5);
  }
}

/** What the sections of a tip meet. */
static void cross_tip(const looked *l, const corners *at, const tip *t, int axis) {
  const vxm_view *view = &l->job->view;
  const int u = axis == 0, v = 2 - (axis == 2); /* the other axes, lower first */
  const two doubt = {1e-6, 1e-6}, one = {1, 1}; /* of a voxel; the error is below 2^-10 steps of 2^-16 */
  const double level = at->across[t->corner];
  const two from = at->in[t->corner];
  const double p_part = 1 / (at->across[t->ends[0]] - level), q_part = 1 / (at->across[t->ends[1]] - level);
  const two p = (at->in[t->ends[0]] - from) * p_part, q = (at->in[t->ends[1]] - from) * q_part;
  for (int64_t plane = t->begin; plane != t->end; plane += t->step) {
    double along = (double)plane - level;
    two end[2] = {from + p * along, from + q * along};
    if (!l->frames && !l->is_far && any(size_of(end[0] - end[1]) > one + doubt))
      return; /* from here on longer than a square */
    if (plane < view->begin[axis] || plane >= view->end[axis])
      continue;
    two before[2] = {floor_two(end[0]), floor_two(end[1])};
    two rest[2] = {end[0] - before[0], end[1] - before[1]};
    section s = {
        {{(int64_t)before[0][0], (int64_t)before[0][1]}, {(int64_t)before[1][0], (int64_t)before[1][1]}},
        {{rest[0][0], rest[0][1]}, {rest[1][0], rest[1][1]}}};
    if (l->is_far ||
        any((rest[0] < doubt) | (rest[1] < doubt) | (rest[0] > one - doubt) | (rest[1] > one - doubt)))
      s = exact_section(&l->job->placed->lattice, l->points, t, plane, axis);
    if (s.before[0][0] == s.before[1][0] && s.before[0][1] == s.before[1][1]) {
      int64_t lowest[3];
      double offset[2][3] = {{s.rest[0][0] - 0.5, s.rest[0][1] - 0.5, 0},
                             {s.rest[1][0] - 0.5, s.rest[1][1] - 0.5, 0}};
      lowest[axis] = plane;
      lowest[u] = s.before[0][0];
      lowest[v] = s.before[0][1];
      look_at_square(l->meetings, l->job, lowest, axis, (const double(*)[3])offset, 2);
    } else if (l->frames)
      cross_lines(l, &s, plane, axis);
  }
}

/**
 * What the sections of a triangle across an axis meet: the square in which one lies whole, or links. Where a
 * section leaves a square it crosses a link of it, which has a voxel.
 */
static void cross_sections(const looked *l, int axis) {
  /* corners from low to high, by whether 0 lies above 1, 1 above 2, and 0 above 2 */
  static const uint8_t orders[8][3] = {{0, 1, 2}, {1, 0, 2}, {0, 2, 1}, {0, 1, 2},
                                       {0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  const vxm_point *points = l->points;
  int64_t level[3];
  for (int k = 0; k < 3; k++)
    level[k] = points[k].at[axis];
  const uint8_t *order =
      orders[(level[0] > level[1]) | (level[1] > level[2]) << 1 | (level[0] > level[2]) << 2];
  int p = order[0], q = order[1], r = order[2];
  const vxm_lattice *lattice = &l->job->placed->lattice;
  int64_t low = vxm_lattice_first(lattice, level[p]), middle = vxm_lattice_first(lattice, level[q]),
          high = vxm_lattice_first(lattice, level[r]);
  const int u = axis == 0, v = 2 - (axis == 2);
  const double inverse = 1.0 / (double)lattice->unit; /* a power of two */
  corners at;
  for (int k = 0; k < 3; k++) {
    at.across[k] = (double)level[k] * inverse - 0.5;
    at.in[k] = (two){(double)points[k].at[u] * inverse - 0.5, (double)points[k].at[v] * inverse - 0.5};
  }
  const tip tips[2] = {{p, {q, r}, low, middle, 1}, {r, {q, p}, high - 1, middle - 1, -1}};
  for (int i = 0; i < 2; i++)
    if (tips[i].begin != tips[i].end)
      cross_tip(l, &at, &tips[i], axis);
}

/** Whether a corner lies more voxels out than there are along the longest axis, or nearly so. */
static bool is_far(const vxm_lattice *lattice, const vxm_point p[3]) {
  const int64_t most = (VXM_DIM_MAX << 1) * lattice->unit;
  bool far = false;
  for (int k = 0; k < 3; k++)
    for (int a = 0; a < 3; a++)
      far |= p[k].at[a] > most || p[k].at[a] < -most;
  return far;
}

/** Whether a triangle is longer than some voxels. */
static bool is_large(const vxm_lattice *lattice, const vxm_point p[3]) {
  enum { LARGE = 20 };
  int64_t longest = 0;
  for (int a = 0; a < 3; a++)
    longest = vxm_max(longest, vxm_max(vxm_max(p[0].at[a], p[1].at[a]), p[2].at[a]) -
                                   vxm_min(vxm_min(p[0].at[a], p[1].at[a]), p[2].at[a]));
  return longest > LARGE * lattice->unit;
}

/** Whether links along axes may have no voxel; `*told`: whether `unsure` says which. */
static bool are_unsure(vxm_link_frame *frames, const vxm_point points[3], vxm_unsure_links *unsure,
                       bool *told) {
  const vxm_thin_job *job = frames[0].job;
  vxm_octree_sieve sieve;
  *told = job->directions == VXM_LINK_AXES &&
          vxm_octree_sieve_of(&sieve, &job->view, &job->placed->lattice, points);
  if (!*told)
    return true;
  *unsure = vxm_unsure_links_none();
  return vxm_octree_sieve_search(&sieve, &frames[0].inner, unsure);
}

void vxm_meet_sections(vxm_link_frame *frames, size_t triangle, uint64_t differ) {
  const vxm_thin_job *job = frames[0].job;
  const uint32_t *corner = job->corners[triangle];
  vxm_point points[3];
  for (int k = 0; k < 3; k++)
    points[k] = vxm_snapped_points_at(job->placed, corner[k]);
  /* Links of large triangles are cheaper found row by row, and some not at all by sections. */
  bool alone = job->directions > VXM_LINK_AXES || is_large(&job->placed->lattice, points);
  vxm_unsure_links unsure;
  bool told, links = are_unsure(frames, points, &unsure, &told);
  if (alone && links)
    vxm_meet_links(frames, triangle, differ, told ? &unsure : NULL);
  vxm_link_surface surface = links ? vxm_link_surface_of(points) : (vxm_link_surface){.size = {0}};
  for (int d = 0; d < VXM_LINK_AXES && links && !alone; d++) {
    frames[d].surface = &surface;
  }
  looked l = {job, frames[0].meetings, alone || !links ? NULL : frames, points,
              is_far(&job->placed->lattice, points)};
  for (int axis = 0; axis < 3; axis++)
    if (differ & vxm_cell_mask(axis))
      cross_sections(&l, axis);
}

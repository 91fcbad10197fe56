/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Drawing triangles of any size, and those that stick out of the grid, in 128-bit integers.
 *
 * Voxels are numbered from the one that holds corner 0, and corners measured from that voxel's least corner.
 * All tests are linear in the voxel's numbers, so along a row each one leaves a half-line, whose end is found
 * by a division for the first row and from there on by adding quotient and remainder of the step.
 *
 * Bounds. The largest difference D of two corners is below 2^41, a voxel's width u at least 2^8 and at most
 * 2^16. A component of the normal, twice the area of a projection, is at most D^2; voxels of the grid and
 * near it have numbers below 2^33 + 2^20. So n . voxel < 3 2^82 2^34 < 2^118 and n . (u / 2 - p) + u / 2 R(n)
 * <= 3 D^2 u < 2^100, and the edges have one factor D less.
 */
#include "voxel/surface/surface_draw.h"

typedef vxm_int128 integer;

/** floor (t / d) and the rest, for d > 0. */
static inline void divide_floor(integer t, integer d, integer *quotient, integer *rest) {
  integer q = t / d, r = t - q * d, below = r < 0;
  *quotient = q - below;
  *rest = below ? r + d : r;
}

typedef struct {
  int64_t at[3][3]; /* corner, role: in lattice steps */
  integer normal[3];
  integer low, high; /* a voxel meets the plane where low <= normal . voxel <= high */
  int64_t origin[3];
} plane_shape;

/** a x + c y + b >= 0 */
typedef struct {
  integer a, c, b;
} test_line;

/** The corners change places where that makes the normal's component along the bits positive. */
static inline void shape_of(plane_shape *shape, const vxm_surface_pen *pen, const vxm_point *const v[3]) {
  const vxm_lattice *lattice = pen->lattice;
  const vxm_layout layout = pen->window->layout;
  const int axis[3] = {layout.fast, layout.middle, layout.slow};
  int64_t e1[3], e2[3];
  for (int r = 0; r < 3; r++) {
    int64_t least = v[0]->at[axis[r]] & -lattice->unit;
    shape->origin[r] = least >> lattice->bits;
    for (int c = 0; c < 3; c++)
      shape->at[c][r] = v[c]->at[axis[r]] - least;
    e1[r] = shape->at[1][r] - shape->at[0][r];
    e2[r] = shape->at[2][r] - shape->at[0][r];
  }
  integer *n = shape->normal;
  n[0] = vxm_cross_128(e1[1], e1[2], e2[1], e2[2]);
  n[1] = vxm_cross_128(e1[2], e1[0], e2[2], e2[0]);
  n[2] = vxm_cross_128(e1[0], e1[1], e2[0], e2[1]);
  if (n[0] < 0)
    for (int r = 0; r < 3; r++) {
      int64_t kept = shape->at[1][r];
      shape->at[1][r] = shape->at[2][r];
      shape->at[2][r] = kept;
      n[r] = -n[r];
    }
  integer half = lattice->unit / 2, centre = 0;
  integer reach = half * vxm_plane_reach_128(n[0], n[1], n[2], pen->kind == VXM_SURFACE_THIN);
  for (int r = 0; r < 3; r++)
    centre += n[r] * (half - shape->at[0][r]);
  /* -reach <= unit n . voxel + centre <= reach, rounded to whole multiples of the unit */
  shape->high = (reach - centre) >> lattice->bits;
  shape->low = -((reach + centre) >> lattice->bits);
}

/** The test of edge e in the projection to roles x and y; a is 0 where the box already implies it. */
static inline test_line edge_test(const vxm_surface_pen *pen, const plane_shape *shape, int e, int x, int y) {
  const int64_t *p = shape->at[e], *q = shape->at[e == 2 ? 0 : e + 1], half = pen->lattice->unit / 2;
  bool left = (shape->normal[3 - x - y] >= 0) == (y == (x + 1) % 3);
  vxm_edge_128 edge = vxm_edge_of_128(q[x] - p[x], q[y] - p[y], half, left, pen->kind == VXM_SURFACE_THIN);
  integer at_first = vxm_edge_value_128(edge, half - p[x], half - p[y]);
  return (test_line){edge.p, edge.q, at_first >> pen->lattice->bits};
}

/**
 * Narrows spans of x in rows y, y + 1, ... to where the line's test holds. Spans count from the grid's first
 * voxel, which is number -origin; they begin and end within [least, most].
 */
static inline void clip_spans(const test_line *line, int64_t origin, int64_t y, vxm_surface_span *spans,
                              size_t count, int32_t least, int32_t most) {
  integer value = line->c * (integer)y + line->b;
  if (line->a == 0) {
    for (size_t i = 0; i < count; i++, value += line->c)
      spans[i].end = value < 0 ? least : spans[i].end;
    return;
  }
  integer d = line->a < 0 ? -line->a : line->a, q, r, step_q, step_r;
  divide_floor(value, d, &q, &r);
  divide_floor(line->c, d, &step_q, &step_r);
  if (line->a < 0) { /* x <= value / d */
    q += origin + 1;
    for (size_t i = 0; i < count; i++) {
      integer end = q > least ? q : least;
      spans[i].end = end < spans[i].end ? (int32_t)end : spans[i].end;
      r += step_r;
      integer carry = r >= d;
      q += step_q + carry;
      r -= carry ? d : 0;
    }
  } else { /* x >= -value / d */
    q -= origin;
    for (size_t i = 0; i < count; i++) {
      integer begin = -q < most ? -q : most;
      spans[i].begin = begin > spans[i].begin ? (int32_t)begin : spans[i].begin;
      r += step_r;
      integer carry = r >= d;
      q += step_q + carry;
      r -= carry ? d : 0;
    }
  }
}

/** Clips spans of role x, one for each y of [y_begin, y_end), by the three edges seen in that projection. */
static inline void clip_edges(const vxm_surface_pen *pen, const plane_shape *shape,
                              const vxm_surface_box *box, int x, int y, int64_t y_begin, int64_t y_end,
                              vxm_surface_span *spans) {
  int32_t least = (int32_t)box->begin[x], most = (int32_t)box->end[x];
  size_t count = (size_t)(y_end - y_begin);
  for (size_t i = 0; i < count; i++)
    spans[i] = (vxm_surface_span){least, most};
  for (int e = 0; e < 3; e++) {
    test_line line = edge_test(pen, shape, e, x, y);
    if (line.a != 0)
      clip_spans(&line, shape->origin[x], y_begin - shape->origin[y], spans, count, least, most);
  }
}

/** Where the plane lies between voxels begin and end - 1 of some row along the bits: two lines in (middle,
 * slow). */
static inline void plane_lines(const plane_shape *shape, int64_t begin, int64_t end, test_line lines[2]) {
  const integer *n = shape->normal;
  integer first = begin - shape->origin[0], last = end - 1 - shape->origin[0];
  lines[0] = (test_line){-n[1], -n[2], shape->high - n[0] * first};
  lines[1] = (test_line){n[1], n[2], n[0] * last - shape->low};
}

/**
 * Where a triangle sticks out of the grid along the bits, its box may have far more rows and slices than hold
 * voxels of it: narrows the range of `role` by the edges, each at its better end of the bits.
 */
static void narrow_box(const vxm_surface_pen *pen, const plane_shape *shape, vxm_surface_box *box, int role) {
  vxm_surface_span span = {(int32_t)box->begin[role], (int32_t)box->end[role]};
  for (int e = 0; e < 3; e++) {
    test_line line = edge_test(pen, shape, e, role, VXM_FAST);
    int64_t best = line.c > 0 ? box->end[VXM_FAST] - 1 : box->begin[VXM_FAST];
    clip_spans(&line, shape->origin[role], best - shape->origin[VXM_FAST], &span, 1,
               (int32_t)box->begin[role], (int32_t)box->end[role]);
  }
  box->begin[role] = span.begin;
  box->end[role] = span.end;
}

/** Rows across.begin..across.end-1 of slice s: `along` holds for the slice, `rows` for each of them. */
static inline void draw_slice(const vxm_surface_pen *pen, const plane_shape *shape, int64_t s,
                              vxm_surface_span across, vxm_surface_span along, const vxm_surface_span *rows) {
  const integer *n = shape->normal;
  size_t stride = pen->window->row_words;
  uint64_t *row = vxm_surface_row(pen, across.begin, s);
  size_t count = (size_t)(across.end - across.begin);
  if (n[0] == 0) { /* seen edge-on along the bits, where the edges imply the plane */
    for (size_t i = 0; i < count; i++, row += stride)
      vxm_row_set_span(row, vxm_max(rows[i].begin, along.begin), vxm_min(rows[i].end, along.end));
    return;
  }
  integer d = n[0], q, r, step_q, step_r, width_q, width_r;
  integer rest =
      shape->high - n[1] * (across.begin - shape->origin[1]) - n[2] * (integer)(s - shape->origin[2]);
  divide_floor(rest, d, &q, &r);
  divide_floor(-n[1], d, &step_q, &step_r);
  divide_floor(shape->high - shape->low, d, &width_q, &width_r);
  q += shape->origin[0];
  for (size_t i = 0; i < count; i++, row += stride) {
    /* floor (rest / d) is q, and ceil ((rest - width) / d) is q - width_q, one more where r > width_r. */
    integer begin = q - width_q + (r > width_r), end = q + 1;
    int32_t least = rows[i].begin > along.begin ? rows[i].begin : along.begin;
    int32_t most = rows[i].end < along.end ? rows[i].end : along.end;
    begin = begin > least ? begin : least;
    end = end < most ? end : most;
    if (begin < end)
      vxm_row_set_span(row, (int64_t)begin, (int64_t)end);
    r += step_r;
    integer carry = r >= d;
    q += step_q + carry;
    r -= carry ? d : 0;
  }
}

size_t vxm_surface_draw_wide(const vxm_surface_pen *pen, const vxm_point *const v[3], vxm_surface_box box) {
  plane_shape shape;
  shape_of(&shape, pen, v);
  narrow_box(pen, &shape, &box, VXM_MIDDLE);
  narrow_box(pen, &shape, &box, VXM_SLOW);
  if (box.begin[VXM_MIDDLE] >= box.end[VXM_MIDDLE] || box.begin[VXM_SLOW] >= box.end[VXM_SLOW])
    return 1;
  int64_t s_begin = box.begin[VXM_SLOW], s_end = box.end[VXM_SLOW];
  size_t slices = (size_t)(s_end - s_begin), done = slices;
  int32_t m_least = (int32_t)box.begin[VXM_MIDDLE], m_most = (int32_t)box.end[VXM_MIDDLE];
  vxm_surface_span across[VXM_SURFACE_SLICES], along[VXM_SURFACE_SLICES];
  clip_edges(pen, &shape, &box, VXM_MIDDLE, VXM_SLOW, s_begin, s_end, across);
  clip_edges(pen, &shape, &box, VXM_FAST, VXM_SLOW, s_begin, s_end, along);
  if (shape.normal[0] != 0) {
    test_line lines[2];
    plane_lines(&shape, box.begin[VXM_FAST], box.end[VXM_FAST], lines);
    for (int i = 0; i < 2; i++)
      clip_spans(&lines[i], shape.origin[1], s_begin - shape.origin[2], across, slices, m_least, m_most);
  }
  int32_t m_begin = m_most, m_end = m_least;
  for (size_t i = 0; i < slices; i++) {
    if (across[i].begin >= across[i].end || along[i].begin >= along[i].end) {
      across[i].end = across[i].begin;
      continue;
    }
    m_begin = across[i].begin < m_begin ? across[i].begin : m_begin;
    m_end = across[i].end > m_end ? across[i].end : m_end;
  }
  if (m_begin >= m_end)
    return done;
  clip_edges(pen, &shape, &box, VXM_FAST, VXM_MIDDLE, m_begin, m_end, pen->rows);
  done += (size_t)(m_end - m_begin);
  for (size_t i = 0; i < slices; i++) {
    if (across[i].begin >= across[i].end)
      continue;
    draw_slice(pen, &shape, s_begin + (int64_t)i, across[i], along[i],
               pen->rows + (across[i].begin - m_begin));
    done += (size_t)(across[i].end - across[i].begin);
  }
  return done;
}

/* ---- Seen along the bits ---- */

void vxm_surface_shadow_of(vxm_surface_shadow *shadow, const vxm_surface_pen *pen,
                           const vxm_point *const v[3]) {
  plane_shape shape;
  test_line lines[5];
  shape_of(&shape, pen, v);
  shadow->count = 3;
  for (int e = 0; e < 3; e++)
    lines[e] = edge_test(pen, &shape, e, VXM_MIDDLE, VXM_SLOW);
  if (shape.normal[0] != 0) {
    plane_lines(&shape, 0, pen->window->fast_dim, lines + 3);
    shadow->count = 5;
  }
  for (int i = 0; i < shadow->count; i++) {
    shadow->line[i].a = lines[i].a;
    shadow->line[i].c = lines[i].c;
    shadow->line[i].b = lines[i].b;
  }
  for (int r = 0; r < 3; r++)
    shadow->origin[r] = shape.origin[r];
}

void vxm_surface_shadow_rows(const vxm_surface_shadow *shadow, int64_t s_begin, int64_t s_end, int64_t *begin,
                             int64_t *end) {
  vxm_surface_span span = {(int32_t)*begin, (int32_t)*end};
  for (int i = 0; i < shadow->count; i++) {
    test_line line = {shadow->line[i].a, shadow->line[i].c, shadow->line[i].b};
    int64_t best = line.c > 0 ? s_end - 1 : s_begin;
    clip_spans(&line, shadow->origin[VXM_MIDDLE], best - shadow->origin[VXM_SLOW], &span, 1, (int32_t)*begin,
               (int32_t)*end);
  }
  *begin = span.begin;
  *end = span.end;
}

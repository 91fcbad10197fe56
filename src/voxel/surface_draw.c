/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/surface_draw.h"

/**
 * floor (t / d) and the rest, for d > 0 and |t| < 2^52. The quotient of doubles is rounded correctly, and one
 * that is not whole differs from the next whole number by at least 1 / d, more than half a unit in its last
 * place: so it is never rounded up to one.
 */
static inline void divide_narrow(int64_t t, int64_t d, int64_t *quotient, int64_t *rest) {
  int64_t q = (int64_t)((double)t / (double)d), r = t - q * d; /* toward zero */
  int64_t below = r < 0;
  *quotient = q - below;
  *rest = below ? r + d : r;
}

static inline void divide_wide(vxm_int128 t, vxm_int128 d, vxm_int128 *quotient, vxm_int128 *rest) {
  vxm_int128 q = t / d, r = t - q * d, below = r < 0;
  *quotient = q - below;
  *rest = below ? r + d : r;
}

/* The same arithmetic twice: in 64 bits for triangles of ordinary size, in 128 bits for the others. */
#define INTEGER int64_t
#define NAME(name) name##_narrow
#include "voxel/surface_body.inc"
#undef INTEGER
#undef NAME

#define INTEGER vxm_int128
#define NAME(name) name##_wide
#include "voxel/surface_body.inc"
#undef INTEGER
#undef NAME

int64_t vxm_surface_narrow_max(const vxm_lattice *lattice) {
  int k = 30;
  for (; k > 0; k--) {
    vxm_int128 square = (vxm_int128)1 << 2 * k;
    vxm_int128 dividend = 3 * square * (((INT64_C(1) << k) >> lattice->bits) + 5);
    if (dividend < (vxm_int128)1 << 52 && 3 * square * lattice->unit < (vxm_int128)1 << 62)
      break;
  }
  return INT64_C(1) << k;
}

vxm_surface_box vxm_surface_bounds(const vxm_lattice *lattice, vxm_layout layout,
                                   const vxm_point *const v[3]) {
  const int axis[3] = {layout.fast, layout.middle, layout.slow};
  vxm_surface_box box;
  for (int r = 0; r < 3; r++) {
    int64_t a = v[0]->at[axis[r]], b = v[1]->at[axis[r]], c = v[2]->at[axis[r]];
    int64_t low = vxm_min(vxm_min(a, b), c), high = vxm_max(vxm_max(a, b), c);
    box.begin[r] = ((low + lattice->unit - 1) >> lattice->bits) - 1;
    box.end[r] = (high >> lattice->bits) + 1;
  }
  return box;
}

static bool is_narrow(const vxm_point *const v[3], int64_t most) {
  for (int a = 0; a < 3; a++) {
    int64_t p = v[0]->at[a], q = v[1]->at[a], r = v[2]->at[a];
    if (vxm_max(vxm_max(p, q), r) - vxm_min(vxm_min(p, q), r) > most)
      return false;
  }
  return true;
}

static size_t fill_box(const vxm_window *window, const vxm_surface_box *box) {
  for (int64_t s = box->begin[VXM_SLOW]; s < box->end[VXM_SLOW]; s++)
    for (int64_t m = box->begin[VXM_MIDDLE]; m < box->end[VXM_MIDDLE]; m++)
      vxm_row_set_span(vxm_window_row(window, m, s), box->begin[VXM_FAST], box->end[VXM_FAST]);
  return (size_t)((box->end[VXM_SLOW] - box->begin[VXM_SLOW]) *
                  (box->end[VXM_MIDDLE] - box->begin[VXM_MIDDLE]));
}

size_t vxm_surface_draw(const vxm_surface_pen *pen, const vxm_point *const v[3]) {
  vxm_surface_box whole = vxm_surface_bounds(pen->lattice, pen->window->layout, v), box;
  int flat = 0, thin = -1;
  for (int r = 0; r < 3; r++) {
    box.begin[r] = vxm_max(whole.begin[r], pen->tile.begin[r]);
    box.end[r] = vxm_min(whole.end[r], pen->tile.end[r]);
    if (box.begin[r] >= box.end[r])
      return 1;
    if (whole.end[r] - whole.begin[r] == 1) {
      flat++;
      thin = r;
    }
  }
  if (pen->kind != VXM_SURFACE_CONSERVATIVE)
    thin = -1; /* the box being one voxel thick does not make the plane pass there */
  else if (flat >= 2)
    return fill_box(pen->window, &box);
  bool is_cut = whole.begin[VXM_FAST] < box.begin[VXM_FAST] || whole.end[VXM_FAST] > box.end[VXM_FAST];
  if (is_narrow(v, pen->narrow_max))
    return draw_narrow(pen, v, box, thin, is_cut);
  return draw_wide(pen, v, box, thin, is_cut);
}

void vxm_surface_shadow_of(vxm_surface_shadow *shadow, const vxm_surface_pen *pen,
                           const vxm_point *const v[3]) {
  shape_wide shape;
  line_wide lines[5];
  shape_of_wide(&shape, pen, v);
  shadow->count = 3;
  for (int e = 0; e < 3; e++)
    lines[e] = edge_wide(pen, &shape, e, VXM_MIDDLE, VXM_SLOW);
  if (shape.normal[0] != 0) {
    plane_lines_wide(&shape, 0, pen->window->fast_dim, lines + 3);
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
    line_wide line = {shadow->line[i].a, shadow->line[i].c, shadow->line[i].b};
    int64_t best = line.c > 0 ? s_end - 1 : s_begin;
    clip_wide(&line, shadow->origin[VXM_MIDDLE], best - shadow->origin[VXM_SLOW], &span, 1, (int32_t)*begin,
              (int32_t)*end);
  }
  *begin = span.begin;
  *end = span.end;
}

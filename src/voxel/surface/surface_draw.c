/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/surface/surface_draw.h"
#include "base/cpu.h"

#include <stdatomic.h>

static int64_t narrow_max(const vxm_lattice *lattice) {
  int k = 30;
  for (; k > 0; k--) {
    vxm_int128 square = (vxm_int128)1 << 2 * k;
    vxm_int128 dividend = 3 * square * (((INT64_C(1) << k) >> lattice->bits) + VXM_SURFACE_LANES + 4);
    if (dividend < (vxm_int128)1 << 50 && 3 * square * lattice->unit < (vxm_int128)1 << 62)
      break;
  }
  return INT64_C(1) << k;
}

static int64_t lane_max(const vxm_lattice *lattice) {
  int64_t low = 0, high = INT64_C(1) << 18; /* the largest one with 3 D^2 (D + 3/2 unit) <= 2^53 */
  while (high - low > 1) {
    int64_t middle = (low + high) / 2;
    bool fits = 3 * middle * middle * (2 * middle + 3 * lattice->unit) <= INT64_C(1) << 54;
    low = fits ? middle : low;
    high = fits ? high : middle;
  }
  return low;
}

/** The largest D with which all of surface_few.inc fits for boxes of `side` voxels. */
static int64_t few_max(const vxm_lattice *lattice, int64_t side) {
  const int64_t u = lattice->unit;
  int64_t low = 0, high = INT64_C(1) << 15;
  while (high - low > 1) {
    int64_t d = (low + high) / 2, square = 3 * d * d;
    bool centre = d + u / 2 < INT64_C(1) << 15;
    bool edges = square + 2 * u * d < INT64_C(1) << 31;
    /* less 2 for rounding */
    bool plane = square * (d + u) < (u << 31) - 2 * u && square * (d + (side + 1) * u) < (u << 32) - 2 * u;
    bool fits = centre && edges && plane;
    low = fits ? d : low;
    high = fits ? high : d;
  }
  return low;
}

vxm_surface_pen vxm_surface_pen_of(const vxm_surface *surface, const vxm_window *window,
                                   vxm_surface_kind kind) {
  return (vxm_surface_pen){
      .surface = surface,
      .window = window,
      .lattice = &surface->lattice,
      .kind = kind,
      .build = vxm_surface_best(),
      .narrow_max = narrow_max(&surface->lattice),
      .lane_max = lane_max(&surface->lattice),
      .four_max = few_max(&surface->lattice, 4),
      .two_max = few_max(&surface->lattice, 2),
      .tile = {{0, 0, window->begin}, {window->fast_dim, window->middle_dim, window->end}}};
}

static size_t fill_box(const vxm_surface_pen *pen, const vxm_surface_box *box) {
  size_t rows = (size_t)(box->end[VXM_MIDDLE] - box->begin[VXM_MIDDLE]);
  for (int64_t s = box->begin[VXM_SLOW]; s < box->end[VXM_SLOW]; s++) {
    uint64_t *row = vxm_surface_row(pen, box->begin[VXM_MIDDLE], s);
    for (size_t m = 0; m < rows; m++, row += pen->window->row_words)
      vxm_row_set_span(row, box->begin[VXM_FAST], box->end[VXM_FAST]);
  }
  return (size_t)(box->end[VXM_SLOW] - box->begin[VXM_SLOW]) * rows;
}

/** The part of a triangle in a box of the tile of at most VXM_SURFACE_SLICES slices. */
static size_t draw_box(const vxm_surface_pen *pen, const vxm_point *const v[3],
                       const vxm_surface_bounds *bounds, const vxm_surface_box *box) {
  const vxm_surface_box *whole = &bounds->box;
  bool one[3] = {whole->end[0] - whole->begin[0] == 1, whole->end[1] - whole->begin[1] == 1,
                 whole->end[2] - whole->begin[2] == 1};
  int flat = one[0] + one[1] + one[2], thin = one[0] ? 0 : one[1] ? 1 : one[2] ? 2 : -1;
  if (pen->kind != VXM_SURFACE_CONSERVATIVE)
    thin = -1; /* the box being one voxel thick does not make the plane pass there */
  else if (flat >= 2)
    return fill_box(pen, box);
  bool is_cut = whole->begin[VXM_FAST] < box->begin[VXM_FAST] || whole->end[VXM_FAST] > box->end[VXM_FAST];
  if (bounds->longest <= pen->narrow_max && (!is_cut || thin >= 0))
    return pen->build->draw(pen, v, box, thin);
  return vxm_surface_draw_wide(pen, v, *box);
}

size_t vxm_surface_draw(const vxm_surface_pen *pen, const vxm_point *const v[3]) {
  vxm_surface_bounds bounds = vxm_surface_bounds_of(pen->lattice, pen->window->layout, v);
  vxm_surface_box box = bounds.box;
  size_t rows = 1;
  if (!vxm_surface_meet(&box, &pen->tile))
    return rows;
  for (int64_t end = box.end[VXM_SLOW]; box.begin[VXM_SLOW] < end; box.begin[VXM_SLOW] = box.end[VXM_SLOW]) {
    box.end[VXM_SLOW] = vxm_min(box.begin[VXM_SLOW] + VXM_SURFACE_SLICES, end);
    rows += draw_box(pen, v, &bounds, &box);
  }
  return rows;
}

/** Rows between two looks at the progress callback. */
enum { POLL_ROWS = 1 << 16 };

bool vxm_surface_draw_some(const vxm_surface_pen *pen, const uint32_t *list, size_t begin, size_t end,
                           vxm_task_progress *progress, int worker) {
  size_t rows = 0;
  for (size_t from = begin, to; from < end; from = to) {
    to = end - from < VXM_SURFACE_AT_ONCE ? end : from + VXM_SURFACE_AT_ONCE;
    if (!pen->surface->wide)
      rows += pen->build->draw_narrow(pen, list, from, to);
    else
      for (size_t i = from; i < to; i++) {
        const vxm_point *v[3];
        vxm_point copies[3];
        vxm_surface_corners(pen->surface, list ? list[i] : i, v, copies);
        rows += 1 + vxm_surface_draw(pen, v);
      }
    if (rows < POLL_ROWS)
      continue;
    rows = 0;
    if (vxm_task_progress_stopped(progress, worker))
      return false;
  }
  return true;
}

/* ---- Builds ---- */

extern const vxm_surface_build vxm_surface_build_plain, vxm_surface_build_avx2, vxm_surface_build_avx512;

static const vxm_surface_build *const builds[] = VXM_CPU_BUILDS(vxm_surface_build);

static _Atomic(const vxm_surface_build *) chosen;

size_t vxm_surface_builds(const vxm_surface_build *out[3]) {
  size_t count = (size_t)vxm_cpu_used() + 1;
  for (size_t i = 0; i < count; i++)
    out[i] = builds[i];
  return count;
}

void vxm_surface_force(const vxm_surface_build *build) {
  atomic_store_explicit(&chosen, build, memory_order_relaxed);
}

const vxm_surface_build *vxm_surface_best(void) {
  const vxm_surface_build *forced = atomic_load_explicit(&chosen, memory_order_relaxed);
  return forced ? forced : builds[vxm_cpu_used()];
}

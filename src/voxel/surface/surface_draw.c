/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/surface/surface_draw.h"
#include "base/cpu.h"

#include <stdatomic.h>

int64_t vxm_surface_narrow_max(const vxm_lattice *lattice) {
  int k = 30;
  for (; k > 0; k--) {
    vxm_int128 square = (vxm_int128)1 << 2 * k;
    vxm_int128 dividend = 3 * square * (((INT64_C(1) << k) >> lattice->bits) + VXM_SURFACE_LANES + 4);
    if (dividend < (vxm_int128)1 << 50 && 3 * square * lattice->unit < (vxm_int128)1 << 62)
      break;
  }
  return INT64_C(1) << k;
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

size_t vxm_surface_draw(const vxm_surface_pen *pen, const vxm_point *const v[3]) {
  vxm_surface_bounds bounds = vxm_surface_bounds_of(pen->lattice, pen->window->layout, v);
  vxm_surface_box whole = bounds.box, box = whole;
  if (!vxm_surface_meet(&box, &pen->tile))
    return 1;
  bool one[3] = {whole.end[0] - whole.begin[0] == 1, whole.end[1] - whole.begin[1] == 1,
                 whole.end[2] - whole.begin[2] == 1};
  int flat = one[0] + one[1] + one[2], thin = one[0] ? 0 : one[1] ? 1 : one[2] ? 2 : -1;
  if (pen->kind != VXM_SURFACE_CONSERVATIVE)
    thin = -1; /* the box being one voxel thick does not make the plane pass there */
  else if (flat >= 2)
    return fill_box(pen, &box);
  bool is_cut = whole.begin[VXM_FAST] < box.begin[VXM_FAST] || whole.end[VXM_FAST] > box.end[VXM_FAST];
  if (bounds.longest <= pen->narrow_max && (!is_cut || thin >= 0))
    return pen->build->draw(pen, v, &box, thin);
  return vxm_surface_draw_wide(pen, v, box);
}

/* ---- Builds ---- */

extern const vxm_surface_build vxm_surface_build_plain, vxm_surface_build_avx2, vxm_surface_build_avx512;

static _Atomic(const vxm_surface_build *) chosen;

size_t vxm_surface_builds(const vxm_surface_build *out[3]) {
  size_t count = 0;
  out[count++] = &vxm_surface_build_plain;
#if VXM_KERNELS_X86
  if (vxm_cpu_has_avx2())
    out[count++] = &vxm_surface_build_avx2;
  if (vxm_cpu_has_avx512())
    out[count++] = &vxm_surface_build_avx512;
#endif
  return count;
}

void vxm_surface_force(const vxm_surface_build *build) {
  atomic_store_explicit(&chosen, build, memory_order_relaxed);
}

const vxm_surface_build *vxm_surface_best(void) {
  const vxm_surface_build *forced = atomic_load_explicit(&chosen, memory_order_relaxed), *all[3];
  return forced ? forced : all[vxm_surface_builds(all) - 1];
}

/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Zhang et al. 2007, conservative voxelization: a triangle is drawn along the dominant axis of its normal,
 * onto all pixels that it overlaps, and in each the range of depths that its plane has over the pixel, cut to
 * the triangle's own, is set. The planes of the other two projections are not asked, and the depths are those
 * of a shader, in floats and rounded outward: both set voxels that the triangle does not touch.
 */
#include "experimental/touch.h"

#include <float.h>
#include <math.h>

typedef struct range {
  int64_t first, last;
} range;

/** Depths of the plane over a pixel of a voxel's width. */
static range depths(const vxm_touch *t, const int64_t voxel[3]) {
  int w = t->dominant, u = (w + 1) % 3, v = (w + 2) % 3;
  float unit = (float)t->lattice->unit, nw = (float)t->normal[w];
  float slope_u = -(float)t->normal[u] / nw, slope_v = -(float)t->normal[v] / nw;
  float middle = (float)t->corner[w] + slope_u * (float)vxm_touch_from(t, voxel[u], u, 0) +
                 slope_v * (float)vxm_touch_from(t, voxel[v], v, 0);
  float spread = (fabsf(slope_u) + fabsf(slope_v)) * unit / 2;
  float rounding = (fabsf(middle) + spread + unit) * 8 * FLT_EPSILON;
  return (range){(int64_t)floorf((middle - spread - rounding) / unit),
                 (int64_t)floorf((middle + spread + rounding) / unit)};
}

static void draw(const vxm_baseline_job *job, const vxm_touch *t) {
  int w = t->dominant, u = (w + 1) % 3, v = (w + 2) % 3;
  const int64_t *dims = job->grid->space.dims;
  int64_t voxel[3], u_end = vxm_min(t->end[u], dims[u]), v_end = vxm_min(t->end[v], dims[v]);
  for (voxel[v] = vxm_max(t->first[v], 0); voxel[v] < v_end; voxel[v]++)
    for (voxel[u] = vxm_max(t->first[u], 0); voxel[u] < u_end; voxel[u]++) {
      job->report->tests++;
      if (!vxm_touch_seen(t, voxel, w))
        continue;
      range all = {t->first[w], t->end[w] - 1};
      range depth = t->normal[w] != 0 ? depths(t, voxel) : all;
      int64_t last = vxm_min(vxm_min(depth.last, all.last), dims[w] - 1);
      for (voxel[w] = vxm_max(vxm_max(depth.first, all.first), 0); voxel[w] <= last; voxel[w]++)
        vxm_baseline_set(job->grid, voxel);
    }
}

vxm_status vxm_baseline_zhang(const vxm_baseline_job *job, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (size_t t = 0; t < job->surface->triangle_count && status == VXM_OK; t++) {
    vxm_point p[3];
    vxm_touch touch;
    vxm_baseline_triangle(p, job, t);
    vxm_touch_make(&touch, &job->surface->lattice, p, false);
    draw(job, &touch);
    status = vxm_check_cancelled_at(t, job->context, error);
  }
  return status;
}

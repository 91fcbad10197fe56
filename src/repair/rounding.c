/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/work.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>

/** Moves vertices to the nearest positions that 32-bit floats hold, before anything else looks at them. */
vxm_status vxm_pass_rounding(vxm_work *work, bool *changed, vxm_error *error) {
  vxm_soup *soup = work->soup;
  *changed = false;
  if (!work->options.single_precision)
    return VXM_OK;
  int64_t moved = 0;
  for (size_t v = 0; v < soup->vertex_count; v++) {
    double *p = soup->positions + 3 * v;
    bool same = true;
    for (int a = 0; a < 3; a++) {
      if (isfinite(p[a]) && fabs(p[a]) > (double)FLT_MAX)
        return vxm_fail_at(
            error, VXM_ERROR_RANGE, (vxm_place){NULL, 0, -1, (int64_t)v},
            "vertex %zu lies at %g, beyond what 32-bit floats hold; write another format than stl", v, p[a]);
      double rounded = vxm_work_round(work, p[a]);
      same = same && (rounded == p[a] || isnan(p[a]));
      p[a] = rounded;
    }
    moved += !same;
  }
  work->counts[VXM_PASS_ROUNDING] += moved;
  *changed = moved > 0;
  return VXM_OK;
}

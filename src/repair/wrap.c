/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/cgal.h"
#include "repair/work.h"

#include <math.h>

/** The last resort, which always gives a closed surface: one that is laid around everything. */
vxm_status vxm_pass_wrap(vxm_work *work, bool *changed, vxm_error *error) {
  *changed = false;
  if (!(work->options.wrap_alpha > 0) || work->soup->face_count == 0)
    return VXM_OK;
  vxm_extent extent;
  vxm_work_extent(work, &extent);
  const double *b = extent.bounds;
  double diagonal = hypot(hypot(b[3] - b[0], b[4] - b[1]), b[5] - b[2]);
  double alpha = work->options.wrap_alpha * diagonal;
  double offset = work->options.wrap_offset > 0 ? work->options.wrap_offset * diagonal : alpha / 30;
  const vxm_cgal *cgal;
  vxm_soup *soup;
  uint64_t *nearest;
  vxm_status status = vxm_cgal_open(&cgal, "wrapping a mesh", error);
  if (status == VXM_OK)
    status = cgal->wrap(&soup, &nearest, work->soup, alpha, offset, error);
  if (status != VXM_OK)
    return status;
  work->counts[VXM_PASS_WRAP] += (int64_t)soup->face_count;
  *changed = true;
  /* The tags are those of what lies beneath; parts are no longer told apart. */
  vxm_free(work->context, work->soup->face_parts);
  work->soup->face_parts = NULL;
  return vxm_work_adopt(work, soup, nearest, error);
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/cgal.h"
#include "repair/work.h"

/** Unites the parts that cut through each other. What is not closed cannot be united: then nothing is done,
 * and the verification tells. */
vxm_status vxm_pass_union(vxm_work *work, bool *changed, vxm_error *error) {
  *changed = false;
  if ((!work->options.unite && !vxm_work_reaches(work, VXM_LEVEL_SOLID)) || work->options.wrap_alpha > 0)
    return VXM_OK;
  vxm_status status = vxm_work_edges(work, error);
  if (status != VXM_OK || work->edges.count == 0)
    return status;
  for (size_t e = 0; e < work->edges.count; e++)
    if (work->edges.edges[e].count != 2)
      return VXM_OK;
  const vxm_cgal *cgal;
  vxm_face_pairs pairs = {0};
  status = vxm_cgal_open(&cgal, "uniting parts", error);
  if (status == VXM_OK)
    status = cgal->self_intersections(&pairs, work->soup, 1, error);
  vxm_free(work->context, pairs.pairs);
  if (status != VXM_OK || pairs.count == 0)
    return status;
  vxm_soup *soup;
  uint64_t *origin;
  vxm_union_report report;
  status = cgal->unite(&soup, &origin, &report, work->soup, error);
  if (status != VXM_OK)
    return status;
  vxm_free(work->context, report.failed_faces);
  work->ununited = report.failed;
  work->counts[VXM_PASS_UNION] += report.united;
  *changed = report.united > 0 || report.crossing > 0;
  return vxm_work_adopt(work, soup, origin, error);
}

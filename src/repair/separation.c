/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/fans.h"
#include "repair/openmesh.h"

/**
 * Makes the faces a manifold: cuts them apart, on vertices of their own at the same positions, where an edge
 * or vertex has too many. No face is lost. What is manifold already stays as it is.
 */
vxm_status vxm_pass_separation(vxm_work *work, bool *changed, vxm_error *error) {
  *changed = false;
  if (!vxm_work_reaches(work, VXM_LEVEL_MANIFOLD) || work->options.wrap_alpha > 0)
    return VXM_OK;
  bool manifold;
  vxm_status status = vxm_is_manifold(&manifold, work, error);
  if (status != VXM_OK || manifold)
    return status;
  const vxm_openmesh *openmesh;
  vxm_soup *soup;
  uint64_t *origin;
  int64_t detached, stitched;
  status = vxm_openmesh_open(&openmesh, "separating faces at edges and vertices that have too many", error);
  if (status == VXM_OK)
    status = openmesh->separate(&soup, &origin, &detached, &stitched, work->soup, error);
  if (status != VXM_OK)
    return status;
  work->counts[VXM_PASS_SEPARATION] += (int64_t)soup->vertex_count - (int64_t)work->soup->vertex_count;
  *changed = true;
  return vxm_work_adopt(work, soup, origin, error);
}

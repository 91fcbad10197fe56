/* SPDX-License-Identifier: BSD-3-Clause */
/** What is wrong with a mesh, and where. */
#ifndef VXM_REPAIR_DEFECTS_H
#define VXM_REPAIR_DEFECTS_H

#include "mesh/soup.h"

struct vxm_defects {
  vxm_context *context; /**< one reference held */
  vxm_defect *items;
  size_t count, capacity;
  size_t vertex_count, face_count;  /**< of the mesh */
  int64_t totals[VXM_DEFECT_KINDS]; /**< found, listed or not; -1 = not looked for */
};

/** vxm_mesh_defects; `most` is 0 for all. */
vxm_status vxm_defects_find(vxm_defects **out, const vxm_soup *soup, size_t most, bool intersections,
                            vxm_error *error);
/** vxm_defects_write. */
vxm_status vxm_defects_paint(const vxm_defects *defects, const vxm_soup *soup, const char *path,
                             vxm_error *error);

#endif

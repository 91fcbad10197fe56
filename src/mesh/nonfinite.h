/* SPDX-License-Identifier: BSD-3-Clause */
/** Faces of vertices that are not finite: repair removes them, so that nothing else may count on them. */
#ifndef VXM_MESH_NONFINITE_H
#define VXM_MESH_NONFINITE_H

#include "mesh/unit_scale.h"

/** Whether all corners of a face are finite. */
static inline bool vxm_face_is_finite(const vxm_soup *soup, const uint32_t *corner, size_t count) {
  for (size_t c = 0; c < count; c++)
    if (!vxm_is_finite(vxm_position(soup, corner[c])))
      return false;
  return true;
}

/** How many faces have a vertex that is not finite; `*first` of them, where there is one. */
size_t vxm_nonfinite_faces(size_t *first, const vxm_soup *soup);

/**
 * Gives each such face a single corner, many times, in the indices of a welded soup: it then has no edge,
 * repeats no face and keeps nothing closed, as if it were gone. The corner is a finite one if there is one,
 * so that the face stays in its component.
 */
void vxm_nonfinite_collapse(uint32_t *welded, const vxm_soup *soup);

#endif

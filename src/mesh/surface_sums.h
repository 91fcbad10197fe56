/* SPDX-License-Identifier: BSD-3-Clause */
/** Area, vector area and volume of all faces of a soup together. */
#ifndef VXM_MESH_SURFACE_SUMS_H
#define VXM_MESH_SURFACE_SUMS_H

#include "mesh/geometry.h"
#include "mesh/unit_scale.h"

typedef struct vxm_surface_sums {
  double area;          /**< in the frame */
  vxm_vec3 vector_area; /**< in the frame */
  double volume;        /**< model units, signed, about the middle of the bounds; of faces that are finite */
  size_t flat_faces;    /**< faces without area (vxm_unit_scale_no_area) */
} vxm_surface_sums;

/**
 * Threads look at the faces, whose shares are then added up in their order: the sums are the same however
 * many there are.
 *
 * @param bounds of the faces (vxm_extent), to which the frame belongs
 * @param flat   face_count elements that become 1 where a face has no area, else 0; may be NULL
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_surface_sums_of(vxm_surface_sums *out, const vxm_soup *soup, const double bounds[6],
                               const vxm_unit_scale *frame, uint8_t *flat, vxm_error *error);

#endif

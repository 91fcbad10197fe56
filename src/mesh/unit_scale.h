/* SPDX-License-Identifier: BSD-3-Clause */
/** Which vertices are used, the bounds of a soup, and the scale in which its areas are computed. */
#ifndef VXM_MESH_UNIT_SCALE_H
#define VXM_MESH_UNIT_SCALE_H

#include "mesh/soup.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * A face with at most this part of the squared diagonal of the bounds has no area. The shared meshes' counts
 * of degenerate faces ask for a value between 0.85e-14 and 1.29e-14.
 */
#define VXM_NO_AREA 1e-14

/** What a look at the vertices alone tells. */
typedef struct vxm_extent {
  size_t nonfinite; /**< vertices with a NaN or an infinity, used or not */
  size_t unused;    /**< vertices of no face */
  double bounds[6]; /**< x0 y0 z0 x1 y1 z1 of the finite vertices of faces; zeros if there are none */
} vxm_extent;

/** @param used vertex_count elements that are set to 1 where a face has the vertex, else to 0 */
void vxm_extent_of(vxm_extent *out, vxm_context *context, const vxm_soup *soup, uint8_t *used);
/** The same for those who do not ask which vertices are used. @return VXM_OK, VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_extent_find(vxm_extent *out, vxm_context *context, const vxm_soup *soup, vxm_error *error);

/**
 * The frame in which areas are computed, so that neither huge nor tiny models overflow or vanish: positions
 * times `scale`, a power of two with which the bounds are at most 1 long along an axis.
 */
typedef struct vxm_unit_scale {
  double scale;
  double diagonal;  /**< of the bounds, in the frame */
  double no_area;   /**< VXM_NO_AREA times the squared diagonal, in the frame */
  double centre[3]; /**< of the bounds, model units */
} vxm_unit_scale;

vxm_unit_scale vxm_unit_scale_of(const double bounds[6]);

/**
 * Whether a face has no area: the triangles from its first corner have VXM_NO_AREA times the squared diagonal
 * together at most, or it has a corner that is not finite.
 */
bool vxm_unit_scale_no_area(const vxm_unit_scale *frame, const vxm_soup *soup, size_t face);

static inline bool vxm_is_finite(const double p[3]) {
  /* infinity and NaN give NaN when taken from themselves */
  return p[0] - p[0] + (p[1] - p[1]) + (p[2] - p[2]) == 0;
}

#ifdef __cplusplus
}
#endif
#endif

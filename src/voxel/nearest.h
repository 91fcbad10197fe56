/* SPDX-License-Identifier: BSD-3-Clause */
/** A tree of boxes over triangles, for the nearest one to a point. */
#ifndef VXM_VOXEL_NEAREST_H
#define VXM_VOXEL_NEAREST_H

#include "base/context.h"

typedef struct vxm_nearest vxm_nearest;

/**
 * Makes a tree.
 *
 * @param corners three points of three coordinates for each triangle; the tree takes them over
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT; then the corners are freed too
 */
vxm_status vxm_nearest_create(vxm_nearest **out, vxm_context *context, double (*corners)[3][3], size_t count,
                              vxm_error *error);
/** NULL is allowed. */
void vxm_nearest_destroy(vxm_nearest *nearest);
/** Bytes of a tree of so many triangles. */
uint64_t vxm_nearest_bytes(size_t count);

/**
 * The squared distance to the nearest triangle, if that is below a bound, else the bound.
 *
 * @param triangle in: one to begin with, such as that of a point nearby; out: the nearest, if there is one
 * below the bound
 */
double vxm_nearest_distance2(const vxm_nearest *nearest, const double p[3], double bound, size_t *triangle);

#endif

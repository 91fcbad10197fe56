/* SPDX-License-Identifier: BSD-3-Clause */
/** The colour of any point of a mesh's surface, by its appearance. All colours are in linear light. */
#ifndef VXM_VOXEL_LABELS_SURFACE_PAINT_H
#define VXM_VOXEL_LABELS_SURFACE_PAINT_H

#include "mesh/soup.h"

/** A triangle of a face, by three of its corners. */
typedef struct vxm_painted_triangle {
  uint32_t face;
  uint32_t corner[3]; /**< counted from the face's first; they run to the left as seen from outside */
} vxm_painted_triangle;

typedef struct vxm_surface_paint {
  const vxm_soup *soup;
  vxm_painted_triangle *triangles;
  size_t count;
  float light[256]; /**< of bytes in sRGB */
} vxm_surface_paint;

/** Cuts the faces of a soup with an appearance into triangles; those with a corner that is not finite are
 * left out. @return VXM_OK; VXM_ERROR_RANGE; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED */
vxm_status vxm_surface_paint_open(vxm_surface_paint *paint, const vxm_soup *soup, vxm_error *error);
void vxm_surface_paint_close(vxm_surface_paint *paint);

void vxm_surface_paint_corners(double out[3][3], size_t triangle, const void *paint);

/** The colour of a point of a triangle, by the weights of its corners, which add up to 1. */
void vxm_surface_paint_color(const vxm_surface_paint *paint, size_t triangle, const double weight[3],
                             double rgb[3]);

/** How many pixels of a texture the points of a triangle with these weights are apart, the longer way along u
 * or v; 0 without a texture. */
double vxm_surface_paint_pixels(const vxm_surface_paint *paint, size_t triangle, const double (*weight)[3],
                                int count);

#endif

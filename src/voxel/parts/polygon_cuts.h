/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Polygons of many corners cut into pieces. Triangles from one corner to all edges
 * (voxel/parts/triangle_set.h) are long, and lie over each other as often as there are many; who looks at all
 * that each of them meets has less to do with pieces, most of which are as small as edges are short. Their
 * boundary is the polygon's, too: counted mod 2 they cover the same, whether or not it crosses itself, but
 * for how it is bent.
 */
#ifndef VXM_VOXEL_PARTS_POLYGON_CUTS_H
#define VXM_VOXEL_PARTS_POLYGON_CUTS_H

#include <stddef.h>
#include <stdint.h>

/** From so many corners on polygons are cut. */
enum { VXM_CUT_CORNERS = 64 };

/** Tells a piece; below it, bit k is for the side behind corner k, if that is an edge of the polygon. */
enum { VXM_CUT_PIECE = 8 };

/**
 * Cuts a polygon of n >= 3 corners.
 *
 * @param[out] pieces vertices of n - 2 triangles
 * @param[out] edges of each of them: VXM_CUT_PIECE, and which sides are edges
 */
void vxm_cut_polygon(const uint32_t *corners, size_t n, uint32_t (*pieces)[3], uint8_t *edges);

#endif

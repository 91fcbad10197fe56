/* SPDX-License-Identifier: BSD-3-Clause */
/** Drawing into large windows, tile by tile, on several threads. */
#ifndef VXM_VOXEL_SURFACE_SURFACE_TILES_H
#define VXM_VOXEL_SURFACE_SURFACE_TILES_H

#include "voxel/surface/surface_draw.h"

/** As vxm_surface_add, for a pen that has all but its words and rows; its tile is the window. */
vxm_status vxm_surface_add_tiled(const vxm_surface_pen *pen, bool is_fresh, vxm_error *error);

/** Takes what a worker has drawn into the pen's tile, with triangles of a list, and leaves its words zero. */
typedef void (*vxm_surface_take_fn)(const vxm_surface_pen *pen, const uint32_t *list, size_t count,
                                    int worker, void *payload);

/**
 * Draws the tiles that a triangle may touch, each of 2^bits rows and slices in words of its own, and hands
 * them over; in any order, on all threads.
 *
 * @param pen  as for vxm_surface_add_tiled, of all slices of a space; its window needs no words
 * @param bits at most 6
 */
vxm_status vxm_surface_take_tiles(const vxm_surface_pen *pen, int bits, vxm_surface_take_fn take,
                                  void *payload, vxm_error *error);

#endif

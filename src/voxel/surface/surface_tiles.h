/* SPDX-License-Identifier: BSD-3-Clause */
/** Drawing into large windows, tile by tile, on several threads. */
#ifndef VXM_VOXEL_SURFACE_SURFACE_TILES_H
#define VXM_VOXEL_SURFACE_SURFACE_TILES_H

#include "voxel/surface/surface_draw.h"

/** As vxm_surface_add, for a pen that has all but its words and rows; its tile is the window. */
vxm_status vxm_surface_add_tiled(const vxm_surface_pen *pen, bool is_fresh, vxm_error *error);

#endif

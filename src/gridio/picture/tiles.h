/* SPDX-License-Identifier: BSD-3-Clause */
/** Where in the picture voxels can be, and how far away: rays elsewhere see the background, and the others
 * need not begin at the eye. */
#ifndef VXM_GRIDIO_PICTURE_TILES_H
#define VXM_GRIDIO_PICTURE_TILES_H

#include "gridio/picture/camera.h"
#include "gridio/picture/shade.h"

/** Pixels along a side of a tile. */
enum { VXM_PICTURE_TILE = 8 };

typedef struct vxm_tiles {
  vxm_context *context;
  int width, height; /**< tiles */
  float *depth; /**< no voxel of a tile is nearer, along the axis of the camera; infinite if there is none */
} vxm_tiles;

/** @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_tiles_create(vxm_tiles *out, const vxm_scene *scene, const vxm_camera *cam, vxm_error *error);
void vxm_tiles_destroy(vxm_tiles *tiles);

/** That of a point of the picture, which may lie on its far borders. */
static inline float vxm_tiles_depth(const vxm_tiles *tiles, double x, double y) {
  return tiles->depth[((int)y / VXM_PICTURE_TILE) * tiles->width + (int)x / VXM_PICTURE_TILE];
}

#endif

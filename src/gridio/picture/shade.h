/* SPDX-License-Identifier: BSD-3-Clause */
/** What a ray of the picture sees: lit voxels, the floor with the shadow on it, or the background. */
#ifndef VXM_GRIDIO_PICTURE_SHADE_H
#define VXM_GRIDIO_PICTURE_SHADE_H

#include "gridio/picture/raycast.h"
#include "gridio/picture/vec3.h"

/**
 * Scene coordinates are voxel coordinates times `step`, so that the longest side of the grid is 1 and angles
 * are those of the model.
 */
/** The linear colour of a set voxel. */
typedef vxm_ray_vec3 (*vxm_paint_fn)(const void *payload, const int64_t voxel[3]);

typedef struct vxm_scene {
  const vxm_grid *grid;
  vxm_paint_fn paint;  /**< NULL = all voxels have one colour */
  const void *painted; /**< handed to paint */
  vxm_occupancy_mips pyramid;
  double step[3];
  vxm_ray_vec3 up, light; /**< unit; toward the light */
  vxm_ray_vec3 side[2];   /**< unit, square to the light and each other: its disk, for soft shadows */
  vxm_ray_vec3 centre;    /**< of the occupied box */
  double radius;          /**< of its sphere */
  double floor;           /**< height of its lowest side along `up` */
  double smoothness;      /**< 0: every voxel is seen as a cube; 1: voxels are too small for that */
  double line_width;      /**< of the lines between voxels, as a part of a voxel's side */
  struct {
    double mass, moment;
  } weighed[128]; /**< every pattern of 7 voxels in a row, weighed around its middle */
} vxm_scene;

/** Fills `weighed`; before the first ray. */
void vxm_scene_weigh(vxm_scene *scene);

/**
 * Light that comes along a ray, linear red, green and blue.
 *
 * @param jitter two numbers in [0, 1) that pick a point of the light
 */
vxm_ray_vec3 vxm_shade(const vxm_scene *scene, vxm_ray_vec3 origin, vxm_ray_vec3 direction,
                       const double jitter[2]);

#endif

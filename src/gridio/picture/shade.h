/* SPDX-License-Identifier: BSD-3-Clause */
/** What a ray of the picture sees: lit voxels, the floor with the shadow on it, or the background. */
#ifndef VXM_GRIDIO_PICTURE_SHADE_H
#define VXM_GRIDIO_PICTURE_SHADE_H

#include "gridio/picture/raycast.h"
#include "gridio/picture/vec3.h"

/** The linear colour of a set voxel. */
typedef vxm_ray_vec3 (*vxm_paint_fn)(const void *payload, const int64_t voxel[3]);

enum { VXM_SCENE_TURNS = 256 };

/**
 * What is looked at. Scene coordinates are voxel coordinates times `step`, so that the longest side of the
 * grid is 1 and angles are those of the model.
 */
typedef struct vxm_scene {
  const vxm_grid *grid;
  vxm_paint_fn paint;  /**< NULL = all voxels have one colour */
  const void *painted; /**< handed to paint */
  vxm_occupancy_mips mips;
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
  } weighed[128];                    /**< every pattern of 7 voxels in a row, weighed around its middle */
  double turned[VXM_SCENE_TURNS][2]; /**< points of a circle */
} vxm_scene;

/** Fills `weighed` and `turned`; before the first ray. */
void vxm_scene_weigh(vxm_scene *scene);

/** A voxel that a ray sees, linear red, green and blue. */
typedef struct vxm_light {
  vxm_ray_vec3 colour;
  vxm_ray_vec3 plain; /**< the same without shadows of the sun and lines between voxels, which are soft by
                         themselves: what tells where something ends */
} vxm_light;

/**
 * Light of the first voxel along a ray; false if there is none.
 *
 * @param jitter two numbers in [0, 1) that pick a point of the light
 */
bool vxm_shade(vxm_light *out, const vxm_scene *scene, vxm_ray_vec3 origin, vxm_ray_vec3 direction,
               const double jitter[2]);

/** Light of what is behind all voxels: white, with the shadow on the floor. @param turn of the sun's disk, in
 * which eight points are looked at */
vxm_ray_vec3 vxm_shade_background(const vxm_scene *scene, vxm_ray_vec3 origin, vxm_ray_vec3 direction,
                                  double turn);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** From where the picture is taken, in scene coordinates. */
#ifndef VXM_GRIDIO_PICTURE_CAMERA_H
#define VXM_GRIDIO_PICTURE_CAMERA_H

#include "gridio/picture/vec3.h"

typedef struct vxm_camera {
  vxm_ray_vec3 eye, back, right, top; /**< unit vectors; the camera looks along -back */
  double pixel;                       /**< width of a pixel at distance 1 */
  int width, height;
} vxm_camera;

/** The direction of the ray through a point of the picture, in pixels from its upper left corner. */
static inline vxm_ray_vec3 vxm_camera_direction(const vxm_camera *cam, double x, double y) {
  double across = (x - 0.5 * cam->width) * cam->pixel, upward = (0.5 * cam->height - y) * cam->pixel;
  vxm_ray_vec3 direction = vxm_ray_vec3_add(vxm_ray_vec3_scale(across, cam->right), upward, cam->top);
  return vxm_ray_vec3_unit(vxm_ray_vec3_add(direction, -1, cam->back));
}

#endif

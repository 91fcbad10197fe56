/* SPDX-License-Identifier: BSD-3-Clause */
/** Three numbers as a value, for the picture. */
#ifndef VXM_GRIDIO_PICTURE_VEC3_H
#define VXM_GRIDIO_PICTURE_VEC3_H

#include <math.h>

typedef struct vxm_ray_vec3 {
  double c[3];
} vxm_ray_vec3;

static inline vxm_ray_vec3 vxm_ray_vec3_of(double x, double y, double z) {
  return (vxm_ray_vec3){{x, y, z}};
}

/** a + scale * b */
static inline vxm_ray_vec3 vxm_ray_vec3_add(vxm_ray_vec3 a, double scale, vxm_ray_vec3 b) {
  return vxm_ray_vec3_of(a.c[0] + scale * b.c[0], a.c[1] + scale * b.c[1], a.c[2] + scale * b.c[2]);
}

static inline vxm_ray_vec3 vxm_ray_vec3_scale(double scale, vxm_ray_vec3 a) {
  return vxm_ray_vec3_of(scale * a.c[0], scale * a.c[1], scale * a.c[2]);
}

static inline double vxm_ray_vec3_dot(vxm_ray_vec3 a, vxm_ray_vec3 b) {
  return a.c[0] * b.c[0] + a.c[1] * b.c[1] + a.c[2] * b.c[2];
}

static inline vxm_ray_vec3 vxm_ray_vec3_cross(vxm_ray_vec3 a, vxm_ray_vec3 b) {
  return vxm_ray_vec3_of(a.c[1] * b.c[2] - a.c[2] * b.c[1], a.c[2] * b.c[0] - a.c[0] * b.c[2],
                         a.c[0] * b.c[1] - a.c[1] * b.c[0]);
}

/** Length 1; a null vector stays null. */
static inline vxm_ray_vec3 vxm_ray_vec3_unit(vxm_ray_vec3 a) {
  double length = sqrt(vxm_ray_vec3_dot(a, a));
  return length > 0 ? vxm_ray_vec3_scale(1 / length, a) : a;
}

#endif

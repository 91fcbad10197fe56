/* SPDX-License-Identifier: BSD-3-Clause */
/** The axes of formats in which y points up, as those of Minecraft and glTF. */
#ifndef VXM_GRIDIO_COMMON_Y_UP_H
#define VXM_GRIDIO_COMMON_Y_UP_H

#include "base/scalar.h"

/** How a model's axes become those: by a turn, never by a mirror. */
typedef struct vxm_y_up {
  int up;       /**< axis of the model that points up: 0 to 2 */
  int of[3];    /**< the model's axis along x, y and z of the format */
  bool back[3]; /**< which of these run the other way */
} vxm_y_up;

/** @param up 0 = z, 1 = x, 2 = y, 3 = z, as in vxm_grid_write_options */
static inline vxm_y_up vxm_y_up_of(int up) {
  switch (up) {
  case 1:
    return (vxm_y_up){0, {2, 0, 1}, {false, false, false}};
  case 2:
    return (vxm_y_up){1, {0, 1, 2}, {false, false, false}};
  default: /* what the model calls y is -z there */
    return (vxm_y_up){2, {0, 2, 1}, {false, false, true}};
  }
}

/** The voxel at a place of the format. @param dims of the model */
static inline void vxm_y_up_to_voxel(int64_t voxel[3], const vxm_y_up *axes, const int64_t dims[3],
                                     const int64_t place[3]) {
  for (int a = 0; a < 3; a++)
    voxel[axes->of[a]] = axes->back[a] ? dims[axes->of[a]] - 1 - place[a] : place[a];
}

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** What the walk of winding_walk.h asks about in a window, and what it does with the numbers of cells and
 * bricks. */
#ifndef VXM_VOXEL_WINDING_WINDING_SETTLE_H
#define VXM_VOXEL_WINDING_WINDING_SETTLE_H

#include "voxel/winding/winding_mesh.h"
#include "voxel/winding/winding_walk.h"

/** Bricks this close to a half are looked at again, voxels this close to it after that by doubles. */
#define VXM_WINDING_DOUBT 0.008F
#define VXM_WINDING_STRICT_DOUBT 3e-4F

/** Voxels that are asked about. */
typedef struct vxm_winding_asking {
  vxm_winding_walk walk; /**< the first, so that what is called back finds the rest */
  vxm_winding_mesh *mesh;
  const vxm_window *window;
  const uint64_t *asked; /**< as in vxm_winding_fill */
  uint8_t *confidence;
  int64_t begin[3], end[3]; /**< the voxels of the window along x, y, z */
  bool is_asked;            /**< mesh->asked says which cells are */
  bool is_alone;            /**< one thread works */
  const vxm_winding_kernels *kernels;
} vxm_winding_asking;

/** The window of what is decided, which begins as the winding number of the closed chain. */
static inline const vxm_window *vxm_winding_decided(const vxm_winding_asking *asking) {
  return &asking->mesh->closed.window;
}

/** Called back with the walk of a vxm_winding_asking: see vxm_winding_walk. */
bool vxm_winding_wants(const vxm_winding_walk *walk, const int64_t origin[3], int level);
void vxm_winding_settle_cell(const vxm_winding_walk *walk, const int64_t origin[3], int level, int number);
void vxm_winding_settle_brick(const vxm_winding_walk *walk, const int64_t origin[3],
                              const vxm_winding_brick *brick);

#endif

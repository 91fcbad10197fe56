/* SPDX-License-Identifier: BSD-3-Clause */
/** Where the models of a .vox file stand. */
#ifndef VXM_GRIDIO_FORMATS_VOX_VOX_SCENE_H
#define VXM_GRIDIO_FORMATS_VOX_VOX_SCENE_H

#include "gridio/formats/vox/vox_chunks.h"

/** A turn, which may mirror, and a step: coordinate a of the outside is `sign[a]` times coordinate `of[a]` of
 * the inside, plus `step[a]`. */
typedef struct vxm_vox_place {
  int of[3], sign[3];
  int64_t step[3];
} vxm_vox_place;

typedef struct vxm_vox_instance {
  const vxm_vox_model *model;
  vxm_vox_place place;
} vxm_vox_instance;

typedef struct vxm_vox_scene {
  vxm_context *context;
  vxm_vox_instance *items;
  size_t count, capacity;
  int64_t low[3], high[3]; /**< the box of all models; high is behind the last voxel */
  size_t left_out;         /**< models behind the first, where there are no nodes: frames of an animation */
} vxm_vox_scene;

/**
 * Finds all models that the scene shows, and their box. Without nodes it is the first model, whose corner is
 * 0.
 *
 * @return VXM_OK; VXM_ERROR_FORMAT with the byte offset; VXM_ERROR_RANGE for models too far away;
 * VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_vox_scene_read(vxm_vox_scene *out, const vxm_vox_file *file, vxm_error *error);
void vxm_vox_scene_destroy(vxm_vox_scene *scene);
/** Where a voxel of a model stands. */
void vxm_vox_voxel_at(int64_t at[3], const vxm_vox_instance *instance, const unsigned char voxel[4]);

#endif

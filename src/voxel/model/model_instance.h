/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A model that has the shape of another one (its parts, caps and turns), but points that move and working
 * memory of its own: several threads can voxelize variants of one model, and one thread variants of many.
 */
#ifndef VXM_VOXEL_MODEL_MODEL_INSTANCE_H
#define VXM_VOXEL_MODEL_MODEL_INSTANCE_H

#include "voxel/model/model.h"

/** How a twin differs from the model that it is attached to. */
typedef struct vxm_variation {
  vxm_vertex_transform points;   /**< of the facets, before first_apex */
  vxm_vertex_transform vertices; /**< of the soup; looked at only where faces set voxels */
  double stretch;                /**< at least how many times as long as the other's edges are any of these */
  double reach;                  /**< plus at most so much, in units of the space */
  bool mirrored;                 /**< whether the points lie as in a mirror */
} vxm_variation;

/** Start from {.context = ...}. */
typedef struct vxm_model_instance {
  vxm_context *context;  /**< whose threads work */
  const vxm_model *of;   /**< NULL = attached to none */
  double (*vertices)[3]; /**< of the soup; NULL unless faces set voxels */
  size_t vertex_room, part_room;
  vxm_soup soup;   /**< the other's, but for `vertices` */
  vxm_model model; /**< its facets have the positions of the other */
} vxm_model_instance;

/** Computes now what all instances of a model share, which the first run would compute otherwise. */
vxm_status vxm_model_instance_prepare(vxm_model *model, vxm_error *error);

/** Attaches an instance to a model that has been prepared and stays unchanged. Memory is kept from one to the
 * next.
 */
vxm_status vxm_model_instance_attach(vxm_model_instance *twin, const vxm_model *of, vxm_error *error);

/** Voxelizes a variation into a window, which is all of the lattice's space. */
vxm_status vxm_model_instance_fill(vxm_model_instance *twin, const vxm_window *window,
                                   const vxm_lattice *lattice, const vxm_variation *variation,
                                   vxm_error *error);
void vxm_model_instance_destroy(vxm_model_instance *twin);

#endif

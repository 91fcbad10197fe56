/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A pass over a model whose points move, with working memory of its own: several threads can voxelize
 * variants of one model, and one thread variants of many.
 */
#ifndef VXM_VOXEL_MODEL_MODEL_INSTANCE_H
#define VXM_VOXEL_MODEL_MODEL_INSTANCE_H

#include "voxel/model/model.h"

/** How an instance differs from the model that it is attached to. */
typedef struct vxm_variation {
  vxm_vertex_transform points;   /**< of the triangles, before first_apex */
  vxm_vertex_transform vertices; /**< of the soup; looked at only where faces set voxels */
  bool mirrored;                 /**< whether the points lie as in a mirror */
  bool is_field;                 /**< shares are made of the voxels, in which thin parts play no part */
} vxm_variation;

/** Start from {.context = ...}; stays where it is in memory. */
typedef struct vxm_model_instance {
  vxm_context *context;  /**< whose threads work */
  const vxm_model *of;   /**< NULL = attached to none */
  double (*vertices)[3]; /**< of the soup, moved; NULL unless faces set voxels */
  size_t vertex_capacity;
  bool is_started; /**< whether `pass` is */
  vxm_model_pass pass;
} vxm_model_instance;

/** Computes now what all instances of a model share, which the first of them would compute otherwise. */
vxm_status vxm_model_instance_prepare(const vxm_model *model, vxm_error *error);

/** Attaches an instance to a model that has been prepared. Memory is kept from one to the next. */
vxm_status vxm_model_instance_attach(vxm_model_instance *instance, const vxm_model *of, vxm_error *error);

/** Places a variation on a lattice; then the pass is filled, in one window that is all of its space. */
vxm_status vxm_model_instance_place(vxm_model_instance *instance, const vxm_lattice *lattice,
                                    const vxm_variation *variation, vxm_error *error);
void vxm_model_instance_destroy(vxm_model_instance *instance);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Labels claim set voxels, piece after piece; of several that claim one the nearest takes it. */
#ifndef VXM_VOXEL_LABELS_LABEL_OVERLAPS_H
#define VXM_VOXEL_LABELS_LABEL_OVERLAPS_H

#include "base/task_progress.h"
#include "voxel/labels/label_solid.h"
#include "voxel/labels/nearest_label.h"
#include "voxel/labels/open_labels.h"
#include "voxel/labels/row_tiles.h"

/** The solid of a piece at hand. */
typedef struct vxm_label_overlap {
  const vxm_label_component *piece;
  vxm_window window; /**< of the box: the solid, and once it has been claimed what others claimed before */
  int64_t first[3];  /**< voxel of the space at which the box begins, in the order of the layout */
  atomic_bool is_contested, has_voxels;
} vxm_label_overlap;

enum { VXM_CLAIMS_BATCH = 256 };

/** Fields up to `pieces` are set by the owner. */
typedef struct vxm_label_overlaps {
  vxm_context *context;
  const vxm_voxelize_options *options; /**< of the model */
  vxm_lattice lattice;                 /**< of the space */
  const vxm_face_labels *labelling;
  vxm_window set;     /**< the voxels of the model */
  uint64_t *several;  /**< bits like those: voxels that more than one label claims */
  uint16_t *values;   /**< in the layout of the window; 0 = no label so far */
  uint8_t *open;      /**< as vxm_open_labels_create has it, and once all claims are made also of labels whose
                           solids have no voxel; NULL = no label is */
  uint8_t *held;      /**< with `open`: whether the solid of a label has voxels */
  vxm_label_bvh *bvh; /**< made when first needed */
  vxm_label_components pieces;
  vxm_label_component_scratch *scratches; /**< of each thread */
  vxm_error *errors;                      /**< of each thread */
  uint64_t *words;                        /**< of the solids at hand */
  size_t batch; /**< how many these are: one, or small ones, each made by one thread */
  vxm_label_overlap claim[VXM_CLAIMS_BATCH];
  vxm_row_tile tiles; /**< rows and slices that they have voxels in */
  atomic_bool has_failed;
  vxm_task_progress progress;
} vxm_label_overlaps;

/** Finds the open labels, and cuts all into pieces; @return as vxm_label_components_create. */
vxm_status vxm_label_overlaps_begin(vxm_label_overlaps *claims, vxm_error *error);
/** Bytes that are held at most while claims are made, those of the BVH included. */
uint64_t vxm_label_overlaps_bytes(const vxm_label_overlaps *claims);
/** Makes all claims. @return as vxm_model_voxelize */
vxm_status vxm_label_overlaps_run(vxm_label_overlaps *claims, vxm_error *error);
/** Makes the BVH unless it is there. */
vxm_status vxm_label_overlaps_need_bvh(vxm_label_overlaps *claims, vxm_error *error);
/** Frees what the claims made, the BVH included. */
void vxm_label_overlaps_end(vxm_label_overlaps *claims);

/** Values of a row. */
static inline uint16_t *vxm_label_overlaps_row(const vxm_label_overlaps *claims, int64_t middle,
                                               int64_t slow) {
  return claims->values + (size_t)(slow * claims->set.middle_dim + middle) * (size_t)claims->set.fast_dim;
}

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Labels claim set voxels, piece after piece; of several that claim one the nearest takes it. */
#ifndef VXM_VOXEL_CLAIMS_H
#define VXM_VOXEL_CLAIMS_H

#include "base/watch.h"
#include "voxel/award.h"
#include "voxel/piece_solid.h"
#include "voxel/tiles.h"

/** The solid of a piece at hand. */
typedef struct vxm_claim {
  const vxm_piece *piece;
  vxm_window window; /**< of the box: the solid, and once it has been claimed what others claimed before */
  int64_t first[3];  /**< voxel of the space at which the box begins, in the order of the layout */
  atomic_bool is_contested;
} vxm_claim;

enum { VXM_CLAIMS_BATCH = 256 };

/** Fields up to `pieces` are set by the owner. */
typedef struct vxm_claims {
  vxm_context *context;
  const vxm_voxelize_options *options; /**< of the model */
  vxm_lattice lattice;                 /**< of the space */
  const vxm_labelling *labelling;
  vxm_window set;     /**< the voxels of the model */
  uint64_t *several;  /**< bits like those: voxels that more than one label claims */
  uint16_t *values;   /**< in the layout of the window; 0 = no label so far */
  vxm_forest *forest; /**< made when first needed */
  vxm_pieces pieces;
  vxm_piece_desk *desks; /**< of each thread */
  vxm_error *errors;     /**< of each thread */
  uint64_t *words;       /**< of the solids at hand */
  size_t batch;          /**< how many these are: one, or small ones, each made by one thread */
  vxm_claim claim[VXM_CLAIMS_BATCH];
  vxm_tile tiles; /**< rows and slices that they have voxels in */
  atomic_bool has_failed;
  vxm_watch watch;
} vxm_claims;

/** Cuts the labels into pieces; @return as vxm_pieces_create. */
vxm_status vxm_claims_begin(vxm_claims *claims, vxm_error *error);
/** Bytes that are held at most while claims are made, those of the forest included. */
uint64_t vxm_claims_bytes(const vxm_claims *claims);
/** Makes all claims. @return as vxm_model_voxelize */
vxm_status vxm_claims_run(vxm_claims *claims, vxm_error *error);
/** Makes the forest unless it is there. */
vxm_status vxm_claims_need_forest(vxm_claims *claims, vxm_error *error);
/** Frees what the claims made, the forest included. */
void vxm_claims_end(vxm_claims *claims);

/** Values of a row. */
static inline uint16_t *vxm_claims_row(const vxm_claims *claims, int64_t middle, int64_t slow) {
  return claims->values + (size_t)(slow * claims->set.middle_dim + middle) * (size_t)claims->set.fast_dim;
}

#endif

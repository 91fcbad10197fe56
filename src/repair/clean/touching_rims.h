/* SPDX-License-Identifier: BSD-3-Clause */
/** Edges where two surfaces touch with their rims, and are not one. */
#ifndef VXM_REPAIR_CLEAN_TOUCHING_RIMS_H
#define VXM_REPAIR_CLEAN_TOUCHING_RIMS_H

#include "repair/state/repair_state.h"

/** Faces joined to patches over edges with two sides. */
typedef struct vxm_rimmed_patches {
  vxm_repair_state *state;
  const size_t (*pair)[2]; /**< per edge with two sides: their faces */
  const uint32_t *label;   /**< per face: its patch */
  const uint8_t *turn;     /**< per face: whether it runs the other way than the first one of its patch */
  size_t count;
} vxm_rimmed_patches;

/**
 * Marks the edges with two sides whose faces lie on each other, folded flat.
 *
 * @param[out] fold per edge
 * @param[out] any  there are some
 */
vxm_status vxm_flat_folds_find(uint8_t *fold, bool *any, const vxm_repair_state *state,
                               const size_t (*pair)[2], double scale, vxm_error *error);

/**
 * Takes away the marks of those that join what they have on both sides. Others do not: boxes without bottoms
 * that stand flush on a floor have rims in common when vertices are welded, and are two bodies for all that.
 *
 * A flat fold joins patches unless both bound a volume; and those that no edge with one side borders, as the
 * skins of a wall without thickness, unless these look the same way and run the same way along the fold. They
 * look as most of their area does.
 *
 * @param patches     over all edges with two sides but the folds
 * @param[in,out] fold per edge
 * @param[out] any    marks were taken away
 */
vxm_status vxm_touching_rims_keep(uint8_t *fold, bool *any, const vxm_rimmed_patches *patches, double scale,
                                  vxm_error *error);

#endif

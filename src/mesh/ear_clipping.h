/* SPDX-License-Identifier: BSD-3-Clause */
/** Ears of a polygon that is being cut up: corners that may be cut off. */
#ifndef VXM_MESH_EAR_CLIPPING_H
#define VXM_MESH_EAR_CLIPPING_H

#include "mesh/triangulate.h"

/** Stands for the corner after one that has been cut off. */
#define VXM_RING_CLIPPED UINT32_MAX

/** The polygon at hand. */
typedef struct vxm_ring {
  vxm_triangulator *tri;
  const uint32_t *corners;
  const double *positions;
  double scale; /**< of these, see vxm_scale_near_one */
  size_t n, remaining;
  bool is_convex;       /**< all ears are free */
  size_t waiting;       /**< corners in the heap */
  size_t leaves;        /**< of the tree, a power of two; 0 = there is none */
  size_t looks;         /**< at corners and boxes so far */
  size_t looks_crossed; /**< of these, those before that */
  size_t looks_max;   /**< allowed; none too many as long as the polygon has not been found to cross itself */
  bool may_touch;     /**< corners on the rim of an ear do not matter as long as they only touch it */
  uint32_t *triangle; /**< where the next one goes */
} vxm_ring;

/** The corners of an ear, turning left. */
typedef struct vxm_ear {
  uint32_t corner[3];
  const double *at[3];
  double low[2], high[2];
} vxm_ear;

/** Makes the tree of a ring of n corners, by which ears are tested without looking at all corners. */
void vxm_ring_make_tree(vxm_ring *r);
/** Takes a corner that has been cut off out of the tree, if there is one. */
void vxm_ring_drop(const vxm_ring *r, uint32_t i);

vxm_ear vxm_ear_at(const vxm_ring *r, uint32_t i);
/** Whether no corner of the ring forbids to cut off an ear. */
bool vxm_ear_is_free(vxm_ring *r, const vxm_ear *e);

#endif

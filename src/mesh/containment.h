/* SPDX-License-Identifier: BSD-3-Clause */
/** Which component of a soup lies inside which, and which way each is wound. */
#ifndef VXM_MESH_CONTAINMENT_H
#define VXM_MESH_CONTAINMENT_H

#include "mesh/soup.h"
#include "mesh/voids.h"

typedef struct vxm_containment {
  vxm_context *context;
  size_t count;     /**< components */
  uint32_t *parent; /**< the smallest solid component around each, of its set if there is one; or
                       VXM_NO_COMPONENT */
  uint32_t *body;   /**< the component that each is a void of (vxm_voids_find), or VXM_NO_COMPONENT */
  double *volume;   /**< signed, about the middle of the component's box: negative if it is wound inward */
} vxm_containment;

/**
 * Finds for every solid component the smallest other solid component that it lies inside of, and which voids
 * are to be cut out of which.
 *
 * @param[out] out     freed with vxm_containment_destroy; empty after a failure
 * @param face_labels  component of every face, below `count` (vxm_components)
 * @param solid        per component: whether it bounds a volume; the others have and are no parents. NULL =
 * all
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 *
 * Where soup->face_sets tells of sets, components around it that are of its own set go before others.
 *
 * A component lies inside another one if its box does and if most of a few sample points do, by crossings of
 * rays along the axes, which are odd, or wind round the point, so that a few missing or turned faces do no
 * harm; if its box reaches out by as little as vertices are moved apart by, all rays have to say so. The
 * points lie on its faces, or within it where these lie on faces of the other one. Where boxes of several are
 * around that of one that is wound the other way, and so may be a void, many points are taken: it lies in
 * those that it does not reach out of, or, if there are none, in the one that it reaches out of least.
 */
vxm_status vxm_containment_build(vxm_containment *out, const vxm_soup *soup, const uint32_t *face_labels,
                                 size_t count, const uint8_t *solid, vxm_error *error);
void vxm_containment_destroy(vxm_containment *containment);

#endif

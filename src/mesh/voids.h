/* SPDX-License-Identifier: BSD-3-Clause */
/** Which body each void is cut out of, where bodies lie in each other or cut through each other. */
#ifndef VXM_MESH_VOIDS_H
#define VXM_MESH_VOIDS_H

#include "base/context.h"

#ifdef __cplusplus
extern "C" {
#endif

#define VXM_NO_COMPONENT UINT32_MAX

/** What is known of the components of a soup. */
typedef struct vxm_void_search {
  vxm_context *context;
  size_t count;          /**< components */
  const uint32_t *order; /**< those that bound something, the smallest first */
  size_t order_count;
  const uint32_t *parent; /**< per component: the one next around it, or VXM_NO_COMPONENT */
  const double *volume;   /**< per component: below 0 if it is wound inward */
  /** Lists all components around one, those that are to be chosen first at the front; *around is the caller's
   * to free with vxm_free. */
  vxm_status (*list_around)(void *payload, uint32_t component, uint32_t **around, size_t *count,
                            vxm_error *error);
  /** Whether boxes of more than one are around that of a component: else its parent is all there is. */
  bool (*may_have_several)(void *payload, uint32_t component);
  /** Whether two may have points within both; it may say so of some that have not. */
  bool (*may_overlap)(void *payload, uint32_t a, uint32_t b);
  void *payload;
} vxm_void_search;

/**
 * Finds for every component the body that it is a void of: one around it that is wound the other way and is
 * no void itself.
 *
 * A solid of several bodies is what their faces wind round once or more. With every void cut out of a body
 * that is around all of it, and voids of one body apart from each other, each body winds round its points
 * once and round no others, so that their union is that solid: whichever of several bodies a void is given
 * to. So of a vessel, a liner in its wall and the voids of both, which lie in each other, one void goes to
 * each of the bodies; and what lies in all voids of all bodies that are around it is no void but a body.
 *
 * @param[out] body per component; VXM_NO_COMPONENT if it is no void
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, and what list_around returns
 *
 * What else is around a component than its parent is only asked where that has a void already that may
 * overlap it. Where voids of one body may overlap, and no other is around them, they stay together; so do
 * some where there are very many.
 */
vxm_status vxm_voids_find(uint32_t *body, const vxm_void_search *search, vxm_error *error);

#ifdef __cplusplus
}
#endif

#endif

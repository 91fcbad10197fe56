/* SPDX-License-Identifier: BSD-3-Clause */
/** Which positions vertices have: where several must not have the same one, or welding would merge them. */
#ifndef VXM_REPAIR_PLACES_H
#define VXM_REPAIR_PLACES_H

#include "mesh/soup.h"

/** A hash of vertices by position. One that is moved after it was added is no longer found, at either place.
 */
typedef struct vxm_places {
  const vxm_soup *soup;
  uint32_t *slots; /**< vertex + 1, or 0 */
  size_t mask;
} vxm_places;

/** @param most calls of vxm_places_add to come @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_places_open(vxm_places *places, const vxm_soup *soup, size_t most, vxm_error *error);
void vxm_places_close(vxm_places *places);
/** Whether a vertex that was added has this position; of zeros either. */
bool vxm_places_taken(const vxm_places *places, const double p[3]);
/** Adds a vertex, unless one was added at its position. */
void vxm_places_add(vxm_places *places, uint32_t vertex);

#endif

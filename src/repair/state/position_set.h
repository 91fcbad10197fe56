/* SPDX-License-Identifier: BSD-3-Clause */
/** Which positions vertices have: where several must not have the same one, or welding would merge them. */
#ifndef VXM_REPAIR_STATE_POSITION_SET_H
#define VXM_REPAIR_STATE_POSITION_SET_H

#include "repair/state/merge_rule.h"

/** A hash table of vertices by position. One that is moved after it was added is no longer found, at either
 * place.
 */
typedef struct vxm_position_set {
  const vxm_soup *soup;
  vxm_merge_rule rule; /**< by which positions are the same */
  uint32_t *slots;     /**< vertex + 1, or 0 */
  size_t mask;
} vxm_position_set;

/** @param most calls of vxm_position_set_add to come @return VXM_OK, VXM_ERROR_MEMORY,
 * VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_position_set_open(vxm_position_set *set, const vxm_soup *soup, size_t most,
                                 vxm_merge_rule rule, vxm_error *error);
void vxm_position_set_close(vxm_position_set *set);
/** Whether a vertex that was added has this position; of zeros either. */
bool vxm_position_set_taken(const vxm_position_set *set, const double p[3]);
/** The vertex that was added and has this position, or VXM_NO_VERTEX. */
uint32_t vxm_position_set_find(const vxm_position_set *set, const double p[3]);
/** Adds a vertex, unless one was added at its position. */
void vxm_position_set_add(vxm_position_set *set, uint32_t vertex);

#endif

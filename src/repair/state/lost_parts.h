/* SPDX-License-Identifier: BSD-3-Clause */
/** A net under the repair: whether what a part enclosed is still enclosed. It shares nothing with the passes.
 */
#ifndef VXM_REPAIR_STATE_LOST_PARTS_H
#define VXM_REPAIR_STATE_LOST_PARTS_H

#include "mesh/soup.h"

typedef struct vxm_lost_parts {
  uint32_t *face_part; /**< per face that came in: its component, after welding */
  size_t part_count;
  uint8_t *lost; /**< per part */
  size_t count;  /**< of those that are lost */
} vxm_lost_parts;

/**
 * Sends lines along the axes through every closed component of a mesh, one in which every edge has an even
 * number of sides, and compares what they meet there with what they meet in another mesh that has come of it.
 * Inside is where a component winds round the line, and where an odd number of its faces was crossed; a line
 * with an end that is inside tells nothing. A part is lost if more than a hundredth of its inside, of one
 * kind or the other, is inside no component any more.
 *
 * @param[out] out freed with vxm_lost_parts_destroy in any case
 * @return VXM_OK, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 *
 * Time is about linear in the faces of both. Of very many components only some are asked,
 * and of lines that meet very many faces.
 */
vxm_status vxm_lost_parts_find(vxm_lost_parts *out, const vxm_soup *before, const vxm_soup *after,
                               vxm_error *error);
void vxm_lost_parts_destroy(vxm_lost_parts *lost, vxm_context *context);

#endif

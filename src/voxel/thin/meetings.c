/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/meetings.h"

#include <math.h>

void vxm_meetings_put(vxm_meetings *meetings, const vxm_view *view, vxm_thin_stage stage,
                      const int64_t lowest[3], int kind, const double offset[3], uint32_t polygon) {
  if (meetings->error.code != VXM_OK)
    return;
  meetings->is_full |= meetings->count >= meetings->most;
  if (meetings->is_full)
    return;
  if (meetings->count == meetings->capacity &&
      vxm_grow(meetings->context, (void **)&meetings->list, &meetings->capacity, meetings->count + 1,
               sizeof *meetings->list, &meetings->error) != VXM_OK)
    return;
  vxm_meeting *m = &meetings->list[meetings->count++];
  m->number = vxm_view_number(view, lowest);
  m->stage = (uint8_t)stage;
  m->kind = (uint8_t)kind;
  for (int s = 0; s < 3; s++)
    m->offset[s] = (int32_t)lrint(offset[s] * VXM_OFFSET_UNIT);
  m->polygon = polygon;
}

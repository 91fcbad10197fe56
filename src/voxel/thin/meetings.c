/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/meetings.h"

#include <math.h>

/** Whether another one may be put. */
static inline bool is_open(vxm_meetings *meetings) {
  meetings->is_full |= meetings->count + meetings->in_cubes_count >= meetings->most;
  return meetings->error.code == VXM_OK && !meetings->is_full;
}

/** Room for another one, or NULL. */
static inline vxm_meeting *next_of(vxm_meetings *meetings) {
  if (!is_open(meetings))
    return NULL;
  if (meetings->count == meetings->capacity &&
      vxm_grow(meetings->context, (void **)&meetings->list, &meetings->capacity, meetings->count + 1,
               sizeof *meetings->list, &meetings->error) != VXM_OK)
    return NULL;
  return &meetings->list[meetings->count++];
}

static int32_t parts_of(double offset) {
  return (int32_t)lrint(offset * VXM_OFFSET_UNIT);
}

void vxm_meetings_put_link(vxm_meetings *meetings, const vxm_view *view, vxm_thin_stage stage,
                           const int64_t lowest[3], int direction, double offset) {
  vxm_meeting *m = next_of(meetings);
  if (m)
    *m = (vxm_meeting){vxm_dual_number(view, stage, direction, lowest), {parts_of(offset)}, 0};
}

void vxm_meetings_put_in_cube(vxm_meetings *meetings, size_t triangle) {
  if (!is_open(meetings) ||
      (meetings->in_cubes_count == meetings->in_cubes_capacity &&
       vxm_grow(meetings->context, (void **)&meetings->in_cubes, &meetings->in_cubes_capacity,
                meetings->in_cubes_count + 1, sizeof *meetings->in_cubes, &meetings->error) != VXM_OK))
    return;
  meetings->in_cubes[meetings->in_cubes_count++] = (uint32_t)triangle;
}

void vxm_meetings_put(vxm_meetings *meetings, const vxm_view *view, int kind, const int64_t lowest[3],
                      const double (*offsets)[3], int count) {
  bool is_cube = kind == VXM_DUAL_CUBE;
  vxm_meeting *m = next_of(meetings);
  if (!m)
    return;
  *m = (vxm_meeting){.element =
                         vxm_dual_number(view, is_cube ? VXM_THIN_CUBES : VXM_THIN_SQUARES, kind, lowest)};
  for (int i = 0; i < count; i++) {
    int32_t at[3] = {0, 0, 0};
    for (int s = 0; s < (is_cube ? 3 : 2); s++)
      m->offset[s] += at[s] = parts_of(offsets[i][s]);
    m->met |= vxm_dual_boxes(at, is_cube ? 3 : 2);
  }
}

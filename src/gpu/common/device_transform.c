/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/common/device_transform.h"

#include <string.h>

vxm_device_transform_job vxm_device_transform_job_of(const vxm_snapped_points *placed,
                                                     const vxm_vertex_transform *motion) {
  vxm_device_transform_job job = {.size = motion->entry ? motion->noise_size : 0,
                                  .offset = motion->offset,
                                  .count = (uint32_t)motion->count};
  memcpy(job.row, motion->matrix, sizeof job.row);
  for (int a = 0; a < 3; a++) {
    job.origin[a] = placed->lattice.space.origin[a];
    job.scale[a] = vxm_snapped_points_scale(placed, a);
  }
  job.scale[3] = VXM_NARROW_MAX;
  return job;
}

bool vxm_device_transform_alike(const vxm_snapped_points *placed, const vxm_vertex_transform *motion) {
  double moved[VXM_MOVED_TRIED][3];
  size_t count = motion->count < VXM_MOVED_TRIED ? motion->count : VXM_MOVED_TRIED;
  vxm_vertex_transform_range(moved, motion, 0, count);
  for (size_t p = 0; p < count; p++) {
    vxm_point point;
    if (!vxm_lattice_place(&placed->lattice, moved[p], &point))
      return false;
    for (int a = 0; a < 3; a++)
      if (placed->narrow[p][a] != point.at[a])
        return false;
  }
  return true;
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/meetings.h"

/** The lowest voxel of the cube in which a triangle lies; false if it reaches into several. */
static bool cube_of(int64_t lowest[3], vxm_point corner[3], const vxm_thin_job *job, size_t triangle) {
  const uint32_t *number = job->corners[triangle];
  for (int k = 0; k < 3; k++) {
    corner[k] = vxm_snapped_points_at(job->placed, number[k]);
    for (int a = 0; a < 3; a++) {
      int64_t before = vxm_lattice_first(&job->placed->lattice, corner[k].at[a]) - 1;
      if (k > 0 && lowest[a] != before)
        return false;
      lowest[a] = before;
    }
  }
  return true;
}

/** Whether a voxel of a cube is set, or the view holds none of them. */
static bool is_settled(const vxm_view *view, const int64_t lowest[3]) {
  int64_t ends[8][3];
  bool held = true;
  for (int a = 0; a < 3; a++)
    held &= lowest[a] >= view->begin[a] && lowest[a] + 1 < view->end[a];
  if (!held) {
    int count = vxm_dual_ends(ends, VXM_DUAL_CUBE, lowest);
    return vxm_view_any_set(view, (const int64_t(*)[3])ends, count, &held) || !held;
  }
  int64_t first = vxm_view_bit(view, lowest);
  for (unsigned v = 0; v < 8; v++)
    if (vxm_view_bit_set(view, first + (v & 1 ? view->step[0] : 0) + (v & 2 ? view->step[1] : 0) +
                                   (v & 4 ? view->step[2] : 0)))
      return true;
  return false;
}

void vxm_meet_cube(vxm_meetings *meetings, const vxm_thin_job *job, size_t triangle) {
  vxm_point corner[3];
  int64_t lowest[3];
  if (cube_of(lowest, corner, job, triangle) && !is_settled(&job->view, lowest))
    vxm_meetings_put_in_cube(meetings, triangle);
}

void vxm_meet_cubes(vxm_meetings *meetings, const vxm_thin_job *job) {
  const double unit = (double)job->placed->lattice.unit;
  while (meetings->in_cubes_count > 0) {
    vxm_point corner[3];
    int64_t lowest[3];
    double offsets[3][3];
    size_t triangle = meetings->in_cubes[--meetings->in_cubes_count];
    if (!cube_of(lowest, corner, job, triangle) || is_settled(&job->view, lowest))
      continue;
    for (int k = 0; k < 3; k++)
      for (int a = 0; a < 3; a++)
        offsets[k][a] = (double)(corner[k].at[a] - (lowest[a] + 1) * job->placed->lattice.unit) / unit;
    vxm_meetings_put(meetings, &job->view, VXM_DUAL_CUBE, lowest, (const double(*)[3])offsets, 3);
  }
}

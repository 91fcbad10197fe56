/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/meetings.h"

void vxm_meet_cube(vxm_meetings *meetings, const vxm_thin_job *job, size_t triangle) {
  const vxm_lattice *lattice = &job->placed->lattice;
  const uint32_t *corner = job->triangles->corners[triangle];
  vxm_point points[3];
  int64_t lowest[3], ends[8][3];
  bool held;
  for (int k = 0; k < 3; k++) {
    points[k] = vxm_snapped_points_at(job->placed, corner[k]);
    for (int a = 0; a < 3; a++) {
      int64_t before = vxm_lattice_first(lattice, points[k].at[a]) - 1;
      if (k > 0 && lowest[a] != before)
        return;
      lowest[a] = before;
    }
  }
  int count = vxm_cell_ends(ends, VXM_CELL_CUBE, lowest);
  if (vxm_view_any_set(&job->view, (const int64_t(*)[3])ends, count, &held) || !held)
    return;
  double offsets[3][3];
  for (int k = 0; k < 3; k++)
    for (int a = 0; a < 3; a++)
      offsets[k][a] = (double)(points[k].at[a] - (lowest[a] + 1) * lattice->unit) / (double)lattice->unit;
  vxm_meetings_put(meetings, &job->view, VXM_CELL_CUBE, lowest, (const double(*)[3])offsets, 3);
}

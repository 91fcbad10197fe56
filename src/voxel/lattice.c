/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/lattice.h"
#include "base/threads.h"

#include <inttypes.h>
#include <math.h>

enum {
  BITS_MIN = 8,
  BITS_MAX = 16,
  /* With differences up to 2^20 the products of three of them, summed, stay below 2^63. */
  COORDINATE_BITS = 20
};

/** Marks a vertex that has no place on the lattice. */
static const int64_t off_lattice = INT64_MIN;

vxm_lattice vxm_lattice_of(const vxm_space *space) {
  int64_t longest = space->dims[0];
  for (int a = 1; a < 3; a++)
    longest = space->dims[a] > longest ? space->dims[a] : longest;
  int bits = COORDINATE_BITS;
  while (bits > BITS_MIN && (longest << bits) > (INT64_C(1) << COORDINATE_BITS))
    bits--;
  if (bits > BITS_MAX)
    bits = BITS_MAX;
  return (vxm_lattice){bits, INT64_C(1) << bits, *space};
}

bool vxm_lattice_place(const vxm_lattice *lattice, const double position[3], vxm_point *point) {
  double steps[3];
  for (int a = 0; a < 3; a++) {
    double voxels = (position[a] - lattice->space.origin[a]) / lattice->space.voxel_size[a];
    steps[a] = voxels * (double)lattice->unit;
    if (!(fabs(steps[a]) < (double)VXM_LATTICE_MAX)) /* NaN too */
      return false;
  }
  for (int a = 0; a < 3; a++)
    point->at[a] = (int64_t)llrint(steps[a]);
  return true;
}

typedef struct snap_job {
  const vxm_lattice *lattice;
  const vxm_soup *soup;
  vxm_point *points;
  size_t slices;
} snap_job;

static void snap_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  const snap_job *job = payload;
  const vxm_lattice *lattice = job->lattice;
  size_t end = vxm_slice_begin(job->soup->vertex_count, job->slices, slice + 1);
  for (size_t v = vxm_slice_begin(job->soup->vertex_count, job->slices, slice); v < end; v++)
    if (!vxm_lattice_place(lattice, vxm_position(job->soup, v), &job->points[v]))
      job->points[v].at[0] = off_lattice;
}

static vxm_status check_used(const vxm_soup *soup, const vxm_point *points, vxm_error *error) {
  for (size_t c = 0; c < soup->corner_count; c++) {
    if (points[soup->indices[c]].at[0] != off_lattice)
      continue;
    uint32_t vertex = soup->indices[c];
    const double *p = vxm_position(soup, vertex);
    vxm_place place = {NULL, 0, -1, vertex};
    if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
      return vxm_fail_at(error, VXM_ERROR_RANGE, place,
                         "vertex %" PRIu32 " of the mesh is not finite; repair the mesh first", vertex);
    return vxm_fail_at(
        error, VXM_ERROR_RANGE, place,
        "vertex %" PRIu32
        " at (%g, %g, %g) lies too many voxels outside the grid; choose larger voxels or remove it",
        vertex, p[0], p[1], p[2]);
  }
  return VXM_OK;
}

vxm_status vxm_lattice_snap(const vxm_lattice *lattice, const vxm_soup *soup, vxm_point *points,
                            vxm_error *error) {
  snap_job job = {lattice, soup, points, 1 + soup->vertex_count / 16384};
  vxm_parallel(soup->context, job.slices, snap_slice, &job);
  return check_used(soup, points, error);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/* Moves the points of a model, displaces each by a vector of a circular buffer and puts them on the lattice, with every
   product and sum rounded by itself as the CPU has them (voxel/lattice/vertex_transform.h). */
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF

/* vxm_device_transform_job */
typedef struct MoveJob {
  double row[3][4];
  double origin[4], scale[4]; /* the fourth scale is what all steps stay below */
  uint size, offset, count, unused;
} MoveJob;

__kernel void move_points(__global const double *originals, __global const uint *entries, __global const float4 *noise,
                          __global int4 *points, const MoveJob job) {
  uint p = get_global_id(0);
  if (p >= job.count)
    return;
  double x = originals[3 * p], y = originals[3 * p + 1], z = originals[3 * p + 2];
  float move[3] = {0.0f, 0.0f, 0.0f};
  if (job.size > 0) {
    uint entry = entries[p] + job.offset;
    float4 vector = noise[entry < job.size ? entry : entry - job.size];
    move[0] = vector.x;
    move[1] = vector.y;
    move[2] = vector.z;
  }
  int steps[3], misfit = 0;
  for (int a = 0; a < 3; a++) {
    double at = job.row[a][0] * x + job.row[a][1] * y + job.row[a][2] * z + job.row[a][3];
    if (job.size > 0)
      at += (double)move[a];
    double whole = rint((at - job.origin[a]) * job.scale[a]);
    bool fits = whole < job.scale[3] && whole > -job.scale[3]; /* NaN does not */
    steps[a] = fits ? (int)whole : 0;
    misfit |= fits ? 0 : 1;
  }
  points[p] = (int4)(steps[0], steps[1], steps[2], misfit);
}

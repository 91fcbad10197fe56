/* SPDX-License-Identifier: BSD-3-Clause */
/** Where a tool is, how it is turned, and what is between two such poses. */
#ifndef VXM_CARVE_MOTION_H
#define VXM_CARVE_MOTION_H

#include "base/error.h"

/** The tool's point p is at turn (p) + place. */
typedef struct vxm_tool_pose {
  double turn[4]; /**< a quaternion of length 1: its real part, then x, y and z */
  double place[3];
} vxm_tool_pose;

/** Reads a 3 x 4 matrix. @return VXM_OK, VXM_ERROR_ARGUMENT unless it is finite and a rotation */
vxm_status vxm_tool_pose_read(vxm_tool_pose *out, const double matrix[12], vxm_error *error);
/** The rotation, row after row. */
void vxm_tool_pose_rotation(double out[9], const vxm_tool_pose *pose);
/** Of the two quaternions for the turn of `to` takes the nearer one to that of `from`. */
void vxm_tool_pose_approach(vxm_tool_pose *to, const vxm_tool_pose *from);
/** Midway; by sums, quotients and square roots alone, which every processor rounds alike. */
void vxm_tool_pose_middle(vxm_tool_pose *out, const vxm_tool_pose *from, const vxm_tool_pose *to);
/** The angle of the turn between two poses, or a little more; radians. */
double vxm_tool_pose_angle(const vxm_tool_pose *from, const vxm_tool_pose *to);

#endif

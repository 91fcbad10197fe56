/* SPDX-License-Identifier: BSD-3-Clause */
#include "carve/motion.h"
#include "mesh/rotation.h"

#include <math.h>
#include <string.h>

static void normalize(double q[4]) {
  double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (int i = 0; i < 4; i++)
    q[i] /= length;
}

/** Shepperd's method: the largest of the four parts is found first, and the others by it. */
static void quaternion_of(double q[4], const double m[9]) {
  double trace = m[0] + m[4] + m[8];
  int most = m[4] > m[0] ? 1 : 0;
  most = m[8] > m[4 * most] ? 2 : most;
  if (trace >= m[4 * most]) {
    q[0] = 1 + trace;
    q[1] = m[7] - m[5];
    q[2] = m[2] - m[6];
    q[3] = m[3] - m[1];
  } else {
    int a = most, b = (a + 1) % 3, c = (a + 2) % 3;
    q[0] = m[3 * c + b] - m[3 * b + c];
    q[1 + a] = 1 + m[4 * a] - m[4 * b] - m[4 * c];
    q[1 + b] = m[3 * b + a] + m[3 * a + b];
    q[1 + c] = m[3 * c + a] + m[3 * a + c];
  }
  normalize(q);
}

vxm_status vxm_tool_pose_read(vxm_tool_pose *out, const double matrix[12], vxm_error *error) {
  double m[9];
  for (int i = 0; i < 12; i++)
    if (!isfinite(matrix[i]))
      return vxm_fail(error, VXM_ERROR_ARGUMENT, "carver: the pose is not finite");
  for (int row = 0; row < 3; row++) {
    memcpy(m + 3 * row, matrix + 4 * row, 3 * sizeof *m);
    out->place[row] = matrix[4 * row + 3];
  }
  if (!vxm_is_rotation(m))
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "carver: the first three columns of the pose are no rotation: " VXM_ROTATION_TEXT);
  quaternion_of(out->turn, m);
  return VXM_OK;
}

void vxm_tool_pose_rotation(double out[9], const vxm_tool_pose *pose) {
  double w = pose->turn[0], x = pose->turn[1], y = pose->turn[2], z = pose->turn[3];
  const double made[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                          2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                          2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
  memcpy(out, made, sizeof made);
}

void vxm_tool_pose_approach(vxm_tool_pose *to, const vxm_tool_pose *from) {
  double product = 0;
  for (int i = 0; i < 4; i++)
    product += from->turn[i] * to->turn[i];
  for (int i = 0; i < 4 && product < 0; i++)
    to->turn[i] = -to->turn[i];
}

void vxm_tool_pose_middle(vxm_tool_pose *out, const vxm_tool_pose *from, const vxm_tool_pose *to) {
  vxm_tool_pose made;
  for (int i = 0; i < 4; i++)
    made.turn[i] = from->turn[i] + to->turn[i];
  normalize(made.turn);
  for (int a = 0; a < 3; a++)
    made.place[a] = from->place[a] / 2 + to->place[a] / 2;
  *out = made;
}

double vxm_tool_pose_angle(const vxm_tool_pose *from, const vxm_tool_pose *to) {
  double squared = 0;
  for (int i = 0; i < 4; i++)
    squared += (from->turn[i] - to->turn[i]) * (from->turn[i] - to->turn[i]);
  /* A turn by t moves the quaternion by 2 sin (t / 4), and 4 asin (c / 2) is at most 2 c times this: */
  double chord = sqrt(squared);
  return 2 * chord * (chord > 0.5 ? 1.12 : 1.011);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** Which way three points of a plane turn, without rounding. */
#ifndef VXM_MESH_ORIENT2D_H
#define VXM_MESH_ORIENT2D_H

/** The sign of the turn, found in full precision where plain arithmetic cannot tell. */
int vxm_orient2d_exact(const double a[2], const double b[2], const double c[2]);

/**
 * 1 if a, b, c turn left, -1 if they turn right, 0 if they lie on a line: exactly, as long as no product of
 * two coordinates overflows or is subnormal.
 */
static inline int vxm_orient2d(const double a[2], const double b[2], const double c[2]) {
  /* Shewchuk 1997: the determinant is off by at most (3 + 16 e) e times the sum of its terms, e = 2^-53. */
  const double bound = 3.3306690738754716e-16;
  double left = (a[0] - c[0]) * (b[1] - c[1]), right = (a[1] - c[1]) * (b[0] - c[0]), area = left - right;
  double sum = (left < 0 ? -left : left) + (right < 0 ? -right : right);
  if (area > bound * sum)
    return 1;
  if (-area > bound * sum)
    return -1;
  return vxm_orient2d_exact(a, b, c);
}

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Whether the matrices that callers give are rotations. */
#ifndef VXM_MESH_ROTATION_H
#define VXM_MESH_ROTATION_H

#include <math.h>
#include <stdbool.h>

/** What messages call such a matrix. */
#define VXM_ROTATION_TEXT "rows of length 1, at right angles to each other, that do not mirror"

/** Whether the rows of a matrix have length 1 and stand at right angles, their products off by below 1e-3,
 * and do not mirror. */
static inline bool vxm_is_rotation(const double m[9]) {
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) {
      double product = 0;
      for (int a = 0; a < 3; a++)
        product += m[3 * i + a] * m[3 * k + a];
      if (!(fabs(product - (i == k)) < 1e-3)) /* NaN too */
        return false;
    }
  double determinant = m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
                       m[2] * (m[3] * m[7] - m[4] * m[6]);
  return determinant > 0;
}

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Which of two faces comes first in space. */
#ifndef VXM_REPAIR_CLEAN_FACE_PLACE_H
#define VXM_REPAIR_CLEAN_FACE_PLACE_H

#include "mesh/geometry.h"

/** Whether a face comes before another one: by the first of its corners in space, then by the last, then by
 * all of them. Both have corners. */
bool vxm_face_lies_before(const vxm_soup *soup, size_t face, size_t other, double scale);

#endif

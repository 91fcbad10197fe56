/* SPDX-License-Identifier: BSD-3-Clause */
/** Faces that repeat others, with the same or with the opposite orientation. */
#ifndef VXM_MESH_DUPLICATE_FACES_H
#define VXM_MESH_DUPLICATE_FACES_H

#include "mesh/soup.h"

typedef enum vxm_repeat {
  VXM_REPEAT_NONE = 0, /**< the first of its kind */
  VXM_REPEAT_SAME,     /**< repeats an earlier face with the same orientation */
  VXM_REPEAT_OPPOSITE  /**< repeats an earlier face with the opposite orientation only */
} vxm_repeat;

/** What a face repeats. A face with fewer than three distinct corners repeats only itself. */
typedef struct vxm_copies {
  size_t first;            /**< the first face with its corners, in either orientation */
  uint32_t rank;           /**< faces before it that have its corners in its own orientation */
  uint32_t same, opposite; /**< faces in all, itself among them, of its orientation and of the other */
  bool turned;             /**< it runs the other way than the first */
} vxm_copies;

typedef struct vxm_duplicates {
  size_t same;           /**< faces beyond the first of each kind and orientation */
  size_t opposite_pairs; /**< per kind, the lesser of the numbers of faces of either orientation */
} vxm_duplicates;

/**
 * Finds faces that repeat an earlier one: the same corners in the same cyclic order, from any
 * start, or in the reverse one. Faces with fewer than three distinct corners take no part.
 *
 * @param kinds  face_count elements that get a vxm_repeat each; may be NULL
 * @param copies face_count elements; may be NULL, as it is if kinds is
 *
 * Linear time, also in the corners of large polygons.
 */
vxm_status vxm_duplicates_find(vxm_duplicates *out, vxm_context *context, const vxm_soup *soup,
                               uint8_t *kinds, vxm_copies *copies, vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Which labels are open: patches of a surface whose other patches have other labels, or sheets.
 *
 * What the faces of an open label enclose is a guess, as caps close it: a face of a cube alone encloses
 * nothing, and the five others all of it. So at the surface the nearest face decides instead (see
 * vxm_model_labels in voxmend.h): `nearest_label.h` with `open`. Labels that are closed are bodies of their
 * own, and keep what they enclose.
 */
#ifndef VXM_VOXEL_LABELS_OPEN_LABELS_H
#define VXM_VOXEL_LABELS_OPEN_LABELS_H

#include "voxel/parts/face_labels.h"

/**
 * Finds the labels with an edge, over vertices welded by position, that an odd number of their faces have.
 *
 * @param[out] out a flag for each label, of label 1 at 0, freed with vxm_free; NULL where none can be open:
 *                 parts are bodies, and a label that is the only one has all voxels
 * @return VXM_OK; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_open_labels_create(uint8_t **out, const vxm_face_labels *labelling, vxm_error *error);

#endif

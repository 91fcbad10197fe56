/* SPDX-License-Identifier: BSD-3-Clause */
/** Takes labels that are bodies apart, before repair. */
#ifndef VXM_VOXEL_LABELS_DIVIDE_H
#define VXM_VOXEL_LABELS_DIVIDE_H

#include "voxel/parts/face_labels.h"

/**
 * Makes each closed label a set of faces of its own (mesh/face_sets.h), and all others set 0: patches of a
 * surface are closed together, and what is left without closed labels has the same odd edges as before. A
 * label that encloses next to nothing, as a sheet drawn from both sides, is no body, and stays with them.
 * Without a closed label beside others nothing changes.
 *
 * @return as vxm_mesh_divide in voxmend.h; after a failure the soup can only be destroyed
 */
vxm_status vxm_labels_divide(vxm_soup *soup, vxm_label_by by, vxm_error *error);

#endif

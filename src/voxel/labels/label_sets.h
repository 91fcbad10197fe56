/* SPDX-License-Identifier: BSD-3-Clause */
/** The solid of each label as an octree. */
#ifndef VXM_VOXEL_LABELS_LABEL_SETS_H
#define VXM_VOXEL_LABELS_LABEL_SETS_H

#include "voxel/labels/label_solid.h"

typedef struct vxm_label_sets {
  vxm_context *context;
  size_t count;
  vxm_sparse **sets; /**< of label 1 at 0 and so on; NULL = no voxel */
} vxm_label_sets;

/**
 * Makes the solids of all labels, as vxm_label_overlaps_run does.
 *
 * @param[out] out destroyed with vxm_label_sets_destroy, also after a failure
 * @param options  of the model
 * @param lattice  of the whole space
 * @return as vxm_model_voxelize
 */
vxm_status vxm_label_sets_create(vxm_label_sets *out, const vxm_face_labels *labelling,
                                 const vxm_voxelize_options *options, const vxm_lattice *lattice,
                                 vxm_error *error);
void vxm_label_sets_destroy(vxm_label_sets *sets);

#endif

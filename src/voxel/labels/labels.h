/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A label for every voxel of a model.
 *
 *   faces -> labels                voxel/parts/face_labels.h; a box of voxels for each label
 *   model -> set voxels            as without labels: which voxels are set has nothing to do with them
 *   label after label:
 *     its faces as a model of their own -> its solid, in its box only
 *     set voxels of that solid: those without a label take it; the others are contested
 *     contested voxels             the label there or this one, whichever has the nearer face
 *   set voxels that no solid holds -> the label of the nearest face of all
 *   near the surface, of voxels of open labels (open_labels.h) -> the same, if that is open too
 *
 * The solids of labels are made on the lattice of the whole space, so that they meet its voxels as the model
 * does. Of several labels that claim a voxel the one with the nearest face is left in the end, the lowest on
 * a tie, since each time the nearer of two remains. The trees for that are made when the first voxel needs
 * them.
 *
 * Beside the model and the values there are a bit for each voxel of the space, one for those that were
 * contested, the bits of the largest box, and the trees.
 */
#ifndef VXM_VOXEL_LABELS_LABELS_H
#define VXM_VOXEL_LABELS_LABELS_H

#include "voxel/model/model.h"
#include "voxel/parts/face_labels.h"

/**
 * Makes the labels of a model.
 *
 * @param values    room for a value per voxel, in the order of the layout
 * @param report    its times are not set
 * @param labelling of the model's mesh; its table goes to the model, with the voxels of each label
 * @return as vxm_model_labels in voxmend.h
 */
vxm_status vxm_labels_run(uint16_t *values, vxm_layout layout, vxm_label_report *report, vxm_model *model,
                          const vxm_space *space, vxm_face_labels *labelling, vxm_error *error);

/** Warns of a mesh without names, and of labels without voxels, as the table has them. */
void vxm_labels_warn(const vxm_face_labels *labelling, int64_t voxels, vxm_warnings *warnings);

#endif

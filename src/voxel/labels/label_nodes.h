/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Labels in nodes: the model and the solid of each label are octrees, and only where the surface of one of
 * them lies, or where labels meet, are voxels looked at one by one.
 *
 * A voxel that is set has, of the labels whose solids hold it, the one with the nearest face, and of all
 * where none does; then open labels take from each other near the surface: what vxm_labels_run comes to,
 * solid after solid.
 */
#ifndef VXM_VOXEL_LABELS_LABEL_NODES_H
#define VXM_VOXEL_LABELS_LABEL_NODES_H

#include "grid/node_values.h"
#include "voxel/labels/labels.h"

typedef struct vxm_label_nodes vxm_label_nodes;

/**
 * Makes the octrees.
 *
 * @param voxelize  that of the set voxels; its times are not set
 * @param space     kept, as the labelling is; must outlive it
 * @param labelling of the model's mesh
 * @return as vxm_model_labels in voxmend.h
 */
vxm_status vxm_label_nodes_create(vxm_label_nodes **out, vxm_voxelize_report *voxelize, vxm_model *model,
                                  const vxm_space *space, vxm_face_labels *labelling, vxm_error *error);
/** NULL is allowed. */
void vxm_label_nodes_destroy(vxm_label_nodes *nodes);

/** The set voxels. */
const vxm_sparse *vxm_label_nodes_voxels(const vxm_label_nodes *nodes);
/** Who makes the values, uint16_t, 0 where no voxel is set. */
vxm_node_maker vxm_label_nodes_maker(vxm_label_nodes *nodes);
/** Once all are made: what came of them, but for the report's `voxelize`; the labelling's table goes to the
 * model. */
vxm_status vxm_label_nodes_report(vxm_label_report *report, vxm_label_nodes *nodes, vxm_error *error);

#endif

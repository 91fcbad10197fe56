/* SPDX-License-Identifier: BSD-3-Clause */
/** Colours in nodes: those of the set voxels, and nothing else. */
#ifndef VXM_VOXEL_LABELS_COLOR_NODES_H
#define VXM_VOXEL_LABELS_COLOR_NODES_H

#include "voxel/labels/color.h"
#include "voxel/labels/label_nodes.h"

typedef struct vxm_color_nodes vxm_color_nodes;

/** The colour of a set voxel from elsewhere. */
typedef void (*vxm_color_fn)(uint8_t value[4], const int64_t at[3], const void *payload);

/** Whether colours can be made so: by the CPU, and without means over the surface. */
bool vxm_color_nodes_are_for(const vxm_model *model, const vxm_color_options *options);

/**
 * Makes the voxels as an octree, and what gives them colours.
 *
 * @param report  of the voxels; its times are not set
 * @param space   kept; must outlive it
 * @param options checked, and such that they can be made so; kept
 * @param color   gives the colours of VXM_COLOR_VOLUME
 * @return as vxm_model_colors in voxmend.h
 */
vxm_status vxm_color_nodes_create(vxm_color_nodes **out, vxm_voxelize_report *report, vxm_model *model,
                                  const vxm_space *space, const vxm_color_options *options,
                                  vxm_color_fn color, const void *payload, vxm_error *error);
/** NULL is allowed. */
void vxm_color_nodes_destroy(vxm_color_nodes *nodes);
/** Who makes the values, four bytes each, to the bit those of vxm_colors_run. */
vxm_node_maker vxm_color_nodes_maker(vxm_color_nodes *nodes);

#endif

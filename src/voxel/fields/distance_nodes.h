/* SPDX-License-Identifier: BSD-3-Clause */
/** Distances within a band, in nodes: only those near the surface are measured. */
#ifndef VXM_VOXEL_FIELDS_DISTANCE_NODES_H
#define VXM_VOXEL_FIELDS_DISTANCE_NODES_H

#include "grid/node_values.h"
#include "voxel/fields/distance.h"

typedef struct vxm_distance_nodes vxm_distance_nodes;

/** Whether distances can be made so: without a band all nodes are near. */
static inline bool vxm_distance_nodes_are_for(const vxm_distance_options *options) {
  return options->band > 0;
}

/**
 * Takes the triangles, and makes the solid that gives the signs as an octree.
 *
 * @param space   kept; must outlive it
 * @param options checked, with a band
 * @return as vxm_model_distance in voxmend.h
 */
vxm_status vxm_distance_nodes_create(vxm_distance_nodes **out, vxm_model *model, const vxm_space *space,
                                     const vxm_distance_options *options, vxm_error *error);
/** NULL is allowed. */
void vxm_distance_nodes_destroy(vxm_distance_nodes *nodes);
/** Bytes that it takes at most, beside the solid. */
uint64_t vxm_distance_nodes_bytes(const vxm_model *model, const vxm_distance_options *options);

/** Who makes the values, floats, to the bit those of vxm_distance_run. */
vxm_node_maker vxm_distance_nodes_maker(vxm_distance_nodes *nodes);
/** Once all are made: what came of them; its times are not set. */
vxm_status vxm_distance_nodes_report(vxm_distance_report *report, vxm_distance_nodes *nodes,
                                     vxm_error *error);

#endif

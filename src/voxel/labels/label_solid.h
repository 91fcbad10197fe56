/* SPDX-License-Identifier: BSD-3-Clause */
/** The solid of a piece of a label, in its box. */
#ifndef VXM_VOXEL_LABELS_LABEL_SOLID_H
#define VXM_VOXEL_LABELS_LABEL_SOLID_H

#include "grid/octree_pieces.h"
#include "voxel/labels/label_components.h"
#include "voxel/model/model.h"

/** What one thread works with; it is kept from piece to piece. */
typedef struct vxm_label_component_scratch {
  vxm_soup *soup;   /**< the faces of a piece; NULL before the first */
  uint32_t *vertex; /**< of the mesh, for each vertex of `soup` */
  uint32_t *slots;  /**< open addressing over them: place + 1, 0 = free */
  size_t vertex_capacity, slot_capacity;
} vxm_label_component_scratch;

void vxm_label_component_scratch_destroy(vxm_label_component_scratch *scratch, vxm_context *context);
/** Bytes that a piece takes at most on its scratch and as a model, beside the words of its voxels. */
uint64_t vxm_label_component_bytes(const vxm_label_components *pieces, const vxm_label_component *piece);

/** The box of a piece that has voxels, as a space and as a window with words still to be given. */
vxm_space vxm_label_component_space(const vxm_label_component *piece, const vxm_space *whole);

/**
 * Fills a window with the solid of a piece: the voxels inside its faces, voxelized alone on the lattice of
 * the whole space.
 *
 * @param window  of all of the box
 * @param options of the model; the mode is not looked at
 * @param lattice of the whole space
 * @param at_once a small piece: no fewer slices are made at a time where memory is short
 * @return as vxm_model_voxelize; no voxel is set where no face has an area
 */
vxm_status vxm_label_component_fill(vxm_label_component_scratch *scratch, const vxm_window *window,
                                    const vxm_label_components *pieces, const vxm_label_component *piece,
                                    const vxm_voxelize_options *options, const vxm_lattice *lattice,
                                    bool at_once, vxm_error *error);

/**
 * Adds the same voxels to the pieces of an octree of the whole space.
 *
 * @param lattice  of the whole space
 * @param is_small its box is not worth an octree of its own
 */
vxm_status vxm_label_component_add(vxm_octree_pieces *out, vxm_label_component_scratch *scratch,
                                   const vxm_label_components *pieces, const vxm_label_component *piece,
                                   const vxm_voxelize_options *options, const vxm_lattice *lattice,
                                   bool is_small, vxm_error *error);

#endif

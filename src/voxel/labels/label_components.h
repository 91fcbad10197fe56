/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The faces of each label in pieces whose solids are made one after the other, each in a box of its own, so
 * that a label that is scattered over the mesh costs what it fills and not the box around all of it.
 *
 * What the solid of a label is must not depend on how it is cut. A closed component that has a label for
 * itself is voxelized alone in any case (voxel/parts/parts.h), unless it or another of the label may be a
 * cavity. All else of a label is one piece. With parts for labels each is a piece, and those that are
 * cavities of others are empty.
 */
#ifndef VXM_VOXEL_LABELS_LABEL_COMPONENTS_H
#define VXM_VOXEL_LABELS_LABEL_COMPONENTS_H

#include "voxel/lattice/lattice.h"
#include "voxel/parts/face_labels.h"

/** Faces, and the voxels that they may claim: begin..end-1 along each axis of the space; none if empty. */
typedef struct vxm_label_component {
  uint32_t label;
  size_t first_face, face_end; /**< in `faces` */
  int64_t begin[3], end[3];
} vxm_label_component;

typedef struct vxm_label_components {
  vxm_context *context;
  const vxm_soup *soup;
  uint32_t *faces;
  vxm_label_component *pieces; /**< those of label 1 first */
  size_t count;
} vxm_label_components;

/**
 * Cuts the labels of a soup.
 *
 * @param[out] out  destroyed with vxm_label_components_destroy, also after a failure
 * @param options   of the solids
 * @param lattice   of the space
 * @param fast      axis along which boxes begin with a word
 * @return VXM_OK, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_label_components_create(vxm_label_components *out, const vxm_face_labels *labelling,
                                       const vxm_voxelize_options *options, const vxm_lattice *lattice,
                                       int fast, vxm_error *error);
void vxm_label_components_destroy(vxm_label_components *pieces);

#endif

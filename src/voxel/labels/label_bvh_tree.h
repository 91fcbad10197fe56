/* SPDX-License-Identifier: BSD-3-Clause */
/** The inside of the trees, for label_bvh.c and label_bvh_build.c. */
#ifndef VXM_VOXEL_LABELS_LABEL_BVH_TREE_H
#define VXM_VOXEL_LABELS_LABEL_BVH_TREE_H

#include "voxel/closest/closest_point.h"
#include "voxel/labels/label_bvh.h"

#define VXM_NO_ROOT UINT32_MAX

/** A box over triangles begin..end-1. The children of a node that is no leaf are `left` and the next. */
typedef struct vxm_label_bvh_node {
  double low[3], high[3];
  uint32_t begin, end;
  uint32_t left;  /**< 0 = a leaf */
  uint32_t label; /**< 0 = several */
} vxm_label_bvh_node;

struct vxm_label_bvh {
  vxm_context *context;
  const vxm_face_labels *labelling;
  double origin[3], side;
  vxm_closest_triangle *triangles;
  vxm_label_bvh_node *nodes; /**< first those over the trees, node 0 over all */
  uint32_t *root;            /**< of each label; VXM_NO_ROOT = it has no triangles */
};

#endif

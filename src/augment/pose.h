/* SPDX-License-Identifier: BSD-3-Clause */
/** How a variant lies in the voxel space, which is the unit cube. */
#ifndef VXM_AUGMENT_POSE_H
#define VXM_AUGMENT_POSE_H

#include "base/context.h"
#include "voxmend/sampler.h"

/** What is known of a model: the box of its points. */
typedef struct vxm_model_extent {
  double centre[3], side[3]; /**< model units */
} vxm_model_extent;

/** What all variants have in common. */
typedef struct vxm_pose_rules {
  vxm_sampler_options options; /**< checked, with the defaults put in; but not how to voxelize */
  vxm_voxelize_options voxelize;
  double axis[3]; /**< of length 1 */
  double reach;   /**< the most that a coordinate is displaced */
} vxm_pose_rules;

typedef struct vxm_placement {
  double matrix[12]; /**< takes (x, y, z, 1) of the model into the unit cube */
  double stretch;    /**< the most that a length is multiplied by */
  double rotation[9], scale[3], shift[3];
  bool mirrored;
  uint32_t offset; /**< where the variant begins in the noise */
} vxm_placement;

/** Width that the model may take, of the unit cube's; not positive if the rules leave no room. */
double vxm_pose_room(const vxm_pose_rules *rules);

/** Draws the pose of a variant. */
void vxm_pose_draw(vxm_placement *out, const vxm_pose_rules *rules, const vxm_model_extent *extent,
                   const vxm_variant *variant);

#endif

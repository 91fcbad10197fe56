/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * What the calls on a model leave behind beside their output: warnings, and the table of labels. Each thread
 * has its own, so that it can read them while others work on the same model.
 */
#ifndef VXM_VOXEL_MODEL_MODEL_RESULTS_H
#define VXM_VOXEL_MODEL_MODEL_RESULTS_H

#include "base/warnings.h"
#include "voxel/parts/face_labels.h"

/** Of one thread; changed by that thread alone. */
typedef struct vxm_model_result {
  const void *thread;
  vxm_warnings warnings;  /**< of its last pass */
  vxm_label_table labels; /**< the last that it made */
  struct vxm_model_result *next;
} vxm_model_result;

typedef struct vxm_model_results vxm_model_results;

vxm_status vxm_model_results_create(vxm_model_results **out, vxm_context *context, vxm_error *error);
/** NULL is allowed. */
void vxm_model_results_destroy(vxm_model_results *results);

/** That of the calling thread, to be filled. @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_model_results_mine(vxm_model_result **out, vxm_model_results *results, vxm_error *error);
/** That of the calling thread, or where it has none, the one that was asked for last, or NULL: whoever waits
 * for a thread that voxelizes may read what that one found. */
const vxm_model_result *vxm_model_results_read(vxm_model_results *results);

#endif

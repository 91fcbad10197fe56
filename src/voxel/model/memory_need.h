/* SPDX-License-Identifier: BSD-3-Clause */
/** What a pass over a grid takes, told before any of it is made. */
#ifndef VXM_VOXEL_MODEL_MEMORY_NEED_H
#define VXM_VOXEL_MODEL_MEMORY_NEED_H

#include "voxel/model/model.h"

/** What a pass takes at most, beside the points of the mesh: `fixed` bytes, and `windows` times the words of
 * the windows it fills, the result included. */
typedef struct vxm_memory_need {
  uint64_t fixed;
  int windows;
} vxm_memory_need;

/** What a pass over windows of this shape takes if the crossings of triangles stay below their bound; or,
 * where `worst`, if all of them become bitmaps, of which each thread may have several. `centres`: of the
 * voxels whose centre is inside, without what holds thin parts together. */
vxm_memory_need vxm_model_memory_need(const vxm_model *model, const vxm_space *space, const vxm_window *shape,
                                      bool worst, bool centres);
/** Windows of words that a pass over a whole grid holds at once, its result included. */
int vxm_model_windows_held(const vxm_model *model);

#endif

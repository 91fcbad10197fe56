/* SPDX-License-Identifier: BSD-3-Clause */
/** An octree being made on the device: which nodes it has, and what it becomes in the end. Level 0 are the
 * lowest nodes, of 16 x 16 x 16 voxels, as on the CPU (grid/octree.h). */
#ifndef VXM_GPU_OPENCL_CL_TREE_H
#define VXM_GPU_OPENCL_CL_TREE_H

#include "gpu/opencl/opencl.h"
#include "grid/octree.h"

/** Where a level lies in the arrays of all nodes. */
typedef struct vxm_cl_level {
  cl_uint first, count;
} vxm_cl_level;

typedef struct vxm_cl_tree {
  vxm_space space;
  int levels;
  vxm_cl_level level[VXM_OCTREE_LEVELS];
  cl_uint node_count; /**< of all levels */
  int32_t cells[3];   /**< of 16 voxels along each axis */
  cl_ulong axes;      /**< bits of a Morton code that cells have */
  cl_uint words;      /**< of 32 cells */
} vxm_cl_tree;

/**
 * Finds the nodes that the triangles of the passes need, and links them: cells, codes, parents, children and
 * neighbours are in their buffers then. The passes, points and corners are on the device.
 *
 * @return VXM_OK; level[0].count is 0 if there are none
 */
vxm_status vxm_cl_tree_create(vxm_cl_tree *out, vxm_opencl *engine, const vxm_space *space,
                              const vxm_sparse_job *job, const vxm_disjoint_passes *passes, vxm_error *error);

/** The same for the triangles of a surface, whose points and corners are on the device. */
vxm_status vxm_cl_tree_create_surface(vxm_cl_tree *out, vxm_opencl *engine, const vxm_surface *surface,
                                      vxm_error *error);

/** Makes the octree of what bricks and nodes have inside: the stage "prune". */
vxm_status vxm_cl_tree_take(vxm_sparse **out, vxm_opencl *engine, const vxm_cl_tree *tree,
                            vxm_cl_buffer_id bricks, vxm_cl_buffer_id inside, vxm_context *context,
                            vxm_error *error);

/** Releases what was made on the device for an octree, in any case and, where `status` is a failure, the
 * octree itself. Returns `status`. */
vxm_status vxm_cl_tree_end(vxm_sparse **out, vxm_opencl *engine, vxm_status status);

/** What kernels are told of a level: see shaders/nodes.cl. */
static inline cl_uint4 vxm_cl_level_of(const vxm_cl_tree *tree, int level, cl_uint z, cl_uint w) {
  return (cl_uint4){{tree->level[level].first, tree->level[level].count, z, w}};
}

/** Adds the time since `*since` to a stage, once the device is done, and begins anew; nothing where no times
 * are asked for. */
vxm_status vxm_cl_stage_end(vxm_opencl *engine, size_t stage, double *since, vxm_error *error);
#define VXM_CL_STAGE(name) offsetof(vxm_cl_stages, name)

#endif

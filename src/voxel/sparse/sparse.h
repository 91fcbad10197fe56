/* SPDX-License-Identifier: BSD-3-Clause */
/** The solid as an octree, straight from the crossings of triangles with columns along x. */
#ifndef VXM_VOXEL_SPARSE_SPARSE_H
#define VXM_VOXEL_SPARSE_SPARSE_H

#include "grid/octree_build.h"
#include "voxel/model/model.h"
#include "voxel/winding/chain_winding.h"

/**
 * Makes the strips of every voxel inside at least one of the job's parts, by parity along x, as
 * vxm_parity_union does for a window; exact, and the same for any number of threads.
 *
 * @param builder in which all strips are empty
 * @param chain   NULL, or a chain that is placed for rows along x: what it is wound around at least once is
 * united, too
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_sparse_union(vxm_octree_builder *builder, vxm_workspace *workspace, const vxm_sparse_job *job,
                            vxm_chain_winding *chain, vxm_error *error);

/** Whether one axis tells all of the solid: then the triangles become an octree directly. */
bool vxm_sparse_is_direct(const vxm_model *model);

/** Whether octrees are made from triangles directly also where it is faster to make a grid first. For tests,
 * while nothing runs. */
void vxm_sparse_force_direct(bool force);

/** The octree of a pass that has been begun and has filled nothing. @return as vxm_model_sparse */
vxm_status vxm_sparse_of_pass(vxm_sparse **out, const vxm_model *model, vxm_model_pass *pass,
                              vxm_error *error);
/** The same of the parts that are closed, or closed by caps, and no others. */
vxm_status vxm_sparse_closed(vxm_sparse **out, vxm_model_pass *pass, vxm_error *error);

/** See vxm_model_sparse in voxmend.h; the arguments are not NULL, except report and transform. */
vxm_status vxm_sparse_make(vxm_sparse **out, vxm_voxelize_report *report, vxm_model *model,
                           const vxm_space *space, const double transform[12], vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Solids and surfaces by OpenCL; see vxm_engine_ops. */
#ifndef VXM_GPU_OPENCL_CL_SOLID_H
#define VXM_GPU_OPENCL_CL_SOLID_H

#include "gpu/common/slab_solid.h"
#include "gpu/opencl/opencl.h"

vxm_status vxm_cl_move(vxm_engine *engine, vxm_snapped_points *placed, const vxm_move_job *job, bool *done,
                       vxm_error *error);
vxm_status vxm_cl_unite(vxm_engine *engine, const vxm_window *window, const vxm_parity_union_job *job,
                        vxm_error *error);
vxm_status vxm_cl_vote(vxm_engine *engine, const vxm_window *window, const vxm_vote_job *job,
                       vxm_vote_tally *tally, vxm_error *error);
/** As vxm_surface_add (cl_surface.c). */
vxm_status vxm_cl_surface(vxm_engine *engine, const vxm_surface *surface, const vxm_window *window,
                          vxm_surface_kind kind, bool is_fresh, vxm_error *error);

/** See vxm_engine_ops (cl_sparse.c). Open parts and oversized triangles are left to the CPU. */
vxm_status vxm_cl_surface_sparse(vxm_engine *engine, vxm_sparse **out, const vxm_surface *surface,
                                 vxm_surface_kind kind, vxm_error *error);
vxm_status vxm_cl_sparse(vxm_engine *engine, vxm_sparse **out, const vxm_space *space,
                         const vxm_sparse_job *job, vxm_error *error);

/** See vxm_engine_ops (cl_coverage.c). */
vxm_status vxm_cl_count(vxm_engine *engine, uint16_t *counts, const vxm_window *window, int n,
                        vxm_error *error);

/** See vxm_engine_ops (cl_device_voxels.c). */
vxm_status vxm_cl_device_voxels(vxm_engine *engine, vxm_device_voxels **out, const vxm_device_info *shape,
                                vxm_error *error);
vxm_status vxm_cl_device_voxels_begin(vxm_engine *engine, const vxm_window *window, vxm_error *error);
vxm_status vxm_cl_device_voxels_end(vxm_engine *engine, vxm_device_voxels *voxels, int64_t index,
                                    const vxm_window *window, vxm_error *error);
/** Puts a slab of a window that stays where it belongs. */
vxm_status vxm_cl_slab_stay(vxm_opencl *engine, const vxm_slab *slab, vxm_cl_buffer_id from,
                            vxm_error *error);
/** The other way. */
vxm_status vxm_cl_slab_bring(vxm_opencl *engine, const vxm_slab *slab, vxm_cl_buffer_id to, vxm_error *error);

/** In VXM_CL_TOUCHED: a part that sets no voxel, and is not looked at. */
#define VXM_CL_NOT_ASKED UINT32_MAX
extern const vxm_slab_solid vxm_cl_slab_solid;
/** See vxm_slab_solid. */
vxm_status vxm_cl_each_slab(vxm_engine *engine, const vxm_window *window, bool is_or, vxm_slab_fn make,
                            void *payload, vxm_error *error);

/** Parity of the job's parts along its axis, united, in a buffer of a slab, triangle by triangle
 * (cl_columns.c). The passes are those of the job, and on the device. */
vxm_status vxm_cl_columns(vxm_opencl *engine, const vxm_slab *slab, const vxm_parity_union_job *job,
                          const vxm_disjoint_passes *passes, vxm_cl_buffer_id into, vxm_error *error);

/** Whether the job can be done tile by tile: its columns run along the bits, and no triangle is oversized. */
bool vxm_cl_can_tile(const vxm_opencl *engine, const vxm_window *window, const vxm_parity_union_job *job);
/** The same for such a job, slab of columns by slab of columns (cl_tiles.c). */
vxm_status vxm_cl_tiles(vxm_opencl *engine, const vxm_slab *slab, const vxm_parity_union_job *job,
                        vxm_cl_buffer_id into, vxm_error *error);

#endif

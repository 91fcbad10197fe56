/* SPDX-License-Identifier: BSD-3-Clause */
/** Surfaces as octrees by OpenCL (Schwarz & Seidel 2010, section 5): the nodes that triangles touch are made
 * first, and then each voxel is set in its brick (shaders/surface_bricks.cl). */
#include "base/clock.h"
#include "gpu/opencl/cl_solid.h"
#include "gpu/opencl/cl_tree.h"

enum {
  FEW_COLUMNS = 64, /**< of a triangle that one work-item does */
  BRICKS = 64       /**< of a node */
};

/** What surfaces of voxels are told; `step` tells where the places of y and z begin. */
static vxm_slab_surface job_of(const vxm_cl_tree *tree, const vxm_surface *surface, vxm_surface_kind kind) {
  vxm_slab_surface job = {.bits = surface->lattice.bits,
                          .thin = kind == VXM_SURFACE_THIN,
                          .triangle_count = (uint32_t)surface->triangle_count,
                          .few_columns = FEW_COLUMNS};
  for (int a = 0; a < 3; a++)
    job.last[a] = (int32_t)tree->space.dims[a];
  job.step[0] = (uint32_t)tree->cells[0];
  job.step[1] = (uint32_t)(tree->cells[0] + tree->cells[1]);
  return job;
}

static vxm_status set_voxels(vxm_opencl *engine, const vxm_cl_tree *tree, const vxm_surface *surface,
                             vxm_surface_kind kind, vxm_error *error) {
  const vxm_slab_surface job = job_of(tree, surface, kind);
  const vxm_cl_arg args[] = {
      VXM_CL_MEM(engine, VXM_CL_SURFACE_POINTS), VXM_CL_MEM(engine, VXM_CL_SURFACE_CORNERS),
      VXM_CL_MEM(engine, VXM_CL_BRICKS),         VXM_CL_MEM(engine, VXM_CL_PLACES),
      VXM_CL_MEM(engine, VXM_CL_CELLS),          VXM_CL_MEM(engine, VXM_CL_BEFORE),
      VXM_CL_MEM(engine, VXM_CL_LARGE),          VXM_CL_VALUE(job)};
  const size_t count = sizeof args / sizeof args[0];
  vxm_status status = vxm_cl_run(engine, VXM_CL_SET_BRICKS, job.triangle_count, args, count, error);
  if (status == VXM_OK)
    status =
        vxm_cl_run_groups(engine, VXM_CL_SET_BRICKS_LARGE, vxm_cl_busy_groups(engine), args, count, error);
  return status == VXM_OK ? vxm_progress(engine->base.context, "voxelizing the surface", 1, error) : status;
}

/** Bricks and nodes have nothing inside at first. */
static vxm_status clear(vxm_opencl *engine, const vxm_cl_tree *tree, size_t triangles, vxm_error *error) {
  size_t bricks = (size_t)tree->level[0].count * BRICKS * sizeof(uint64_t);
  vxm_status status = vxm_cl_clear(engine, VXM_CL_INSIDE, (size_t)tree->node_count * 16, error);
  if (status == VXM_OK)
    status = vxm_cl_clear(engine, VXM_CL_BRICKS, bricks, error);
  return status == VXM_OK ? vxm_cl_clear_large(engine, triangles, error) : status;
}

static vxm_status make(vxm_sparse **out, vxm_opencl *engine, const vxm_surface *surface,
                       vxm_surface_kind kind, vxm_error *error) {
  vxm_cl_tree tree;
  vxm_status status = vxm_cl_tree_create_surface(&tree, engine, surface, error);
  double since = vxm_clock_ms();
  bool any = status == VXM_OK && tree.level[0].count > 0;
  if (any)
    status = clear(engine, &tree, surface->triangle_count, error);
  if (any && status == VXM_OK)
    status = set_voxels(engine, &tree, surface, kind, error);
  if (status == VXM_OK)
    status = vxm_cl_stage_end(engine, VXM_CL_STAGE(voxelize), &since, error);
  return status == VXM_OK
             ? vxm_cl_tree_take(out, engine, &tree, VXM_CL_BRICKS, VXM_CL_INSIDE, surface->context, error)
             : status;
}

vxm_status vxm_cl_surface_sparse(vxm_engine *base, vxm_sparse **out, const vxm_surface *surface,
                                 vxm_surface_kind kind, vxm_error *error) {
  vxm_opencl *engine = vxm_opencl_of(base);
  *out = NULL;
  vxm_status status = vxm_device_cache_surface(&engine->device_cache, surface, error);
  if (status != VXM_OK || engine->device_cache.oversized_surface.count > 0)
    return status;
  status = make(out, engine, surface, kind, error);
  return vxm_cl_tree_end(out, engine, status);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** Octrees by OpenCL (Schwarz & Seidel 2010, section 5): the nodes that a surface needs are made first, its
 * flips go to the bricks of the lowest ones, and are carried along x from the bricks up to the root; what is
 * inside by a node is handed down to its bricks again. */
#include "base/clock.h"
#include "gpu/opencl/cl_solid.h"
#include "gpu/opencl/cl_tree.h"

enum {
  FEW_COLUMNS = 2048, /**< of a triangle that one work-item does */
  BRICKS = 64         /**< of a node */
};

typedef struct making {
  vxm_opencl *engine;
  const vxm_sparse_job *job;
  vxm_disjoint_passes passes;
  vxm_cl_tree tree;
  vxm_slab_columns columns;
  vxm_cl_buffer_id bricks, inside; /**< of the union of all passes */
} making;

/* ---- What is left to the CPU ---- */

/** Whether all parts are closed, so that parity along x tells what is inside, and is the same for all columns
 * between nodes. */
static bool are_closed(const vxm_sparse_job *job) {
  const vxm_split *split = &job->triangles->split;
  return job->part_end <= split->kind_end[job->roles & VXM_ROLE_CAP ? VXM_PART_CAPPED : VXM_PART_CLOSED];
}

static bool has_oversized(const vxm_oversized *oversized, const vxm_sparse_job *job) {
  for (size_t i = 0; i < oversized->count; i++)
    if (job->triangles->part[oversized->triangles[i]] < job->part_end &&
        (vxm_role_of(job->triangles, oversized->triangles[i]) & job->roles))
      return true;
  return false;
}

/* ---- Flips ---- */

/** Columns along x. Those of a node beyond the grid have no flips; its first column, which tells how it is
 * left, lies in the grid. */
static vxm_slab_columns columns_of(const vxm_cl_tree *tree, const vxm_lattice *lattice) {
  vxm_slab_columns columns = {
      .axes = {1, 2, 0}, .bits = lattice->bits, .keep_before = 1, .few_columns = FEW_COLUMNS};
  for (int i = 0; i < 3; i++)
    columns.last[i] = (int32_t)tree->space.dims[columns.axes[i]];
  columns.step[0] = (uint32_t)tree->cells[0];
  columns.step[1] = (uint32_t)(tree->cells[0] + tree->cells[1]);
  return columns;
}

/** Flips what the triangles of a pass flip or, with `asks`, finds out which of their parts flip something. */
static vxm_status flip(making *m, cl_uint asks, vxm_error *error) {
  vxm_opencl *engine = m->engine;
  const vxm_slab_columns columns = m->columns;
  vxm_status status = vxm_cl_clear(engine, VXM_CL_LARGE, sizeof(uint32_t), error);
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_FLIP_BRICKS, columns.triangle_count,
                        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_POINTS), VXM_CL_MEM(engine, VXM_CL_CORNERS),
                                    VXM_CL_MEM(engine, VXM_CL_ORDER), VXM_CL_MEM(engine, VXM_CL_BRICKS),
                                    VXM_CL_MEM(engine, VXM_CL_CELLS), VXM_CL_MEM(engine, VXM_CL_BEFORE),
                                    VXM_CL_MEM(engine, VXM_CL_PLACES), VXM_CL_MEM(engine, VXM_CL_LARGE),
                                    VXM_CL_MEM(engine, VXM_CL_PARTS), VXM_CL_MEM(engine, VXM_CL_TOUCHED),
                                    VXM_CL_VALUE(columns), VXM_CL_VALUE(asks)),
                        error);
  if (status == VXM_OK)
    status = vxm_cl_run_groups(
        engine, VXM_CL_FLIP_BRICKS_LARGE, vxm_cl_busy_groups(engine),
        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_POINTS), VXM_CL_MEM(engine, VXM_CL_CORNERS),
                    VXM_CL_MEM(engine, VXM_CL_BRICKS), VXM_CL_MEM(engine, VXM_CL_CELLS),
                    VXM_CL_MEM(engine, VXM_CL_BEFORE), VXM_CL_MEM(engine, VXM_CL_PLACES),
                    VXM_CL_MEM(engine, VXM_CL_LARGE), VXM_CL_MEM(engine, VXM_CL_PARTS),
                    VXM_CL_MEM(engine, VXM_CL_TOUCHED), VXM_CL_VALUE(columns), VXM_CL_VALUE(asks)),
        error);
  return status;
}

/* ---- From flips to what is inside ---- */

static vxm_status fold_level(making *m, int level, vxm_error *error) {
  vxm_opencl *engine = m->engine;
  const cl_uint4 range = vxm_cl_level_of(&m->tree, level, m->tree.level[level - 1].first, 0);
  return vxm_cl_run(engine, VXM_CL_FOLD_NODES, (uint64_t)range.s[1] * 16,
                    VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_CHILDREN), VXM_CL_MEM(engine, VXM_CL_FIRSTS),
                                VXM_CL_MEM(engine, VXM_CL_NEXT), VXM_CL_MEM(engine, VXM_CL_EXITS),
                                VXM_CL_MEM(engine, VXM_CL_INSIDE), VXM_CL_VALUE(range)),
                    error);
}

static vxm_status fold(making *m, vxm_error *error) {
  vxm_opencl *engine = m->engine;
  const cl_uint count = m->tree.level[0].count;
  vxm_status status =
      vxm_cl_run(engine, VXM_CL_FOLD_BRICKS, (uint64_t)count * 16,
                 VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_BRICKS), VXM_CL_MEM(engine, VXM_CL_NEXT),
                             VXM_CL_MEM(engine, VXM_CL_EXITS), VXM_CL_VALUE(count)),
                 error);
  for (int l = 1; l < m->tree.levels && status == VXM_OK; l++)
    status = fold_level(m, l, error);
  return status;
}

/** Hands down what is inside, from the root to the bricks; these are put into the union, or added to it. */
static vxm_status push(making *m, bool is_added, vxm_error *error) {
  vxm_opencl *engine = m->engine;
  const vxm_cl_tree *tree = &m->tree;
  vxm_status status = VXM_OK;
  for (int l = tree->levels - 2; l > 0 && status == VXM_OK; l--) {
    const cl_uint4 range = vxm_cl_level_of(tree, l, tree->level[l + 1].first, 0);
    status = vxm_cl_run(engine, VXM_CL_PUSH_NODES, (uint64_t)range.s[1] * 16,
                        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_CODES), VXM_CL_MEM(engine, VXM_CL_PARENTS),
                                    VXM_CL_MEM(engine, VXM_CL_INSIDE), VXM_CL_VALUE(range)),
                        error);
  }
  const cl_uint moved = m->bricks == VXM_CL_BRICKS ? 0 : is_added ? 2 : 1;
  const cl_uint4 nodes = {
      {tree->level[0].count, tree->levels > 1 ? tree->level[1].first : 0, tree->levels > 1, moved}};
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_PUSH_BRICKS, (uint64_t)nodes.s[0] * BRICKS,
                        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_BRICKS), VXM_CL_MEM(engine, m->bricks),
                                    VXM_CL_MEM(engine, VXM_CL_CODES), VXM_CL_MEM(engine, VXM_CL_PARENTS),
                                    VXM_CL_MEM(engine, VXM_CL_INSIDE), VXM_CL_VALUE(nodes)),
                        error);
  const cl_uint words = 4 * tree->node_count, add = is_added; /* 16 bytes of a node */
  if (status == VXM_OK && moved)
    status = vxm_cl_run(engine, VXM_CL_UNITE_NODES, words,
                        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_INSIDE), VXM_CL_MEM(engine, m->inside),
                                    VXM_CL_VALUE(words), VXM_CL_VALUE(add)),
                        error);
  return status;
}

/* ---- All of it ---- */

/** Room for bricks and what is inside: a second time where passes are united. */
static vxm_status reserve(making *m, vxm_error *error) {
  vxm_opencl *engine = m->engine;
  bool many = m->passes.count > 1;
  size_t bricks = (size_t)m->tree.level[0].count * BRICKS * sizeof(uint64_t);
  m->bricks = many ? VXM_CL_UNITED_BRICKS : VXM_CL_BRICKS;
  m->inside = many ? VXM_CL_UNITED_INSIDE : VXM_CL_INSIDE;
  vxm_status status = vxm_cl_clear(engine, VXM_CL_INSIDE, (size_t)m->tree.node_count * 16, error);
  if (status == VXM_OK)
    status = vxm_cl_clear(engine, VXM_CL_BRICKS, bricks, error);
  if (status == VXM_OK && many)
    status = vxm_cl_reserve(engine, m->bricks, bricks, error);
  if (status == VXM_OK && many)
    status = vxm_cl_reserve(engine, m->inside, (size_t)m->tree.node_count * 16, error);
  return status;
}

static vxm_status make_passes(making *m, vxm_error *error) {
  vxm_opencl *engine = m->engine;
  const vxm_disjoint_passes *passes = &m->passes;
  double since = vxm_clock_ms();
  size_t begin = 0;
  m->columns.ordered = passes->ordered;
  vxm_status status = reserve(m, error);
  for (size_t p = 0; p < passes->count && status == VXM_OK; p++) {
    m->columns.triangle_first = (uint32_t)(passes->ordered ? begin : passes->first);
    m->columns.triangle_count = (uint32_t)(passes->triangle_end[p] - begin);
    begin = passes->triangle_end[p];
    status = flip(m, 0, error);
    if (status == VXM_OK)
      status = flip(m, 1, error);
    if (status == VXM_OK)
      status = vxm_cl_stage_end(engine, VXM_CL_STAGE(voxelize), &since, error);
    if (status == VXM_OK)
      status = fold(m, error);
    if (status == VXM_OK)
      status = push(m, p > 0, error);
    if (status == VXM_OK)
      status = vxm_cl_stage_end(engine, VXM_CL_STAGE(propagate), &since, error);
    if (status == VXM_OK)
      status =
          vxm_progress(engine->base.context, "voxelizing", (double)(p + 1) / (double)passes->count, error);
  }
  return status;
}

/** 0 for parts that are still to be asked about; those without a box set nothing, and may share their pass
 * with others at the border of the grid. */
static vxm_status upload_touched(const making *m, vxm_error *error) {
  vxm_opencl *engine = m->engine;
  vxm_error local = VXM_ERROR_INIT;
  size_t parts = m->job->triangles->split.part_count;
  uint32_t *has_voxels = vxm_alloc(engine->base.context, parts, sizeof *has_voxels, &local);
  for (size_t p = 0; has_voxels && p < parts; p++)
    has_voxels[p] = VXM_CL_NOT_ASKED;
  for (size_t b = 0; has_voxels && b < m->passes.box_count; b++)
    has_voxels[m->passes.boxes[b].part] = 0;
  vxm_status status =
      has_voxels ? vxm_cl_upload(engine, VXM_CL_TOUCHED, has_voxels, parts * sizeof *has_voxels, &local)
                 : local.code;
  vxm_free(engine->base.context, has_voxels);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

static vxm_status prepare(making *m, const vxm_space *space, vxm_error *error) {
  vxm_opencl *engine = m->engine;
  const vxm_window window = vxm_window_of(space, (vxm_layout)VXM_LAYOUT_GRID, 0, space->dims[2]);
  const vxm_parity_union_job job = {.triangles = m->job->triangles,
                                    .placed = m->job->placed,
                                    .part_end = m->job->part_end,
                                    .roles = m->job->roles,
                                    .has_voxels = m->job->has_voxels,
                                    .phase = "voxelizing"};
  vxm_status status =
      vxm_device_cache_passes(&m->passes, &engine->device_cache, &window, &job, 0, SIZE_MAX, error);
  if (status == VXM_OK)
    status = vxm_cl_place_parts(engine, job.triangles, error);
  if (status == VXM_OK)
    status = upload_touched(m, error);
  if (status == VXM_OK)
    status = vxm_cl_tree_create(&m->tree, engine, space, m->job, &m->passes, error);
  if (status == VXM_OK)
    m->columns = columns_of(&m->tree, &job.placed->lattice);
  return status;
}

static vxm_status make(vxm_sparse **out, making *m, const vxm_space *space, vxm_error *error) {
  vxm_opencl *engine = m->engine;
  vxm_status status = prepare(m, space, error);
  if (status == VXM_OK && m->tree.level[0].count > 0)
    status = make_passes(m, error);
  if (status == VXM_OK)
    status = vxm_cl_tree_take(out, engine, &m->tree, m->bricks, m->inside, m->job->placed->context, error);
  if (status == VXM_OK)
    status = vxm_slab_solid_touched(&vxm_cl_slab_solid, &engine->base, m->job->has_voxels,
                                    m->job->triangles->split.part_count, error);
  return status;
}

vxm_status vxm_cl_sparse(vxm_engine *base, vxm_sparse **out, const vxm_space *space,
                         const vxm_sparse_job *job, vxm_error *error) {
  vxm_opencl *engine = vxm_opencl_of(base);
  *out = NULL;
  if (job->part_end == 0 || !are_closed(job))
    return VXM_OK;
  vxm_status status = vxm_device_cache_triangles(&engine->device_cache, job->triangles, job->placed, error);
  if (status != VXM_OK || has_oversized(&engine->device_cache.oversized, job))
    return status;
  making m = {.engine = engine, .job = job, .passes = {.context = base->context}};
  status = make(out, &m, space, error);
  vxm_disjoint_passes_destroy(&m.passes);
  return vxm_cl_tree_end(out, engine, status);
}

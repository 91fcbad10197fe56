/* SPDX-License-Identifier: BSD-3-Clause */
/** The octree that the device has made, in its canonical form: shaders/prune.cl finds out what is empty or
 * full, prefix sums tell where the rest belongs. */
#include "base/clock.h"
#include "gpu/opencl/cl_sort.h"
#include "gpu/opencl/cl_tree.h"

typedef struct pruning {
  vxm_opencl *engine;
  const vxm_cl_tree *tree;
  vxm_cl_buffer_id bricks, inside;
  vxm_sparse *sparse;
} pruning;

/** Finds out what the children of all nodes are, from the bricks to the root. */
static vxm_status find(const pruning *p, vxm_error *error) {
  vxm_opencl *engine = p->engine;
  const vxm_cl_tree *tree = p->tree;
  const int64_t *n = tree->space.dims;
  const cl_int4 dims = {{(cl_int)n[0], (cl_int)n[1], (cl_int)n[2], 0}};
  const cl_uint count = tree->level[0].count;
  size_t bytes = tree->node_count * sizeof(cl_ulong);
  vxm_status status = vxm_cl_reserve(engine, VXM_CL_MIXED, bytes, error);
  if (status == VXM_OK)
    status = vxm_cl_reserve(engine, VXM_CL_FULL, bytes, error);
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_PRUNE_BRICKS, (uint64_t)count * 4,
                        VXM_CL_ARGS(VXM_CL_MEM(engine, p->bricks), VXM_CL_MEM(engine, VXM_CL_CODES),
                                    VXM_CL_MEM(engine, VXM_CL_MIXED), VXM_CL_MEM(engine, VXM_CL_FULL),
                                    VXM_CL_VALUE(dims), VXM_CL_VALUE(count)),
                        error);
  for (int l = 1; l < tree->levels && status == VXM_OK; l++) {
    const cl_uint4 range = vxm_cl_level_of(tree, l, tree->level[l - 1].first, (cl_uint)(2 * l + 2));
    status = vxm_cl_run(engine, VXM_CL_PRUNE_NODES, range.s[1],
                        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_CODES), VXM_CL_MEM(engine, VXM_CL_CHILDREN),
                                    VXM_CL_MEM(engine, VXM_CL_FIRSTS), VXM_CL_MEM(engine, p->inside),
                                    VXM_CL_MEM(engine, VXM_CL_MIXED), VXM_CL_MEM(engine, VXM_CL_FULL),
                                    VXM_CL_VALUE(dims), VXM_CL_VALUE(range)),
                        error);
  }
  return status;
}

/** Numbers the nodes of a level that stay or, for level -1, the mixed bricks. `*total`: how many. */
static vxm_status number(const pruning *p, int level, vxm_cl_buffer_id into, cl_uint *total,
                         vxm_error *error) {
  vxm_opencl *engine = p->engine;
  const cl_uint4 range = vxm_cl_level_of(p->tree, level < 0 ? 0 : level, 0, 0);
  const cl_uint of_children = level < 0;
  vxm_status status = vxm_cl_reserve(engine, into, ((size_t)range.s[1] + 1) * sizeof(cl_uint), error);
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_COUNT_KEPT, range.s[1],
                        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_MIXED), VXM_CL_MEM(engine, VXM_CL_FULL),
                                    VXM_CL_MEM(engine, into), VXM_CL_VALUE(range), VXM_CL_VALUE(of_children)),
                        error);
  if (status == VXM_OK)
    status = vxm_cl_scan(engine, into, range.s[1], error);
  return status == VXM_OK
             ? vxm_cl_download(engine, into, range.s[1] * sizeof(cl_uint), total, sizeof *total, error)
             : status;
}

static void *allocate(vxm_context *context, size_t count, size_t size, vxm_status *status, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  void *block = vxm_alloc(context, count, size, &local);
  *status = local.code;
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return block;
}

static vxm_status take_bricks(const pruning *p, vxm_cl_buffer_id before, cl_uint total, vxm_error *error) {
  vxm_opencl *engine = p->engine;
  const cl_uint count = p->tree->level[0].count;
  vxm_status status;
  p->sparse->brick_count = total;
  p->sparse->bricks = allocate(p->sparse->context, total, sizeof *p->sparse->bricks, &status, error);
  if (status == VXM_OK)
    status = vxm_cl_reserve(engine, VXM_CL_TAKEN, total * sizeof(uint64_t), error);
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_TAKE_BRICKS, (uint64_t)count * 64,
                        VXM_CL_ARGS(VXM_CL_MEM(engine, p->bricks), VXM_CL_MEM(engine, VXM_CL_MIXED),
                                    VXM_CL_MEM(engine, before), VXM_CL_MEM(engine, VXM_CL_TAKEN),
                                    VXM_CL_VALUE(count)),
                        error);
  return status == VXM_OK ? vxm_cl_download(engine, VXM_CL_TAKEN, 0, p->sparse->bricks,
                                            total * sizeof *p->sparse->bricks, error)
                          : status;
}

/** Takes the nodes of a level that stay; `below` numbers those of the level below, or the bricks. */
static vxm_status take_level(const pruning *p, int level, vxm_cl_buffer_id kept, vxm_cl_buffer_id below,
                             cl_uint total, vxm_error *error) {
  vxm_opencl *engine = p->engine;
  bool is_root = level == p->tree->levels - 1;
  size_t count = is_root ? 1 : total;
  const cl_uint4 range = vxm_cl_level_of(p->tree, level, level == 0, is_root);
  vxm_status status;
  p->sparse->node_count[level] = count;
  vxm_octree_node *nodes = allocate(p->sparse->context, count, sizeof *nodes, &status, error);
  p->sparse->nodes[level] = nodes;
  if (status == VXM_OK)
    status = vxm_cl_reserve(engine, VXM_CL_TAKEN, count * sizeof *nodes, error);
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_TAKE_NODES, range.s[1],
                        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_MIXED), VXM_CL_MEM(engine, VXM_CL_FULL),
                                    VXM_CL_MEM(engine, VXM_CL_FIRSTS), VXM_CL_MEM(engine, kept),
                                    VXM_CL_MEM(engine, below), VXM_CL_MEM(engine, VXM_CL_TAKEN),
                                    VXM_CL_VALUE(range)),
                        error);
  return status == VXM_OK ? vxm_cl_download(engine, VXM_CL_TAKEN, 0, nodes, count * sizeof *nodes, error)
                          : status;
}

static vxm_status take_all(const pruning *p, vxm_error *error) {
  static const vxm_cl_buffer_id kept[2] = {VXM_CL_KEPT, VXM_CL_KEPT2};
  cl_uint total = 0;
  vxm_status status = find(p, error);
  if (status == VXM_OK)
    status = number(p, -1, kept[1], &total, error);
  if (status == VXM_OK)
    status = take_bricks(p, kept[1], total, error);
  for (int l = 0; l < p->tree->levels && status == VXM_OK; l++) {
    status = number(p, l, kept[l % 2], &total, error);
    if (status == VXM_OK)
      status = take_level(p, l, kept[l % 2], kept[(l + 1) % 2], total, error);
  }
  return status;
}

/** An octree of nothing: its root. */
static vxm_status take_none(const pruning *p, vxm_error *error) {
  int root = p->tree->levels - 1;
  vxm_status status;
  p->sparse->nodes[root] = allocate(p->sparse->context, 1, sizeof *p->sparse->nodes[root], &status, error);
  if (status == VXM_OK) {
    p->sparse->nodes[root][0] = (vxm_octree_node){0, 0, 0};
    p->sparse->node_count[root] = 1;
  }
  return status;
}

vxm_status vxm_cl_tree_take(vxm_sparse **out, vxm_opencl *engine, const vxm_cl_tree *tree,
                            vxm_cl_buffer_id bricks, vxm_cl_buffer_id inside, vxm_context *context,
                            vxm_error *error) {
  pruning p = {.engine = engine, .tree = tree, .bricks = bricks, .inside = inside};
  double since = vxm_clock_ms();
  vxm_status status = vxm_octree_new(out, context, &tree->space, error);
  p.sparse = *out;
  if (status == VXM_OK)
    status = tree->level[0].count > 0 ? take_all(&p, error) : take_none(&p, error);
  if (status == VXM_OK && engine->stages) {
    engine->stages->cells_active = tree->level[0].count;
    engine->stages->nodes = tree->node_count;
  }
  return status == VXM_OK ? vxm_cl_stage_end(engine, VXM_CL_STAGE(prune), &since, error) : status;
}

vxm_status vxm_cl_tree_end(vxm_sparse **out, vxm_opencl *engine, vxm_status status) {
  if (status != VXM_OK) {
    engine->cl->Finish(engine->queue);
    vxm_sparse_destroy(*out);
    *out = NULL;
  }
  for (int b = VXM_CL_CELLS; b <= VXM_CL_OCTREE_END; b++)
    vxm_cl_release(engine, (vxm_cl_buffer_id)b);
  return status;
}

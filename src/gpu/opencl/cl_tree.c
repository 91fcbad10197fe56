/* SPDX-License-Identifier: BSD-3-Clause */
/** Which nodes an octree needs (Schwarz & Seidel 2010, sections 5.1 and 5.2): shaders/cells.cl marks cells,
 * in Morton order, so that a prefix sum lists them; shaders/nodes.cl makes the levels above of them. */
#include "gpu/opencl/cl_tree.h"
#include "base/clock.h"
#include "gpu/opencl/cl_sort.h"

enum {
  CELL_BITS = 4,        /**< a cell is 2^4 voxels wide */
  FEW_COLUMNS = 64,     /**< of cells, of a triangle that one work-item does */
  CELLS_MOST = 1 << 25, /**< so that their bricks are counted in 32 bits, and nodes of all levels in 31 */
};

vxm_status vxm_cl_stage_end(vxm_opencl *engine, size_t stage, double *since, vxm_error *error) {
  if (!engine->stages)
    return VXM_OK;
  vxm_status status = vxm_cl_check(engine->cl->Finish(engine->queue), "waiting for a stage", error);
  double now = vxm_clock_ms();
  *(double *)((char *)engine->stages + stage) += now - *since;
  *since = now;
  return status;
}

/* ---- Numbers of cells ---- */

/** Bits that the cells along an axis need. */
static int bits_of(int32_t cells) {
  int bits = 0;
  while (INT32_C(1) << bits < cells)
    bits++;
  return bits;
}

static vxm_status shape(vxm_cl_tree *tree, const vxm_space *space, vxm_error *error) {
  int bits[3], all = 0;
  *tree = (vxm_cl_tree){.space = *space, .levels = vxm_octree_levels(space)};
  for (int a = 0; a < 3; a++) {
    tree->cells[a] = (int32_t)((space->dims[a] + 15) >> CELL_BITS);
    bits[a] = bits_of(tree->cells[a]);
    all += bits[a];
    for (int b = 0; b < bits[a]; b++)
      tree->axes |= (cl_ulong)1 << (3 * b + a);
  }
  if (all > 36)
    return vxm_fail(error, VXM_ERROR_RANGE,
                    "an octree of %lld x %lld x %lld voxels is too large for OpenCL; use --engine cpu",
                    (long long)space->dims[0], (long long)space->dims[1], (long long)space->dims[2]);
  tree->words = all > 5 ? (cl_uint)1 << (all - 5) : 1;
  return VXM_OK;
}

/** What each coordinate adds to the number of a cell: its bits lie where those of the axes before in Morton
 * order leave them room. */
static vxm_status upload_places(vxm_opencl *engine, const vxm_cl_tree *tree, vxm_error *error) {
  size_t count = (size_t)tree->cells[0] + (size_t)tree->cells[1] + (size_t)tree->cells[2], at = 0;
  vxm_error local = VXM_ERROR_INIT;
  cl_ulong *places = vxm_calloc(engine->base.context, count, sizeof *places, &local);
  for (int a = 0; places && a < 3; a++)
    for (int32_t c = 0; c < tree->cells[a]; c++, at++)
      for (int b = 0; c >> b != 0; b++)
        if (c >> b & 1)
          places[at] |= (cl_ulong)1 << vxm_popcount(tree->axes & vxm_low_bits((unsigned)(3 * b + a)));
  vxm_status status =
      places ? vxm_cl_upload(engine, VXM_CL_PLACES, places, count * sizeof *places, &local) : local.code;
  vxm_free(engine->base.context, places);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/* ---- Cells ---- */

static vxm_slab_surface surface_of(const vxm_cl_tree *tree, const vxm_lattice *lattice) {
  vxm_slab_surface job = {.bits = lattice->bits + CELL_BITS,
                          .few_columns = FEW_COLUMNS,
                          .shift = (int32_t)(lattice->unit / 2),
                          .shadow = 1};
  for (int a = 0; a < 3; a++)
    job.last[a] = tree->cells[a];
  return job;
}

/** Points and corners of triangles; `list`: the first of them, and whether they are looked up in `order`. */
typedef struct marking {
  vxm_cl_buffer_id points, corners, order;
  cl_uint2 list;
} marking;

static vxm_status mark_triangles(vxm_opencl *engine, const vxm_slab_surface *job, const marking *m,
                                 vxm_error *error) {
  vxm_status status = vxm_cl_clear_large(engine, job->triangle_count, error);
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_MARK_CELLS, job->triangle_count,
                        VXM_CL_ARGS(VXM_CL_MEM(engine, m->points), VXM_CL_MEM(engine, m->corners),
                                    VXM_CL_MEM(engine, m->order), VXM_CL_MEM(engine, VXM_CL_CELLS),
                                    VXM_CL_MEM(engine, VXM_CL_PLACES), VXM_CL_MEM(engine, VXM_CL_LARGE),
                                    VXM_CL_VALUE(*job), VXM_CL_VALUE(m->list)),
                        error);
  if (status == VXM_OK)
    status =
        vxm_cl_run_groups(engine, VXM_CL_MARK_LARGE, vxm_cl_busy_groups(engine),
                          VXM_CL_ARGS(VXM_CL_MEM(engine, m->points), VXM_CL_MEM(engine, m->corners),
                                      VXM_CL_MEM(engine, VXM_CL_CELLS), VXM_CL_MEM(engine, VXM_CL_PLACES),
                                      VXM_CL_MEM(engine, VXM_CL_LARGE), VXM_CL_VALUE(*job)),
                          error);
  return status;
}

/** What is inside may lie partly beyond the grid, and has to be cut there: the last cells along an axis
 * become nodes, where bodies reach beyond them and cells or nodes above do. */
static vxm_status mark_border(vxm_opencl *engine, const vxm_cl_tree *tree, const vxm_sparse_job *job,
                              const vxm_slab_surface *surface, vxm_error *error) {
  const vxm_lattice *lattice = &job->placed->lattice;
  int64_t low[3] = {INT64_MAX, INT64_MAX, INT64_MAX}, high[3] = {INT64_MIN, INT64_MIN, INT64_MIN};
  vxm_status status = VXM_OK;
  for (uint32_t i = 0; i < job->triangles->first_apex; i++) {
    vxm_point p = vxm_snapped_points_at(job->placed, i);
    for (int a = 0; a < 3; a++) {
      low[a] = vxm_min(low[a], p.at[a]);
      high[a] = vxm_max(high[a], p.at[a]);
    }
  }
  cl_int4 first = {{0, 0, 0, 0}}, last = first;
  for (int a = 0; a < 3; a++) {
    int64_t unit = lattice->unit << CELL_BITS, most = tree->cells[a] - 1;
    first.s[a] = (cl_int)vxm_max(0, vxm_min(most, low[a] / unit - 1));
    last.s[a] = (cl_int)vxm_max(0, vxm_min(most, high[a] / unit + 1));
  }
  for (int a = 0; a < 3 && status == VXM_OK; a++) {
    int64_t dim = tree->space.dims[a];
    if (dim % vxm_octree_side(tree->levels) == 0 || high[a] <= dim << lattice->bits)
      continue;
    cl_int4 from = first;
    cl_uint4 size = {{1, 1, 1, 0}};
    from.s[a] = tree->cells[a] - 1;
    for (int b = 0; b < 3; b++)
      size.s[b] = b == a ? 1 : (cl_uint)(last.s[b] - first.s[b] + 1);
    status = vxm_cl_run(engine, VXM_CL_MARK_BOX, (uint64_t)size.s[0] * size.s[1] * size.s[2],
                        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_CELLS), VXM_CL_MEM(engine, VXM_CL_PLACES),
                                    VXM_CL_VALUE(*surface), VXM_CL_VALUE(from), VXM_CL_VALUE(size)),
                        error);
  }
  return status;
}

static vxm_status mark(vxm_opencl *engine, const vxm_cl_tree *tree, const vxm_sparse_job *job,
                       const vxm_disjoint_passes *passes, vxm_error *error) {
  vxm_slab_surface surface = surface_of(tree, &job->placed->lattice);
  const marking all = {VXM_CL_POINTS,
                       VXM_CL_CORNERS,
                       VXM_CL_ORDER,
                       {{passes->ordered ? 0 : (cl_uint)passes->first, passes->ordered}}};
  surface.triangle_count = (uint32_t)passes->triangle_end[passes->count - 1];
  vxm_status status = upload_places(engine, tree, error);
  if (status == VXM_OK)
    status = vxm_cl_clear(engine, VXM_CL_CELLS, tree->words * sizeof(cl_uint), error);
  if (status == VXM_OK)
    status = mark_triangles(engine, &surface, &all, error);
  if (status == VXM_OK)
    status = mark_border(engine, tree, job, &surface, error);
  return status;
}

/** The cells that the triangles of a surface touch. */
static vxm_status mark_surface(vxm_opencl *engine, const vxm_cl_tree *tree, const vxm_surface *surface,
                               vxm_error *error) {
  vxm_slab_surface job = surface_of(tree, &surface->lattice);
  const marking all = {VXM_CL_SURFACE_POINTS, VXM_CL_SURFACE_CORNERS, VXM_CL_SURFACE_CORNERS, {{0, 0}}};
  job.shift = job.shadow = 0;
  job.triangle_count = (uint32_t)surface->triangle_count;
  vxm_status status = upload_places(engine, tree, error);
  if (status == VXM_OK)
    status = vxm_cl_clear(engine, VXM_CL_CELLS, tree->words * sizeof(cl_uint), error);
  return status == VXM_OK ? mark_triangles(engine, &job, &all, error) : status;
}

/** Counts the cells before each word; all of them are level 0. */
static vxm_status count_cells(vxm_opencl *engine, vxm_cl_tree *tree, vxm_error *error) {
  cl_uint total[2] = {0, 0}; /* the low and the high half */
  vxm_status status =
      vxm_cl_reserve(engine, VXM_CL_BEFORE, ((size_t)tree->words + 1) * sizeof(cl_uint), error);
  if (status == VXM_OK)
    status = vxm_cl_clear(engine, VXM_CL_TALLY, sizeof total, error);
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_COUNT_CELLS, tree->words,
                        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_CELLS), VXM_CL_MEM(engine, VXM_CL_BEFORE),
                                    VXM_CL_MEM(engine, VXM_CL_TALLY), VXM_CL_VALUE(tree->words)),
                        error);
  if (status == VXM_OK)
    status = vxm_cl_download(engine, VXM_CL_TALLY, 0, total, sizeof total, error);
  if (status == VXM_OK && (total[1] > 0 || total[0] > CELLS_MOST))
    return vxm_fail(
        error, VXM_ERROR_RANGE,
        "an octree of %llu cells of 16 x 16 x 16 voxels is too large for OpenCL; use --engine cpu",
        (unsigned long long)total[1] << 32 | total[0]);
  if (status == VXM_OK)
    status = vxm_cl_scan(engine, VXM_CL_BEFORE, tree->words, error);
  tree->level[0].count = total[0];
  return status;
}

/* ---- Nodes ---- */

static vxm_status list_cells(vxm_opencl *engine, const vxm_cl_tree *tree, vxm_error *error) {
  return vxm_cl_run(engine, VXM_CL_LIST_CELLS, tree->words,
                    VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_CELLS), VXM_CL_MEM(engine, VXM_CL_BEFORE),
                                VXM_CL_MEM(engine, VXM_CL_CODES), VXM_CL_VALUE(tree->axes),
                                VXM_CL_VALUE(tree->words)),
                    error);
}

/** How many nodes the levels above have, and where all lie. */
static vxm_status count_nodes(vxm_opencl *engine, vxm_cl_tree *tree, vxm_error *error) {
  cl_uint counts[VXM_OCTREE_LEVELS] = {0}, levels = (cl_uint)tree->levels;
  uint64_t total = tree->level[0].count;
  vxm_status status = vxm_cl_clear(engine, VXM_CL_LEVELS, sizeof counts, error);
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_COUNT_NODES, tree->level[0].count,
                        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_CODES), VXM_CL_MEM(engine, VXM_CL_LEVELS),
                                    VXM_CL_VALUE(tree->level[0].count), VXM_CL_VALUE(levels)),
                        error);
  if (status == VXM_OK)
    status = vxm_cl_download(engine, VXM_CL_LEVELS, 0, counts, sizeof counts, error);
  for (int l = 1; l < tree->levels && status == VXM_OK; l++) {
    tree->level[l] = (vxm_cl_level){(cl_uint)total, counts[l]};
    total += counts[l];
  }
  tree->node_count = (cl_uint)total;
  return status;
}

/** Room for all nodes. Codes of level 0 are there already, in a buffer with room for them alone at first. */
static vxm_status reserve(vxm_opencl *engine, const vxm_cl_tree *tree, vxm_error *error) {
  static const struct {
    vxm_cl_buffer_id id;
    size_t bytes;
  } arrays[] = {{VXM_CL_PARENTS, 4},  {VXM_CL_NEXT, 4},   {VXM_CL_EXITS, 4},
                {VXM_CL_CHILDREN, 8}, {VXM_CL_FIRSTS, 4}, {VXM_CL_INSIDE, 16}};
  vxm_status status = VXM_OK;
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays && status == VXM_OK; i++)
    status = vxm_cl_reserve(engine, arrays[i].id, tree->node_count * arrays[i].bytes, error);
  if (status == VXM_OK)
    status = vxm_cl_reserve(engine, VXM_CL_KEPT, ((size_t)tree->level[0].count + 1) * sizeof(cl_uint), error);
  return status;
}

static vxm_status make_parents(vxm_opencl *engine, const vxm_cl_tree *tree, int level, vxm_error *error) {
  const cl_uint4 range = vxm_cl_level_of(tree, level, tree->level[level + 1].first, 0);
  vxm_status status = vxm_cl_run(
      engine, VXM_CL_FLAG_PARENTS, tree->level[level].count,
      VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_CODES), VXM_CL_MEM(engine, VXM_CL_KEPT), VXM_CL_VALUE(range)),
      error);
  if (status == VXM_OK)
    status = vxm_cl_scan(engine, VXM_CL_KEPT, tree->level[level].count, error);
  if (status == VXM_OK)
    status = vxm_cl_run(engine, VXM_CL_MAKE_PARENTS, tree->level[level].count,
                        VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_CODES), VXM_CL_MEM(engine, VXM_CL_KEPT),
                                    VXM_CL_MEM(engine, VXM_CL_PARENTS), VXM_CL_MEM(engine, VXM_CL_CHILDREN),
                                    VXM_CL_MEM(engine, VXM_CL_FIRSTS), VXM_CL_VALUE(range)),
                        error);
  return status;
}

static vxm_status link_nodes(vxm_opencl *engine, const vxm_cl_tree *tree, int level, vxm_error *error) {
  const cl_uint4 range = vxm_cl_level_of(tree, level, 0, 0);
  return vxm_cl_run(
      engine, VXM_CL_LINK_NODES, tree->level[level].count,
      VXM_CL_ARGS(VXM_CL_MEM(engine, VXM_CL_CODES), VXM_CL_MEM(engine, VXM_CL_NEXT), VXM_CL_VALUE(range)),
      error);
}

static vxm_status construct(vxm_opencl *engine, vxm_cl_tree *tree, vxm_error *error) {
  /* Levels above level 0 have fewer nodes each, and a hundredth of it in all on most surfaces; of a few cells
     each level may have as many. */
  size_t most = (size_t)tree->level[0].count * (size_t)tree->levels;
  vxm_status status = vxm_cl_reserve(engine, VXM_CL_CODES, most * sizeof(cl_ulong), error);
  if (status == VXM_OK)
    status = list_cells(engine, tree, error);
  if (status == VXM_OK)
    status = count_nodes(engine, tree, error);
  if (status == VXM_OK)
    status = reserve(engine, tree, error);
  for (int l = 0; l < tree->levels && status == VXM_OK; l++) {
    if (l + 1 < tree->levels)
      status = make_parents(engine, tree, l, error);
    if (status == VXM_OK)
      status = link_nodes(engine, tree, l, error);
  }
  return status;
}

/** The nodes of the cells that are marked. */
static vxm_status make_nodes(vxm_cl_tree *tree, vxm_opencl *engine, double *since, vxm_error *error) {
  vxm_status status = count_cells(engine, tree, error);
  if (status == VXM_OK)
    status = vxm_cl_stage_end(engine, VXM_CL_STAGE(cells), since, error);
  if (status == VXM_OK && tree->level[0].count > 0)
    status = construct(engine, tree, error);
  return status == VXM_OK ? vxm_cl_stage_end(engine, VXM_CL_STAGE(construct), since, error) : status;
}

vxm_status vxm_cl_tree_create(vxm_cl_tree *out, vxm_opencl *engine, const vxm_space *space,
                              const vxm_sparse_job *job, const vxm_disjoint_passes *passes,
                              vxm_error *error) {
  double since = vxm_clock_ms();
  vxm_status status = shape(out, space, error);
  if (status == VXM_OK)
    status = mark(engine, out, job, passes, error);
  return status == VXM_OK ? make_nodes(out, engine, &since, error) : status;
}

vxm_status vxm_cl_tree_create_surface(vxm_cl_tree *out, vxm_opencl *engine, const vxm_surface *surface,
                                      vxm_error *error) {
  double since = vxm_clock_ms();
  vxm_status status = shape(out, &surface->lattice.space, error);
  if (status == VXM_OK)
    status = mark_surface(engine, out, surface, error);
  return status == VXM_OK ? make_nodes(out, engine, &since, error) : status;
}

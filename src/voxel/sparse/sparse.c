/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/sparse/sparse.h"
#include "voxel/model/memory_need.h"
#include "voxel/model/model_report.h"
#include "voxel/solid/outside_parts.h"
#include "voxel/solid/self_overlap_fill.h"
#include "voxel/surface/surface_octree.h"
#include "voxel/thin/thin_sparse.h"

#include <math.h>

/** The axis of rows of an octree. */
enum { along_x = 0 };

/** Bytes of a range of slices, unless so few are more. */
static const uint64_t window_bytes_most = UINT64_C(1) << 26;

bool vxm_sparse_is_direct(const vxm_model *model) {
  const vxm_voxelize_options *options = &model->options;
  const vxm_split *split = &model->analysis.triangles.split;
  if (vxm_shell_wanted(options) || options->method == VXM_METHOD_WINDING)
    return false;
  if (vxm_one_voter(options)) /* of closed parts all axes tell the same */
    return options->method == VXM_METHOD_X || split->kind_end[VXM_PART_CLOSED] == split->part_count;
  return !vxm_votes_wanted(&model->analysis, options);
}

static bool is_direct_forced;

void vxm_sparse_force_direct(bool force) {
  is_direct_forced = force;
}

/** Whether the mesh is so fine that to keep thin parts takes less time in a grid than in an octree. */
static bool is_better_in_grid(const vxm_model_pass *pass) {
  const uint64_t words_each = 128; /* for each triangle, as measured */
  const int64_t *dims = pass->space.dims;
  uint64_t triangles = pass->solid.analysis->triangles.triangle_count;
  uint64_t words = (uint64_t)(dims[0] + 63) / 64 * (uint64_t)dims[1] * (uint64_t)dims[2];
  return pass->separating && !is_direct_forced && words <= words_each * triangles &&
         words * sizeof words < vxm_memory_left(pass->solid.context) / 4;
}

/** Whether nothing is made by windows: neither the solid, where one is wanted, nor the faces. */
static bool is_without_windows(const vxm_model *model, const vxm_model_pass *pass) {
  const vxm_engine *engine = pass->solid.engine;
  const vxm_engine_ops *ops = engine ? engine->ops : NULL;
  bool solid = vxm_solid_wanted(&model->options), faces = vxm_faces_wanted(&model->options);
  if (ops && vxm_overlaps_wanted(&model->analysis, &model->options))
    return false; /* parts that lie in themselves are filled by the CPU */
  if (ops && ((solid && !ops->sparse) || (faces && ops->surface && !ops->sparse_surface)))
    return false; /* the engine makes windows only */
  return !solid || (vxm_sparse_is_direct(model) && (ops || !is_better_in_grid(pass)));
}

static vxm_sparse_job job_of(const vxm_model_pass *pass) {
  const vxm_voxel_pass *solid = &pass->solid;
  vxm_sparse_job job = {.triangles = &solid->analysis->triangles,
                        .placed = &solid->placed,
                        .part_end = solid->analysis->triangles.split.part_count,
                        .roles = VXM_ROLE_FACE,
                        .has_voxels = solid->has_voxels};
  if (!vxm_one_voter(&solid->options))
    job.roles |= VXM_ROLE_CAP;
  return job;
}

static vxm_status unite_parts(vxm_sparse **out, vxm_model_pass *pass, const vxm_sparse_job *job,
                              vxm_chain_winding *chain, vxm_error *error) {
  vxm_octree_builder builder;
  vxm_status status = vxm_octree_builder_create(&builder, pass->solid.context, &pass->space, error);
  if (status == VXM_OK)
    status = vxm_sparse_union(&builder, &pass->workspace, job, chain, error);
  if (status == VXM_OK)
    status = vxm_octree_builder_end(out, &builder, error);
  vxm_octree_builder_destroy(&builder);
  return status;
}

/** Whether a part that lies in itself, and in the grid, has no voxel by parity. */
static bool lacks_voxels(const vxm_voxel_pass *solid) {
  const vxm_self_overlap *overlap = &solid->analysis->self_overlap;
  bool lacks = false;
  for (size_t i = 0; i < overlap->part_count && solid->has_voxels && !lacks; i++)
    lacks = !atomic_load_explicit(&solid->has_voxels[overlap->part[i]], memory_order_relaxed) &&
            !vxm_part_is_outside(solid, overlap->part[i]);
  return lacks;
}

/** Notes whether the parts that lie in themselves have voxels only in what parity leaves hollow: the octree
 * is made once more without that. Few models have a part for which this is asked. */
static vxm_status note_filled(const vxm_sparse *filled, vxm_model_pass *pass, const vxm_sparse_job *job,
                              vxm_error *error) {
  vxm_sparse *hollow;
  int64_t voxels, of_parity;
  uint64_t hash;
  vxm_status status = unite_parts(&hollow, pass, job, NULL, error);
  if (status != VXM_OK)
    return status;
  vxm_octree_count_hash(filled, &voxels, &hash);
  vxm_octree_count_hash(hollow, &of_parity, &hash);
  vxm_sparse_destroy(hollow);
  if (voxels > of_parity)
    vxm_self_overlap_note(&pass->solid);
  return VXM_OK;
}

/** @param noted whether the report is to know which parts have voxels */
static vxm_status unite_directly(vxm_sparse **out, vxm_model_pass *pass, const vxm_sparse_job *job,
                                 bool noted, vxm_error *error) {
  vxm_voxel_pass *solid = &pass->solid;
  if (!vxm_overlaps_wanted(solid->analysis, &solid->options))
    return unite_parts(out, pass, job, NULL, error);
  vxm_status status = vxm_self_overlap_place(solid, along_x, error);
  if (status == VXM_OK)
    status = unite_parts(out, pass, job, &solid->overlap_winding, error);
  if (status == VXM_OK && noted && lacks_voxels(solid))
    status = note_filled(*out, pass, job, error);
  if (status != VXM_OK) {
    vxm_sparse_destroy(*out);
    *out = NULL;
  }
  return status;
}

vxm_status vxm_sparse_closed(vxm_sparse **out, vxm_model_pass *pass, vxm_error *error) {
  vxm_sparse_job job = job_of(pass);
  job.part_end = pass->solid.analysis->triangles.split.kind_end[VXM_PART_CAPPED];
  job.roles = VXM_ROLE_FACE | VXM_ROLE_CAP;
  return unite_directly(out, pass, &job, false, error);
}

/** By the pass's engine; `*out` stays NULL where that is for the CPU. */
static vxm_status unite_elsewhere(vxm_sparse **out, vxm_model_pass *pass, vxm_error *error) {
  vxm_engine *engine = pass->solid.engine;
  vxm_error local = VXM_ERROR_INIT;
  if (!engine || !engine->ops || !engine->ops->sparse)
    return VXM_OK;
  vxm_sparse_job job = job_of(pass);
  vxm_status status = engine->ops->sparse(engine, out, &pass->space, &job, &local);
  if (status == VXM_OK || vxm_engine_falls_back(engine, &local))
    return VXM_OK;
  vxm_error_pass(error, &local);
  return status;
}

/** From so many bytes on an octree matters more than room that is kept for the next call. */
static const uint64_t large_octree = UINT64_C(1) << 27;

/** Whether to order the triangles takes less time than it saves: many, with many crossings. Memory is to be
 * left for what is needed. */
static bool is_order_wanted(const vxm_voxel_pass *solid) {
  const size_t least_triangles = 1 << 12, count = solid->analysis->triangles.triangle_count;
  const double least_crossings = 1 << 22;
  return count >= least_triangles && count * VXM_ORDER_BYTES <= vxm_memory_left(solid->context) / 8 &&
         vxm_raster_schedule_placed_bound(&solid->placed, VXM_ROLE_FACE) >= least_crossings;
}

/** The solid, straight from the triangles, by the CPU where there is none yet. */
static vxm_status make_of(vxm_sparse **out, vxm_model_pass *pass, const vxm_sparse_job *job,
                          vxm_error *error) {
  vxm_status status = *out ? VXM_OK : unite_directly(out, pass, job, true, error);
  if (status == VXM_OK && vxm_octree_bytes(*out) >= large_octree) {
    vxm_workspace_destroy(&pass->workspace);
    pass->workspace = vxm_workspace_of(pass->solid.context);
  }
  return status == VXM_OK && pass->separating ? vxm_thin_add_sparse(&pass->thin.thin, out, job->triangles,
                                                                    job->placed, pass->separating, error)
                                              : status;
}

static vxm_status make_solid(vxm_sparse **out, vxm_model_pass *pass, vxm_error *error) {
  vxm_status status = unite_elsewhere(out, pass, error);
  vxm_sparse_job job = job_of(pass);
  if (status != VXM_OK || !is_order_wanted(&pass->solid))
    return status == VXM_OK ? make_of(out, pass, &job, error) : status;
  vxm_triangle_order order;
  vxm_triangle_order_make(&order, pass->solid.context, job.triangles, job.placed);
  job.triangles = &order.set;
  job.order = &order;
  status = make_of(out, pass, &job, error);
  vxm_triangle_order_destroy(&order);
  return status;
}

/** The faces by the pass's engine; `*out` stays NULL where that is for the CPU. */
static vxm_status make_faces_elsewhere(vxm_sparse **out, vxm_model_pass *pass, vxm_error *error) {
  vxm_engine *engine = pass->solid.engine;
  vxm_error local = VXM_ERROR_INIT;
  if (!engine || !engine->ops || !engine->ops->sparse_surface)
    return VXM_OK;
  vxm_status status =
      engine->ops->sparse_surface(engine, out, pass->surface, pass->solid.options.surface, &local);
  if (status == VXM_OK || vxm_engine_falls_back(engine, &local))
    return VXM_OK;
  vxm_error_pass(error, &local);
  return status;
}

static vxm_status make_faces(vxm_sparse **out, vxm_model_pass *pass, vxm_error *error) {
  *out = NULL;
  vxm_status status = make_faces_elsewhere(out, pass, error);
  return status == VXM_OK && !*out
             ? vxm_surface_octree(out, pass->surface, pass->solid.options.surface, error)
             : status;
}

/** Puts the voxels of the faces to those of the solid; NULL for none. */
static vxm_status add_faces(vxm_sparse **octree, vxm_model_pass *pass, vxm_error *error) {
  vxm_sparse *faces, *both = NULL;
  vxm_status status = make_faces(&faces, pass, error);
  if (status == VXM_OK && *octree) {
    status = vxm_octree_combine(&both, *octree, faces, VXM_SET_UNION, error);
    vxm_sparse_destroy(faces);
    faces = both;
  }
  if (status == VXM_OK) {
    vxm_sparse_destroy(*octree);
    *octree = faces;
  }
  return status;
}

/** Slices of a range: whole strips, as many as memory allows. */
static int64_t range_slices(const vxm_model *model, const vxm_space *space, const vxm_window *window) {
  vxm_memory_need demand = vxm_model_memory_need(model, space, window, false, false);
  uint64_t slice = window->slice_words * sizeof *window->words, left = vxm_memory_left(model->context);
  uint64_t room = left > demand.fixed ? (left - demand.fixed) / 2 / (uint64_t)demand.windows : 0;
  room = room < window_bytes_most ? room : window_bytes_most;
  int64_t strips = (int64_t)(room / slice) / VXM_STRIP_VOXELS;
  return vxm_max(strips, 1) * VXM_STRIP_VOXELS;
}

/** Range of slices after range, each as a window. */
static vxm_status add_windows(vxm_octree_builder *builder, const vxm_model *model, vxm_model_pass *pass,
                              vxm_error *error) {
  vxm_layout layout = VXM_LAYOUT_GRID;
  vxm_window window = vxm_window_of(&pass->space, layout, 0, 0);
  int64_t slices = vxm_min(range_slices(model, &pass->space, &window), window.slow_dim);
  vxm_status status = VXM_OK;
  window.words = vxm_try_alloc(model->context, (size_t)slices * window.slice_words, sizeof *window.words,
                               &status, error);
  if (!window.words)
    return status;
  for (int64_t begin = 0; begin < window.slow_dim && status == VXM_OK; begin += slices) {
    window.begin = begin;
    window.end = vxm_min(begin + slices, window.slow_dim);
    status = vxm_model_pass_fill(pass, &window, error);
    if (status == VXM_OK)
      vxm_octree_builder_add(builder, &window);
    if (status == VXM_OK)
      status = vxm_octree_builder_check(builder, error);
  }
  vxm_free(model->context, window.words);
  return status;
}

static vxm_status unite_by_windows(vxm_sparse **out, const vxm_model *model, vxm_model_pass *pass,
                                   vxm_error *error) {
  vxm_octree_builder builder;
  vxm_status status = vxm_octree_builder_create(&builder, model->context, &pass->space, error);
  if (status == VXM_OK)
    status = add_windows(&builder, model, pass, error);
  if (status == VXM_OK)
    status = vxm_octree_builder_end(out, &builder, error);
  vxm_octree_builder_destroy(&builder);
  return status;
}

/** Whether all crossings of parts that lie in themselves may be kept that are in one layer of strips. */
static bool is_layer_small(const vxm_voxel_pass *solid, const vxm_space *space) {
  double layer = fmin(VXM_STRIP_VOXELS / (double)space->dims[2], 1);
  return solid->overlap_winding.estimate * layer <= vxm_raster_schedule_round(solid->context);
}

static vxm_status make(vxm_sparse **out, const vxm_model *model, vxm_model_pass *pass, vxm_error *error) {
  bool direct = is_without_windows(model, pass), solid = vxm_solid_wanted(&model->options);
  vxm_status status = VXM_OK;
  if (direct && vxm_overlaps_wanted(&model->analysis, &model->options)) {
    status = vxm_self_overlap_place(&pass->solid, along_x, error);
    direct = is_layer_small(&pass->solid, &pass->space);
  }
  if (status == VXM_OK && !direct)
    return unite_by_windows(out, model, pass, error);
  if (status == VXM_OK && solid)
    status = make_solid(out, pass, error);
  return status == VXM_OK && vxm_faces_wanted(&model->options) ? add_faces(out, pass, error) : status;
}

vxm_status vxm_sparse_of_pass(vxm_sparse **out, const vxm_model *model, vxm_model_pass *pass,
                              vxm_error *error) {
  *out = NULL;
  vxm_status status = make(out, model, pass, error);
  if (status != VXM_OK) {
    vxm_sparse_destroy(*out);
    *out = NULL;
  }
  return status;
}

vxm_status vxm_sparse_make(vxm_sparse **out, vxm_voxelize_report *report, vxm_model *model,
                           const vxm_space *space, const double transform[12], vxm_error *error) {
  *out = NULL;
  if (model->options.confidence)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sparse: the confidence needs the whole grid");
  vxm_model_pass *pass;
  vxm_status status = vxm_model_begin(&pass, model, space, transform, NULL, error);
  if (status == VXM_OK)
    status = vxm_sparse_of_pass(out, model, pass, error);
  if (status == VXM_OK && report) {
    int64_t voxels;
    uint64_t hash;
    vxm_octree_count_hash(*out, &voxels, &hash);
    vxm_model_report(pass, report, voxels, hash);
  }
  vxm_model_close(model, pass);
  return status;
}

/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * One thread's way through the windows of one grid: the options, the points on that grid's lattice, and the
 * memory that is kept from one grid to the next; and its steps, each by the pass's engine or by the CPU.
 */
#ifndef VXM_VOXEL_SOLID_VOXEL_PASS_H
#define VXM_VOXEL_SOLID_VOXEL_PASS_H

#include "voxel/engine/engine.h"
#include "voxel/parity/slabs.h"
#include "voxel/solid/solid_policy.h"
#include "voxel/winding/winding_mesh.h"

/** Words as a window has, kept from one use to the next. */
typedef struct vxm_buffer {
  uint64_t *words;
  size_t count;
} vxm_buffer;

enum {
  VXM_BUFFER_VOTERS = 0, /**< x, y, z and the tetrahedra */
  VXM_BUFFER_MASK = 4,   /**< contested voxels */
  VXM_BUFFER_CLOSED,     /**< what closed parts fill */
  VXM_BUFFER_CARRY,      /**< a slice, for vxm_axis_vote */
  VXM_BUFFERS
};

typedef struct vxm_voxel_pass {
  vxm_context *context; /**< whose threads work, and which counts what the pass holds */
  const vxm_mesh_analysis *analysis;
  vxm_voxelize_options options;
  vxm_workspace *workspace; /**< lent */
  vxm_engine *engine;       /**< NULL = the CPU */
  vxm_snapped_points placed;
  const vxm_vertex_transform
      *motion;   /**< how points move before they are placed; NULL = only by a transform */
  bool mirrored; /**< the transform turns triangles inside out */
  vxm_buffer buffers[VXM_BUFFERS];
  vxm_winding_mesh open_winding, all_winding; /**< made when first needed */
  vxm_chain_winding overlap_winding;          /**< of parts that lie in themselves */
  bool overlap_placed;                        /**< whether it is */
  atomic_uchar *has_voxels;                   /**< per part: whether it sets a voxel; NULL = not asked */
  uint8_t *confidence;                        /**< of the whole grid, x fastest; NULL = not asked */
  int64_t contested, winding_decided;
  bool added;          /**< whether the open parts set a voxel */
  bool no_vote_resume; /**< an engine fell back behind the first window, so that a vote has no state to go on
                          from */
} vxm_voxel_pass;

/** A pass that holds nothing yet, in the context of its workspace. */
vxm_voxel_pass vxm_voxel_pass_of(const vxm_mesh_analysis *analysis, const vxm_voxelize_options *options,
                                 vxm_workspace *workspace);
/** Frees what the pass holds: its placing, buffers and trees. */
void vxm_voxel_pass_destroy(vxm_voxel_pass *pass);

/** What the pass's engine does; NULL = it is the CPU. */
static inline const vxm_engine_ops *vxm_voxel_pass_ops(const vxm_voxel_pass *pass) {
  return pass->engine ? pass->engine->ops : NULL;
}

/** Forgets what is known of the grid before. */
void vxm_voxel_pass_begin(vxm_voxel_pass *pass);
/** Places the points, as vxm_snapped_points_set or vxm_snapped_points_move; by the engine, if it moves
 * points. */
vxm_status vxm_voxel_pass_place(vxm_voxel_pass *pass, const vxm_lattice *lattice, const double transform[12],
                                vxm_error *error);
/** A window like another with the words of a buffer. */
vxm_status vxm_voxel_pass_buffer(vxm_voxel_pass *pass, int buffer, const vxm_window *like, vxm_window *out,
                                 vxm_error *error);
/** Sets every voxel of a job's parts. */
vxm_status vxm_voxel_pass_unite_job(vxm_voxel_pass *pass, const vxm_window *window,
                                    const vxm_parity_union_job *job, vxm_error *error);
/** Sets every voxel of parts part_begin to part_end - 1 by parity along an axis. */
vxm_status vxm_voxel_pass_unite(vxm_voxel_pass *pass, const vxm_window *window, int axis, size_t part_begin,
                                size_t part_end, unsigned roles, vxm_error *error);
/** The surface in a window, as vxm_surface_add. */
vxm_status vxm_voxel_pass_surface(vxm_voxel_pass *pass, const vxm_surface *surface, const vxm_window *window,
                                  vxm_surface_kind kind, bool is_fresh, vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The solid of facets in the windows of one grid: which parts one axis settles, who votes on the others, and
 * what the winding number decides.
 */
#ifndef VXM_VOXEL_SOLID_SOLID_POLICY_H
#define VXM_VOXEL_SOLID_SOLID_POLICY_H

#include "voxel/engine/engine.h"
#include "voxel/parity/slabs.h"
#include "voxel/winding/orient_patches.h"
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

/** What is known of a mesh whatever the grid. */
typedef struct vxm_mesh_analysis {
  vxm_context *context;
  const vxm_soup *soup;
  const vxm_voxelize_options *options;
  vxm_triangle_set facets;
  vxm_flip_mask open_turns, all_turns; /**< triangles that face inward, of the open parts and of all; found
                                      when first needed */
  vxm_workspace workspace;
} vxm_mesh_analysis;

/** The voxelization of a shape in one grid, window after window. */
typedef struct vxm_voxel_pass {
  vxm_mesh_analysis *shape;
  vxm_engine *engine; /**< NULL = the CPU */
  vxm_snapped_points placed;
  const vxm_vertex_transform
      *motion;   /**< how points move before they are placed; NULL = only by a transform */
  bool mirrored; /**< the transform turns triangles inside out */
  vxm_buffer buffers[VXM_BUFFERS];
  vxm_winding_mesh open_wound, all_wound; /**< made when first needed */
  atomic_uchar *has_voxels;               /**< per part: whether it sets a voxel; NULL = not asked */
  uint8_t *confidence;                    /**< of the whole grid, x fastest; NULL = not asked */
  int64_t contested, escalated;
  bool added;   /**< whether the open parts set a voxel */
  bool no_poll; /**< an engine gave way behind the first window, so that a poll has no state to go on from */
} vxm_voxel_pass;

/** Whether holes are capped: only where no rule of the papers was asked for. */
bool vxm_caps_wanted(const vxm_voxelize_options *options);
/** Whether the method is one voter for all parts. */
bool vxm_one_voter(const vxm_voxelize_options *options);
/** The first part of those that voters decide. If there are any, they have odd edges. */
size_t vxm_voted_begin(const vxm_mesh_analysis *shape);
/** Windows that a run holds beside its result, as far as options and parts tell. */
int vxm_voxel_pass_buffers(const vxm_mesh_analysis *shape);
/** Whether the run needs apexes placed. */
bool vxm_voxel_pass_apexes(const vxm_mesh_analysis *shape);
/** Places the points, as vxm_snapped_points_set or vxm_snapped_points_move; by the engine, if it moves
 * points. */
vxm_status vxm_voxel_pass_place(vxm_voxel_pass *run, const vxm_lattice *lattice, const double transform[12],
                                bool confidence, vxm_error *error);

/**
 * Replaces the words of a window by the solid.
 *
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_solid_fill(vxm_voxel_pass *run, const vxm_window *window, vxm_error *error);

/** Sets every voxel of parts part_begin to part_end - 1 by parity along an axis; a part of vxm_solid_fill. */
vxm_status vxm_voxel_pass_unite(vxm_voxel_pass *run, const vxm_window *window, int axis, size_t part_begin,
                                size_t part_end, unsigned roles, vxm_error *error);
/** The surface in a window, as vxm_surface_add. */
vxm_status vxm_voxel_pass_surface(vxm_voxel_pass *run, const vxm_surface *surface, const vxm_window *window,
                                  vxm_surface_kind kind, bool is_fresh, vxm_error *error);
/** A window like another with the words of a buffer. */
vxm_status vxm_voxel_pass_buffer(vxm_voxel_pass *run, int buffer, const vxm_window *like, vxm_window *out,
                                 vxm_error *error);
/** Frees what the run holds; its placing, buffers and trees. */
void vxm_voxel_pass_destroy(vxm_voxel_pass *run);

#endif

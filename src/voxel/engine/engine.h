/* SPDX-License-Identifier: BSD-3-Clause */
/** What an engine other than the CPU does: it makes the bits of windows in place of parity_union.h,
 * axis_vote.h and surface.h. */
#ifndef VXM_VOXEL_ENGINE_ENGINE_H
#define VXM_VOXEL_ENGINE_ENGINE_H

#include "voxel/engine/device_voxels.h"
#include "voxel/engine/sparse_job.h"
#include "voxel/lattice/vertex_transform.h"
#include "voxel/parity/parity_union.h"
#include "voxel/parity/vote.h"
#include "voxel/surface/surface.h"
#include "voxmend/sparse.h"

/** Parts that voters decide; some of them have odd edges, else all voters would agree. */
typedef struct vxm_vote_job {
  const vxm_triangle_set *triangles;
  const vxm_snapped_points *placed;
  size_t part_begin, part_end; /**< each voter is the union of these */
  bool tetra;                  /**< ask the tetrahedra, too, as parity with cones */
  vxm_vote rule;
  atomic_uchar *has_voxels; /**< as in vxm_parity_union_job */
} vxm_vote_job;

/** Voters of an election: x, y, z, and the tetrahedra as parity with cones. */
enum { VXM_VOTERS = 4 };

/** What a voter unites. */
vxm_parity_union_job vxm_voter(const vxm_vote_job *job, const vxm_window *window, int voter);

/** Voxels to colour. */
typedef struct vxm_color_job {
  const vxm_grid *grid;
  const uint16_t *parts; /**< a number per voxel, [x][y][z] in C order; NULL = not needed */
  const vxm_color_options *options;
} vxm_color_job;

/** Points of triangles to be moved and placed. */
typedef struct vxm_move_job {
  const vxm_triangle_set *triangles;
  const vxm_vertex_transform *motion; /**< of the points before first_apex */
  bool apexes;                        /**< as for vxm_snapped_points_set */
} vxm_move_job;

/** All but `destroy` may be NULL: the CPU does it then. Each gives the bits that the CPU gives, unless the
 * engine's own documentation says how far it is off. */
typedef struct vxm_engine_ops {
  /** Moves and places points as vxm_snapped_points_move does: `placed`, which was begun,
   * becomes what that makes of it, and the points are where `unite` and `vote` look for them. `*done` stays
   * false, and that is no failure, where the CPU has to do it. */
  vxm_status (*move)(vxm_engine *engine, vxm_snapped_points *placed, const vxm_move_job *job, bool *done,
                     vxm_error *error);
  vxm_status (*unite)(vxm_engine *engine, const vxm_window *window, const vxm_parity_union_job *job,
                      vxm_error *error);
  /** Adds to the window's words what the voters decide, as vxm_vote_count does. */
  vxm_status (*vote)(vxm_engine *engine, const vxm_window *window, const vxm_vote_job *job,
                     vxm_vote_tally *tally, vxm_error *error);
  /** As vxm_surface_add. */
  vxm_status (*surface)(vxm_engine *engine, const vxm_surface *surface, const vxm_window *window,
                        vxm_surface_kind kind, bool is_fresh, vxm_error *error);
  /** The octree of a job; `*out` stays NULL, and that is no failure, where the CPU has to make it. */
  vxm_status (*sparse)(vxm_engine *engine, vxm_sparse **out, const vxm_space *space,
                       const vxm_sparse_job *job, vxm_error *error);
  /** As vxm_surface_octree; `*out` stays NULL, and that is no failure, where the CPU has to make it. */
  vxm_status (*sparse_surface)(vxm_engine *engine, vxm_sparse **out, const vxm_surface *surface,
                               vxm_surface_kind kind, vxm_error *error);
  /** Fills [x][y][z][4] bytes, 0 where a voxel is not set. */
  vxm_status (*color)(vxm_engine *engine, uint8_t *values, const vxm_color_job *job, vxm_error *error);
  /** Counts the voxels that are set in each group of n x n x n of a window, which begins and ends between
   * groups: a number for each, along bits, then rows, then slices. */
  vxm_status (*count)(vxm_engine *engine, uint16_t *counts, const vxm_window *window, int n,
                      vxm_error *error);
  /** Makes room for voxels that stay; see device_voxels.h. NULL: the engine keeps none. */
  vxm_status (*device_voxels)(vxm_engine *engine, vxm_device_voxels **out, const vxm_device_info *shape,
                              vxm_error *error);
  /** Before a window is made that stays, and is all of a grid: from now on `unite`, `vote` and `surface`
   * leave it on the device, and look at no words. */
  vxm_status (*device_voxels_begin)(vxm_engine *engine, const vxm_window *window, vxm_error *error);
  /** Takes the window, or where its words are not NULL these, into variant `index` of the voxels. */
  vxm_status (*device_voxels_end)(vxm_engine *engine, vxm_device_voxels *voxels, int64_t index,
                                  const vxm_window *window, vxm_error *error);
  void (*destroy)(vxm_engine *engine);
} vxm_engine_ops;

struct vxm_engine {
  const vxm_engine_ops *ops;  /**< NULL: the CPU */
  vxm_context *context;       /**< one reference held */
  bool wants_apexes;          /**< apexes have to be placed */
  bool displaces;             /**< its voxels are those of a mesh whose vertices it has moved */
  bool falls_back;            /**< where it fails, the CPU does the work, and `info.note` says so */
  bool keeps;                 /**< what is made stays on the device */
  bool needs_host;            /**< what should have stayed cannot be made without the CPU */
  atomic_int reference_count; /**< held by who made it, and by voxels in its context */
  vxm_engine_info info;
};

/** Whether the CPU is to do the work after a failure of the engine, which is then switched off and noted. */
bool vxm_engine_falls_back(vxm_engine *engine, const vxm_error *error);

/** For an engine that keeps: the CPU has to take part. @return VXM_ERROR_UNAVAILABLE */
vxm_status vxm_fail_to_keep(vxm_engine *engine, vxm_error *error);

#endif

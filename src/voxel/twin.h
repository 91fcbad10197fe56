/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * A model that has the shape of another one (its parts, caps and turns), but points and working memory of its
 * own: several threads can voxelize variants of one model, and one thread variants of many.
 */
#ifndef VXM_VOXEL_TWIN_H
#define VXM_VOXEL_TWIN_H

#include "voxel/model.h"

/** Start from {.context = ...}. */
typedef struct vxm_twin {
  vxm_context *context;   /**< whose threads work */
  const vxm_model *of;    /**< NULL = attached to none */
  double (*positions)[3]; /**< of the facets' points before first_apex: to be filled before each run, unless
                             an engine moves them */
  double (*vertices)[3];  /**< of the soup, to be filled too; NULL unless faces set voxels */
  size_t position_room, vertex_room, part_room;
  vxm_soup soup; /**< the other's, but for `vertices` */
  vxm_model model;
} vxm_twin;

/** Finds what all twins of a model share, and a run would find when it first needs it. */
vxm_status vxm_twin_prepare(vxm_model *model, vxm_error *error);

/** Attaches a twin to a model that has been prepared and stays as it is. Memory is kept from one to the next.
 */
vxm_status vxm_twin_attach(vxm_twin *twin, const vxm_model *of, vxm_error *error);

/**
 * Has the engine move and place the points for the next run, if there is one that does.
 *
 * @param done becomes whether that is so; else `positions` are to be filled
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_UNAVAILABLE
 */
vxm_status vxm_twin_place(vxm_twin *twin, const vxm_motion *motion, const vxm_lattice *lattice, bool *done,
                          vxm_error *error);

/**
 * Voxelizes the points into a window, which is all of the lattice's space.
 *
 * @param stretch  at least how many times as long as the other's edges are any of these
 * @param reach    plus at most so much, in units of the space
 * @param mirrored whether the points lie as in a mirror
 */
vxm_status vxm_twin_fill(vxm_twin *twin, const vxm_window *window, const vxm_lattice *lattice, double stretch,
                         double reach, bool mirrored, vxm_error *error);
void vxm_twin_destroy(vxm_twin *twin);

#endif

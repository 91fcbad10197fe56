/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file voxmend/carve.h
 * Material removal: what a tool cuts of a grid or an octree along its path.
 */
#ifndef VOXMEND_CARVE_H
#define VOXMEND_CARVE_H

#include "voxmend/sparse.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Material removal: a tool cuts what it moves through ---- */

/**
 * A tool, a mesh that was prepared once, and the voxels from which it takes away: virtual milling, drilling,
 * erosion. One carver, and its grid, may be used by one thread at a time.
 *
 * A pose is the 3 x 4 matrix, row after row, that takes (x, y, z, 1) of the tool to the model units of the
 * stock: a rotation, and where the tool's origin is. Of a stock every voxel is cleared whose centre comes to
 * lie within the tool, anywhere along its path:
 *  - Straight ahead the path is covered exactly, whatever the shape of the tool: by the prisms that its faces
 *    sweep. The path is not sampled, so that a step may be of any length.
 *  - Between poses that are turned, the tool's origin moves straight and evenly, and the tool turns evenly
 *    the shorter way about an axis. That is done in equal parts (by halves) in which no point of the tool
 *    moves by more than half a voxel through the turn; in each the corners of faces go straight ahead, so
 *    that there are no gaps. By that a point misses its arc by less than 1 / (32 r) of a voxel, r voxels from
 *    the axis.
 *
 * Corners lie on a lattice of at least 256 steps to a voxel, and all else is exact. The same steps give the
 * same bits on any machine and for any number of threads.
 */
typedef struct vxm_carver vxm_carver;

/** What a step has removed. */
typedef struct vxm_carve_report {
  size_t size;      /**< as the initializer sets it, or 0 */
  int64_t removed;  /**< voxels that were set, and are cleared */
  int64_t begin[3]; /**< the box of these: from this voxel ... */
  int64_t end[3];   /**< ... to the one before this along each axis; all 0 where none was removed */
} vxm_carve_report;

/** Initial value of vxm_carve_report. */
#define VXM_CARVE_REPORT_INIT           \
  {                                     \
    sizeof(vxm_carve_report), 0, {0}, { \
      0                                 \
    }                                   \
  }

/**
 * Makes a carver that cuts a grid in place.
 *
 * @param grid must outlive the carver; its bits may be read, and written, between steps; those set within
 *             the tool where it stands stay until it is placed there again
 * @param tool in the model units of the grid; closed, as vxm_mesh_prepare makes it: open parts have the caps
 *             of their holes, and what has no inside cuts where its faces pass. Must outlive the carver
 * @return VXM_OK; VXM_ERROR_ARGUMENT; VXM_ERROR_EMPTY if no face has three different corners; VXM_ERROR_RANGE
 *         for corners that are not finite, edges longer than 2048 voxels, or a tool that reaches 2^22 voxels
 *         from its origin; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
VXM_API vxm_status vxm_carver_create(vxm_carver **out, vxm_grid *grid, const vxm_mesh *tool,
                                     vxm_error *error);
/**
 * Makes a carver of an octree, which stays as it is: what the tool comes to is held in cubes of 64 x 64 x 64
 * voxels, so that memory follows the path of the tool.
 *
 * @param sparse must outlive the carver
 * @return as vxm_carver_create
 */
VXM_API vxm_status vxm_carver_create_sparse(vxm_carver **out, const vxm_sparse *sparse, const vxm_mesh *tool,
                                            vxm_error *error);
/** Drops it; NULL is allowed. */
VXM_API void vxm_carver_destroy(vxm_carver *carver);

/**
 * Puts the tool somewhere, without a path to there: the first step, and after each that is to cut nothing on
 * its way. The voxels of its solid are removed, those that vxm_voxelize sets with VXM_THIN_DROP.
 *
 * @param report may be NULL
 * @return VXM_OK; VXM_ERROR_ARGUMENT for a pose that is not finite or no rotation; VXM_ERROR_RANGE 2^24
 *         voxels or more outside of the grid; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED:
 *         then voxels may have been removed, and the tool is where it was
 */
VXM_API vxm_status vxm_carver_place(vxm_carve_report *report, vxm_carver *carver, const double pose[12],
                                    vxm_error *error);
/**
 * Moves the tool from where it is to a pose, and removes what it meets. Where it is nowhere yet, this is
 * vxm_carver_place.
 *
 * @param report may be NULL
 * @return as vxm_carver_place
 */
VXM_API vxm_status vxm_carver_move(vxm_carve_report *report, vxm_carver *carver, const double pose[12],
                                   vxm_error *error);

/**
 * The octree as it is now: a new one, owned by the caller.
 *
 * @return VXM_OK; VXM_ERROR_ARGUMENT if the carver cuts a grid; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
VXM_API vxm_status vxm_carver_sparse(vxm_sparse **out, const vxm_carver *carver, vxm_error *error);

#ifdef __cplusplus
}
#endif
#endif

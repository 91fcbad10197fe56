/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The winding number of a closed chain of triangles at all voxels of a window: a whole number, counted
 * exactly.
 *
 * In each row a triangle that faces against it adds one to the voxels behind it, one that faces along it
 * takes one away. The crossings are those of parity (voxel/parity/columns.h), with the same perturbation. In
 * nearly all rows the number is 0 or 1 and follows from the parity of crossings; the few other rows are
 * marked, and there crossings are counted.
 */
#ifndef VXM_VOXEL_WINDING_CHAIN_WINDING_H
#define VXM_VOXEL_WINDING_CHAIN_WINDING_H

#include "voxel/parity/slabs.h"
#include "voxel/winding/chain.h"

/** A crossing beyond the first of its kind in its voxel. */
typedef struct vxm_more_crossings {
  uint64_t row; /**< of the window */
  int64_t voxel;
  int sign;
} vxm_more_crossings;

/** Start from {.context = ...}; keeps its memory from one window to the next. */
typedef struct vxm_chain_winding {
  vxm_context *context;
  vxm_window window;   /**< its words are bits: whether the number is at least 1; its own, or lent */
  uint64_t *words;     /**< its own */
  uint32_t *counted;   /**< of each row: 0; or, where it has other numbers than 0 and 1, the number of its
                          crossings */
  uint64_t *crossings; /**< of these rows, from 1 on: words of where triangles are entered, then of where they
                          are left */
  size_t word_capacity, row_capacity, crossing_count, crossing_capacity;
  vxm_more_crossings *more; /**< sorted by row and voxel */
  size_t more_count, more_capacity;
  uint64_t *slabs; /**< scratch of each worker, zero */
  size_t slab_capacity;
  uint32_t (*corners)[3]; /**< of the chain: those that are entered first, then those that are left */
  uint32_t *part;
  size_t corner_capacity, entered, corner_count;
  double estimate;           /**< of all triangles with rows of the grid, at most */
  vxm_crossing_bins bins[2]; /**< enter, leave */
} vxm_chain_winding;

/**
 * Sorts the triangles of a chain by the side that they show to the rows of a window. To be called whenever
 * points have been placed anew, or rows run along another axis.
 *
 * @param mirrored the points have been placed by a transform that turns triangles inside out
 */
vxm_status vxm_chain_winding_place(vxm_chain_winding *out, const vxm_winding_chain *chain,
                                   const vxm_snapped_points *placed, int axis, bool mirrored,
                                   vxm_error *error);

/**
 * Counts in a window. Its rows run along the axis of the call before.
 *
 * @param in_place  the bits replace the window's own words; else these are not touched
 * @param workspace lent
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED. The same for any number of
 * threads
 */
vxm_status vxm_chain_winding_fill(vxm_chain_winding *out, vxm_workspace *workspace,
                                  const vxm_snapped_points *placed, const vxm_window *window, bool in_place,
                                  vxm_error *error);
void vxm_chain_winding_destroy(vxm_chain_winding *counted);

/**
 * Puts the crossings of triangles with columns into the bins of what is entered and of what is left, and
 * counts nothing.
 *
 * @param columns along the axis of the call before, of all slabs; roles and triangles are the chain's
 * @return VXM_OK, also where the work has been cancelled; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_chain_winding_raster(vxm_chain_winding *out, vxm_workspace *workspace,
                                    const vxm_snapped_points *placed, const vxm_columns *columns,
                                    size_t slabs, vxm_task_progress *progress, vxm_error *error);
/** How many steps that takes. */
vxm_status vxm_chain_winding_steps(size_t *steps, vxm_chain_winding *out, vxm_workspace *workspace,
                                   const vxm_snapped_points *placed, const vxm_columns *columns,
                                   vxm_error *error);

/** The number at a voxel of a row that is marked in `counted`; `row` is a row of the window. */
int64_t vxm_chain_winding_at(const vxm_chain_winding *counted, size_t row, int64_t voxel);

#endif

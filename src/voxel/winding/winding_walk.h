/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The winding number of triangles at many voxels, from the whole grid down to bricks of 4 x 4 x 4.
 *
 * A cell of 4 * 2^l voxels along each axis has 4 x 4 x 4 samples, at Chebyshev's places (a brick: at its
 * voxels), for what is far from it, and a list of nodes of the tree that are near. What is far is added to
 * the samples, and a cell's samples are interpolated to those of its eight children, so that it is never
 * looked at again. If the range of a cell's samples and the most that the near nodes can add leave but one
 * whole number to which the winding number can be rounded, the cell is settled as a whole: only what lies
 * about the rims of holes comes down to bricks, where near triangles count by their exact solid angles.
 *
 * Arithmetic is in floats relative to the cell, the same in each lane whatever the number of lanes, so that
 * all builds give the same. Measured errors are at most 0.0037, of the strict walk 0.00015.
 */
#ifndef VXM_VOXEL_WINDING_WINDING_WALK_H
#define VXM_VOXEL_WINDING_WINDING_WALK_H

#include "voxel/parity/kernels.h"
#include "voxel/winding/winding_tree.h"

enum {
  VXM_BRICK = 64,          /**< voxels of a brick, samples of a cell: 16 z + 4 y + x */
  VXM_WINDING_LEVELS = 20, /**< a cell of level l is 4 * 2^l voxels wide */
  VXM_BRICK_SIDE = 4
};

/** What samples count at four places along an axis: one[sample][place]. */
typedef struct vxm_winding_weights {
  float one[4][4];
  float in_rows[4][16]; /**< [sample], for each of a layer's samples 4 y + x by x */
  float of_rows[4][16]; /**< and by y */
} vxm_winding_weights;

/** Where the samples of a cell lie, from its middle, along each axis alike, and what they tell its children.
 */
typedef struct vxm_winding_level {
  float x[16], y[16], z[4];        /**< of samples 4 y + x with one z, and of all with another z */
  vxm_winding_weights to_child[2]; /**< at the samples of children, by half */
  vxm_winding_weights bound; /**< for coefficients of Bernstein's polynomials: these bound what is between */
  float reach;               /**< of the voxel centres of a cell, from its middle, along an axis */
} vxm_winding_level;

typedef struct vxm_winding_walk vxm_winding_walk;

/** Bit v of a mask is that of voxel 16 z + 4 y + x. */
typedef struct vxm_winding_brick {
  float value[VXM_BRICK];
  uint64_t above[2]; /**< -1/2, 1/2 */
  uint64_t doubtful; /**< they are nearer to a half-integer than walk->doubt, or may lie on a triangle */
} vxm_winding_brick;

/** What one thread works with. */
typedef struct vxm_winding_scratch {
  vxm_context *context;
  uint32_t *nodes; /**< the lists of near nodes of a cell and of those around it, one behind the other */
  size_t count, capacity;
  vxm_status status; /**< what `nodes` could not grow for; then results mean nothing */
  vxm_error error;
} vxm_winding_scratch;

struct vxm_winding_walk {
  const vxm_winding_tree *tree;
  const vxm_winding_level *levels;
  float doubt;
  bool strict; /**< nodes are opened sooner, and all cells come down to bricks */
  bool whole;  /**< all cells come down to bricks, as their numbers themselves are wanted */
  /** Whether anything is asked about in a cell. */
  bool (*wants)(const vxm_winding_walk *walk, const int64_t origin[3], int level);
  /** The winding number rounds to `number` in all of a cell of the level. */
  void (*settle_cell)(const vxm_winding_walk *walk, const int64_t origin[3], int level, int number);
  /** The winding numbers of a brick. */
  void (*settle_brick)(const vxm_winding_walk *walk, const int64_t origin[3], const vxm_winding_brick *brick);
  /** Takes over a cell of task_level, as arguments for vxm_winding_kernels.descend; NULL = nobody does. */
  void (*hand_on)(const vxm_winding_walk *walk, vxm_winding_scratch *scratch, const int64_t origin[3],
                  const float samples[VXM_BRICK], size_t list, size_t count);
  int task_level;
};

/** Triangles that are seen from one point. Half a solid angle is the argument of (sides, volume). */
enum { VXM_WINDING_SEEN = 64, VXM_WINDING_SUMS = 8 };
typedef struct vxm_winding_seen {
  size_t count;
  double corner[3][3][VXM_WINDING_SEEN]; /**< behind the last one there are numbers up to a multiple of 8 */
  double sides[VXM_WINDING_SEEN], volume[VXM_WINDING_SEEN];
  uint64_t flat; /**< those in whose plane the point may lie; they are in no sum */
  /** Of the others, triangle t in sum t % VXM_WINDING_SUMS: half solid angles as products of complex numbers,
   * by their arguments. A sum went round (turns + 1 where it is negative now) / 2 times. */
  double real[VXM_WINDING_SUMS], imaginary[VXM_WINDING_SUMS];
  int64_t turns[VXM_WINDING_SUMS];
} vxm_winding_seen;

typedef struct vxm_winding_kernels {
  /**
   * Settles a cell, or all that it consists of.
   *
   * @param samples what is known of it
   * @param list    where in scratch->nodes the nodes begin that samples do not hold, and how many they are
   */
  void (*descend)(const vxm_winding_walk *walk, vxm_winding_scratch *scratch, const int64_t origin[3],
                  int level, const float samples[VXM_BRICK], size_t list, size_t count);
  /** Finds what is to be known of the triangles whose corners are there, and sums it up. */
  void (*see)(vxm_winding_seen *seen, const double from[3]);
} vxm_winding_kernels;

/** The build that goes with vxm_kernels_get. */
const vxm_winding_kernels *vxm_winding_kernels_get(void);

/** The tables of all levels. */
const vxm_winding_level *vxm_winding_levels(void);

/** Adds a node to a list; false after a failure. */
bool vxm_winding_scratch_grow(vxm_winding_scratch *scratch);
static inline void vxm_winding_scratch_add(vxm_winding_scratch *scratch, uint32_t node) {
  if (scratch->count < scratch->capacity || vxm_winding_scratch_grow(scratch))
    scratch->nodes[scratch->count++] = node;
}

#endif

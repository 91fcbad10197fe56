/* SPDX-License-Identifier: BSD-3-Clause */
/** A free position near that of a vertex, for one that is to be moved from others. */
#ifndef VXM_REPAIR_MANIFOLD_FREE_POSITIONS_H
#define VXM_REPAIR_MANIFOLD_FREE_POSITIONS_H

#include "repair/state/position_set.h"

/** Of the direction's length: along an axis that has less of it nothing has to change. */
#define VXM_MOVE_AXIS 0.2

/** What a vertex is to be moved by. */
typedef struct vxm_position_move {
  double from[3], toward[3]; /**< toward: of length 1 */
  double unit[3];            /**< along each axis: what the numbers that hold the position tell apart */
  double step;               /**< how far to go, where they allow it */
  double fine, coarse;       /**< the most along each axis, in that direction and elsewhere */
  bool straight;             /**< the direction is to be kept */
  bool floats;               /**< 32-bit floats are to tell it from others, too */
} vxm_position_move;

/** Positions about one that are known to be taken for good. */
typedef struct vxm_full_positions {
  double from[3], step[3]; /**< steps with their signs; all 0: nothing is known */
  uint64_t taken;          /**< bit: the position of that number */
  bool floats;
} vxm_full_positions;

enum { VXM_FULL_POSITIONS = 1024 };

/** Vertices are moved in their order, each once. */
typedef struct vxm_free_positions {
  const vxm_position_set *taken;  /**< what is taken */
  const vxm_position_set *floats; /**< what is taken once positions are 32-bit floats */
  const uint32_t *number;         /**< per vertex: VXM_NO_VERTEX if it is not to be moved at all */
  bool single_precision;          /**< positions are rounded to 32-bit floats */
  vxm_full_positions *full;       /**< VXM_FULL_POSITIONS of them, zeroed */
  uint64_t looked_up;             /**< positions, so far */
} vxm_free_positions;

/** Whether there is a position for a vertex whose turn it is, and which. */
bool vxm_free_positions_find(vxm_free_positions *near, uint32_t vertex, const vxm_position_move *by,
                             double p[3]);

#endif

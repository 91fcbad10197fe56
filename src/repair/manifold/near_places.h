/* SPDX-License-Identifier: BSD-3-Clause */
/** A free place near that of a vertex, for one that is to be moved from others. */
#ifndef VXM_REPAIR_MANIFOLD_NEAR_PLACES_H
#define VXM_REPAIR_MANIFOLD_NEAR_PLACES_H

#include "repair/state/position_hash.h"

/** Of the direction's length: along an axis that has less of it nothing has to change. */
#define VXM_NEAR_AXIS 0.2

/** What a vertex is to be moved by. */
typedef struct vxm_near_moves {
  double from[3], toward[3]; /**< toward: of length 1 */
  double unit[3];            /**< along each axis: what the numbers that hold the position tell apart */
  double step;               /**< how far to go, where they allow it */
  double fine, coarse;       /**< the most along each axis, in that direction and elsewhere */
  bool straight;             /**< the direction is to be kept */
  bool floats;               /**< 32-bit floats are to tell it from others, too */
} vxm_near_moves;

/** Places about one that are known to be taken for good. */
typedef struct vxm_full_places {
  double from[3], step[3]; /**< steps with their signs; all 0: nothing is known */
  uint64_t taken;          /**< bit: the place of that number */
  bool floats;
} vxm_full_places;

enum { VXM_FULL_PLACES = 1024 };

/** Vertices are moved in their order, each once. */
typedef struct vxm_near_places {
  const vxm_position_hash *places; /**< what is taken */
  const vxm_position_hash *floats; /**< what is taken once positions are 32-bit floats */
  const uint32_t *number;          /**< per vertex: VXM_NO_VERTEX if it is not to be moved at all */
  bool single_precision;           /**< positions are rounded to 32-bit floats */
  vxm_full_places *full;           /**< VXM_FULL_PLACES of them, zeroed */
  uint64_t looked_up;              /**< places, so far */
} vxm_near_places;

/** Whether there is a place for a vertex whose turn it is, and which. */
bool vxm_near_places_find(vxm_near_places *near, uint32_t vertex, const vxm_near_moves *by, double p[3]);

#endif

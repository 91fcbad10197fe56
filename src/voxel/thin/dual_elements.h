/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * What lies between voxel centres: the link between two of them, the square between four and the cube between
 * eight, as the surface meets them.
 *
 * Where a face crosses a link, an edge crosses a square, or a vertex lies in a cube, and no voxel at its ends
 * is set, one of them is to be: the one about which the surface there has its middle. Each meeting is a
 * record; the records of a link, square or cube are added up in any order.
 */
#ifndef VXM_VOXEL_THIN_DUAL_ELEMENTS_H
#define VXM_VOXEL_THIN_DUAL_ELEMENTS_H

#include "grid/octree.h"

/** Directions of links: along x, y, z, then over the edges and over the corners of voxels. */
enum { VXM_LINK_AXES = 3, VXM_LINK_EDGES = 9, VXM_LINK_DIRECTIONS = 13 };

/** The step from the lower to the upper end of a link; the last axis that it changes, it changes by 1. */
extern const int8_t vxm_link_step[VXM_LINK_DIRECTIONS][3];

/** A link by its direction, a square by the axis across it, or a cube. */
enum { VXM_DUAL_SQUARE = VXM_LINK_DIRECTIONS, VXM_DUAL_CUBE = VXM_DUAL_SQUARE + 3 };

/** The order in which voxels are chosen: what an earlier stage sets a later one need not. Links along the
 * axis along which a face's normal is longest come first, as they give a plate one voxel per column. */
typedef enum vxm_thin_stage {
  VXM_THIN_DOMINANT_LINKS,
  VXM_THIN_LINKS,        /**< along the other axes */
  VXM_THIN_EDGE_LINKS,   /**< over edges of voxels */
  VXM_THIN_CORNER_LINKS, /**< over corners of voxels */
  VXM_THIN_SQUARES,
  VXM_THIN_CUBES
} vxm_thin_stage;

/** Parts of a voxel in an offset, beyond which it is rounded. */
enum { VXM_OFFSET_UNIT = 1 << 20 };

/** The surface in a link, square or cube: a face that crosses the link or lies in the cube, a section in the
 * square. */
typedef struct vxm_meeting {
  uint64_t element;  /**< vxm_dual_number */
  int32_t offset[3]; /**< from the middle, along the axes that it spans, lowest first; parts of a voxel,
                        summed over the ends of a section or the corners of a face */
  uint32_t met; /**< in a square or a cube the voxels at the ends whose boxes the surface meets there, a bit
                   for each */
} vxm_meeting;

/** Bits of a coordinate in the number of a bit of an octree. */
enum { VXM_VIEW_AXIS_BITS = 21 };

/** The bits of a window, or an octree, as voxels of the space. Outside of it nothing is set. */
typedef struct vxm_view {
  uint64_t *words; /**< NULL: those of the octree */
  const vxm_sparse *octree;
  const struct vxm_voxel_set *added; /**< beside the octree's; NULL = none */
  int64_t begin[3], end[3];          /**< of the window along x, y, z */
  int axis[3];                       /**< by `step`, from near to far */
  int64_t step[3];                   /**< bits from a voxel to the next one */
  int64_t origin;                    /**< bits from voxel (0, 0, 0) to the first one, negated */
} vxm_view;

static inline vxm_view vxm_view_of(const vxm_window *window) {
  vxm_view view = {.words = window->words};
  const int axis[3] = {window->layout.fast, window->layout.middle, window->layout.slow};
  const int64_t step[3] = {1, (int64_t)window->row_words * 64, (int64_t)window->slice_words * 64};
  const int64_t end[3] = {window->fast_dim, window->middle_dim, window->end};
  for (int i = 0; i < 3; i++) {
    view.axis[i] = axis[i];
    view.step[axis[i]] = step[i];
    view.end[axis[i]] = end[i];
  }
  view.begin[axis[2]] = window->begin;
  view.origin = -window->begin * step[2];
  return view;
}

/** A view of an octree: a bit's number is its voxel's coordinates side by side. */
static inline vxm_view vxm_view_of_octree(const vxm_sparse *octree) {
  vxm_view view = {.octree = octree};
  for (int a = 0; a < 3; a++) {
    view.axis[a] = a;
    view.end[a] = octree->space.dims[a];
    view.step[a] = INT64_C(1) << (VXM_VIEW_AXIS_BITS * a);
  }
  return view;
}

static inline bool vxm_view_holds(const vxm_view *view, const int64_t voxel[3]) {
  return voxel[0] >= view->begin[0] && voxel[0] < view->end[0] && voxel[1] >= view->begin[1] &&
         voxel[1] < view->end[1] && voxel[2] >= view->begin[2] && voxel[2] < view->end[2];
}

/** The bit of a voxel of the view. */
static inline int64_t vxm_view_bit(const vxm_view *view, const int64_t voxel[3]) {
  return view->origin + voxel[0] * view->step[0] + voxel[1] * view->step[1] + voxel[2] * view->step[2];
}

/** See vxm_view_bit_set, of an octree. */
bool vxm_view_octree_bit_set(const vxm_view *view, int64_t bit);

/** Bricks and nodes of an octree that a thread has looked at, each where its number says. What a triangle
 * asks for lies side by side, and going down an octree takes a while. */
enum { VXM_KEPT_BITS = 3, VXM_KEPT_BRICKS = 1 << 3 * VXM_KEPT_BITS };

typedef struct vxm_kept_bricks {
  uint64_t serial; /**< of the octree */
  uint64_t number[VXM_KEPT_BRICKS], bits[VXM_KEPT_BRICKS];
  uint64_t node_number[VXM_KEPT_BRICKS];
  const vxm_octree_node *nodes[VXM_KEPT_BRICKS]; /**< of level 0 */
  uint64_t high_number[VXM_KEPT_BRICKS];
  const vxm_octree_node *highs[VXM_KEPT_BRICKS]; /**< of level 1 */
} vxm_kept_bricks;

/** Those of this thread. */
vxm_kept_bricks *vxm_view_kept_bricks(const vxm_view *view);
/** The number of the brick of a voxel of an octree, by the voxel's bit; 0 is none. */
static inline uint64_t vxm_brick_number(int64_t bit) {
  const uint64_t low =
      UINT64_C(3) | UINT64_C(3) << VXM_VIEW_AXIS_BITS | UINT64_C(3) << 2 * VXM_VIEW_AXIS_BITS;
  return ((uint64_t)bit & ~low) | 1;
}

/** The same of the node of level 0. */
static inline uint64_t vxm_node_number(int64_t bit) {
  const uint64_t low =
      UINT64_C(15) | UINT64_C(15) << VXM_VIEW_AXIS_BITS | UINT64_C(15) << 2 * VXM_VIEW_AXIS_BITS;
  return ((uint64_t)bit & ~low) | 1;
}

/** Where in its brick a voxel has its bit. */
static inline unsigned vxm_place_in_brick(int64_t bit) {
  return (unsigned)((bit & 3) | (bit >> (VXM_VIEW_AXIS_BITS - 2) & 12) |
                    (bit >> (2 * VXM_VIEW_AXIS_BITS - 4) & 48));
}

/** The node of level 0 with a voxel. */
const vxm_octree_node *vxm_kept_node_fetch(vxm_kept_bricks *kept, const vxm_sparse *octree, int64_t bit,
                                           size_t at);

static inline const vxm_octree_node *vxm_kept_node(vxm_kept_bricks *kept, const vxm_sparse *octree,
                                                   int64_t bit) {
  enum { LOW = (1 << VXM_KEPT_BITS) - 1 };
  uint64_t x = (uint64_t)bit >> 4, y = x >> VXM_VIEW_AXIS_BITS, z = y >> VXM_VIEW_AXIS_BITS;
  size_t at = (z & LOW) << 2 * VXM_KEPT_BITS | (y & LOW) << VXM_KEPT_BITS | (x & LOW);
  return kept->node_number[at] == vxm_node_number(bit) ? kept->nodes[at]
                                                       : vxm_kept_node_fetch(kept, octree, bit, at);
}

/** The brick of a voxel within the octree's dimensions. */
uint64_t vxm_kept_brick_fetch(vxm_kept_bricks *kept, const vxm_sparse *octree, int64_t bit, size_t at);

static inline uint64_t vxm_kept_brick(vxm_kept_bricks *kept, const vxm_sparse *octree, int64_t bit) {
  enum { LOW = (1 << VXM_KEPT_BITS) - 1 };
  uint64_t x = (uint64_t)bit >> 2, y = x >> VXM_VIEW_AXIS_BITS, z = y >> VXM_VIEW_AXIS_BITS;
  size_t at = (z & LOW) << 2 * VXM_KEPT_BITS | (y & LOW) << VXM_KEPT_BITS | (x & LOW);
  return kept->number[at] == vxm_brick_number(bit) ? kept->bits[at]
                                                   : vxm_kept_brick_fetch(kept, octree, bit, at);
}

static inline bool vxm_view_bit_set(const vxm_view *view, int64_t bit) {
  if (!view->words)
    return vxm_view_octree_bit_set(view, bit);
  return view->words[(uint64_t)bit / 64] >> ((uint64_t)bit % 64) & 1;
}

static inline bool vxm_view_set(const vxm_view *view, const int64_t voxel[3]) {
  return vxm_view_holds(view, voxel) && vxm_view_bit_set(view, vxm_view_bit(view, voxel));
}

/** The number of a cell: in which stage it comes and of which kind it is, above these bits, and its lowest
 * voxel, in the order of bits. Cells of an earlier stage have lower numbers. */
enum { VXM_DUAL_VOXEL_BITS = 59 };

static inline uint64_t vxm_dual_number(const vxm_view *view, vxm_thin_stage stage, int kind,
                                       const int64_t lowest[3]) {
  uint64_t voxel = 0; /* it may lie one before the view */
  for (int i = 2; i >= 0; i--) {
    int a = view->axis[i];
    voxel =
        voxel * (uint64_t)(view->end[a] - view->begin[a] + 2) + (uint64_t)(lowest[a] - view->begin[a] + 1);
  }
  return (uint64_t)(stage == VXM_THIN_DOMINANT_LINKS ? kind : kind + VXM_LINK_AXES) << VXM_DUAL_VOXEL_BITS |
         voxel;
}

static inline int vxm_dual_kind(uint64_t number) {
  int rank = (int)(number >> VXM_DUAL_VOXEL_BITS);
  return rank < VXM_LINK_AXES ? rank : rank - VXM_LINK_AXES;
}

static inline vxm_thin_stage vxm_dual_stage(uint64_t number) {
  int kind = vxm_dual_kind(number);
  if (kind < VXM_LINK_AXES)
    return number >> VXM_DUAL_VOXEL_BITS < VXM_LINK_AXES ? VXM_THIN_DOMINANT_LINKS : VXM_THIN_LINKS;
  return kind < VXM_LINK_EDGES        ? VXM_THIN_EDGE_LINKS
         : kind < VXM_LINK_DIRECTIONS ? VXM_THIN_CORNER_LINKS
         : kind < VXM_DUAL_CUBE       ? VXM_THIN_SQUARES
                                      : VXM_THIN_CUBES;
}

/** The voxels at the ends of a kind: 2 of a link, 4 of a square, 8 of a cube. */
int vxm_dual_ends(int64_t ends[8][3], int kind, const int64_t lowest[3]);

/** The ends of a square or a cube, by the axes it spans, in whose boxes a point lies that is `offset` from
 * the middle. */
unsigned vxm_dual_boxes(const int32_t offset[3], int span);

/** Whether one of some voxels is set; `*held`: whether the view holds one of them. */
bool vxm_view_any_set(const vxm_view *view, const int64_t (*voxels)[3], int count, bool *held);

/**
 * Adds up meetings and chooses the voxel: among those whose box the surface meets there and
 * which the view holds, the one nearest to the mean.
 *
 * @param count meetings of one link, square or cube
 * @return false if there is no such voxel, or one at the ends is set by now
 */
bool vxm_dual_choose(const vxm_view *view, const vxm_meeting *meetings, size_t count, int64_t voxel[3]);

#endif

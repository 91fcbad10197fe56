/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/dual_elements.h"
#include "voxel/thin/voxel_set.h"

#include <string.h>

const int8_t vxm_link_step[VXM_LINK_DIRECTIONS][3] = {
    {1, 0, 0}, {0, 1, 0},  {0, 0, 1},                                     /* over faces */
    {1, 1, 0}, {-1, 1, 0}, {1, 0, 1},  {-1, 0, 1}, {0, 1, 1}, {0, -1, 1}, /* over edges */
    {1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {-1, -1, 1}                        /* over corners */
};

vxm_kept_bricks *vxm_view_kept_bricks(const vxm_view *view) {
  static _Thread_local vxm_kept_bricks kept;
  if (kept.serial != view->octree->serial) {
    memset(&kept, 0, sizeof kept);
    kept.serial = view->octree->serial;
  }
  return &kept;
}

/** The node of level 1 with a voxel of an octree that has so many levels. */
static const vxm_octree_node *kept_high(vxm_kept_bricks *kept, const vxm_sparse *octree,
                                        const int64_t of[3]) {
  const int64_t low = (1 << VXM_KEPT_BITS) - 1, x = of[0] >> 6, y = of[1] >> 6, z = of[2] >> 6;
  size_t at = (size_t)((z & low) << 2 * VXM_KEPT_BITS | (y & low) << VXM_KEPT_BITS | (x & low));
  uint64_t number = (uint64_t)((z << VXM_VIEW_AXIS_BITS | y) << VXM_VIEW_AXIS_BITS | x) + 1;
  if (kept->high_number[at] != number) {
    kept->high_number[at] = number;
    kept->highs[at] = vxm_octree_node_at(octree, 1, of[0], of[1], of[2]);
  }
  return kept->highs[at];
}

const vxm_octree_node *vxm_kept_node_fetch(vxm_kept_bricks *kept, const vxm_sparse *octree, int64_t bit,
                                           size_t at) {
  const int64_t mask = (INT64_C(1) << VXM_VIEW_AXIS_BITS) - 1;
  const int64_t of[3] = {bit & mask, bit >> VXM_VIEW_AXIS_BITS & mask, bit >> 2 * VXM_VIEW_AXIS_BITS & mask};
  kept->node_number[at] = vxm_node_number(bit);
  kept->nodes[at] = octree->levels == 1
                        ? octree->nodes[0]
                        : vxm_octree_below(octree, 1, kept_high(kept, octree, of), of[0], of[1], of[2]);
  return kept->nodes[at];
}

uint64_t vxm_kept_brick_fetch(vxm_kept_bricks *kept, const vxm_sparse *octree, int64_t bit, size_t at) {
  const vxm_octree_node *node = vxm_kept_node(kept, octree, bit);
  unsigned child = vxm_octree_child((unsigned)(bit >> 2), (unsigned)(bit >> (VXM_VIEW_AXIS_BITS + 2)),
                                    (unsigned)(bit >> (2 * VXM_VIEW_AXIS_BITS + 2)));
  kept->number[at] = vxm_brick_number(bit);
  if (node->mixed >> child & 1)
    kept->bits[at] = octree->bricks[vxm_octree_index(node, child)];
  else
    kept->bits[at] = node->full >> child & 1 ? ~UINT64_C(0) : 0;
  return kept->bits[at];
}

bool vxm_view_octree_bit_set(const vxm_view *view, int64_t bit) {
  const int64_t mask = (INT64_C(1) << VXM_VIEW_AXIS_BITS) - 1, *dims = view->octree->space.dims;
  int64_t i = bit & mask, j = bit >> VXM_VIEW_AXIS_BITS & mask, k = bit >> 2 * VXM_VIEW_AXIS_BITS;
  if (i < dims[0] && j < dims[1] && k >= 0 && k < dims[2] &&
      (vxm_kept_brick(vxm_view_kept_bricks(view), view->octree, bit) >> vxm_place_in_brick(bit) & 1))
    return true;
  return view->added && vxm_voxel_set_has(view->added, (uint64_t)bit);
}

/** The lowest voxel of a cell. */
static void lowest_of(const vxm_view *view, uint64_t number, int64_t lowest[3]) {
  number &= (UINT64_C(1) << VXM_DUAL_VOXEL_BITS) - 1;
  for (int i = 0; i < 2; i++) {
    int a = view->axis[i];
    uint64_t size = (uint64_t)(view->end[a] - view->begin[a] + 2);
    lowest[a] = (int64_t)(number % size) + view->begin[a] - 1;
    number /= size;
  }
  lowest[view->axis[2]] = (int64_t)number + view->begin[view->axis[2]] - 1;
}

/** The axes that a kind spans, lowest first; a link is an axis of its own. */
static int span_of(int kind, int axes[3]) {
  int count = 0;
  if (kind < VXM_LINK_DIRECTIONS)
    return 1;
  for (int a = 0; a < 3; a++)
    if (kind == VXM_DUAL_CUBE || a != kind - VXM_DUAL_SQUARE)
      axes[count++] = a;
  return count;
}

int vxm_dual_ends(int64_t ends[8][3], int kind, const int64_t lowest[3]) {
  if (kind < VXM_LINK_DIRECTIONS) {
    for (int a = 0; a < 3; a++) {
      ends[0][a] = lowest[a];
      ends[1][a] = lowest[a] + vxm_link_step[kind][a];
    }
    return 2;
  }
  int axes[3], span = span_of(kind, axes);
  memcpy(ends[0], lowest, sizeof ends[0]);
  for (int s = 0; s < span; s++) /* those before, one further along the axis */
    for (int e = 0; e < 1 << s; e++) {
      memcpy(ends[e + (1 << s)], ends[e], sizeof ends[0]);
      ends[e + (1 << s)][axes[s]]++;
    }
  return 1 << span;
}

bool vxm_view_any_set(const vxm_view *view, const int64_t (*voxels)[3], int count, bool *held) {
  bool any = false;
  *held = false;
  for (int v = 0; v < count; v++) {
    bool holds = vxm_view_holds(view, voxels[v]);
    *held |= holds;
    any |= holds && vxm_view_bit_set(view, vxm_view_bit(view, voxels[v]));
  }
  return any;
}

/** The ends in whose boxes a point lies that is `offset` from the middle. */
unsigned vxm_dual_boxes(const int32_t offset[3], int span) {
  static const unsigned upper[3] = {0xaa, 0xcc, 0xf0};
  unsigned boxes = (1U << (1 << span)) - 1;
  for (int s = 0; s < span; s++)
    boxes &= offset[s] < 0 ? ~upper[s] : offset[s] > 0 ? upper[s] : ~0U;
  return boxes;
}

/** Adds up meetings; returns the ends whose boxes the surface meets. */
static unsigned add_up(const vxm_meeting *meetings, size_t count, int kind, int64_t sum[3]) {
  unsigned met = 0;
  for (size_t m = 0; m < count; m++) {
    for (int s = 0; s < 3; s++)
      sum[s] += meetings[m].offset[s];
    met |= kind < VXM_LINK_DIRECTIONS ? vxm_dual_boxes(meetings[m].offset, 1) : meetings[m].met;
  }
  return met;
}

/** Where the ends of a cell are, from the lowest one: a bit for each that is set, and for each that the view
 * holds. */
static unsigned ends_set(const vxm_view *view, const int64_t (*ends)[3], int count, unsigned *held) {
  unsigned set = 0;
  *held = 0;
  for (int e = 0; e < count; e++)
    if (vxm_view_holds(view, ends[e])) {
      *held |= 1U << e;
      set |= (unsigned)vxm_view_bit_set(view, vxm_view_bit(view, ends[e])) << e;
    }
  return set;
}

/** The same where a link along an axis is crossed once, as most are that have no voxel. */
static bool choose_at_crossing(const vxm_view *view, int32_t offset, int axis, const int64_t lower[3],
                               int64_t voxel[3]) {
  int64_t upper[3] = {lower[0], lower[1], lower[2]}, step = view->step[axis];
  upper[axis]++;
  const bool has_lower = vxm_view_holds(view, lower), has_upper = vxm_view_holds(view, upper);
  const int64_t bit = vxm_view_bit(view, lower);
  if ((has_lower && vxm_view_bit_set(view, bit)) || (has_upper && vxm_view_bit_set(view, bit + step)))
    return false;
  const bool is_upper = offset > 0 || (offset == 0 && !has_lower);
  memcpy(voxel, is_upper ? upper : lower, sizeof upper);
  return is_upper ? has_upper : has_lower;
}

bool vxm_dual_choose(const vxm_view *view, const vxm_meeting *meetings, size_t count, int64_t voxel[3]) {
  int kind = vxm_dual_kind(meetings[0].element), axes[3], span = span_of(kind, axes), best = -1;
  int64_t sum[3] = {0, 0, 0}, lowest[3], ends[8][3], nearest = 0;
  unsigned held;
  lowest_of(view, meetings[0].element, lowest);
  if (count == 1 && kind < VXM_LINK_AXES)
    return choose_at_crossing(view, meetings->offset[0], kind, lowest, voxel);
  int ends_count = vxm_dual_ends(ends, kind, lowest);
  if (ends_set(view, (const int64_t(*)[3])ends, ends_count, &held))
    return false;
  held &= add_up(meetings, count, kind, sum);
  for (int e = 0; e < ends_count; e++) {
    if (!(held >> e & 1))
      continue;
    int64_t nearness = 0;
    for (int s = 0; s < span; s++)
      nearness += e >> s & 1 ? sum[s] : -sum[s];
    if (best < 0 || nearness > nearest) {
      best = e;
      nearest = nearness;
    }
  }
  for (int a = 0; a < 3 && best >= 0; a++)
    voxel[a] = ends[best][a];
  return best >= 0;
}

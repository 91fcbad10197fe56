/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Thin parts: voxels that are added to a solid so that what is thinner than a voxel holds together.
 *
 * A voxel of a solid is set where its centre is inside, so what lies between centres is lost. With the voxels
 * that are added here, every link between neighbouring centres that a face crosses has a set voxel at an end,
 * and so has every square between four centres that an edge crosses, and every cube between eight in which a
 * vertex lies. Where two neighbouring cubes meet the surface on their common square, that square has a set
 * voxel, and voxels of one cube all touch each other: so what is connected in the mesh is 26-connected in the
 * grid; and no path over the faces of voxels leads across a face outside of them, as it would follow links.
 *
 * A body that is thick everywhere gains next to nothing: voxels where a top pokes past a layer of centres.
 */
#ifndef VXM_VOXEL_THIN_THIN_H
#define VXM_VOXEL_THIN_THIN_H

#include "voxel/thin/meeting_slabs.h"
#include "voxel/thin/slice_order.h"
#include "voxel/thin/voxel_set.h"

/** Slices on either side of those that are wanted which decide about these: one for each stage. */
static inline int64_t vxm_thin_margin(int separating) {
  return separating == 26 ? VXM_THIN_CUBES + 1 : VXM_THIN_CUBES - 1;
}

/** Memory that is kept from one grid to the next, and what was found of the present one. Start from {.context
 * = ...}. */
typedef struct vxm_thin_adder {
  vxm_context *context;
  vxm_meetings *found; /**< of each thread */
  int threads;
  vxm_meeting_slabs slabs;
  uint64_t *maps; /**< see vxm_thin_job */
  size_t map_words;
  uint32_t *short_cells;
  size_t short_capacity;
  vxm_slice_order order;
  int64_t added;
  int64_t area;  /**< of the surface that had no voxel beside it, as vxm_meetings has it */
  bool is_slack; /**< several times as many slices might have been looked at together */
} vxm_thin_adder;

/** Forgets what was found of another grid. */
static inline void vxm_thin_begin(vxm_thin_adder *thin) {
  thin->added = 0;
  thin->area = 0;
}

/**
 * Adds to the solid in a window the voxels that hold thin parts together. Only those of slices begin to end -
 * 1 are right, if the window has vxm_thin_margin slices of the solid before and behind them where the space
 * has such; only they are counted.
 *
 * @param separating 6 or 26: over which neighbours no path leads across a face
 * @param confidence NULL, or a byte per voxel of the space, x fastest, which becomes 255 where one is added
 * @param[in,out] too_many NULL, or becomes true, and nothing is added, where there is more to be looked at
 * than vxm_thin_budget allows: take fewer slices
 * @return VXM_OK; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_thin_add(vxm_thin_adder *thin, const vxm_window *window, int64_t begin, int64_t end,
                        const vxm_triangle_set *triangles, const vxm_snapped_points *placed, int separating,
                        uint8_t *confidence, bool *too_many, vxm_error *error);

/** The same of an octree, which stays as it is: puts the numbers of the bits that are to be added into a set
 * (vxm_view_of_octree), those of slices begin to end - 1 along z and some around, which are to be left out.
 */
vxm_status vxm_thin_find(vxm_thin_adder *thin, vxm_voxel_set *added, const vxm_sparse *solid, int64_t begin,
                         int64_t end, const vxm_triangle_set *triangles, const vxm_snapped_points *placed,
                         int separating, bool *too_many, vxm_error *error);

/** How often a meeting is held at most: in a list that grows by a half while it is copied, then once more,
 * with a quarter to spare, where it is sorted, and in scratch for that. */
enum { VXM_THIN_COPIES = 2 + 3 };

/** Bytes that are held at most while voxels are added to some slices, unless to one alone. */
uint64_t vxm_thin_budget(const vxm_context *context);

void vxm_thin_destroy(vxm_thin_adder *thin);

#endif

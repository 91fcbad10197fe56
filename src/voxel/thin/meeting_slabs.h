/* SPDX-License-Identifier: BSD-3-Clause */
/** The meetings that threads have found, those of a cell side by side, taken apart for the threads. */
#ifndef VXM_VOXEL_THIN_MEETING_SLABS_H
#define VXM_VOXEL_THIN_MEETING_SLABS_H

#include "voxel/thin/meetings.h"

enum { VXM_MEETING_SLABS = 64 };

/** All meetings of a range of cells, as vxm_meetings_sort has them. */
typedef struct vxm_meeting_slab {
  vxm_meeting *meetings;
  size_t count;
  size_t begin, end; /**< those of the stage at hand */
  size_t chosen;     /**< voxels of that stage, packed into `cell` of the meetings from `begin` on */
  int64_t added;     /**< voxels that have been set, of slices that are counted */
} vxm_meeting_slab;

/** Start from {.context = ...}. The memory is kept from one grid to the next. */
typedef struct vxm_meeting_slabs {
  vxm_context *context;
  vxm_meeting *room; /**< for all of them; twice where they are few */
  size_t capacity;
  vxm_meeting *scratch; /**< for a slab of each thread that sorts */
  size_t scratch_capacity;
  size_t (*starts)[VXM_MEETING_SLABS]; /**< of each thread: where its meetings of each slab go */
  size_t starts_capacity;
  vxm_meeting_slab slabs[VXM_MEETING_SLABS];
  size_t count; /**< of slabs: 0 if there are no meetings */
} vxm_meeting_slabs;

/**
 * Sorts the meetings of some threads into slabs, one where they are few. What is in their lists is
 * overwritten; the lists must stay as long as the slabs are used.
 *
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_meeting_slabs_sort(vxm_meeting_slabs *slabs, const vxm_meetings *found, int threads,
                                  vxm_error *error);

void vxm_meeting_slabs_destroy(vxm_meeting_slabs *slabs);

#endif

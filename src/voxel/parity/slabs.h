/* SPDX-License-Identifier: BSD-3-Clause */
/** How a window is cut into slabs whose bits stay in cache, and the memory of the threads that fold them. */
#ifndef VXM_VOXEL_PARITY_SLABS_H
#define VXM_VOXEL_PARITY_SLABS_H

#include "voxel/parity/columns.h"
#include "voxel/parity/crossing_bins.h"
#include "voxel/parity/raster_schedule.h"

/** Words of a slab, unless one layer has more: 512 KiB, a part of a usual second-level cache. */
enum { VXM_SLAB_WORDS = 1 << 16 };

/** Memory that is kept from one use to the next. Start from {.context = ...}. */
typedef struct vxm_workspace {
  vxm_context *context;
  vxm_crossing_bins bins;
  vxm_raster_schedule crossings;
  uint64_t *scratch;
  size_t scratch_words;
} vxm_workspace;

vxm_workspace vxm_workspace_of(vxm_context *context);
void vxm_workspace_destroy(vxm_workspace *workspace);
/** Room for so many words, zero where the last use left them zero, as every use must. */
vxm_status vxm_workspace_scratch(vxm_workspace *workspace, size_t words, vxm_error *error);

/** Slabs of 2^shift layers each. */
typedef struct vxm_slabs {
  int64_t layers; /**< of the window along the axis that is cut */
  int shift;
  size_t count;
  size_t words; /**< of one slab */
} vxm_slabs;

/** Cuts `layers` of layer_words each: as thick as fits the cache, but several slabs for each of the threads.
 */
vxm_slabs vxm_slabs_of(int64_t layers, size_t layer_words, int threads);

/** Whether a window is so large that its words are better stored past the caches, which would first read
 * them. */
static inline bool vxm_window_is_large(const vxm_window *window) {
  const size_t large = 1 << 22; /* 32 MiB */
  return (size_t)(window->end - window->begin) * window->slice_words >= large;
}

/** The columns of a window along an axis of the voxel space, with the layers of its slabs cut along v. */
vxm_columns vxm_columns_of(const vxm_window *window, int axis);

#endif

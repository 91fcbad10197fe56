/* SPDX-License-Identifier: BSD-3-Clause */
/** Slices of a window that an engine makes at once, and what its shaders are told of them. */
#ifndef VXM_GPU_COMMON_SLAB_H
#define VXM_GPU_COMMON_SLAB_H

#include "voxel/engine/engine.h"
#include "voxel/parity/parity_union.h"
#include "voxel/surface/surface.h"

/** Rows lie one behind the other, without room between slices. */
typedef struct vxm_slab {
  const vxm_window *window;
  int64_t begin, end; /**< slices of the window's space */
  size_t row_words;   /**< of 64 bits */
  size_t words;       /**< of 64 bits, in all */
} vxm_slab;

vxm_slab vxm_slab_of(const vxm_window *window, int64_t begin, int64_t slices);
/** How many slices of a window fit `most` bytes, one at least. @return VXM_OK; VXM_ERROR_RANGE if one takes
 * more than slice_most */
vxm_status vxm_slab_slices(int64_t *out, const vxm_engine *engine, const vxm_window *window,
                           int64_t slice_most, int64_t most, vxm_error *error);
/** Bytes that a slab may take under the memory limit, with so many buffers of its size which hold `held`
 * bytes already. */
int64_t vxm_slab_share(vxm_context *context, size_t held, int buffers);
/** Words of a slice. */
size_t vxm_slab_slice_words(const vxm_slab *slab);
/** Bytes before it in words that hold its window without room between slices. */
size_t vxm_slab_offset(const vxm_slab *slab);
/** Where a slice lies in words that are laid out as the window's. */
uint64_t *vxm_slab_slice_at(const vxm_slab *slab, uint64_t *words, int64_t slice);
/** As vxm_progress_enter, for the slab's part of its window. */
vxm_progress_part vxm_slab_progress(const vxm_slab *slab);
/** Moves a slab's words into the window's, or (`is_or`) adds them. */
void vxm_slab_take(const vxm_slab *slab, uint64_t *words, const uint64_t *from, bool is_or);

/** The columns of a slab and the triangles that flip them; axes in the order u, v, w, w along the columns.
 * The layout is that of shaders/job.glsl and shaders/lattice.cl. */
typedef struct vxm_slab_columns {
  int32_t axes[3], bits;         /**< bits of the lattice below a voxel */
  int32_t first[3], keep_before; /**< first voxel; whether a flip before it along w counts for it */
  int32_t last[3], unused;       /**< voxel behind the last */
  uint32_t step[4];              /**< bits from a voxel to the next one */
  uint32_t triangle_first, triangle_count, ordered, few_columns;
} vxm_slab_columns;

/** What the passes over a slab have in common; the triangles are still to be told. */
vxm_slab_columns vxm_slab_columns_of(const vxm_slab *slab, const vxm_parity_union_job *job);

/** The voxels of a slab along x, y, z and the triangles of a surface. The layout is that of
 * shaders/touching.glsl and shaders/touching.cl. */
typedef struct vxm_slab_surface {
  int32_t first[3], bits;
  int32_t last[3], thin;
  uint32_t step[4];
  uint32_t triangle_count, few_columns;
  int32_t shift, shadow; /**< 0; see shaders/touching.cl */
} vxm_slab_surface;

vxm_slab_surface vxm_slab_surface_of(const vxm_slab *slab, const vxm_surface *surface, vxm_surface_kind kind);

#endif

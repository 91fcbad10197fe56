/* SPDX-License-Identifier: BSD-3-Clause */
/** What one thread makes variants with; its memory is kept from one to the next. */
#ifndef VXM_AUGMENT_DESK_H
#define VXM_AUGMENT_DESK_H

#include "augment/subject.h"

typedef struct vxm_desk {
  vxm_context *context; /**< one reference held; NULL = not made yet */
  vxm_twin twin;
  vxm_grid *grid;  /**< a variant on its way to a file; NULL before the first */
  uint64_t *words; /**< of a window, where what is asked for has another form */
  size_t word_room;
} vxm_desk;

/** @param alone whether one thread works here while others work elsewhere; else all of the context's do */
vxm_status vxm_desk_create(vxm_desk *out, vxm_context *context, bool alone, vxm_error *error);
void vxm_desk_destroy(vxm_desk *desk);

/** Voxelizes a variant into a window, which is all of a cube. @return as vxm_sampler_batch */
vxm_status vxm_desk_fill(vxm_desk *desk, const vxm_window *window, const vxm_subject *subject,
                         const vxm_placement *placement, const vxm_noise *noise, vxm_error *error);

/** The same into memory, as [x][y][z] in C order. */
vxm_status vxm_desk_write(vxm_desk *desk, void *out, vxm_voxels voxels, int64_t resolution,
                          const vxm_subject *subject, const vxm_placement *placement, const vxm_noise *noise,
                          vxm_error *error);

/** The same into a file. */
vxm_status vxm_desk_save(vxm_desk *desk, const char *path, const char *format, int64_t resolution,
                         const vxm_subject *subject, const vxm_placement *placement, const vxm_noise *noise,
                         vxm_error *error);

/** The voxel space of all variants: the unit cube. */
vxm_space vxm_desk_space(int64_t resolution);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Room for much that is freed at once: blocks that become larger, so that large ones go back to the system.
 */
#ifndef VXM_GRID_BLOCK_ARENA_H
#define VXM_GRID_BLOCK_ARENA_H

#include "base/context.h"

typedef struct vxm_block_arena {
  struct vxm_arena_block *last;
  size_t used; /**< bytes of `last` */
} vxm_block_arena;

/** A pointer to `bytes` free ones, of which vxm_block_arena_keep then says how many were used; NULL, with the
 * reason in `*failed`, if memory ran out. */
void *vxm_block_arena_room(vxm_block_arena *arena, vxm_context *context, size_t bytes, vxm_status *failed);

static inline void vxm_block_arena_keep(vxm_block_arena *arena, size_t bytes) {
  arena->used += bytes;
}

/** Drops all that is in it. */
void vxm_block_arena_clear(vxm_block_arena *arena, vxm_context *context);

#endif

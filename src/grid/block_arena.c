/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/block_arena.h"

/** Each block is four times the one before. The C library gives back at once what is freed only of blocks
 * beyond 32 MiB. */
enum { LEAST = 1 << 20, MOST = 1 << 26, GROWTH = 4 };

typedef struct vxm_arena_block {
  struct vxm_arena_block *before;
  size_t bytes;
  _Alignas(8) unsigned char data[];
} vxm_arena_block;

static vxm_arena_block *new_block(vxm_context *context, size_t bytes, vxm_error *error) {
  vxm_arena_block *block = vxm_alloc(context, 1, sizeof *block + bytes, error);
  if (block)
    block->bytes = bytes;
  return block;
}

void *vxm_block_arena_room(vxm_block_arena *arena, vxm_context *context, size_t bytes, vxm_status *failed) {
  vxm_arena_block *last = arena->last;
  if (last && last->bytes - arena->used >= bytes)
    return last->data + arena->used;
  size_t least = bytes > LEAST ? bytes : LEAST - sizeof *last, wanted = last ? last->bytes * GROWTH : least;
  wanted = wanted > MOST ? MOST : wanted;
  vxm_error local = VXM_ERROR_INIT, once_more = VXM_ERROR_INIT;
  vxm_arena_block *block = wanted > least ? new_block(context, wanted, &local) : NULL;
  if (!block)
    block = new_block(context, least, &once_more);
  if (!block) {
    *failed = once_more.code;
    return NULL;
  }
  block->before = last;
  arena->last = block;
  arena->used = 0;
  return block->data;
}

void vxm_block_arena_clear(vxm_block_arena *arena, vxm_context *context) {
  for (vxm_arena_block *block = arena->last; block;) {
    vxm_arena_block *before = block->before;
    vxm_free(context, block);
    block = before;
  }
  *arena = (vxm_block_arena){NULL, 0};
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** What .schem and .litematic files hold, before it becomes a grid or a field. */
#ifndef VXM_GRIDIO_FORMATS_MINECRAFT_BLOCK_FILE_H
#define VXM_GRIDIO_FORMATS_MINECRAFT_BLOCK_FILE_H

#include "gridio/formats/minecraft/blocks.h"
#include "gridio/formats/minecraft/nbt_read.h"

/** Names of blocks, each once; number 0 is all kinds of air. */
typedef struct vxm_block_list {
  vxm_context *context;
  char *text; /**< all names with their zero bytes */
  size_t size, capacity;
  size_t *begin; /**< of each name in the text */
  size_t count, begin_capacity;
  uint32_t *table; /**< numbers by hash, 0 = free; of `slots`, a power of two */
  size_t slots;
} vxm_block_list;

/** @return VXM_OK; VXM_ERROR_RANGE beyond 65535 names; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_block_list_add(uint32_t *number, vxm_block_list *list, const char *name, size_t size,
                              vxm_error *error);
void vxm_block_list_destroy(vxm_block_list *list);

/** Blocks along the game's axes. */
typedef struct vxm_block_file {
  vxm_context *context;
  int64_t size[3];
  int64_t corner[3]; /**< where the first block stands */
  uint16_t *ids;     /**< of `list`: x fastest, then z, then y; NULL = they were not wanted */
  vxm_block_list list;
  vxm_nbt_value own; /**< the compound "voxmend", if `is_own` */
  bool is_own;
} vxm_block_file;

/** Reads the blocks of a tree: Sponge's of versions 1 to 3, or Litematica's. */
vxm_status vxm_schem_load(vxm_block_file *out, const vxm_nbt *tree, const vxm_input *input, bool wants_ids,
                          vxm_error *error);
vxm_status vxm_litematic_load(vxm_block_file *out, const vxm_nbt *tree, const vxm_input *input,
                              bool wants_ids, vxm_error *error);

/** Checks the sizes, and gives room for all blocks, which are air. */
vxm_status vxm_block_file_make(vxm_block_file *file, const vxm_input *input, bool wants_ids,
                               vxm_error *error);
void vxm_block_file_destroy(vxm_block_file *file);

#endif

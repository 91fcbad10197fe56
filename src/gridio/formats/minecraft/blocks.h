/* SPDX-License-Identifier: BSD-3-Clause */
/** Voxels as Minecraft's blocks: which block stands for which voxel, and which way is up. */
#ifndef VXM_GRIDIO_FORMATS_MINECRAFT_BLOCKS_H
#define VXM_GRIDIO_FORMATS_MINECRAFT_BLOCKS_H

#include "gridio/common/values.h"
#include "gridio/common/y_up.h"
#include "gridio/formats/minecraft/nbt_write.h"

enum { VXM_BLOCK_NAME_MOST = 255, VXM_BLOCK_CHOICES_MOST = 4096 };

/** "minecraft:oak_log[axis=y]" */
typedef struct vxm_block_name {
  char text[VXM_BLOCK_NAME_MOST + 1];
  uint16_t label; /**< the first that it stands for; 0 = none */
} vxm_block_name;

/** A field as blocks; block 0 is air. */
typedef struct vxm_blocks {
  const vxm_field *field;
  vxm_field_kind kind; /**< VXM_FIELD_NUMBERS for bits, VXM_FIELD_LABELS or VXM_FIELD_COLORS */
  uint16_t *numbers;   /**< of bits and labels: the block of each; */
  uint16_t *ids;       /**< of colours: the block of each voxel, as they lie in the field */
  vxm_y_up axes;
  int64_t size[3];       /**< along the game's axes */
  vxm_block_name *names; /**< of the blocks that may occur */
  size_t count, capacity;
} vxm_blocks;

/**
 * Checks names of blocks between commas: lower-case letters, digits and "_-./", after "minecraft:" or another
 * name and a colon, with states between brackets behind them. NULL is right, and stands for the format's own
 * blocks.
 *
 * @return VXM_OK, VXM_ERROR_ARGUMENT
 */
vxm_status vxm_blocks_check_names(const char *names, vxm_error *error);

/**
 * Whether a field can be blocks: bits, labels from 0 to 65535, or colours, and not too many of them.
 *
 * @param format   ".schem" or ".litematic"
 * @param side_max the most blocks along an axis that it holds
 * @return VXM_OK, VXM_ERROR_ARGUMENT, VXM_ERROR_RANGE
 */
vxm_status vxm_blocks_check_field(const vxm_field *field, const char *path, const char *format,
                                  int64_t side_max, vxm_error *error);
/** Makes blocks of a field, and writes the tree of a format of them. @param row has room for one */
vxm_status vxm_blocks_write(vxm_output *output, const vxm_field *field,
                            vxm_status (*put_tree)(vxm_nbt_writer *writer, const vxm_blocks *blocks,
                                                   uint16_t *row, vxm_error *error),
                            vxm_error *error);

/** The blocks of a row along the game's x. */
void vxm_blocks_row(uint16_t *out, const vxm_blocks *blocks, int64_t y, int64_t z);
/** Blocks that are not air. */
int64_t vxm_blocks_count(const vxm_blocks *blocks);
/** Writes the compound "voxmend", from which the same grid is read back. */
void vxm_blocks_put_metadata(vxm_nbt_writer *writer, const vxm_blocks *blocks);

#endif

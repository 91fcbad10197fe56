/* SPDX-License-Identifier: BSD-3-Clause */
/** Minecraft's blocks that are plain opaque cubes, with the colours that they have from afar. */
#ifndef VXM_GRIDIO_FORMATS_MINECRAFT_BLOCK_COLORS_H
#define VXM_GRIDIO_FORMATS_MINECRAFT_BLOCK_COLORS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct vxm_block_color {
  const char *name; /**< such as "minecraft:red_wool" */
  uint8_t rgb[3];   /**< sRGB, the average of the game's own texture */
} vxm_block_color;

/** The first VXM_BLOCK_DYED are those for labels: concrete, wool and terracotta of the 16 dyes. */
enum { VXM_BLOCK_DYED = 48, VXM_BLOCK_COLORS_MOST = 128 };

/** All blocks; they are all of version 1.13 of the game. */
const vxm_block_color *vxm_block_colors(size_t *count);

/** Finds the nearest block of many colours. */
typedef struct vxm_block_matcher {
  double lab[VXM_BLOCK_COLORS_MOST][3];
  bool barred[VXM_BLOCK_COLORS_MOST]; /**< set by the caller, before the first is matched: not to be taken */
  struct {
    uint32_t key; /**< a colour and 2^24; 0 = none yet */
    uint16_t block;
  } known[1 << 12];
} vxm_block_matcher;

void vxm_block_matcher_init(vxm_block_matcher *matcher);
/** The number of the block whose colour is nearest in CIELAB (1976, D65); of several the first. */
size_t vxm_block_match(vxm_block_matcher *matcher, const uint8_t rgb[3]);

#endif

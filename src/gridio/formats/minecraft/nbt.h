/* SPDX-License-Identifier: BSD-3-Clause */
/** The kinds of tags of Minecraft's named binary tags: trees of named numbers, texts, arrays and lists,
 * big-endian, as a rule packed by gzip. */
#ifndef VXM_GRIDIO_FORMATS_MINECRAFT_NBT_H
#define VXM_GRIDIO_FORMATS_MINECRAFT_NBT_H

typedef enum vxm_nbt_type {
  VXM_NBT_END,
  VXM_NBT_BYTE,
  VXM_NBT_SHORT,
  VXM_NBT_INT,
  VXM_NBT_LONG,
  VXM_NBT_FLOAT,
  VXM_NBT_DOUBLE,
  VXM_NBT_BYTES,
  VXM_NBT_STRING,
  VXM_NBT_LIST,
  VXM_NBT_COMPOUND,
  VXM_NBT_INTS,
  VXM_NBT_LONGS
} vxm_nbt_type;

#endif

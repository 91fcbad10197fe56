/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * .litematic, Litematica's: a region with a palette of blocks, and their numbers packed into 64-bit words as
 * closely as possible, across the borders of words too; x fastest, then z, then y (up). block_read.c reads
 * it.
 */
#include "gridio/common/format.h"
#include "gridio/formats/minecraft/block_read.h"
#include "gridio/formats/minecraft/blocks.h"

#include <inttypes.h>
#include <string.h>

/** Version 5 is that of Litematica for Minecraft 1.16.5. */
enum { LITEMATIC_VERSION = 5, DATA_VERSION = 2586, BITS_LEAST = 2 };

static int bits_of(size_t count) {
  int bits = BITS_LEAST;
  while ((count - 1) >> bits)
    bits++;
  return bits;
}

/** Words in the making. */
typedef struct packer {
  vxm_nbt_writer *writer;
  uint64_t word;
  int used, bits;
} packer;

static void put_row(packer *p, const uint16_t *row, int64_t count) {
  for (int64_t i = 0; i < count; i++) {
    uint64_t value = row[i];
    p->word |= value << p->used;
    p->used += p->bits;
    if (p->used < 64)
      continue;
    vxm_nbt_number(p->writer, p->word, 8);
    p->used -= 64;
    p->word = p->used > 0 ? value >> (p->bits - p->used) : 0;
  }
}

static vxm_status put_states(vxm_nbt_writer *writer, const vxm_blocks *blocks, uint16_t *row,
                             vxm_error *error) {
  packer p = {.writer = writer, .bits = bits_of(blocks->count)};
  uint64_t count = (uint64_t)(blocks->size[0] * blocks->size[1] * blocks->size[2]);
  vxm_status status = VXM_OK;
  vxm_nbt_tag(writer, VXM_NBT_LONGS, "BlockStates");
  vxm_nbt_number(writer, (count * (uint64_t)p.bits + 63) / 64, 4);
  for (int64_t y = 0; y < blocks->size[1] && status == VXM_OK; y++) {
    for (int64_t z = 0; z < blocks->size[2]; z++) {
      vxm_blocks_row(row, blocks, y, z);
      put_row(&p, row, blocks->size[0]);
    }
    status =
        vxm_progress(blocks->field->context, "writing", (double)(y + 1) / (double)blocks->size[1], error);
  }
  if (p.used > 0)
    vxm_nbt_number(writer, p.word, 8);
  return status;
}

static void put_vector(vxm_nbt_writer *writer, const char *name, const int64_t vector[3]) {
  static const char *const axes[] = {"x", "y", "z"};
  vxm_nbt_tag(writer, VXM_NBT_COMPOUND, name);
  for (int a = 0; a < 3; a++)
    vxm_nbt_integer(writer, VXM_NBT_INT, axes[a], vector[a]);
  vxm_nbt_end(writer);
}

/** Times are 0: the same content gives the same file. */
static void put_metadata(vxm_nbt_writer *writer, const vxm_blocks *blocks) {
  vxm_nbt_tag(writer, VXM_NBT_COMPOUND, "Metadata");
  vxm_nbt_string(writer, "Name", "voxmend");
  vxm_nbt_string(writer, "Author", "voxmend");
  vxm_nbt_string(writer, "Description", "");
  vxm_nbt_integer(writer, VXM_NBT_INT, "RegionCount", 1);
  vxm_nbt_integer(writer, VXM_NBT_INT, "TotalVolume", blocks->size[0] * blocks->size[1] * blocks->size[2]);
  vxm_nbt_integer(writer, VXM_NBT_INT, "TotalBlocks", vxm_blocks_count(blocks));
  vxm_nbt_integer(writer, VXM_NBT_LONG, "TimeCreated", 0);
  vxm_nbt_integer(writer, VXM_NBT_LONG, "TimeModified", 0);
  put_vector(writer, "EnclosingSize", blocks->size);
  vxm_blocks_put_metadata(writer, blocks);
  vxm_nbt_end(writer);
}

/** The states in the brackets of a name, "axis=y,lit=true", as texts by name. */
static void put_states_of(vxm_nbt_writer *writer, const char *states) {
  char part[VXM_BLOCK_NAME_MOST + 1];
  vxm_nbt_tag(writer, VXM_NBT_COMPOUND, "Properties");
  while (*states && *states != ']') {
    size_t length = strcspn(states, ",]");
    memcpy(part, states, length);
    part[length] = '\0';
    char *equals = strchr(part, '=');
    if (equals) {
      *equals = '\0';
      vxm_nbt_string(writer, part, equals + 1);
    }
    states += length + (states[length] == ',');
  }
  vxm_nbt_end(writer);
}

static void put_palette(vxm_nbt_writer *writer, const vxm_blocks *blocks) {
  vxm_nbt_list(writer, "BlockStatePalette", VXM_NBT_COMPOUND, blocks->count);
  for (size_t b = 0; b < blocks->count; b++) {
    char name[VXM_BLOCK_NAME_MOST + 1];
    strcpy(name, blocks->names[b].text);
    char *states = strchr(name, '[');
    if (states)
      *states = '\0';
    vxm_nbt_string(writer, "Name", name);
    if (states)
      put_states_of(writer, states + 1);
    vxm_nbt_end(writer);
  }
}

static vxm_status put_tree(vxm_nbt_writer *writer, const vxm_blocks *blocks, uint16_t *row,
                           vxm_error *error) {
  static const char *const empty[] = {"Entities", "TileEntities", "PendingBlockTicks", "PendingFluidTicks"};
  static const int64_t corner[3] = {0, 0, 0};
  vxm_nbt_tag(writer, VXM_NBT_COMPOUND, "");
  vxm_nbt_integer(writer, VXM_NBT_INT, "Version", LITEMATIC_VERSION);
  vxm_nbt_integer(writer, VXM_NBT_INT, "MinecraftDataVersion", DATA_VERSION);
  put_metadata(writer, blocks);
  vxm_nbt_tag(writer, VXM_NBT_COMPOUND, "Regions");
  vxm_nbt_tag(writer, VXM_NBT_COMPOUND, "voxmend");
  put_vector(writer, "Position", corner);
  put_vector(writer, "Size", blocks->size);
  put_palette(writer, blocks);
  vxm_status status = put_states(writer, blocks, row, error);
  for (size_t e = 0; e < sizeof empty / sizeof empty[0]; e++)
    vxm_nbt_list(writer, empty[e], VXM_NBT_COMPOUND, 0);
  for (int compound = 0; compound < 3; compound++)
    vxm_nbt_end(writer);
  return status;
}

static vxm_status write_litematic(vxm_output *output, const vxm_field *field, vxm_error *error) {
  return vxm_blocks_write(output, field, put_tree, error);
}

static vxm_status check_field(const vxm_field *field, const char *path, vxm_error *error) {
  return vxm_blocks_check_field(field, path, ".litematic", INT64_MAX, error);
}

static vxm_status write_field(const vxm_field *field, const char *path, vxm_error *error) {
  return vxm_field_write_file(field, path, write_litematic, error);
}

/** By its content it is taken for a .schem, whose readers tell both apart. */
const vxm_grid_format vxm_format_litematic = {
    .name = "litematic",
    .holds = VXM_HOLDS_BITS | VXM_HOLDS_LABELS | VXM_HOLDS_COLORS,
    .read = vxm_block_read_bits,
    .read_field = vxm_block_read_field,
    .check_field = check_field,
    .write_field = write_field,
};

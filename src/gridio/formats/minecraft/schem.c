/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * .schem, Sponge's schematic: a palette of blocks, and the number of each block, x fastest, then z, then y
 * (up). Of the versions the second is written, which WorldEdit, FAWE, Amulet and mcschematic have in common;
 * block_read.c reads it.
 */
#include "gridio/common/format.h"
#include "gridio/formats/minecraft/block_read.h"
#include "gridio/formats/minecraft/blocks.h"
#include "gridio/formats/minecraft/nbt_read.h"

/** Minecraft 1.16.5, whose blocks all later versions know how to read. */
enum { SCHEM_VERSION = 2, DATA_VERSION = 2586 };

/** 7 bits a byte, the lowest first. Returns their number. */
static size_t put_number(unsigned char to[3], unsigned value) {
  size_t size = 0;
  for (; value > 127; value >>= 7)
    to[size++] = (unsigned char)(value | 128);
  to[size++] = (unsigned char)value;
  return size;
}

/** The blocks of a row; returns their bytes. */
static size_t pack_row(unsigned char *to, uint16_t *row, const vxm_blocks *blocks, int64_t y, int64_t z) {
  size_t size = 0;
  vxm_blocks_row(row, blocks, y, z);
  for (int64_t x = 0; x < blocks->size[0]; x++)
    size += put_number(to + size, row[x]);
  return size;
}

/** Goes through all rows: counts their bytes, or writes them where there is a writer. */
static vxm_status do_rows(size_t *size, vxm_nbt_writer *writer, const vxm_blocks *blocks, uint16_t *row,
                          unsigned char *bytes, vxm_error *error) {
  vxm_status status = VXM_OK;
  *size = 0;
  for (int64_t y = 0; y < blocks->size[1] && status == VXM_OK; y++) {
    for (int64_t z = 0; z < blocks->size[2]; z++) {
      size_t used = pack_row(bytes, row, blocks, y, z);
      if (writer)
        vxm_nbt_put(writer, bytes, used);
      *size += used;
    }
    status = writer ? vxm_progress(blocks->field->context, "writing",
                                   (double)(y + 1) / (double)blocks->size[1], error)
                    : vxm_check_cancelled(blocks->field->context, error);
  }
  return status;
}

static void put_front(vxm_nbt_writer *writer, const vxm_blocks *blocks) {
  static const char *const sides[] = {"Width", "Height", "Length"};
  vxm_nbt_tag(writer, VXM_NBT_COMPOUND, "Schematic");
  vxm_nbt_integer(writer, VXM_NBT_INT, "Version", SCHEM_VERSION);
  vxm_nbt_integer(writer, VXM_NBT_INT, "DataVersion", DATA_VERSION);
  vxm_nbt_tag(writer, VXM_NBT_COMPOUND, "Metadata");
  vxm_nbt_string(writer, "Name", "voxmend");
  vxm_blocks_put_metadata(writer, blocks);
  vxm_nbt_end(writer);
  for (int a = 0; a < 3; a++)
    vxm_nbt_integer(writer, VXM_NBT_SHORT, sides[a], blocks->size[a]);
  vxm_nbt_tag(writer, VXM_NBT_INTS, "Offset");
  vxm_nbt_number(writer, 3, 4);
  for (int a = 0; a < 3; a++)
    vxm_nbt_number(writer, 0, 4);
}

static void put_palette(vxm_nbt_writer *writer, const vxm_blocks *blocks) {
  vxm_nbt_integer(writer, VXM_NBT_INT, "PaletteMax", (int64_t)blocks->count);
  vxm_nbt_tag(writer, VXM_NBT_COMPOUND, "Palette");
  for (size_t b = 0; b < blocks->count; b++)
    vxm_nbt_integer(writer, VXM_NBT_INT, blocks->names[b].text, (int64_t)b);
  vxm_nbt_end(writer);
}

static vxm_status put_packed(vxm_nbt_writer *writer, const vxm_blocks *blocks, uint16_t *row,
                             unsigned char *bytes, vxm_error *error) {
  size_t size;
  vxm_status status = do_rows(&size, NULL, blocks, row, bytes, error);
  if (status == VXM_OK && size > INT32_MAX)
    status =
        vxm_fail(error, VXM_ERROR_RANGE,
                 ".schem holds up to %d bytes of blocks, not %zu; lower the resolution", INT32_MAX, size);
  if (status != VXM_OK)
    return status;
  put_front(writer, blocks);
  put_palette(writer, blocks);
  vxm_nbt_tag(writer, VXM_NBT_BYTES, "BlockData");
  vxm_nbt_number(writer, size, 4);
  status = do_rows(&size, writer, blocks, row, bytes, error);
  vxm_nbt_list(writer, "BlockEntities", VXM_NBT_COMPOUND, 0);
  vxm_nbt_list(writer, "Entities", VXM_NBT_COMPOUND, 0);
  vxm_nbt_end(writer);
  return status;
}

static vxm_status put_tree(vxm_nbt_writer *writer, const vxm_blocks *blocks, uint16_t *row,
                           vxm_error *error) {
  vxm_context *context = blocks->field->context;
  unsigned char *bytes = vxm_alloc(context, (size_t)blocks->size[0], 3, error);
  vxm_status status = bytes ? put_packed(writer, blocks, row, bytes, error) : error->code;
  vxm_free(context, bytes);
  return status;
}

static vxm_status write_schem(vxm_output *output, const vxm_field *field, vxm_error *error) {
  return vxm_blocks_write(output, field, put_tree, error);
}

static vxm_status check_field(const vxm_field *field, const char *path, vxm_error *error) {
  return vxm_blocks_check_field(field, path, ".schem", UINT16_MAX, error);
}

static vxm_status write_field(const vxm_field *field, const char *path, vxm_error *error) {
  return vxm_field_write_file(field, path, write_schem, error);
}

const vxm_grid_format vxm_format_schem = {
    .name = "schem",
    .holds = VXM_HOLDS_BITS | VXM_HOLDS_LABELS | VXM_HOLDS_COLORS,
    .sniff = vxm_nbt_sniff,
    .read = vxm_block_read_bits,
    .read_field = vxm_block_read_field,
    .check_field = check_field,
    .write_field = write_field,
};

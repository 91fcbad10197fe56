/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/common/format.h"
#include "gridio/formats/minecraft/block_file.h"

#include <inttypes.h>

/** The parts of a file, wherever its version has them. */
typedef struct parts {
  vxm_nbt_value root, palette, data;
} parts;

/** Version 3 has all in a compound "Schematic", and the blocks in one of their own. */
static vxm_status find_parts(parts *p, const vxm_nbt *tree, const vxm_input *input, vxm_error *error) {
  vxm_nbt_value inner, blocks;
  p->root = tree->root;
  if (vxm_nbt_find(&inner, &tree->root, "Schematic", VXM_NBT_COMPOUND))
    p->root = inner;
  bool has_third = vxm_nbt_find(&blocks, &p->root, "Blocks", VXM_NBT_COMPOUND);
  if (!has_third)
    blocks = p->root;
  if (vxm_nbt_find(&p->palette, &blocks, "Palette", VXM_NBT_COMPOUND) &&
      vxm_nbt_find(&p->data, &blocks, has_third ? "Data" : "BlockData", VXM_NBT_BYTES))
    return VXM_OK;
  vxm_nbt_value old;
  if (vxm_nbt_find(&old, &p->root, "Materials", VXM_NBT_STRING))
    return vxm_fail_byte(
        error, input, 0,
        "a schematic of MCEdit, whose blocks are numbers; save it as .schem (Sponge) or .litematic");
  return vxm_fail_byte(error, input, 0, "no schematic: there is no Palette, or no data of blocks");
}

static vxm_status read_sizes(vxm_block_file *out, const vxm_nbt_value *root, const vxm_input *input,
                             vxm_error *error) {
  static const char *const sides[] = {"Width", "Height", "Length"};
  vxm_nbt_value offset;
  for (int a = 0; a < 3; a++) {
    if (!vxm_nbt_find_integer(&out->size[a], root, sides[a]))
      return vxm_fail_byte(error, input, 0, "the schematic has no %s", sides[a]);
    if (out->size[a] < 0 && out->size[a] >= INT16_MIN) /* written without a sign */
      out->size[a] += 1 << 16;
  }
  if (vxm_nbt_find(&offset, root, "Offset", VXM_NBT_INTS) && vxm_nbt_count(&offset) == 3)
    for (int a = 0; a < 3; a++)
      out->corner[a] = (int32_t)vxm_nbt_load_number(offset.at + 4 + 4 * a, 4);
  return VXM_OK;
}

/** What the numbers of the file are in the list. */
typedef struct numbers {
  uint32_t *of; /**< UINT32_MAX = none */
  size_t count;
} numbers;

static vxm_status read_palette(numbers *out, vxm_block_file *file, const vxm_nbt_value *palette,
                               const vxm_input *input, vxm_error *error) {
  const unsigned char *at = palette->at;
  const char *name;
  size_t size, capacity = 0;
  vxm_nbt_value value;
  vxm_status status = VXM_OK;
  while (status == VXM_OK && vxm_nbt_next(&at, palette, &name, &size, &value)) {
    int64_t number = vxm_nbt_integer_of(&value);
    if (number < 0 || number > UINT16_MAX || value.type == VXM_NBT_LONG)
      return vxm_fail_byte(error, input, 0, "the palette numbers a block %" PRId64, number);
    size_t needed = (size_t)number + 1;
    if (needed > out->count) {
      status = vxm_grow(file->context, (void **)&out->of, &capacity, needed, sizeof *out->of, error);
      while (status == VXM_OK && out->count < needed)
        out->of[out->count++] = UINT32_MAX;
    }
    if (status == VXM_OK)
      status = vxm_block_list_add(&out->of[number], &file->list, name, size, error);
  }
  return status;
}

/** A number of up to 21 bits, 7 in a byte; false if it goes beyond the end. */
static bool take_number(uint32_t *out, const unsigned char **at, const unsigned char *end) {
  *out = 0;
  for (int shift = 0; shift < 21 && *at < end; shift += 7) {
    unsigned char byte = *(*at)++;
    *out |= (uint32_t)(byte & 127) << shift;
    if (byte < 128)
      return true;
  }
  return false;
}

static vxm_status read_blocks(vxm_block_file *file, const numbers *known, const vxm_nbt_value *data,
                              const vxm_input *input, vxm_error *error) {
  size_t count = (size_t)(file->size[0] * file->size[1] * file->size[2]);
  const unsigned char *at = data->at + 4;
  vxm_status status = VXM_OK;
  for (size_t b = 0; b < count && status == VXM_OK; b++) {
    uint32_t number;
    if (!take_number(&number, &at, data->end))
      return vxm_fail_byte(error, input, input->size, "the blocks end after %zu of %zu", b, count);
    if (number >= known->count || known->of[number] == UINT32_MAX)
      return vxm_fail_byte(error, input, 0,
                           "block %zu is number %" PRIu32 ", which the palette does not have", b, number);
    if (file->ids)
      file->ids[b] = (uint16_t)known->of[number];
    status = vxm_check_cancelled_at(b, file->context, error);
  }
  return status;
}

vxm_status vxm_schem_load(vxm_block_file *out, const vxm_nbt *tree, const vxm_input *input, bool wants_ids,
                          vxm_error *error) {
  parts p;
  numbers known = {NULL, 0};
  vxm_nbt_value metadata;
  vxm_status status = find_parts(&p, tree, input, error);
  if (status == VXM_OK)
    status = read_sizes(out, &p.root, input, error);
  if (status != VXM_OK)
    return status;
  out->is_own = vxm_nbt_find(&metadata, &p.root, "Metadata", VXM_NBT_COMPOUND) &&
                vxm_nbt_find(&out->own, &metadata, "voxmend", VXM_NBT_COMPOUND);
  uint64_t bytes = vxm_nbt_count(&p.data);
  /* a byte each at least, which a grid cannot ask for without having it */
  for (int a = 0; a < 3; a++)
    bytes /= out->size[a] > 0 ? (uint64_t)out->size[a] : 1;
  if (bytes == 0)
    return vxm_fail_byte(error, input, 0,
                         "%zu bytes of blocks are too few for %" PRId64 " x %" PRId64 " x %" PRId64,
                         vxm_nbt_count(&p.data), out->size[0], out->size[1], out->size[2]);
  status = vxm_block_file_make(out, input, wants_ids, error);
  if (status == VXM_OK)
    status = read_palette(&known, out, &p.palette, input, error);
  if (status == VXM_OK)
    status = read_blocks(out, &known, &p.data, input, error);
  vxm_free(out->context, known.of);
  return status;
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/common/format.h"
#include "gridio/formats/minecraft/block_file.h"

#include <inttypes.h>
#include <string.h>

/** A region: a box of blocks. */
typedef struct region {
  int64_t begin[3], size[3];
  vxm_nbt_value palette, states;
} region;

static bool read_vector(int64_t out[3], const vxm_nbt_value *parent, const char *name) {
  static const char *const axes[] = {"x", "y", "z"};
  vxm_nbt_value vector;
  if (!vxm_nbt_find(&vector, parent, name, VXM_NBT_COMPOUND))
    return false;
  for (int a = 0; a < 3; a++)
    if (!vxm_nbt_find_integer(&out[a], &vector, axes[a]) || out[a] > INT32_MAX || out[a] < INT32_MIN)
      return false;
  return true;
}

/** Sizes below 0 reach from the position the other way. */
static vxm_status read_region(region *out, const vxm_nbt_value *value, const vxm_input *input,
                              vxm_error *error) {
  if (!read_vector(out->begin, value, "Position") || !read_vector(out->size, value, "Size") ||
      !vxm_nbt_find(&out->palette, value, "BlockStatePalette", VXM_NBT_LIST) ||
      !vxm_nbt_find(&out->states, value, "BlockStates", VXM_NBT_LONGS))
    return vxm_fail_byte(error, input, 0,
                         "a region of the litematic lacks Position, Size, BlockStatePalette or BlockStates");
  for (int a = 0; a < 3; a++)
    if (out->size[a] < 0) {
      out->begin[a] += out->size[a] + 1;
      out->size[a] = -out->size[a];
    }
  return VXM_OK;
}

/* ---- The palette ---- */

/** "minecraft:oak_log[axis=y,...]", as .schem has it, within a limit; 0 if it is none. */
static size_t name_of(char text[VXM_BLOCK_NAME_MOST + 1], const vxm_nbt_value *entry) {
  vxm_nbt_value name, states, value;
  size_t used, size;
  if (entry->type != VXM_NBT_COMPOUND || !vxm_nbt_find(&name, entry, "Name", VXM_NBT_STRING))
    return 0;
  const char *from = vxm_nbt_string_of(&name, &used);
  if (used > VXM_BLOCK_NAME_MOST)
    used = VXM_BLOCK_NAME_MOST;
  memcpy(text, from, used);
  if (!vxm_nbt_find(&states, entry, "Properties", VXM_NBT_COMPOUND))
    return used;
  const unsigned char *at = states.at;
  char before = '[';
  while (vxm_nbt_next(&at, &states, &from, &size, &value)) {
    size_t value_size;
    if (value.type != VXM_NBT_STRING)
      continue;
    const char *text_of = vxm_nbt_string_of(&value, &value_size);
    if (size + value_size + 3 > VXM_BLOCK_NAME_MOST - used)
      break;
    text[used++] = before;
    memcpy(text + used, from, size);
    used += size;
    text[used++] = '=';
    memcpy(text + used, text_of, value_size);
    used += value_size;
    before = ',';
  }
  if (before == ',')
    text[used++] = ']';
  return used;
}

static vxm_status read_palette(uint32_t *numbers, vxm_block_file *file, const vxm_nbt_value *palette,
                               const vxm_input *input, vxm_error *error) {
  const unsigned char *at = NULL;
  vxm_nbt_value entry;
  vxm_status status = VXM_OK;
  while (status == VXM_OK && vxm_nbt_next_item(&at, palette, &entry)) {
    char name[VXM_BLOCK_NAME_MOST + 1];
    size_t size = name_of(name, &entry);
    if (size == 0)
      return vxm_fail_byte(error, input, 0, "an entry of the palette has no name");
    status = vxm_block_list_add(numbers++, &file->list, name, size, error);
  }
  return status;
}

/* ---- The blocks ---- */

typedef struct unpacker {
  const unsigned char *words;
  int bits;
} unpacker;

static uint32_t number_at(const unpacker *u, size_t index) {
  size_t bit = index * (size_t)u->bits, word = bit / 64, shift = bit % 64;
  uint64_t value = vxm_nbt_load_number(u->words + 8 * word, 8) >> shift;
  if (shift + (size_t)u->bits > 64)
    value |= vxm_nbt_load_number(u->words + 8 * (word + 1), 8) << (64 - shift);
  return (uint32_t)(value & ((UINT64_C(1) << u->bits) - 1));
}

static int bits_of(size_t count) {
  int bits = 2;
  while (count > 1 && (count - 1) >> bits)
    bits++;
  return bits;
}

/** Regions may overlap: air leaves what is there. */
static vxm_status put_blocks(vxm_block_file *file, const region *r, const uint32_t *numbers, size_t count,
                             const vxm_input *input, vxm_error *error) {
  const unpacker u = {r->states.at + 4, bits_of(count)};
  vxm_status status = VXM_OK;
  size_t index = 0;
  for (int64_t y = 0; y < r->size[1]; y++)
    for (int64_t z = 0; z < r->size[2] && status == VXM_OK; z++) {
      int64_t row = (y + r->begin[1] - file->corner[1]) * file->size[2] + z + r->begin[2] - file->corner[2];
      size_t at = (size_t)(row * file->size[0] + r->begin[0] - file->corner[0]);
      for (int64_t x = 0; x < r->size[0]; x++, at++, index++) {
        uint32_t number = number_at(&u, index);
        if (number >= count)
          return vxm_fail_byte(error, input, 0, "block %zu is number %" PRIu32 " of a palette of %zu", index,
                               number, count);
        if (file->ids && numbers[number] != 0)
          file->ids[at] = (uint16_t)numbers[number];
      }
      status = vxm_check_cancelled(file->context, error);
    }
  return status;
}

/** Whether there are as many words as the blocks of a region need. */
static bool has_words(const region *r, size_t count) {
  uint64_t left = (uint64_t)vxm_nbt_count(&r->states) * 64 / (uint64_t)bits_of(count);
  for (int a = 0; a < 3; a++)
    left = r->size[a] > 0 ? left / (uint64_t)r->size[a] : 0;
  return left > 0;
}

static vxm_status load_region(vxm_block_file *file, const region *r, const vxm_input *input,
                              vxm_error *error) {
  size_t count = vxm_nbt_count(&r->palette);
  if (count == 0 || !has_words(r, count))
    return vxm_fail_byte(error, input, 0,
                         "a region of %" PRId64 " x %" PRId64 " x %" PRId64
                         " blocks lacks some of them, or its palette",
                         r->size[0], r->size[1], r->size[2]);
  vxm_error local = VXM_ERROR_INIT;
  uint32_t *numbers = vxm_alloc(file->context, count, sizeof *numbers, &local);
  vxm_status status = numbers ? read_palette(numbers, file, &r->palette, input, &local) : local.code;
  if (status == VXM_OK)
    status = put_blocks(file, r, numbers, count, input, &local);
  vxm_free(file->context, numbers);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/* ---- All regions ---- */

typedef vxm_status (*region_fn)(vxm_block_file *file, const region *r, const vxm_input *input,
                                vxm_error *error);

static vxm_status for_regions(vxm_block_file *file, const vxm_nbt_value *regions, region_fn function,
                              const vxm_input *input, vxm_error *error) {
  const unsigned char *at = regions->at;
  const char *name;
  size_t size;
  vxm_nbt_value value;
  vxm_status status = VXM_OK;
  while (status == VXM_OK && vxm_nbt_next(&at, regions, &name, &size, &value)) {
    region r;
    if (value.type != VXM_NBT_COMPOUND)
      continue;
    status = read_region(&r, &value, input, error);
    if (status == VXM_OK)
      status = function(file, &r, input, error);
  }
  return status;
}

/** Widens the box of all regions; `size` is their far corner as yet. */
static vxm_status widen(vxm_block_file *file, const region *r, const vxm_input *input, vxm_error *error) {
  if (r->size[0] == 0 || r->size[1] == 0 || r->size[2] == 0)
    return vxm_fail_byte(error, input, 0, "a region of the litematic has no blocks");
  bool is_first = file->size[0] == INT64_MIN;
  for (int a = 0; a < 3; a++) {
    int64_t end = r->begin[a] + r->size[a];
    file->corner[a] = is_first || r->begin[a] < file->corner[a] ? r->begin[a] : file->corner[a];
    file->size[a] = is_first || end > file->size[a] ? end : file->size[a];
  }
  return VXM_OK;
}

vxm_status vxm_litematic_load(vxm_block_file *out, const vxm_nbt *tree, const vxm_input *input,
                              bool wants_ids, vxm_error *error) {
  vxm_nbt_value regions, metadata;
  if (!vxm_nbt_find(&regions, &tree->root, "Regions", VXM_NBT_COMPOUND))
    return vxm_fail_byte(error, input, 0, "no litematic: there are no Regions");
  out->is_own = vxm_nbt_find(&metadata, &tree->root, "Metadata", VXM_NBT_COMPOUND) &&
                vxm_nbt_find(&out->own, &metadata, "voxmend", VXM_NBT_COMPOUND);
  out->size[0] = INT64_MIN;
  vxm_status status = for_regions(out, &regions, widen, input, error);
  if (status == VXM_OK && out->size[0] == INT64_MIN)
    status = vxm_fail_byte(error, input, 0, "the litematic has no region");
  for (int a = 0; status == VXM_OK && a < 3; a++)
    out->size[a] -= out->corner[a];
  if (status == VXM_OK)
    status = vxm_block_file_make(out, input, wants_ids, error);
  return status == VXM_OK ? for_regions(out, &regions, load_region, input, error) : status;
}

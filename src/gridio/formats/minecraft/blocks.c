/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/minecraft/blocks.h"
#include "gridio/common/format.h"
#include "gridio/formats/minecraft/block_colors.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* ---- Names ---- */

/** The length of the name at the beginning of a list, up to a comma outside brackets; 0 if it is none. */
static size_t name_length(const char *names) {
  static const char plain[] = "abcdefghijklmnopqrstuvwxyz0123456789_-./:";
  size_t length = strspn(names, plain);
  if (length == 0)
    return 0;
  if (names[length - 1] == ':')
    return 0;
  if (names[length] == '[') {
    size_t states = strspn(names + length + 1, "abcdefghijklmnopqrstuvwxyz0123456789_=,");
    if (states == 0 || names[length + 1 + states] != ']')
      return 0;
    length += states + 2;
  }
  return names[length] == '\0' || names[length] == ',' ? length : 0;
}

static bool has_namespace(const char *name, size_t length) {
  size_t plain = strcspn(name, "[,");
  return memchr(name, ':', plain < length ? plain : length);
}

vxm_status vxm_blocks_check_names(const char *names, vxm_error *error) {
  static const char domain[] = "minecraft:";
  size_t count = 0;
  if (!names)
    return VXM_OK;
  for (const char *at = names;; at++) {
    size_t length = name_length(at);
    if (length == 0 || length + sizeof domain > VXM_BLOCK_NAME_MOST)
      return vxm_fail(error, VXM_ERROR_ARGUMENT,
                      "blocks: \"%.60s\" does not begin with the name of a block, such as oak_planks, "
                      "minecraft:stone or oak_log[axis=y]",
                      at);
    if (++count > VXM_BLOCK_CHOICES_MOST)
      return vxm_fail(error, VXM_ERROR_ARGUMENT, "blocks: more than %d names", VXM_BLOCK_CHOICES_MOST);
    at += length;
    if (*at == '\0')
      return VXM_OK;
  }
}

/** Adds a name, unless it is there already; *out is its number. */
static vxm_status add_name(size_t *out, vxm_blocks *blocks, const char *name, size_t length,
                           vxm_error *error) {
  vxm_block_name full = {.label = 0};
  snprintf(full.text, sizeof full.text, "%s%.*s",
           has_namespace(name, length) ? "" : "minecraft:", (int)length, name);
  for (*out = 0; *out < blocks->count; ++*out)
    if (strcmp(blocks->names[*out].text, full.text) == 0)
      return VXM_OK;
  vxm_status status = vxm_grow(blocks->field->context, (void **)&blocks->names, &blocks->capacity,
                               blocks->count + 1, sizeof *blocks->names, error);
  if (status == VXM_OK)
    blocks->names[blocks->count++] = full;
  return status;
}

/** The name at a number of the list, which is walked again and again from its beginning. */
static const char *choice_at(const char *names, size_t index, size_t *length) {
  for (;; index--) {
    *length = name_length(names);
    if (index == 0)
      return names;
    names += *length + 1;
  }
}

static size_t count_choices(const char *names) {
  size_t count = 1;
  while (*(names += name_length(names)) == ',') {
    names++;
    count++;
  }
  return count;
}

/* ---- Making ---- */

static vxm_status check_space(const vxm_space *space, const char *path, const char *format, int64_t side_max,
                              vxm_error *error) {
  const vxm_place place = {path, 0, -1, -1};
  uint64_t count = (uint64_t)space->dims[0] * (uint64_t)space->dims[1] * (uint64_t)space->dims[2];
  for (int a = 0; a < 3; a++)
    if (space->dims[a] > side_max)
      return vxm_fail_at(error, VXM_ERROR_RANGE, place,
                         "%s holds up to %" PRId64 " blocks along an axis, not %" PRId64
                         "; lower the resolution",
                         format, side_max, space->dims[a]);
  if (count > INT32_MAX)
    return vxm_fail_at(error, VXM_ERROR_RANGE, place,
                       "%s holds up to %d blocks, not %" PRIu64 "; lower the resolution", format, INT32_MAX,
                       count);
  return VXM_OK;
}

static vxm_status check_values(const vxm_field *field, const char *path, vxm_error *error) {
  vxm_field_range range = VXM_FIELD_RANGE_INIT;
  vxm_field_kind kind = field->about.kind;
  if (kind == VXM_FIELD_COLORS)
    return VXM_OK;
  if ((kind != VXM_FIELD_LABELS && kind != VXM_FIELD_NUMBERS) || vxm_scalar_is_float(field->scalar))
    return vxm_field_refuse(field, path, VXM_ERROR_ARGUMENT,
                            "cannot become blocks, which stand for labels or colours; choose a threshold",
                            error);
  vxm_status status = vxm_field_measure(&range, field, error);
  if (status == VXM_OK && (range.min < 0 || range.max > UINT16_MAX))
    status =
        vxm_field_refuse(field, path, VXM_ERROR_RANGE,
                         "has numbers beyond 0 to 65535, which are the labels that blocks can have; choose a "
                         "threshold, or .npy or .nrrd",
                         error);
  return status;
}

vxm_status vxm_blocks_check_field(const vxm_field *field, const char *path, const char *format,
                                  int64_t side_max, vxm_error *error) {
  vxm_status status = check_values(field, path, error);
  return status == VXM_OK ? check_space(&field->space, path, format, side_max, error) : status;
}

/** Bits lie in a field as numbers 0 and 1 of which nothing is said. */
static vxm_field_kind kind_of(const vxm_field *field, const vxm_field_range *range) {
  if (field->channels == 4)
    return VXM_FIELD_COLORS;
  return field->about.kind == VXM_FIELD_NUMBERS && range->max <= 1 ? VXM_FIELD_NUMBERS : VXM_FIELD_LABELS;
}

/** Blocks for the labels 1 to `most`, in turn. */
static vxm_status number_labels(vxm_blocks *out, size_t most, const char *names, vxm_error *error) {
  size_t colors, choices = names ? count_choices(names) : VXM_BLOCK_DYED, length = 0, number = 0;
  const vxm_block_color *table = vxm_block_colors(&colors);
  vxm_status status = VXM_OK;
  for (size_t label = 1; label <= most && status == VXM_OK; label++) {
    if (label > choices) {
      out->numbers[label] = out->numbers[label - choices];
      continue;
    }
    const char *name = names ? choice_at(names, label - 1, &length) : table[label - 1].name;
    status = add_name(&number, out, name, names ? length : strlen(name), error);
    if (status == VXM_OK && number == 0)
      status = vxm_fail(error, VXM_ERROR_ARGUMENT, "blocks: what is set cannot be air");
    if (status == VXM_OK && out->names[number].label == 0)
      out->names[number].label = (uint16_t)label;
    out->numbers[label] = (uint16_t)number;
  }
  return status;
}

static vxm_status choose_labels(vxm_blocks *out, const char *names, const vxm_field_range *range,
                                vxm_error *error) {
  size_t most = range->max > 0 ? (size_t)range->max : 0;
  out->numbers = vxm_calloc(out->field->context, most + 2, sizeof *out->numbers, error);
  if (!out->numbers)
    return error->code;
  if (out->kind == VXM_FIELD_NUMBERS)
    return number_labels(out, 1, names ? names : "stone", error);
  return number_labels(out, most, names, error);
}

/** Only what is named is taken, and only what has a colour. */
static vxm_status bar_others(const vxm_blocks *blocks, vxm_block_matcher *matcher, vxm_error *error) {
  size_t count, found = 0;
  const vxm_block_color *table = vxm_block_colors(&count);
  for (size_t b = 0; b < count; b++)
    matcher->barred[b] = true;
  for (size_t n = 1; n < blocks->count; n++) {
    for (found = 0; found < count && strcmp(table[found].name, blocks->names[n].text) != 0;)
      found++;
    if (found == count)
      return vxm_fail(
          error, VXM_ERROR_ARGUMENT,
          "blocks: the colour of %s is not known: colours become concrete, wool, terracotta and other plain "
          "cubes",
          blocks->names[n].text);
    matcher->barred[found] = false;
  }
  return VXM_OK;
}

/** The blocks that may occur: those that are named, or all whose colours are known. */
static vxm_status add_colored(vxm_blocks *out, vxm_error *error) {
  const char *names = out->field->style.blocks;
  size_t count, length = 0, number;
  const vxm_block_color *table = vxm_block_colors(&count);
  vxm_status status = VXM_OK;
  count = names ? count_choices(names) : count;
  for (size_t b = 0; b < count && status == VXM_OK; b++) {
    const char *name = names ? choice_at(names, b, &length) : table[b].name;
    status = add_name(&number, out, name, names ? length : strlen(name), error);
  }
  return status;
}

/** The numbers of the blocks of the table. */
static void number_colored(uint16_t numbers[VXM_BLOCK_COLORS_MOST], const vxm_blocks *blocks) {
  size_t count;
  const vxm_block_color *table = vxm_block_colors(&count);
  for (size_t n = 1; n < blocks->count; n++)
    for (size_t b = 0; b < count; b++)
      if (strcmp(table[b].name, blocks->names[n].text) == 0)
        numbers[b] = (uint16_t)n;
}

static vxm_status match_colors(vxm_blocks *out, vxm_block_matcher *matcher, vxm_error *error) {
  const vxm_field *field = out->field;
  uint16_t numbers[VXM_BLOCK_COLORS_MOST] = {0};
  size_t voxels = vxm_field_count(field);
  vxm_status status = add_colored(out, error);
  vxm_block_matcher_init(matcher);
  if (status == VXM_OK && field->style.blocks)
    status = bar_others(out, matcher, error);
  number_colored(numbers, out);
  for (size_t v = 0; v < voxels && status == VXM_OK; v++) {
    const uint8_t *rgba = field->values + 4 * v;
    out->ids[v] = rgba[3] ? numbers[vxm_block_match(matcher, rgba)] : 0;
    status = vxm_check_cancelled_at(v, field->context, error);
  }
  return status;
}

static vxm_status choose_colors(vxm_blocks *out, vxm_error *error) {
  vxm_context *context = out->field->context;
  out->ids = vxm_alloc(context, vxm_field_count(out->field), sizeof *out->ids, error);
  vxm_block_matcher *matcher = out->ids ? vxm_alloc(context, 1, sizeof *matcher, error) : NULL;
  vxm_status status = matcher ? match_colors(out, matcher, error) : error->code;
  vxm_free(context, matcher);
  return status;
}

static void destroy_blocks(vxm_blocks *blocks) {
  vxm_context *context = blocks->field->context;
  vxm_free(context, blocks->names);
  vxm_free(context, blocks->numbers);
  vxm_free(context, blocks->ids);
  blocks->names = NULL;
  blocks->numbers = blocks->ids = NULL;
}

/**
 * Chooses the blocks of a field that has been checked, with the names and the axis of its style: bits take
 * the first name, or stone; labels the names in turn, or the dyed blocks; colours the nearest block. The
 * field is used, not copied.
 */
static vxm_status make_blocks(vxm_blocks *out, const vxm_field *field, vxm_error *error) {
  vxm_field_range range = VXM_FIELD_RANGE_INIT;
  vxm_error local = VXM_ERROR_INIT;
  size_t air;
  *out = (vxm_blocks){.field = field, .axes = vxm_y_up_of(field->style.up)};
  for (int a = 0; a < 3; a++)
    out->size[a] = field->space.dims[out->axes.of[a]];
  vxm_status status = vxm_blocks_check_names(field->style.blocks, &local);
  if (status == VXM_OK)
    status = vxm_field_measure(&range, field, &local);
  if (status == VXM_OK)
    status = add_name(&air, out, "air", 3, &local);
  if (status == VXM_OK) {
    out->kind = kind_of(field, &range);
    status = out->kind == VXM_FIELD_COLORS ? choose_colors(out, &local)
                                           : choose_labels(out, field->style.blocks, &range, &local);
  }
  if (status != VXM_OK) {
    destroy_blocks(out);
    vxm_error_pass(error, &local);
  }
  return status;
}

vxm_status vxm_blocks_write(vxm_output *output, const vxm_field *field,
                            vxm_status (*put_tree)(vxm_nbt_writer *writer, const vxm_blocks *blocks,
                                                   uint16_t *row, vxm_error *error),
                            vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  vxm_nbt_writer *writer = NULL;
  vxm_blocks blocks;
  vxm_status status = make_blocks(&blocks, field, error);
  if (status != VXM_OK)
    return status;
  uint16_t *row = vxm_alloc(field->context, (size_t)blocks.size[0], sizeof *row, &local);
  status = row ? vxm_nbt_open(&writer, field->context, output, &local) : local.code;
  if (status == VXM_OK)
    status = put_tree(writer, &blocks, row, &local);
  vxm_nbt_close(writer);
  vxm_free(field->context, row);
  destroy_blocks(&blocks);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/* ---- Using ---- */

static uint16_t block_at(const vxm_blocks *blocks, const int64_t at[3]) {
  const vxm_field *field = blocks->field;
  const int64_t *n = field->space.dims;
  size_t voxel = (size_t)((at[0] * n[1] + at[1]) * n[2] + at[2]);
  return blocks->ids ? blocks->ids[voxel] : blocks->numbers[vxm_field_label(field, voxel)];
}

void vxm_blocks_row(uint16_t *out, const vxm_blocks *blocks, int64_t y, int64_t z) {
  int64_t block[3] = {0, y, z}, voxel[3];
  for (; block[0] < blocks->size[0]; block[0]++) {
    vxm_y_up_to_voxel(voxel, &blocks->axes, blocks->field->space.dims, block);
    out[block[0]] = block_at(blocks, voxel);
  }
}

int64_t vxm_blocks_count(const vxm_blocks *blocks) {
  const vxm_field *field = blocks->field;
  size_t voxels = vxm_field_count(field);
  int64_t count = 0;
  for (size_t v = 0; v < voxels; v++)
    count += blocks->ids ? blocks->ids[v] != 0 : vxm_field_label(field, v) != 0;
  return count;
}

/** The label that each block stands for, and the names of labels. */
static void put_labels(vxm_nbt_writer *writer, const vxm_blocks *blocks) {
  const vxm_label_table *table = &blocks->field->about.table;
  vxm_nbt_tag(writer, VXM_NBT_COMPOUND, "LabelOfBlock");
  for (size_t b = 1; b < blocks->count; b++)
    vxm_nbt_integer(writer, VXM_NBT_INT, blocks->names[b].text, blocks->names[b].label);
  vxm_nbt_end(writer);
  if (table->count == 0)
    return;
  vxm_nbt_list(writer, "Labels", VXM_NBT_STRING, table->count);
  for (size_t label = 1; label <= table->count; label++)
    vxm_nbt_text(writer, vxm_label_table_name(table, label));
}

void vxm_blocks_put_metadata(vxm_nbt_writer *writer, const vxm_blocks *blocks) {
  vxm_nbt_tag(writer, VXM_NBT_COMPOUND, "voxmend");
  vxm_nbt_string(writer, "Values",
                 blocks->kind == VXM_FIELD_NUMBERS ? "bits" : vxm_field_kind_name(blocks->kind));
  vxm_nbt_integer(writer, VXM_NBT_BYTE, "Up", blocks->axes.up);
  vxm_nbt_triple(writer, "Origin", blocks->field->space.origin);
  vxm_nbt_triple(writer, "VoxelSize", blocks->field->space.voxel_size);
  if (blocks->kind == VXM_FIELD_LABELS)
    put_labels(writer, blocks);
  vxm_nbt_end(writer);
}

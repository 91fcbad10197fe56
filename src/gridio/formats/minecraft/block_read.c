/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/minecraft/block_read.h"
#include "gridio/common/format.h"
#include "gridio/formats/minecraft/block_colors.h"
#include "gridio/formats/minecraft/block_file.h"

#include <string.h>

/* ---- The file ---- */

/** Blocks of a box: regions far apart ask for more than their bytes are worth. */
static const uint64_t blocks_most = UINT64_C(1) << 30;

vxm_status vxm_block_file_make(vxm_block_file *file, const vxm_input *input, bool wants_ids,
                               vxm_error *error) {
  const vxm_space space = {{file->size[0], file->size[1], file->size[2]}, {0, 0, 0}, {1, 1, 1}};
  vxm_status status = vxm_space_check_file(&space, input, 0, error);
  if (status == VXM_OK && vxm_space_voxels(&space) > blocks_most)
    status = vxm_fail_at(error, VXM_ERROR_RANGE, (vxm_place){input->name, 0, -1, -1},
                         "the regions stand so far apart that a grid of all has more than 2^30 blocks");
  if (status != VXM_OK || !wants_ids)
    return status;
  file->ids =
      vxm_try_calloc(file->context, (size_t)vxm_space_voxels(&space), sizeof *file->ids, &status, error);
  return status;
}

void vxm_block_file_destroy(vxm_block_file *file) {
  vxm_free(file->context, file->ids);
  vxm_block_list_destroy(&file->list);
}

/** A file with its tree. */
typedef struct loaded {
  vxm_nbt tree;
  vxm_block_file file;
  vxm_y_up axes;
  vxm_space space;
  const char *values; /**< what voxmend wrote: a kind of fields, or "bits"; "" if it did not */
} loaded;

static void unload(loaded *l) {
  vxm_block_file_destroy(&l->file);
  vxm_nbt_destroy(&l->tree);
}

/** Voxels of 1 at the places of the blocks, y becoming z, unless voxmend has written where they lie. */
static vxm_status find_space(loaded *l, const vxm_input *input, vxm_error *error) {
  int64_t up = 2;
  const vxm_block_file *file = &l->file;
  double numbers[6];
  bool is_own = file->is_own && vxm_nbt_find_integer(&up, &file->own, "Up") && up >= 0 && up <= 2 &&
                vxm_nbt_find_triple(numbers, &file->own, "Origin") &&
                vxm_nbt_find_triple(numbers + 3, &file->own, "VoxelSize");
  l->axes = vxm_y_up_of(is_own ? (int)up + 1 : 0);
  for (int a = 0; a < 3; a++) {
    int of = l->axes.of[a];
    l->space.dims[of] = file->size[a];
    l->space.origin[of] = (double)(l->axes.back[a] ? -file->corner[a] - file->size[a] : file->corner[a]);
    l->space.voxel_size[of] = 1;
  }
  if (is_own) {
    memcpy(l->space.origin, numbers, 3 * sizeof *numbers);
    memcpy(l->space.voxel_size, numbers + 3, 3 * sizeof *numbers);
  }
  return vxm_space_check_file(&l->space, input, 0, error);
}

static void find_values(loaded *l) {
  static const char *const kinds[] = {"bits", "labels", "colors"};
  vxm_nbt_value value;
  size_t size;
  l->values = "";
  if (!l->file.is_own || !vxm_nbt_find(&value, &l->file.own, "Values", VXM_NBT_STRING))
    return;
  const char *text = vxm_nbt_string_of(&value, &size);
  for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++)
    if (strlen(kinds[k]) == size && memcmp(kinds[k], text, size) == 0)
      l->values = kinds[k];
}

static vxm_status load(loaded *l, const vxm_input *input, bool wants_ids, vxm_error *error) {
  vxm_nbt_value regions;
  *l = (loaded){.file = {.context = input->context, .list = {.context = input->context}}};
  vxm_status status = vxm_nbt_load(&l->tree, input, error);
  if (status == VXM_OK)
    status = vxm_nbt_find(&regions, &l->tree.root, "Regions", VXM_NBT_COMPOUND)
                 ? vxm_litematic_load(&l->file, &l->tree, input, wants_ids, error)
                 : vxm_schem_load(&l->file, &l->tree, input, wants_ids, error);
  if (status == VXM_OK)
    status = find_space(l, input, error);
  if (status == VXM_OK)
    find_values(l);
  else
    unload(l);
  return status;
}

/* ---- Bits ---- */

/** Kinds of blocks that occur, air not counted; at most 2. */
static int count_kinds(const vxm_block_file *file) {
  size_t count = (size_t)(file->size[0] * file->size[1] * file->size[2]);
  uint16_t first = 0;
  for (size_t b = 0; b < count; b++) {
    if (file->ids[b] == 0 || file->ids[b] == first)
      continue;
    if (first != 0)
      return 2;
    first = file->ids[b];
  }
  return first != 0;
}

static void fill_bits(vxm_grid *grid, const loaded *l) {
  const vxm_block_file *file = &l->file;
  const uint16_t *id = file->ids;
  int64_t block[3], voxel[3];
  for (block[1] = 0; block[1] < file->size[1]; block[1]++)
    for (block[2] = 0; block[2] < file->size[2]; block[2]++)
      for (block[0] = 0; block[0] < file->size[0]; block[0]++, id++) {
        if (*id == 0)
          continue;
        vxm_y_up_to_voxel(voxel, &l->axes, l->space.dims, block);
        vxm_grid_row(grid, voxel[1], voxel[2])[voxel[0] / 64] |= UINT64_C(1) << (voxel[0] % 64);
      }
}

vxm_status vxm_block_read_bits(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  loaded l;
  vxm_grid *grid = NULL;
  vxm_status status = load(&l, input, rule != VXM_BITS_NONE, error);
  if (status != VXM_OK)
    return status;
  bool are_values = *l.values && strcmp(l.values, "bits") != 0;
  if (rule != VXM_BITS_NONE && (are_values || count_kinds(&l.file) > 1))
    status = vxm_fail_numbers(error, input->name, strcmp(l.values, "colors") == 0 ? "colors" : "labels");
  if (status == VXM_OK)
    status = vxm_grid_create(&grid, input->context, &l.space, error);
  if (status == VXM_OK && rule != VXM_BITS_NONE) {
    fill_bits(grid, &l);
    status = vxm_progress(input->context, "reading", 1, error);
  }
  unload(&l);
  if (status != VXM_OK) {
    vxm_grid_destroy(grid);
    return status;
  }
  *out = grid;
  return VXM_OK;
}

/* ---- Labels and colours ---- */

typedef void (*put_fn)(vxm_field *field, size_t voxel, uint16_t id, const void *payload);

static void for_blocks(vxm_field *field, const loaded *l, put_fn put, const void *payload) {
  const vxm_block_file *file = &l->file;
  const int64_t *n = l->space.dims;
  const uint16_t *id = file->ids;
  int64_t block[3], voxel[3];
  for (block[1] = 0; block[1] < file->size[1]; block[1]++)
    for (block[2] = 0; block[2] < file->size[2]; block[2]++)
      for (block[0] = 0; block[0] < file->size[0]; block[0]++, id++) {
        vxm_y_up_to_voxel(voxel, &l->axes, n, block);
        put(field, (size_t)((voxel[0] * n[1] + voxel[1]) * n[2] + voxel[2]), *id, payload);
      }
}

static void put_label(vxm_field *field, size_t voxel, uint16_t id, const void *payload) {
  const uint16_t *label = payload;
  memcpy(field->values + 2 * voxel, &label[id], 2);
}

static void put_color(vxm_field *field, size_t voxel, uint16_t id, const void *payload) {
  memcpy(field->values + 4 * voxel, (const uint8_t *)payload + 4 * (size_t)id, 4);
}

/** The labels that voxmend wrote. Blocks that it did not write, as after the file was edited, come behind. */
static vxm_status own_labels(uint16_t *label, loaded *l, vxm_error *error) {
  vxm_block_list *list = &l->file.list;
  vxm_nbt_value labels, value;
  const char *name;
  size_t size, most = 0;
  vxm_status status = VXM_OK;
  if (vxm_nbt_find(&labels, &l->file.own, "LabelOfBlock", VXM_NBT_COMPOUND))
    for (const unsigned char *at = labels.at;
         status == VXM_OK && vxm_nbt_next(&at, &labels, &name, &size, &value);) {
      int64_t number = vxm_nbt_integer_of(&value);
      uint32_t block = 0;
      if (number < 1 || number > UINT16_MAX)
        continue;
      status = vxm_block_list_add(&block, list, name, size, error);
      if (status == VXM_OK && block != 0)
        label[block] = (uint16_t)number;
    }
  for (size_t b = 1; b < list->count; b++)
    most = label[b] > most ? label[b] : most;
  for (size_t b = 1; b < list->count; b++)
    if (label[b] == 0)
      label[b] = (uint16_t)(most < UINT16_MAX ? ++most : most);
  return status;
}

/** Voxels of each label. */
static void count_labels(int64_t *voxels, const loaded *l, const uint16_t *label) {
  const vxm_block_file *file = &l->file;
  size_t count = (size_t)(file->size[0] * file->size[1] * file->size[2]);
  for (size_t b = 0; b < count; b++)
    voxels[label[file->ids[b]]]++;
}

static bool add_name(vxm_about *about, vxm_context *context, const char *name, int64_t voxels) {
  if (!vxm_label_table_add(&about->table, context, name, voxels))
    about->starved = true;
  return !about->starved;
}

/** The names that voxmend wrote. */
static void name_own(vxm_about *about, const loaded *l, const int64_t *voxels) {
  vxm_nbt_value names, value;
  const unsigned char *at = NULL;
  if (!vxm_nbt_find(&names, &l->file.own, "Labels", VXM_NBT_LIST) || vxm_nbt_count(&names) > VXM_LABELS_MAX)
    return;
  for (size_t label = 1; vxm_nbt_next_item(&at, &names, &value); label++) {
    char text[512];
    size_t size;
    if (value.type != VXM_NBT_STRING)
      return;
    const char *name = vxm_nbt_string_of(&value, &size);
    size = size < sizeof text ? size : sizeof text - 1;
    memcpy(text, name, size);
    text[size] = '\0';
    if (!add_name(about, l->file.context, text, voxels[label]))
      return;
  }
}

/** The names of the blocks that occur, in the order of the file; label[] takes their numbers. */
static void name_blocks(vxm_about *about, const loaded *l, uint16_t *label, int64_t *voxels) {
  const vxm_block_list *list = &l->file.list;
  uint16_t next = 0;
  for (size_t b = 0; b < list->count; b++)
    label[b] = (uint16_t)b;
  count_labels(voxels, l, label);
  for (size_t b = 1; b < list->count; b++) {
    label[b] = 0;
    if (voxels[b] == 0)
      continue;
    if (!add_name(about, l->file.context, list->text + list->begin[b], voxels[b]))
      return;
    label[b] = ++next;
  }
}

static vxm_status read_labels(vxm_field **out, loaded *l, vxm_error *error) {
  enum { LABELS = UINT16_MAX + 1 };
  vxm_context *context = l->file.context;
  vxm_about about = {.is_declared = true, .kind = VXM_FIELD_LABELS};
  vxm_error local = VXM_ERROR_INIT;
  uint16_t *label = vxm_calloc(context, LABELS, sizeof *label, &local);
  int64_t *voxels = label ? vxm_calloc(context, LABELS, sizeof *voxels, &local) : NULL;
  vxm_status status = local.code;
  bool is_own = strcmp(l->values, "labels") == 0;
  if (status == VXM_OK && is_own)
    status = own_labels(label, l, &local);
  if (status == VXM_OK)
    status = vxm_field_make(out, context, &l->space, VXM_FIELD_LABELS, VXM_UINT16, &local);
  if (status == VXM_OK) {
    if (is_own) {
      count_labels(voxels, l, label);
      name_own(&about, l, voxels);
    } else
      name_blocks(&about, l, label, voxels);
    for_blocks(*out, l, put_label, label);
    vxm_field_describe(*out, &about);
  }
  vxm_free(context, voxels);
  vxm_free(context, label);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

/** Blocks that are none of the table, as after the file was edited, are grey. */
static void find_colors(uint8_t *rgba, const vxm_block_list *list) {
  size_t count;
  const vxm_block_color *table = vxm_block_colors(&count);
  for (size_t n = 1; n < list->count; n++) {
    const char *name = list->text + list->begin[n];
    memcpy(rgba + 4 * n, (const uint8_t[4]){128, 128, 128, 255}, 4);
    for (size_t b = 0; b < count; b++)
      if (strcmp(table[b].name, name) == 0)
        memcpy(rgba + 4 * n, table[b].rgb, 3);
  }
}

static vxm_status read_colors(vxm_field **out, const loaded *l, vxm_error *error) {
  vxm_context *context = l->file.context;
  vxm_about about = {.is_declared = true, .kind = VXM_FIELD_COLORS};
  vxm_error local = VXM_ERROR_INIT;
  uint8_t *rgba = vxm_calloc(context, l->file.list.count + 1, 4, &local);
  vxm_status status = local.code;
  if (status == VXM_OK)
    status = vxm_field_make(out, context, &l->space, VXM_FIELD_COLORS, VXM_UINT8, &local);
  if (status == VXM_OK) {
    find_colors(rgba, &l->file.list);
    for_blocks(*out, l, put_color, rgba);
    vxm_field_describe(*out, &about);
  }
  vxm_free(context, rgba);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_block_read_field(vxm_field **out, const vxm_input *input, vxm_error *error) {
  loaded l;
  vxm_field *field = NULL;
  vxm_status status = load(&l, input, true, error);
  if (status != VXM_OK)
    return status;
  status = strcmp(l.values, "colors") == 0 ? read_colors(&field, &l, error) : read_labels(&field, &l, error);
  unload(&l);
  if (status != VXM_OK)
    return status;
  return vxm_field_hand_over(out, field, vxm_progress(input->context, "reading", 1, error), error);
}

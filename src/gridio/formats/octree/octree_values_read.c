/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/endian.h"
#include "grid/crop.h"
#include "gridio/common/values_crop.h"
#include "gridio/formats/octree/octree_values.h"

#include <inttypes.h>

/* ---- The header ---- */

/** As vxm_octree_each_block; a single tile is not in the index. */
static uint64_t each_block(const vxm_sparse_file *file, const int64_t begin[3], const int64_t end[3],
                           vxm_octree_block_fn function, void *payload) {
  static const int64_t origin[3] = {0, 0, 0};
  if (file->tile_level < file->levels - 1)
    return vxm_octree_each_block(file->nodes, file->levels, begin, end, function, payload);
  if (vxm_octree_file_tile_voxels(file, 0) == 0)
    return 0;
  function(0, origin, payload);
  return 1;
}

static bool skip(uint64_t number, const int64_t at[3], void *payload) {
  (void)number;
  (void)at;
  (void)payload;
  return true;
}

/** A text of at most `size` bytes, which ends in zeros. */
static bool take_text(char out[16], const unsigned char *at, size_t size) {
  size_t length = strnlen((const char *)at, size);
  if (length == size)
    return false;
  memcpy(out, at, length + 1);
  for (size_t b = length; b < size; b++)
    if (at[b])
      return false;
  return true;
}

static vxm_status check_blocks(const vxm_sparse_file *file, vxm_error *error) {
  const vxm_input *input = &file->input;
  uint64_t last = 0, first = file->values + VXM_OCTREE_VALUES_HEADER + 8 * (file->block_count + 1);
  for (uint64_t b = 0; b <= file->block_count; b++) {
    const unsigned char *at = file->blocks + 8 * b;
    uint64_t offset = vxm_load_le64(at);
    bool fits = b == 0 ? offset == first : offset > last;
    if (!fits || offset > input->size || (b == file->block_count && offset != input->size))
      return vxm_fail_byte(error, input, at - input->data,
                           "the values of block %" PRIu64 " begin at byte %" PRIu64
                           ", where none can: the file is damaged or cut short",
                           b, offset);
    last = offset;
  }
  return VXM_OK;
}

vxm_status vxm_octree_values_open(vxm_sparse_file *file, vxm_error *error) {
  const vxm_input *input = &file->input;
  const int64_t origin[3] = {0, 0, 0};
  char kind[16], scalar[16];
  if (input->size - file->values < VXM_OCTREE_VALUES_HEADER)
    return vxm_fail_byte(error, input, file->values, "the file ends before its values: it is cut short");
  const unsigned char *data = input->data + file->values;
  uint64_t channels = vxm_load_le64(data + 24);
  if (!take_text(kind, data, 16) || !take_text(scalar, data + 16, 8) ||
      (kind[0] && !vxm_field_kind_find(&file->kind, kind)) || !vxm_scalar_find(&file->scalar, scalar) ||
      channels != (file->kind == VXM_FIELD_COLORS ? 4 : 1) || (channels == 4 && file->scalar != VXM_UINT8) ||
      vxm_load_le64(data + 48) != 0)
    return vxm_fail_byte(error, input, file->values, "the octree has values that this version cannot read");
  file->channels = (int)channels;
  size_t bytes = vxm_scalar_bytes(file->scalar) * (size_t)channels;
  vxm_octree_copy_value(file->background, data + VXM_OCTREE_BACKGROUND, bytes, file->channels);
  file->block_count = vxm_load_le64(data + 40);
  file->blocks = data + VXM_OCTREE_VALUES_HEADER;
  uint64_t expected = each_block(file, origin, origin, skip, NULL);
  uint64_t room = (input->size - file->values - VXM_OCTREE_VALUES_HEADER) / 8;
  if (file->block_count != expected || room == 0 || file->block_count > room - 1)
    return vxm_fail_byte(error, input, file->values + 40,
                         "the values are not those of the octree's %" PRIu64 " blocks: the file is damaged",
                         expected);
  return check_blocks(file, error);
}

vxm_status vxm_octree_file_need_bits(const vxm_sparse_file *file, vxm_error *error) {
  if (file->values == 0)
    return VXM_OK;
  return vxm_fail_numbers(error, file->name, file->channels == 4 ? "colors" : vxm_scalar_name(file->scalar));
}

/* ---- Values ---- */

typedef struct decoder {
  const vxm_sparse_file *file;
  const vxm_sparse *tree;
  const int64_t *begin, *end;
  vxm_field *field; /**< NULL = the values are only visited */
  vxm_octree_found_fn found;
  void *payload;
  size_t bytes;              /**< of a value */
  const unsigned char *at;   /**< still to be read */
  const unsigned char *stop; /**< where the block ends */
  vxm_status status;
  vxm_error *error;
} decoder;

static void fail(decoder *d, const char *what) {
  if (d->status == VXM_OK)
    d->status = vxm_fail_byte(d->error, &d->file->input, d->at - d->file->input.data,
                              "%s: the file is damaged", what);
}

/** The next bytes, or NULL. */
static const unsigned char *take(decoder *d, size_t size) {
  const unsigned char *data = d->at;
  if (d->status != VXM_OK || size > (size_t)(d->stop - d->at)) {
    fail(d, "the values of a block end before it does");
    return NULL;
  }
  d->at += size;
  return data;
}

static unsigned char *place_of(const decoder *d, int64_t x, int64_t y, int64_t z) {
  const int64_t *n = d->field->space.dims;
  size_t voxel = (size_t)(((x - d->begin[0]) * n[1] + (y - d->begin[1])) * n[2] + (z - d->begin[2]));
  return d->field->values + voxel * d->bytes;
}

static void put(const decoder *d, const int64_t brick[3], int bit, const unsigned char *value) {
  if (!d->field)
    return;
  const int64_t at[3] = {brick[0] + bit % 4, brick[1] + bit / 4 % 4, brick[2] + bit / 16};
  for (int a = 0; a < 3; a++)
    if (at[a] < d->begin[a] || at[a] >= d->end[a])
      return;
  vxm_octree_copy_value(place_of(d, at[0], at[1], at[2]), value, d->bytes, d->field->channels);
}

static void fill_cube(const decoder *d, const int64_t at[3], int64_t side, const unsigned char *value) {
  int64_t low[3], high[3];
  for (int a = 0; a < 3; a++) {
    low[a] = vxm_max(at[a], d->begin[a]);
    high[a] = vxm_min(at[a] + side, d->end[a]);
  }
  for (int64_t x = low[0]; x < high[0]; x++)
    for (int64_t y = low[1]; y < high[1]; y++)
      for (int64_t z = low[2]; z < high[2]; z++)
        vxm_octree_copy_value(place_of(d, x, y, z), value, d->bytes, d->field->channels);
}

/** A brick is a part of level -1. */
static int64_t side_of(int level) {
  return level < 0 ? 4 : vxm_octree_side(level + 1);
}

static uint64_t bits_of(const decoder *d, vxm_octree_part brick) {
  return brick.kind == VXM_OCTREE_MIXED ? d->tree->bricks[brick.index] : ~UINT64_C(0);
}

/** Gives all voxels of a part one value. */
static void fill(const decoder *d, int level, vxm_octree_part part, const int64_t at[3],
                 const unsigned char *value) {
  if (!d->field || !vxm_cube_meets(at, side_of(level), d->begin, d->end))
    return;
  if (part.kind == VXM_OCTREE_FULL) {
    fill_cube(d, at, side_of(level), value);
    return;
  }
  if (level < 0) {
    for (uint64_t left = bits_of(d, part); left; left &= left - 1)
      put(d, at, __builtin_ctzll(left), value);
    return;
  }
  for (uint64_t left = vxm_octree_children(d->tree, level, part); left; left &= left - 1) {
    unsigned child = (unsigned)__builtin_ctzll(left);
    int64_t place[3];
    vxm_octree_child_at(place, at, child, vxm_octree_side(level));
    fill(d, level - 1, vxm_octree_child_part(d->tree, level, part, child), place, value);
  }
}

/** The next value, which is not the background. */
static const unsigned char *take_value(decoder *d) {
  const unsigned char *value = take(d, d->bytes);
  if (value && memcmp(value, d->file->input.data + d->file->values + VXM_OCTREE_BACKGROUND, d->bytes) == 0)
    fail(d, "a value is the background");
  return value;
}

/** Values of a brick's voxels, which are not all alike. */
static void decode_brick(decoder *d, vxm_octree_part brick, const int64_t at[3]) {
  uint64_t bits = bits_of(d, brick);
  const unsigned char *first = d->at;
  bool alike = true;
  for (uint64_t left = bits; left && d->status == VXM_OK; left &= left - 1) {
    const unsigned char *value = take_value(d);
    if (!value)
      return;
    alike &= memcmp(first, value, d->bytes) == 0;
    put(d, at, __builtin_ctzll(left), value);
  }
  if (alike)
    fail(d, "the values of a brick are one");
}

/** @return the one value of a part, or NULL */
static const unsigned char *decode(decoder *d, int level, vxm_octree_part part, const int64_t at[3]) {
  const unsigned char *how = take(d, 1), *value = NULL;
  if (!how)
    return NULL;
  if (d->found && (level == 0 || (level > 0 && *how == 1)))
    d->found(level, at, how, d->payload);
  if (*how == 1) {
    value = take_value(d);
    if (value)
      fill(d, level, part, at, value);
    return value;
  }
  if (*how != 0) {
    fail(d, "values are neither one nor several");
    return NULL;
  }
  if (level < 0) {
    decode_brick(d, part, at);
    return NULL;
  }
  bool alike = true, is_first = true;
  for (uint64_t left = vxm_octree_children(d->tree, level, part); left && d->status == VXM_OK;
       left &= left - 1) {
    unsigned child = (unsigned)__builtin_ctzll(left);
    int64_t place[3];
    vxm_octree_child_at(place, at, child, vxm_octree_side(level));
    const unsigned char *other =
        decode(d, level - 1, vxm_octree_child_part(d->tree, level, part, child), place);
    value = is_first ? other : value;
    alike &= value && other && memcmp(value, other, d->bytes) == 0;
    is_first = false;
  }
  if (alike)
    fail(d, "the values of a node are one");
  return NULL;
}

static bool decode_block(uint64_t number, const int64_t at[3], void *payload) {
  decoder *d = payload;
  int level = d->file->tile_level;
  const unsigned char *data = d->file->input.data, *ends = d->file->blocks + 8 * number;
  d->at = data + vxm_load_le64(ends);
  d->stop = data + vxm_load_le64(ends + 8);
  decode(d, level, vxm_octree_part_at(d->tree, level, at), at);
  if (d->at != d->stop)
    fail(d, "the values of a block end before its bytes do");
  return d->status == VXM_OK;
}

vxm_status vxm_octree_values_visit(const vxm_sparse_file *file, const vxm_sparse *tree,
                                   vxm_octree_found_fn found, void *payload, vxm_error *error) {
  static const int64_t origin[3] = {0, 0, 0};
  decoder d = {.file = file,
               .tree = tree,
               .begin = origin,
               .end = file->space.dims,
               .found = found,
               .payload = payload,
               .bytes = vxm_scalar_bytes(file->scalar) * (size_t)file->channels,
               .error = error};
  each_block(file, origin, file->space.dims, decode_block, &d);
  return d.status;
}

static void fill_background(const decoder *d) {
  size_t count = vxm_field_count(d->field);
  for (size_t v = 0; v < count; v++)
    memcpy(d->field->values + v * d->bytes, d->file->background, d->bytes);
}

/** The names beside the file, with the voxels that are here. */
static vxm_status take_labels(vxm_field *field, const vxm_sparse_file *file, vxm_error *error) {
  vxm_about about = {.is_declared = field->about.is_declared, .kind = field->about.kind};
  vxm_sidecar_take_labels(&about, file->space.dims, &file->input);
  vxm_status status = VXM_OK;
  if (about.table.count > 0)
    status = vxm_field_add_table(field, &about.table, error);
  field->about.starved |= about.starved;
  vxm_about_destroy(&about);
  return status;
}

vxm_status vxm_octree_values_load(vxm_field **out, const vxm_sparse_file *file, const int64_t begin[3],
                                  const int64_t end[3], vxm_error *error) {
  vxm_space space = vxm_space_of_box(&file->space, begin, end);
  vxm_sparse *tree = NULL;
  decoder d = {.file = file, .begin = begin, .end = end, .error = error};
  vxm_status status = vxm_field_make(&d.field, file->context, &space, file->kind, file->scalar, error);
  if (status == VXM_OK)
    status = vxm_octree_file_load(&tree, file, begin, end, error);
  if (status == VXM_OK) {
    d.tree = tree;
    d.bytes = vxm_field_voxel_bytes(d.field);
    d.field->about.is_declared = file->kind != VXM_FIELD_NUMBERS;
    fill_background(&d);
    each_block(file, begin, end, decode_block, &d);
    status = d.status;
  }
  vxm_sparse_destroy(tree);
  if (status == VXM_OK)
    status = take_labels(d.field, file, error);
  return vxm_field_hand_over(out, d.field, status, error);
}

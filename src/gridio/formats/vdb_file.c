/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/vdb_file.h"
#include "base/endian.h"
#include "gridio/common/format.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/** The number 0x56444220, in 8 bytes. */
static const unsigned char magic[8] = {' ', 'B', 'D', 'V', 0, 0, 0, 0};

bool vxm_vdb_sniff(const vxm_input *input) {
  return input->size >= sizeof magic && memcmp(input->data, magic, sizeof magic) == 0;
}

/* ---- Pieces ---- */

typedef struct scanner {
  const vxm_input *input;
  vxm_error *error;
  size_t at;
} scanner;

/** The next bytes; NULL, with an error, if the file ends before. */
static const unsigned char *take(scanner *s, size_t size) {
  const unsigned char *bytes = s->input->data + s->at;
  if (s->input->size - s->at < size) {
    vxm_fail_byte(s->error, s->input, s->input->size, "the file is cut short");
    return NULL;
  }
  s->at += size;
  return bytes;
}

static bool take_u32(scanner *s, uint32_t *value) {
  const unsigned char *bytes = take(s, 4);
  if (bytes)
    *value = vxm_load_le32(bytes);
  return bytes != NULL;
}

/** Bytes behind their number. */
typedef struct text {
  const unsigned char *at;
  size_t size;
} text;

static bool take_text(scanner *s, text *out) {
  uint32_t size;
  if (!take_u32(s, &size))
    return false;
  out->at = take(s, size);
  out->size = size;
  return out->at != NULL;
}

static bool equals(text t, const char *word) {
  return t.size == strlen(word) && memcmp(t.at, word, t.size) == 0;
}

/** As far as it fits, for messages. Names that are the same are told apart behind a separator. */
static void copy_text(char out[64], text t) {
  enum { SEPARATOR = 0x1e };
  size_t size = 0;
  for (; size < 63 && size < t.size && t.at[size] != SEPARATOR; size++)
    out[size] = (char)t.at[size];
  out[size] = '\0';
}

static void load_vector(double out[3], const unsigned char *bytes) {
  for (int a = 0; a < 3; a++)
    out[a] = vxm_load_double(bytes + 8 * a);
}

/* ---- Metadata ---- */

/** What voxmend adds to its grids; the dimensions and places count only together. */
typedef struct addition {
  bool dims, origin, size;
  vxm_space space;
} addition;

/** Texts that OpenVDB itself writes, or that are told in another way. */
static bool is_own(text name) {
  static const char *const own[] = {"class",       "name",          "creator",       "value_type",
                                    "vector_type", "file_bbox_max", "file_bbox_min", "file_compression"};
  for (size_t n = 0; n < sizeof own / sizeof own[0]; n++)
    if (equals(name, own[n]))
      return true;
  return false;
}

static void declare(vxm_about *about, vxm_field_kind kind) {
  about->is_declared = true;
  about->kind = kind;
}

/** What a text says of the values. What voxmend says counts more than the class. */
static void read_words(vxm_vdb_grid *grid, vxm_context *context, text name, text value) {
  char word[64];
  vxm_field_kind kind;
  copy_text(word, value);
  if (equals(name, "class") && !grid->about.is_declared && equals(value, "level set"))
    declare(&grid->about, VXM_FIELD_DISTANCE);
  else if (equals(name, "class") && !grid->about.is_declared && equals(value, "fog volume"))
    declare(&grid->about, VXM_FIELD_COVERAGE);
  else if (equals(name, "voxmend_values") && vxm_field_kind_find(&kind, word))
    declare(&grid->about, kind);
  else if (equals(name, "voxmend_scalar"))
    vxm_scalar_find(&grid->scalar, word);
  else if (!is_own(name))
    vxm_metadata_add(&grid->about.pairs, context, (const char *)name.at, name.size, (const char *)value.at,
                     value.size);
}

static void read_pair(vxm_vdb_grid *grid, vxm_context *context, addition *added, text name, text type,
                      text value) {
  if (equals(type, "string"))
    read_words(grid, context, name, value);
  if (equals(name, "voxmend_dims") && equals(type, "vec3i") && value.size == 12) {
    added->dims = true;
    for (int a = 0; a < 3; a++)
      added->space.dims[a] = (int32_t)vxm_load_le32(value.at + 4 * a);
  }
  bool is_vector = equals(type, "vec3d") && value.size == 24;
  if (equals(name, "voxmend_origin") && is_vector) {
    added->origin = true;
    load_vector(added->space.origin, value.at);
  }
  if (equals(name, "voxmend_voxel_size") && is_vector) {
    added->size = true;
    load_vector(added->space.voxel_size, value.at);
  }
}

/** Reads pairs of name and value; into `grid`, unless that is NULL. */
static bool read_metadata(scanner *s, vxm_vdb_grid *grid, addition *added) {
  uint32_t count;
  if (!take_u32(s, &count))
    return false;
  for (uint32_t i = 0; i < count; i++) {
    text name, type, value;
    if (!take_text(s, &name) || !take_text(s, &type) || !take_text(s, &value))
      return false;
    if (grid)
      read_pair(grid, s->input->context, added, name, type, value);
  }
  return true;
}

/* ---- The transform ---- */

/** What a map of a type holds, as far as it matters: where scale and translation stand among its numbers. */
typedef struct map {
  const char *type;
  size_t numbers;
  int scale, translation; /**< -1 = none */
} map;

static const map maps[] = {
    {"UniformScaleMap", 15, 0, -1},  {"ScaleMap", 15, 0, -1},      {"UniformScaleTranslateMap", 18, 3, 0},
    {"ScaleTranslateMap", 18, 3, 0}, {"TranslationMap", 3, -1, 0},
};

/** Matrices act on row vectors: the translation is their last row. */
static bool read_matrix(vxm_vdb_grid *grid, const unsigned char *numbers) {
  bool is_plain = vxm_load_double(numbers + 8 * 15) == 1;
  for (int row = 0; row < 3; row++)
    for (int column = 0; column < 4; column++) {
      double value = vxm_load_double(numbers + 8 * (4 * row + column));
      if (row == column)
        grid->size[row] = value;
      else
        is_plain = is_plain && value == 0;
    }
  load_vector(grid->first, numbers + 8 * 12);
  return is_plain;
}

static vxm_status read_transform(scanner *s, vxm_vdb_grid *grid) {
  text type;
  size_t begin = s->at;
  if (!take_text(s, &type))
    return VXM_ERROR_FORMAT;
  bool is_plain = true, is_matrix = equals(type, "AffineMap") || equals(type, "UnitaryMap");
  const map *known = maps, *end = maps + sizeof maps / sizeof maps[0];
  while (known < end && !equals(type, known->type))
    known++;
  if (known == end && !is_matrix)
    return vxm_fail_byte(s->error, s->input, begin,
                         "its transform is not linear: the grid has no voxels of one size");
  const unsigned char *numbers = take(s, 8 * (is_matrix ? 16 : known->numbers));
  if (!numbers)
    return VXM_ERROR_FORMAT;
  for (int a = 0; a < 3; a++) {
    grid->size[a] = 1;
    grid->first[a] = 0;
  }
  if (is_matrix)
    is_plain = read_matrix(grid, numbers);
  else {
    if (known->scale >= 0)
      load_vector(grid->size, numbers + 8 * known->scale);
    if (known->translation >= 0)
      load_vector(grid->first, numbers + 8 * known->translation);
  }
  for (int a = 0; a < 3; a++)
    is_plain = is_plain && grid->size[a] > 0;
  return is_plain ? VXM_OK
                  : vxm_fail_byte(s->error, s->input, begin,
                                  "its axes are turned or mirrored; only grids along x, y and z can be read");
}

/* ---- Grids ---- */

/** Whether the name of a type of tree is one that can be read. */
static bool find_type(vxm_vdb_grid *grid, text type) {
  static const char half[] = "_HalfFloat";
  size_t length = sizeof half - 1;
  grid->is_half = type.size > length && memcmp(type.at + type.size - length, half, length) == 0;
  if (grid->is_half)
    type.size -= length;
  if (equals(type, "Tree_bool_5_4_3"))
    grid->type = VXM_VDB_TYPE_BOOL;
  else if (equals(type, "Tree_mask_5_4_3"))
    grid->type = VXM_VDB_TYPE_MASK;
  else if (equals(type, "Tree_float_5_4_3"))
    grid->type = VXM_VDB_TYPE_FLOAT;
  else
    return false;
  return !grid->is_half || grid->type == VXM_VDB_TYPE_FLOAT;
}

/** Later programs may have moved the grid, or made other voxels of it: what voxmend has added is then of
 * another. */
static void take_addition(vxm_vdb_grid *grid, const addition *added) {
  grid->has_space = added->dims && added->origin && added->size;
  grid->space = added->space;
  for (int a = 0; a < 3 && grid->has_space; a++) {
    grid->has_space = grid->space.voxel_size[a] == grid->size[a];
    if (grid->space.origin[a] + grid->size[a] / 2 != grid->first[a])
      grid->space.origin[a] = grid->first[a] - grid->size[a] / 2;
  }
}

static vxm_status read_grid(scanner *s, vxm_vdb_grid *grid) {
  addition added = {.dims = false};
  size_t begin = s->at;
  grid->scalar = VXM_FLOAT32;
  if (!take_u32(s, &grid->compression))
    return VXM_ERROR_FORMAT;
  if (grid->compression > (VXM_VDB_ZIP | VXM_VDB_ACTIVE_ONLY | VXM_VDB_BLOSC))
    return vxm_fail_byte(s->error, s->input, begin, "compression %" PRIu32 " is unknown", grid->compression);
  if (!read_metadata(s, grid, &added))
    return VXM_ERROR_FORMAT;
  vxm_status status = read_transform(s, grid);
  if (status != VXM_OK)
    return status;
  take_addition(grid, &added);
  grid->tree = s->at;
  return VXM_OK;
}

/** The name by which voxmend calls unsigned distances says what they are; other names are carried along. */
static void take_name(vxm_vdb_grid *grid, vxm_context *context) {
  const char *name = grid->name;
  vxm_field_kind kind = grid->about.kind;
  if (!grid->about.is_declared && strcmp(name, vxm_field_kind_name(VXM_FIELD_DISTANCE)) == 0)
    declare(&grid->about, VXM_FIELD_DISTANCE);
  else if (*name && strcmp(name, vxm_field_kind_name(kind)) != 0)
    vxm_metadata_add(&grid->about.pairs, context, VXM_VDB_NAME_KEY, strlen(VXM_VDB_NAME_KEY), name,
                     strlen(name));
}

static vxm_status fail_types(const scanner *s, size_t begin, text type, uint32_t count) {
  char shown[64];
  copy_text(shown, type);
  return vxm_fail_byte(s->error, s->input, begin,
                       "no grid here can be read (%" PRIu32
                       " of them, the last a \"%s\"): only those of bool, mask and float can",
                       count, shown);
}

/** The grids stand behind each other, each behind its description; where the next one begins is told only in
 * files that can be read in any order. */
static vxm_status find_grid(scanner *s, vxm_vdb_grid *grid, bool has_offsets, uint32_t count) {
  text name, type = {s->input->data, 0}, parent;
  size_t begin = s->at;
  for (uint32_t g = 0; g < count; g++) {
    begin = s->at;
    if (!take_text(s, &name) || !take_text(s, &type) || !take_text(s, &parent))
      return VXM_ERROR_FORMAT;
    const unsigned char *places = take(s, 24);
    if (!places)
      return VXM_ERROR_FORMAT;
    uint64_t end = vxm_load_le64(places + 16);
    if (has_offsets && (vxm_load_le64(places) != s->at || end < s->at || end > s->input->size))
      return vxm_fail_byte(s->error, s->input, s->at - 24,
                           end > s->input->size ? "the file is cut short"
                                                : "the offsets of a grid are damaged");
    if (parent.size == 0 && find_type(grid, type)) {
      copy_text(grid->name, name);
      vxm_status status = read_grid(s, grid);
      if (status == VXM_OK)
        take_name(grid, s->input->context);
      return status;
    }
    if (!has_offsets)
      break;
    s->at = (size_t)end;
  }
  return fail_types(s, begin, type, count);
}

/* ---- The file ---- */

static vxm_status read_head(scanner *s, bool *has_offsets) {
  enum { OLDEST = 222, NEWEST = 224, UUID = 36 };
  uint32_t version;
  s->at = sizeof magic;
  if (!take_u32(s, &version))
    return VXM_ERROR_FORMAT;
  if (version < OLDEST || version > NEWEST)
    return vxm_fail_byte(s->error, s->input, sizeof magic,
                         "version %" PRIu32 " of the format is unknown; %d to %d can be read", version,
                         OLDEST, NEWEST);
  const unsigned char *rest = take(s, 4 + 4 + 1 + UUID);
  if (!rest)
    return VXM_ERROR_FORMAT;
  if (rest[8] > 1)
    return vxm_fail_byte(s->error, s->input, 20, "the header is damaged");
  *has_offsets = rest[8] == 1;
  return VXM_OK;
}

vxm_status vxm_vdb_file_read(vxm_vdb_grid *out, const vxm_input *input, vxm_warnings *warnings,
                             vxm_error *error) {
  *out = (vxm_vdb_grid){.name = ""};
  if (!vxm_vdb_sniff(input))
    return vxm_fail_byte(error, input, 0, "not a vdb file: it does not begin with \" BDV\"");
  scanner s = {input, error, 0};
  bool has_offsets = false;
  uint32_t count;
  vxm_status status = read_head(&s, &has_offsets);
  if (status != VXM_OK)
    return status;
  if (!read_metadata(&s, NULL, NULL) || !take_u32(&s, &count))
    return VXM_ERROR_FORMAT;
  if (count == 0)
    return vxm_fail_byte(error, input, s.at, "the file has no grid");
  status = find_grid(&s, out, has_offsets, count);
  if (status == VXM_OK && count > 1)
    vxm_warn(warnings, "of its %" PRIu32 " grids \"%s\" is read", count, out->name);
  return status;
}

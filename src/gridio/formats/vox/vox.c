/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * MagicaVoxel's .vox, version 150: chunks of an identifier, two sizes and content. Each model holds up to 256
 * voxels along an axis and a number of the palette for each; larger grids are several models, which a scene
 * graph puts in their places.
 */
#include "gridio/formats/vox/vox.h"
#include "base/endian.h"
#include "base/number.h"
#include "gridio/common/format.h"
#include "gridio/common/label_color.h"
#include "gridio/formats/vox/vox_palette.h"

#include <stdio.h>
#include <string.h>

enum { MODEL = 256 /**< voxels of a model along an axis */ };

/** A field as numbers of a palette. */
typedef struct source {
  const vxm_field *field;
  vxm_field_kind kind; /**< VXM_FIELD_NUMBERS for bits, VXM_FIELD_LABELS or VXM_FIELD_COLORS */
  vxm_vox_palette palette;
  char origin[128], size[128]; /**< of the space, as text */
} source;

static uint8_t number_at(const source *s, int64_t i, int64_t j, int64_t k) {
  const int64_t *n = s->field->space.dims;
  size_t voxel = (size_t)((i * n[1] + j) * n[2] + k);
  return s->kind == VXM_FIELD_COLORS ? vxm_vox_palette_number(&s->palette, s->field->values + 4 * voxel)
                                     : (uint8_t)vxm_field_label(s->field, voxel);
}

/* ---- Chunks ---- */

static void put_word(vxm_output *output, int64_t value) {
  uint32_t word = vxm_le32((uint32_t)(int32_t)value);
  vxm_output_write(output, &word, sizeof word);
}

static void put_chunk(vxm_output *output, const char *name, int64_t content, int64_t children) {
  vxm_output_write(output, name, 4);
  put_word(output, content);
  put_word(output, children);
}

static void put_text(vxm_output *output, const char *text) {
  put_word(output, (int64_t)strlen(text));
  vxm_output_write(output, text, strlen(text));
}

/** Voxels of one model. */
typedef struct model_box {
  int64_t begin[3], end[3];
  int64_t voxels;
} model_box;

static model_box model_at(const source *c, int64_t index) {
  model_box box;
  int64_t counts[3];
  for (int a = 0; a < 3; a++)
    counts[a] = (c->field->space.dims[a] + MODEL - 1) / MODEL;
  const int64_t place[3] = {index % counts[0], index / counts[0] % counts[1], index / counts[0] / counts[1]};
  for (int a = 0; a < 3; a++) {
    box.begin[a] = place[a] * MODEL;
    box.end[a] = vxm_min(box.begin[a] + MODEL, c->field->space.dims[a]);
  }
  box.voxels = 0;
  for (int64_t i = box.begin[0]; i < box.end[0]; i++)
    for (int64_t j = box.begin[1]; j < box.end[1]; j++)
      for (int64_t k = box.begin[2]; k < box.end[2]; k++)
        box.voxels += number_at(c, i, j, k) != 0;
  return box;
}

static void put_model(vxm_output *output, const source *c, const model_box *box) {
  put_chunk(output, "SIZE", 12, 0);
  for (int a = 0; a < 3; a++)
    put_word(output, box->end[a] - box->begin[a]);
  put_chunk(output, "XYZI", 4 + 4 * box->voxels, 0);
  put_word(output, box->voxels);
  for (int64_t i = box->begin[0]; i < box->end[0]; i++)
    for (int64_t j = box->begin[1]; j < box->end[1]; j++)
      for (int64_t k = box->begin[2]; k < box->end[2]; k++) {
        uint8_t number = number_at(c, i, j, k);
        if (number == 0)
          continue;
        const uint8_t voxel[4] = {(uint8_t)(i - box->begin[0]), (uint8_t)(j - box->begin[1]),
                                  (uint8_t)(k - box->begin[2]), number};
        vxm_output_write(output, voxel, sizeof voxel);
      }
}

/** Where the middle of a model lies, as the scene graph wants it. */
static void place_text(char text[64], const model_box *box) {
  long long at[3];
  for (int a = 0; a < 3; a++)
    at[a] = (long long)(box->begin[a] + (box->end[a] - box->begin[a]) / 2);
  snprintf(text, 64, "%lld %lld %lld", at[0], at[1], at[2]);
}

/** A pair of a dictionary. Returns its bytes; writes it where there is an output. */
static int64_t put_pair(vxm_output *output, const char *key, const char *value) {
  if (output) {
    put_text(output, key);
    put_text(output, value);
  }
  return 8 + (int64_t)(strlen(key) + strlen(value));
}

/** What the format itself does not hold, as attributes of the root, which other programs leave alone: how
 * many pairs, and then these. */
static int64_t put_attributes(vxm_output *output, const source *c) {
  const vxm_label_table *table = &c->field->about.table;
  size_t labels = c->kind == VXM_FIELD_LABELS && table->count <= VXM_VOX_COLORS ? table->count : 0;
  char text[128];
  if (output)
    put_word(output, 3 + (int64_t)labels);
  int64_t bytes = 4 + put_pair(output, VXM_VOX_VALUES_KEY,
                               c->kind == VXM_FIELD_NUMBERS ? "bits" : vxm_field_kind_name(c->kind));
  bytes += put_pair(output, VXM_VOX_ORIGIN_KEY, c->origin) + put_pair(output, VXM_VOX_SIZE_KEY, c->size);
  for (size_t label = 1; label <= labels; label++) {
    snprintf(text, sizeof text, VXM_VOX_LABEL_KEY "%zu", label);
    bytes += put_pair(output, text, vxm_label_table_name(table, label));
  }
  return bytes;
}

/** The root: its attributes, the group below it, nothing reserved, no layer, and one frame without a place.
 */
static int64_t put_root(vxm_output *output, const source *c) {
  int64_t size = 4 + put_attributes(NULL, c) + 4 + 4 + 4 + 4 + 4;
  if (output) {
    put_chunk(output, "nTRN", size, 0);
    put_word(output, 0);
    put_attributes(output, c);
    put_word(output, 1);
    put_word(output, -1);
    put_word(output, -1);
    put_word(output, 1);
    put_word(output, 0);
  }
  return 12 + size;
}

/** A transform of a model: its number, no attributes, its child, nothing reserved, the first layer, one frame
 * with a place. */
static int64_t put_transform(vxm_output *output, int64_t number, int64_t child, const char *place) {
  int64_t size = 4 + 4 + 4 + 4 + 4 + 4 + 4 + put_pair(NULL, "_t", place);
  if (output) {
    put_chunk(output, "nTRN", size, 0);
    put_word(output, number);
    put_word(output, 0);
    put_word(output, child);
    put_word(output, -1);
    put_word(output, 0);
    put_word(output, 1);
    put_word(output, 1);
    put_pair(output, "_t", place);
  }
  return 12 + size;
}

/** The scene: a root, a group, and for each model a transform and a shape. Returns its bytes; writes them
 * where there is an output. */
static int64_t put_scene(vxm_output *output, const source *c, int64_t models) {
  int64_t bytes = put_root(output, c), group = 4 + 4 + 4 + 4 * models;
  if (output) {
    put_chunk(output, "nGRP", group, 0);
    put_word(output, 1);
    put_word(output, 0);
    put_word(output, models);
    for (int64_t m = 0; m < models; m++)
      put_word(output, 2 + 2 * m);
  }
  bytes += 12 + group;
  for (int64_t m = 0; m < models; m++) {
    char place[64];
    model_box box = model_at(c, m);
    place_text(place, &box);
    bytes += put_transform(output, 2 + 2 * m, 3 + 2 * m, place) + 12 + 20;
    if (!output)
      continue;
    put_chunk(output, "nSHP", 20, 0);
    put_word(output, 3 + 2 * m);
    put_word(output, 0);
    put_word(output, 1);
    put_word(output, m);
    put_word(output, 0);
  }
  return bytes;
}

static void put_palette(vxm_output *output, const vxm_vox_palette *p) {
  put_chunk(output, "RGBA", 4 * (VXM_VOX_COLORS + 1), 0);
  for (int i = 0; i <= VXM_VOX_COLORS; i++) {
    uint8_t color[4] = {0, 0, 0, 255};
    if (i < p->size)
      memcpy(color, p->color[i], 3);
    vxm_output_write(output, color, sizeof color);
  }
}

static vxm_status write_chunks(vxm_output *output, const source *c, vxm_error *error) {
  int64_t models = 1, bytes = 12 + 4 * (VXM_VOX_COLORS + 1);
  for (int a = 0; a < 3; a++)
    models *= (c->field->space.dims[a] + MODEL - 1) / MODEL;
  for (int64_t m = 0; m < models && bytes <= INT32_MAX; m++)
    bytes += 24 + 16 + 4 * model_at(c, m).voxels;
  bytes += put_scene(NULL, c, models);
  if (bytes > INT32_MAX)
    return vxm_fail(error, VXM_ERROR_RANGE, ".vox holds less than 2^31 bytes; use .npy");
  vxm_output_write(output, "VOX ", 4);
  put_word(output, 150);
  put_chunk(output, "MAIN", 0, bytes);
  for (int64_t m = 0; m < models; m++) {
    model_box box = model_at(c, m);
    put_model(output, c, &box);
  }
  put_scene(output, c, models);
  put_palette(output, &c->palette);
  return VXM_OK;
}

/** Bits are grey; a label has its own number of the palette. */
static void choose_colors(vxm_vox_palette *p, vxm_field_kind kind) {
  static const uint8_t grey[3] = {170, 170, 170};
  *p = (vxm_vox_palette){.size = kind == VXM_FIELD_NUMBERS ? 1 : VXM_VOX_COLORS};
  memcpy(p->color[0], grey, sizeof grey);
  for (int label = 1; kind == VXM_FIELD_LABELS && label <= VXM_VOX_COLORS; label++)
    vxm_label_color_bytes(p->color[label - 1], label);
}

/** Three numbers with a space between, which read back bit for bit. */
static void print_numbers(char text[128], const double numbers[3]) {
  size_t used = 0;
  for (int a = 0; a < 3; a++) {
    char number[VXM_NUMBER_ROOM];
    size_t length = vxm_number_write(number, numbers[a]);
    memcpy(text + used, number, length);
    used += length;
    text[used++] = a < 2 ? ' ' : '\0';
  }
}

static vxm_status write_vox(vxm_output *output, const vxm_field *field, vxm_error *error) {
  vxm_field_range range = VXM_FIELD_RANGE_INIT;
  source s = {.field = field};
  vxm_status status = vxm_field_measure(&range, field, error);
  if (status != VXM_OK)
    return status;
  print_numbers(s.origin, field->space.origin);
  print_numbers(s.size, field->space.voxel_size);
  s.kind = field->channels == 4                                       ? VXM_FIELD_COLORS
           : field->about.kind == VXM_FIELD_NUMBERS && range.max <= 1 ? VXM_FIELD_NUMBERS
                                                                      : VXM_FIELD_LABELS;
  if (s.kind == VXM_FIELD_COLORS)
    status = vxm_vox_palette_of_colors(&s.palette, field, error);
  else
    choose_colors(&s.palette, s.kind);
  if (status != VXM_OK)
    return status;
  status = write_chunks(output, &s, error);
  if (s.kind == VXM_FIELD_COLORS)
    vxm_vox_palette_destroy(&s.palette);
  return status;
}

static vxm_status check_field(const vxm_field *field, const char *path, vxm_error *error) {
  return vxm_field_check_labels(field, path, VXM_VOX_COLORS,
                                "has numbers that are no labels from 0 to 255, which .vox holds; choose a "
                                "threshold, or .npy or .nrrd",
                                error);
}

static vxm_status write_field(const vxm_field *field, const char *path, vxm_error *error) {
  return vxm_field_write_file(field, path, write_vox, error);
}

const vxm_grid_format vxm_format_vox = {
    .name = "vox",
    .holds = VXM_HOLDS_BITS | VXM_HOLDS_LABELS | VXM_HOLDS_COLORS,
    .sniff = vxm_vox_sniff,
    .read = vxm_vox_read_bits,
    .read_field = vxm_vox_read_field,
    .check_field = check_field,
    .write_field = write_field,
};

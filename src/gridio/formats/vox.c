/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * MagicaVoxel's .vox, version 150: chunks of an identifier, two sizes and content. Each model holds up to 256
 * voxels along an axis and a number of the palette for each; larger grids are several models, which a scene
 * graph puts in their places.
 */
#include "base/endian.h"
#include "gridio/common/format.h"

#include <stdio.h>
#include <string.h>

enum {
  MODEL = 256,   /**< voxels of a model along an axis */
  PALETTE = 255, /**< number 0 stands for no voxel */
  BITS = 5,      /**< of each colour that choosing a palette looks at */
  BINS = 1 << 3 * BITS
};

/* ---- A palette ---- */

/** Bins of colours that become one: those between `low` and `high`, which hold `count` voxels. */
typedef struct color_box {
  int low[3], high[3];
  uint64_t count;
} color_box;

typedef struct palette {
  uint64_t *count;    /**< voxels of each bin */
  uint64_t (*sum)[3]; /**< of their colours */
  uint8_t *number;    /**< of each bin: 1 to PALETTE */
  uint8_t color[PALETTE][3];
  int size;
} palette;

static size_t bin_of(const uint8_t color[3]) {
  return (size_t)(color[0] >> (8 - BITS)) << 2 * BITS | (size_t)(color[1] >> (8 - BITS)) << BITS |
         (size_t)(color[2] >> (8 - BITS));
}

static size_t bin_at(int r, int g, int b) {
  return (size_t)r << 2 * BITS | (size_t)g << BITS | (size_t)b;
}

/** Shrinks a box to the bins that hold anything, and counts them. */
static void fit_box(color_box *box, const palette *p) {
  color_box fitted = {{1 << BITS, 1 << BITS, 1 << BITS}, {-1, -1, -1}, 0};
  for (int r = box->low[0]; r <= box->high[0]; r++)
    for (int g = box->low[1]; g <= box->high[1]; g++)
      for (int b = box->low[2]; b <= box->high[2]; b++) {
        const int at[3] = {r, g, b};
        if (p->count[bin_at(r, g, b)] == 0)
          continue;
        fitted.count += p->count[bin_at(r, g, b)];
        for (int c = 0; c < 3; c++) {
          fitted.low[c] = at[c] < fitted.low[c] ? at[c] : fitted.low[c];
          fitted.high[c] = at[c] > fitted.high[c] ? at[c] : fitted.high[c];
        }
      }
  *box = fitted;
}

static int longest_side(const color_box *box) {
  int side = 0;
  for (int c = 1; c < 3; c++)
    if (box->high[c] - box->low[c] > box->high[side] - box->low[side])
      side = c;
  return side;
}

/** Cuts a box across its longest side, in the middle of its voxels (median cut, Heckbert 1982). */
static void cut_box(color_box *box, color_box *other, const palette *p) {
  int side = longest_side(box), at = box->low[side];
  uint64_t below = 0;
  for (; at < box->high[side]; at++) {
    color_box slab = *box;
    slab.low[side] = slab.high[side] = at;
    fit_box(&slab, p);
    below += slab.count;
    if (2 * below >= box->count)
      break;
  }
  at = at < box->high[side] ? at : box->high[side] - 1;
  *other = *box;
  box->high[side] = at;
  other->low[side] = at + 1;
  fit_box(box, p);
  fit_box(other, p);
}

static void number_box(palette *p, const color_box *box) {
  uint64_t sum[3] = {0, 0, 0};
  for (int r = box->low[0]; r <= box->high[0]; r++)
    for (int g = box->low[1]; g <= box->high[1]; g++)
      for (int b = box->low[2]; b <= box->high[2]; b++) {
        for (int c = 0; c < 3; c++)
          sum[c] += p->sum[bin_at(r, g, b)][c];
        p->number[bin_at(r, g, b)] = (uint8_t)(p->size + 1);
      }
  for (int c = 0; c < 3; c++)
    p->color[p->size][c] = (uint8_t)((sum[c] + box->count / 2) / box->count);
  p->size++;
}

/** The box that is cut next: that with the most voxels of those with several bins; -1 if there is none. */
static int widest_box(const color_box *boxes, int count) {
  int found = -1;
  for (int i = 0; i < count; i++) {
    int side = longest_side(&boxes[i]);
    if (boxes[i].high[side] > boxes[i].low[side] && (found < 0 || boxes[i].count > boxes[found].count))
      found = i;
  }
  return found;
}

static void choose_colors(palette *p) {
  color_box boxes[PALETTE] = {{{0, 0, 0}, {(1 << BITS) - 1, (1 << BITS) - 1, (1 << BITS) - 1}, 0}};
  int count = 1;
  fit_box(&boxes[0], p);
  if (boxes[0].count == 0)
    return;
  for (int next = widest_box(boxes, count); next >= 0 && count < PALETTE; next = widest_box(boxes, count))
    cut_box(&boxes[next], &boxes[count++], p);
  for (int i = 0; i < count; i++)
    number_box(p, &boxes[i]);
}

static void count_colors(palette *p, const vxm_field *c) {
  const int64_t *dims = c->space.dims;
  size_t voxels = (size_t)(dims[0] * dims[1] * dims[2]);
  for (size_t i = 0; i < voxels; i++) {
    const uint8_t *color = c->values + 4 * i;
    if (!color[3])
      continue;
    p->count[bin_of(color)]++;
    for (int k = 0; k < 3; k++)
      p->sum[bin_of(color)][k] += color[k];
  }
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

static model_box model_at(const vxm_field *c, int64_t index) {
  model_box box;
  int64_t counts[3];
  for (int a = 0; a < 3; a++)
    counts[a] = (c->space.dims[a] + MODEL - 1) / MODEL;
  const int64_t place[3] = {index % counts[0], index / counts[0] % counts[1], index / counts[0] / counts[1]};
  for (int a = 0; a < 3; a++) {
    box.begin[a] = place[a] * MODEL;
    box.end[a] = vxm_min(box.begin[a] + MODEL, c->space.dims[a]);
  }
  box.voxels = 0;
  for (int64_t i = box.begin[0]; i < box.end[0]; i++)
    for (int64_t j = box.begin[1]; j < box.end[1]; j++)
      for (int64_t k = box.begin[2]; k < box.end[2]; k++)
        box.voxels += vxm_field_color(c, i, j, k)[3] != 0;
  return box;
}

static void put_model(vxm_output *output, const vxm_field *c, const model_box *box, const palette *p) {
  put_chunk(output, "SIZE", 12, 0);
  for (int a = 0; a < 3; a++)
    put_word(output, box->end[a] - box->begin[a]);
  put_chunk(output, "XYZI", 4 + 4 * box->voxels, 0);
  put_word(output, box->voxels);
  for (int64_t i = box->begin[0]; i < box->end[0]; i++)
    for (int64_t j = box->begin[1]; j < box->end[1]; j++)
      for (int64_t k = box->begin[2]; k < box->end[2]; k++) {
        const uint8_t *color = vxm_field_color(c, i, j, k);
        if (!color[3])
          continue;
        const uint8_t voxel[4] = {(uint8_t)(i - box->begin[0]), (uint8_t)(j - box->begin[1]),
                                  (uint8_t)(k - box->begin[2]), p->number[bin_of(color)]};
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

/** A transform node: its number, no names, its child, nothing reserved, no layer, one frame with a place or
 * none. */
static int64_t put_transform(vxm_output *output, int64_t number, int64_t child, const char *place) {
  int64_t size = 4 + 4 + 4 + 4 + 4 + 4 + 4 + (place ? 4 + 2 + 4 + (int64_t)strlen(place) : 0);
  if (output) {
    put_chunk(output, "nTRN", size, 0);
    put_word(output, number);
    put_word(output, 0);
    put_word(output, child);
    put_word(output, -1);
    put_word(output, place ? 0 : -1);
    put_word(output, 1);
    put_word(output, place ? 1 : 0);
    if (place) {
      put_text(output, "_t");
      put_text(output, place);
    }
  }
  return 12 + size;
}

/** The scene: a root, a group, and for each model a transform and a shape. Returns its bytes; writes them
 * where there is an output. */
static int64_t put_scene(vxm_output *output, const vxm_field *c, int64_t models) {
  int64_t bytes = put_transform(output, 0, 1, NULL), group = 4 + 4 + 4 + 4 * models;
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

static void put_palette(vxm_output *output, const palette *p) {
  put_chunk(output, "RGBA", 4 * (PALETTE + 1), 0);
  for (int i = 0; i <= PALETTE; i++) {
    uint8_t color[4] = {0, 0, 0, 255};
    if (i < p->size)
      memcpy(color, p->color[i], 3);
    vxm_output_write(output, color, sizeof color);
  }
}

static vxm_status write_chunks(vxm_output *output, const vxm_field *c, const palette *p, vxm_error *error) {
  int64_t models = 1, bytes = 12 + 4 * (PALETTE + 1);
  for (int a = 0; a < 3; a++)
    models *= (c->space.dims[a] + MODEL - 1) / MODEL;
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
    put_model(output, c, &box, p);
  }
  put_scene(output, c, models);
  put_palette(output, p);
  return VXM_OK;
}

static vxm_status write_vox(vxm_output *output, const vxm_field *c, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  palette p = {.size = 0};
  p.count = vxm_calloc(c->context, BINS, sizeof *p.count, &local);
  p.sum = vxm_calloc(c->context, BINS, sizeof *p.sum, &local);
  p.number = vxm_calloc(c->context, BINS, sizeof *p.number, &local);
  vxm_status status = local.code;
  if (status == VXM_OK) {
    count_colors(&p, c);
    choose_colors(&p);
    status = write_chunks(output, c, &p, &local);
  }
  vxm_free(c->context, p.count);
  vxm_free(c->context, p.sum);
  vxm_free(c->context, p.number);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

static vxm_status write_field(const vxm_field *field, const char *path, vxm_error *error) {
  return vxm_field_write_file(field, path, write_vox, error);
}

const vxm_grid_format vxm_format_vox = {
    .name = "vox",
    .holds = VXM_HOLDS_COLORS,
    .write_field = write_field,
};

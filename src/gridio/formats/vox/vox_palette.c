/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/vox/vox_palette.h"

enum {
  BITS = 5, /**< of each colour that choosing a palette looks at */
  BINS = 1 << 3 * BITS
};

/** Bins of colours that become one: those between `low` and `high`, which hold `count` voxels. */
typedef struct color_box {
  int low[3], high[3];
  uint64_t count;
} color_box;

static size_t bin_of(const uint8_t color[3]) {
  return (size_t)(color[0] >> (8 - BITS)) << 2 * BITS | (size_t)(color[1] >> (8 - BITS)) << BITS |
         (size_t)(color[2] >> (8 - BITS));
}

static size_t bin_at(int r, int g, int b) {
  return (size_t)r << 2 * BITS | (size_t)g << BITS | (size_t)b;
}

/** Shrinks a box to the bins that hold anything, and counts them. */
static void fit_box(color_box *box, const vxm_vox_palette *p) {
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
static void cut_box(color_box *box, color_box *other, const vxm_vox_palette *p) {
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

static void number_box(vxm_vox_palette *p, const color_box *box) {
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

static void choose_colors(vxm_vox_palette *p) {
  color_box boxes[VXM_VOX_COLORS] = {{{0, 0, 0}, {(1 << BITS) - 1, (1 << BITS) - 1, (1 << BITS) - 1}, 0}};
  int count = 1;
  fit_box(&boxes[0], p);
  if (boxes[0].count == 0)
    return;
  for (int next = widest_box(boxes, count); next >= 0 && count < VXM_VOX_COLORS;
       next = widest_box(boxes, count))
    cut_box(&boxes[next], &boxes[count++], p);
  for (int i = 0; i < count; i++)
    number_box(p, &boxes[i]);
}

static void count_colors(vxm_vox_palette *p, const vxm_field *c) {
  size_t voxels = vxm_field_count(c);
  for (size_t i = 0; i < voxels; i++) {
    const uint8_t *color = c->values + 4 * i;
    if (!color[3])
      continue;
    p->count[bin_of(color)]++;
    for (int k = 0; k < 3; k++)
      p->sum[bin_of(color)][k] += color[k];
  }
}

uint8_t vxm_vox_palette_number(const vxm_vox_palette *p, const uint8_t rgba[4]) {
  return rgba[3] ? p->number[bin_of(rgba)] : 0;
}

vxm_status vxm_vox_palette_of_colors(vxm_vox_palette *p, const vxm_field *field, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  *p = (vxm_vox_palette){.context = field->context};
  p->count = vxm_calloc(p->context, BINS, sizeof *p->count, &local);
  p->sum = vxm_calloc(p->context, BINS, sizeof *p->sum, &local);
  p->number = vxm_calloc(p->context, BINS, sizeof *p->number, &local);
  if (local.code != VXM_OK) {
    vxm_vox_palette_destroy(p);
    vxm_error_pass(error, &local);
    return local.code;
  }
  count_colors(p, field);
  choose_colors(p);
  return VXM_OK;
}

void vxm_vox_palette_destroy(vxm_vox_palette *p) {
  vxm_free(p->context, p->count);
  vxm_free(p->context, p->sum);
  vxm_free(p->context, p->number);
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/picture/slice.h"
#include "gridio/common/label_color.h"
#include "gridio/common/png_write.h"
#include "gridio/picture/digits.h"
#include "gridio/picture/palette.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/** Numbers beside the bar of colours, from its upper end to its lower. */
enum { NUMBERS = 5, NUMBER_SIZE = 16 };

typedef struct slice {
  const vxm_grid *grid;
  const vxm_field *field;
  vxm_field_kind kind;
  double low, high; /**< of the colours */
  int across, right, up;
  int64_t layer;
  int width, height;     /**< pixels */
  double left, top;      /**< the corner of the drawing, pixels */
  double size[2];        /**< its size, pixels */
  int bar_left, bar_end; /**< columns of the bar of colours; none if they are the same */
  int pixel;             /**< of a digit is so many wide and high; 0 = there is no room for numbers */
  char number[NUMBERS][NUMBER_SIZE];
} slice;

/* ---- Cells ---- */

static size_t index_of(const slice *s, int64_t u, int64_t v) {
  int64_t voxel[3];
  const int64_t *n = s->field->space.dims;
  voxel[s->across] = s->layer;
  voxel[s->right] = u;
  voxel[s->up] = v;
  return (size_t)((voxel[0] * n[1] + voxel[1]) * n[2] + voxel[2]);
}

static double value_of(const slice *s, int64_t u, int64_t v) {
  double value;
  vxm_field_doubles(&value, s->field, index_of(s, u, v), 1);
  return value;
}

static int64_t within(double at, int64_t count) {
  return at < 0 ? 0 : at >= (double)count ? count - 1 : (int64_t)at;
}

/** Between the centres of cells, in cells; not a number where a neighbour is none. */
static double interpolated(const slice *s, double u, double v) {
  const int64_t *n = s->field->space.dims;
  int64_t at[2][2];
  double part[2], place[2] = {u - 0.5, v - 0.5};
  const int axes[2] = {s->right, s->up};
  for (int a = 0; a < 2; a++) {
    double base = floor(place[a]);
    part[a] = place[a] - base;
    at[a][0] = within(base, n[axes[a]]);
    at[a][1] = within(base + 1, n[axes[a]]);
  }
  double sum = 0;
  for (int c = 0; c < 4; c++)
    sum += (c & 1 ? part[0] : 1 - part[0]) * (c & 2 ? part[1] : 1 - part[1]) *
           value_of(s, at[0][c & 1], at[1][c >> 1]);
  return sum;
}

/* ---- Colours ---- */

static void color_number(uint8_t rgb[3], const slice *s, double value) {
  double span = s->high > s->low ? s->high - s->low : 1, part = (value - s->low) / span;
  if (isnan(value))
    memset(rgb, 204, 3);
  else if (s->kind == VXM_FIELD_DISTANCE)
    vxm_palette_diverging(rgb, 2 * part - 1);
  else if (s->kind == VXM_FIELD_COVERAGE)
    vxm_palette_grey(rgb, part);
  else
    vxm_palette_sequential(rgb, part);
}

static void color_cell(uint8_t rgb[3], const slice *s, int64_t u, int64_t v) {
  static const uint8_t set[3] = {222, 134, 78}, clear[3] = {255, 255, 255};
  if (!s->field) {
    int64_t voxel[3];
    voxel[s->across] = s->layer;
    voxel[s->right] = u;
    voxel[s->up] = v;
    memcpy(rgb, vxm_grid_get(s->grid, voxel[0], voxel[1], voxel[2]) ? set : clear, 3);
  } else if (s->kind == VXM_FIELD_COLORS) {
    const unsigned char *color = s->field->values + 4 * index_of(s, u, v);
    memcpy(rgb, color[3] > 0 ? color : clear, 3);
  } else {
    double value = value_of(s, u, v);
    if (s->kind != VXM_FIELD_LABELS)
      color_number(rgb, s, value);
    else if (value == 0 || isnan(value))
      memcpy(rgb, clear, 3);
    else
      vxm_label_color_bytes(rgb, value);
  }
}

/** Whether a distance is 0 between this pixel and the next to the right or below. */
static bool is_contour(const slice *s, double u, double v, const double step[2]) {
  bool inside = signbit(interpolated(s, u, v));
  return signbit(interpolated(s, u + step[0], v)) != inside ||
         signbit(interpolated(s, u, v - step[1])) != inside;
}

/** The pixel at a place of the drawing, in cells. Large cells have lines between them, but for distances,
 * which are smooth. */
static void color_place(uint8_t rgb[3], const slice *s, double u, double v, const double step[2]) {
  const int64_t *n = s->field ? s->field->space.dims : s->grid->space.dims;
  if (s->kind == VXM_FIELD_DISTANCE && s->field) {
    color_number(rgb, s, interpolated(s, u, v));
    if (is_contour(s, u, v, step))
      memset(rgb, 0, 3);
    return;
  }
  color_cell(rgb, s, within(u, n[s->right]), within(v, n[s->up]));
  bool is_line = step[0] < 0.125 && step[1] < 0.125 && (u - floor(u) < step[0] || v - floor(v) < step[1]);
  for (int c = 0; is_line && c < 3; c++)
    rgb[c] = (uint8_t)(rgb[c] * 0.85);
}

/* ---- The picture ---- */

/** The numbers that are in a row of the picture, in grey. */
static void draw_numbers(unsigned char *row, const slice *s, int y) {
  if (s->pixel == 0)
    return;
  int height = VXM_DIGIT_HEIGHT * s->pixel, left = s->bar_end + 2 * s->pixel;
  for (int n = 0; n < NUMBERS; n++) {
    int down = y - ((int)(s->top + s->size[1] * n / (NUMBERS - 1)) - height / 2);
    for (int x = left; x < s->width && down >= 0 && down < height; x++)
      if (vxm_digits_ink(s->number[n], (x - left) / s->pixel, down / s->pixel))
        memset(row + 3 * x, 64, 3);
  }
}

static void draw_row(unsigned char *row, const slice *s, int y) {
  const int64_t *n = s->field ? s->field->space.dims : s->grid->space.dims;
  const double step[2] = {(double)n[s->right] / s->size[0], (double)n[s->up] / s->size[1]};
  double down = y + 0.5 - s->top, v = (s->size[1] - down) * step[1];
  memset(row, 255, 3 * (size_t)s->width);
  draw_numbers(row, s, y);
  if (down < 0 || down > s->size[1])
    return;
  for (int x = 0; x < s->width; x++) {
    double along = x + 0.5 - s->left;
    if (along >= 0 && along <= s->size[0])
      color_place(row + 3 * x, s, along * step[0], v, step);
    else if (x >= s->bar_left && x < s->bar_end)
      color_number(row + 3 * x, s, s->high - (s->high - s->low) * down / s->size[1]);
  }
}

static vxm_status draw(const slice *s, vxm_context *context, const char *path, vxm_error *error) {
  vxm_status status = VXM_OK;
  vxm_output *output;
  vxm_png *png = NULL;
  unsigned char *row = vxm_try_alloc(context, (size_t)s->width, 3, &status, error);
  if (!row)
    return status;
  status = vxm_output_open(&output, context, path, error);
  if (status == VXM_OK) {
    status = vxm_png_create(&png, context, output, s->width, s->height, error);
    for (int y = 0; status == VXM_OK && y < s->height; y++) {
      draw_row(row, s, y);
      status = vxm_png_rows(png, row, 1, error);
      if (status == VXM_OK && y % 32 == 31)
        status = vxm_progress(context, "drawing", (double)(y + 1) / s->height, error);
    }
    if (status == VXM_OK)
      status = vxm_png_finish(png, error);
    vxm_png_destroy(png);
    if (status == VXM_OK)
      status = vxm_output_commit(output, error);
    else
      vxm_output_abort(output);
  }
  vxm_free(context, row);
  return status;
}

/** Prints the numbers, and returns the columns that they take. */
static int put_numbers(slice *s) {
  const int small = 200, usual = 300;
  int least = s->width < s->height ? s->width : s->height;
  size_t longest = 0;
  s->pixel = least < small ? 0 : least < usual ? 1 : least / usual;
  for (int n = 0; n < NUMBERS; n++) {
    double value = s->high - (s->high - s->low) * n / (NUMBERS - 1);
    snprintf(s->number[n], NUMBER_SIZE, "%.3g", value + 0.0); /* no -0 */
    longest = strlen(s->number[n]) > longest ? strlen(s->number[n]) : longest;
  }
  return s->pixel * (2 + VXM_DIGIT_WIDTH * (int)longest);
}

/** Where the drawing and the bar of colours with its numbers lie. */
static void lay_out(slice *s, const vxm_space *space) {
  bool has_bar = s->field && s->kind != VXM_FIELD_LABELS && s->kind != VXM_FIELD_COLORS;
  double strip = has_bar ? 0.06 * s->width : 0, bar = strip + (has_bar ? put_numbers(s) : 0),
         room[2] = {0.94 * s->width - bar, 0.94 * s->height};
  double extent[2] = {(double)space->dims[s->right] * (space->voxel_size[s->right] * 0x1p-60),
                      (double)space->dims[s->up] * (space->voxel_size[s->up] * 0x1p-60)};
  double scale = fmin(room[0] / extent[0], room[1] / extent[1]);
  for (int a = 0; a < 2; a++)
    s->size[a] = fmax(extent[a] * scale, 1);
  s->left = (s->width - bar - s->size[0]) / 2;
  s->top = (s->height - s->size[1]) / 2;
  s->bar_left = has_bar ? (int)(s->left + s->size[0] + strip / 3) : 0;
  s->bar_end = has_bar ? s->bar_left + (int)(strip / 2) : 0;
}

vxm_status vxm_gridio_slice(const vxm_grid *grid, const vxm_field *field, vxm_field_kind kind,
                            const vxm_field_range *range, const char *path,
                            const vxm_picture_options *options, vxm_error *error) {
  const vxm_space *space = grid ? &grid->space : &field->space;
  int across = options->slice_axis - 1;
  slice s = {.grid = grid, .field = field, .kind = kind, .across = across};
  s.right = across == 0 ? 1 : 0;
  s.up = across == 2 ? 1 : 2;
  s.width = options->width ? options->width : 800;
  s.height = options->height ? options->height : 600;
  s.layer = within(options->slice * (double)space->dims[across], space->dims[across]);
  if (range) {
    s.low = range->min;
    s.high = range->max;
  }
  if (kind == VXM_FIELD_DISTANCE && range) /* what is farther outside is as dark: inside there is less room */
    s.low = -(s.high = fmax(-range->min, fabs(range->max) / 2));
  lay_out(&s, space);
  return draw(&s, grid ? grid->context : field->context, path, error);
}

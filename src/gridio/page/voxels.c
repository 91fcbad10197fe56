/* SPDX-License-Identifier: BSD-3-Clause */
/** The voxels of a page: bits, numbers of labels in its legend, numbers of 16 bits, or colours; x fastest. */
#include "base/endian.h"
#include "gridio/common/label_color.h"
#include "gridio/page/parts.h"
#include "gridio/picture/picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

vxm_status vxm_page_put_grid(vxm_page *page, const vxm_grid *grid, vxm_error *error) {
  const int64_t *n = grid->space.dims;
  vxm_pack *pack;
  json_object_set_new(page->about, "kind", json_string("bits"));
  json_object_set_new(page->about, "count", json_integer(vxm_grid_count(grid)));
  vxm_status status = vxm_pack_begin(&pack, page->context, page->output, "voxels", error);
  for (int64_t row = 0; status == VXM_OK && row < n[1] * n[2]; row++) {
    const uint64_t *words = vxm_grid_row(grid, row % n[1], row / n[1]);
    for (int64_t i = 0; i < n[0]; i += 64) {
      unsigned char bytes[8];
      vxm_store_le64(bytes, words[i / 64]);
      int64_t left = (n[0] - i + 7) / 8;
      vxm_pack_put(pack, bytes, left < 8 ? (size_t)left : 8);
    }
  }
  return status == VXM_OK ? vxm_pack_end(pack, error) : status;
}

/* ---- Rows of a field along x ---- */

typedef struct rows {
  const vxm_field *field;
  double *values;       /**< of a row */
  unsigned char *bytes; /**< four for each voxel of a row */
} rows;

static size_t index_of(const vxm_field *field, int64_t i, int64_t row) {
  const int64_t *n = field->space.dims;
  return (size_t)((i * n[1] + row % n[1]) * n[2] + row / n[1]);
}

static void read_row(const rows *r, int64_t row) {
  for (int64_t i = 0; i < r->field->space.dims[0]; i++)
    vxm_field_doubles(r->values + i, r->field, index_of(r->field, i, row), 1);
}

/** Bytes of a row as they go into the page; gives how many. */
typedef size_t (*encode_fn)(const rows *r, int64_t row, const void *payload);

static vxm_status put_rows(vxm_page *page, const rows *r, encode_fn encode, const void *payload, int passes,
                           vxm_error *error) {
  const int64_t *n = r->field->space.dims;
  vxm_pack *pack;
  vxm_status status = vxm_pack_begin(&pack, page->context, page->output, "voxels", error);
  if (status != VXM_OK)
    return status;
  for (int pass = 0; pass < passes; pass++)
    for (int64_t row = 0; row < n[1] * n[2]; row++) {
      size_t bytes = encode(r, row, payload);
      vxm_pack_put(pack, r->bytes + (pass == 0 ? 0 : n[0]), bytes);
    }
  return vxm_pack_end(pack, error);
}

/* ---- Labels ---- */

/** Those that have a line in the legend; all others share the last number. */
enum { LABELS_MAX = 254, OTHERS = 255, SLOTS = 1024 };

typedef struct legend {
  int count;
  double label[LABELS_MAX + 2]; /**< by its number, from 1 on */
  int64_t voxels[LABELS_MAX + 2];
  struct {
    double label;
    int number;
  } slot[SLOTS]; /**< number 0 = free */
} legend;

/** The number of a label; with `is_new` it gets one. */
static int number_of(legend *l, double label, bool is_new) {
  uint64_t bits;
  memcpy(&bits, &label, sizeof bits);
  size_t at = (size_t)(bits * UINT64_C(0x9e3779b97f4a7c15) >> 54);
  while (l->slot[at].number != 0 && l->slot[at].label != label)
    at = (at + 1) % SLOTS;
  if (l->slot[at].number == 0 && is_new && l->count < LABELS_MAX) {
    l->slot[at].label = label;
    l->slot[at].number = ++l->count;
    l->label[l->count] = label;
  }
  return l->slot[at].number != 0 ? l->slot[at].number : OTHERS;
}

static int by_value(const void *a, const void *b) {
  const double *x = a, *y = b;
  return (*x > *y) - (*x < *y);
}

/** Finds the labels, and numbers them upward. */
static void find_labels(legend *l, const rows *r) {
  const int64_t *n = r->field->space.dims;
  for (int64_t row = 0; row < n[1] * n[2]; row++) {
    read_row(r, row);
    double last = 0;
    for (int64_t i = 0; i < n[0]; i++)
      if (r->values[i] != 0 && r->values[i] != last && !isnan(r->values[i]))
        number_of(l, last = r->values[i], true);
  }
  qsort(l->label + 1, (size_t)l->count, sizeof *l->label, by_value);
  memset(l->slot, 0, sizeof l->slot);
  int count = l->count;
  l->count = 0;
  for (int k = 1; k <= count; k++)
    number_of(l, l->label[k], true);
}

static size_t encode_labels(const rows *r, int64_t row, const void *payload) {
  legend *l = *(legend *const *)payload;
  read_row(r, row);
  for (int64_t i = 0; i < r->field->space.dims[0]; i++) {
    double label = r->values[i];
    int number = label == 0 || isnan(label) ? 0 : number_of(l, label, false);
    l->voxels[number]++;
    r->bytes[i] = (unsigned char)number;
  }
  return (size_t)r->field->space.dims[0];
}

static json_t *legend_line(const vxm_field *field, const legend *l, int number) {
  double label = l->label[number];
  char text[48];
  uint8_t rgb[3] = {128, 128, 128};
  const char *name = "";
  snprintf(text, sizeof text, "%.17g", label);
  if (number != OTHERS) {
    vxm_label_color_bytes(rgb, label);
    const vxm_label_table *table = &field->about.table;
    name = label >= 1 && label <= (double)table->count ? vxm_label_table_name(table, (size_t)label) : "";
  }
  return json_pack("{s:s, s:o, s:o, s:I, s:i}", "label", number == OTHERS ? "" : text, "name",
                   vxm_page_text(number == OTHERS ? "all other labels" : name), "color", vxm_page_color(rgb),
                   "count", (json_int_t)l->voxels[number], "code", number);
}

static vxm_status put_labels(vxm_page *page, const rows *r, vxm_error *error) {
  vxm_status status = VXM_OK;
  legend *l = vxm_try_calloc(page->context, 1, sizeof *l, &status, error);
  if (!l)
    return status;
  find_labels(l, r);
  status = put_rows(page, r, encode_labels, &l, 1, error);
  json_t *lines = json_array();
  int64_t count = 0;
  for (int number = 1; number <= OTHERS; number++)
    if (l->voxels[number] > 0) {
      json_array_append_new(lines, legend_line(r->field, l, number));
      count += l->voxels[number];
    }
  json_object_set_new(page->about, "kind", json_string("labels"));
  json_object_set_new(page->about, "labels", lines);
  json_object_set_new(page->about, "count", json_integer(count));
  vxm_free(page->context, l);
  return status;
}

/* ---- Numbers and colours ---- */

/**
 * A number as 16 bits: 0 is not a number; 1 to 32767 are below 0 (or -0), 32768 to 65534 from 0 on, so that
 * the sign of a distance is kept however small it is.
 */
static unsigned code_of(double value, double largest) {
  enum { STEPS = 32766, ZERO = 32768 };
  if (isnan(value))
    return 0;
  double part = largest > 0 ? fmin(fabs(value) / largest, 1) : 0;
  unsigned steps = (unsigned)(part * STEPS + 0.5);
  return signbit(value) ? ZERO - 1 - steps : ZERO + steps;
}

/** High bytes, and behind them the low ones. */
static size_t encode_numbers(const rows *r, int64_t row, const void *payload) {
  const double *largest = payload;
  int64_t n = r->field->space.dims[0];
  read_row(r, row);
  for (int64_t i = 0; i < n; i++) {
    unsigned code = code_of(r->values[i], *largest);
    r->bytes[i] = (unsigned char)(code >> 8);
    r->bytes[n + i] = (unsigned char)code;
  }
  return (size_t)n;
}

static size_t encode_colors(const rows *r, int64_t row, const void *payload) {
  (void)payload;
  int64_t n = r->field->space.dims[0];
  for (int64_t i = 0; i < n; i++)
    memcpy(r->bytes + 4 * i, r->field->values + 4 * index_of(r->field, i, row), 4);
  return (size_t)(4 * n);
}

/** The largest magnitude of finite numbers. */
static double find_largest(const rows *r) {
  double largest = 0;
  const int64_t *n = r->field->space.dims;
  for (int64_t row = 0; row < n[1] * n[2]; row++) {
    read_row(r, row);
    for (int64_t i = 0; i < n[0]; i++)
      if (isfinite(r->values[i]) && fabs(r->values[i]) > largest)
        largest = fabs(r->values[i]);
  }
  return largest;
}

static json_t *bound_json(bool is_used, double value) {
  return is_used ? json_real(value) : json_null();
}

static vxm_status put_numbers(vxm_page *page, const rows *r, vxm_field_kind kind,
                              const vxm_field_range *range, const vxm_threshold_options *shown,
                              vxm_error *error) {
  double largest = find_largest(r);
  double low = fmax(range->min, -largest), high = fmin(range->max, largest);
  if (!(low <= high)) /* no number is finite */
    low = high = 0;
  const char *name = kind == VXM_FIELD_NUMBERS ? "numbers" : vxm_field_kind_name(kind);
  json_object_set_new(page->about, "kind", json_string(name));
  json_object_set_new(page->about, "scale", json_real(largest));
  json_object_set_new(page->about, "range", json_pack("[f,f]", low, high));
  json_object_set_new(page->about, "from", bound_json(shown->use_at_least, shown->at_least));
  json_object_set_new(page->about, "below", bound_json(shown->use_below, shown->below));
  return put_rows(page, r, encode_numbers, &largest, 2, error);
}

static vxm_status put_values(vxm_page *page, const rows *r, const vxm_threshold_options *threshold,
                             vxm_error *error) {
  vxm_field_range range = VXM_FIELD_RANGE_INIT;
  vxm_threshold_options own;
  vxm_status status = vxm_field_measure(&range, r->field, error);
  if (status != VXM_OK)
    return status;
  vxm_field_kind kind = vxm_gridio_field_guess(r->field, &range);
  if (kind == VXM_FIELD_COLORS) {
    json_object_set_new(page->about, "kind", json_string("colors"));
    return put_rows(page, r, encode_colors, NULL, 1, error);
  }
  if (kind == VXM_FIELD_LABELS && !threshold)
    return put_labels(page, r, error);
  if (!threshold && vxm_gridio_field_shown(&own, kind, r->field, &range, NULL) != VXM_OK)
    own = (vxm_threshold_options){sizeof own, true, range.min / 2 + range.max / 2, false, 0};
  return put_numbers(page, r, kind, &range, threshold ? threshold : &own, error);
}

vxm_status vxm_page_put_field(vxm_page *page, const vxm_field *field, const vxm_threshold_options *threshold,
                              vxm_error *error) {
  rows r = {.field = field};
  size_t n = (size_t)field->space.dims[0];
  vxm_error local = VXM_ERROR_INIT;
  r.values = vxm_alloc(page->context, n, sizeof *r.values, &local);
  r.bytes = r.values ? vxm_alloc(page->context, n, 4, &local) : NULL;
  if (!r.bytes)
    vxm_error_pass(error, &local);
  vxm_status status = r.bytes ? put_values(page, &r, threshold, error) : local.code;
  vxm_free(page->context, r.bytes);
  vxm_free(page->context, r.values);
  return status;
}

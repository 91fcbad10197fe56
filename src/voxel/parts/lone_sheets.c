/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/parts/lone_sheets.h"

#include "base/box.h"
#include "mesh/nonfinite.h"

#include <math.h>

enum { OPENINGS_MOST = 4096 };

/** Of the sides of a box: what comes as near is near. */
static const double near_part = 1.0 / 16;
/** Of the cap of a sheet: an opening that is smaller is not what the sheet is the lid of. */
static const double opening_part = 1.0 / 4;

typedef struct box {
  double low[3], high[3];
  size_t component;
} box;

static void measure(box *boxes, const uint32_t *number, const vxm_soup *soup, const uint32_t *component) {
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(soup, f, &count);
    for (size_t i = 0; i < count && number[component[f]] != UINT32_MAX; i++) {
      box *b = &boxes[number[component[f]]];
      if (vxm_is_finite(vxm_position(soup, corner[i])))
        vxm_box_include(b->low, b->high, vxm_position(soup, corner[i]));
    }
  }
}

/** Whether a box, grown by a part of its longest side, meets another one. */
static bool is_near(const box *b, const box *other) {
  double side = 0;
  for (int a = 0; a < 3; a++)
    side = fmax(side, b->high[a] - b->low[a]);
  for (int a = 0; a < 3; a++)
    if (other->low[a] - b->high[a] > near_part * side || b->low[a] - other->high[a] > near_part * side)
      return false;
  return true;
}

/** Whether a component could make a body with a sheet. */
static bool may_go_with(const vxm_opening *other, const vxm_opening *sheet) {
  return other->open || other->widest_cap >= opening_part * sheet->widest_cap;
}

static void compare_boxes(vxm_opening *openings, const box *boxes, size_t count) {
  for (size_t i = 0; i < count; i++) {
    vxm_opening *sheet = &openings[boxes[i].component];
    for (size_t k = 0; k < count && sheet->lone; k++)
      sheet->lone =
          i == k || !may_go_with(&openings[boxes[k].component], sheet) || !is_near(&boxes[i], &boxes[k]);
  }
}

static bool has_opening(const vxm_opening *o) {
  return o->open || o->widest_cap > 0;
}

vxm_status vxm_lone_sheets_keep(vxm_opening *openings, const vxm_soup *soup, const uint32_t *component,
                                size_t count, vxm_error *error) {
  vxm_error local = VXM_ERROR_INIT;
  size_t listed = 0;
  for (size_t c = 0; c < count; c++)
    listed += has_opening(&openings[c]);
  for (size_t c = 0; c < count && listed > OPENINGS_MOST; c++)
    openings[c].lone = false;
  if (listed > OPENINGS_MOST)
    return VXM_OK;
  uint32_t *number = vxm_alloc(soup->context, count, sizeof *number, &local);
  box *boxes = vxm_alloc(soup->context, listed, sizeof *boxes, &local);
  listed = 0;
  for (size_t c = 0; number && boxes && c < count; c++) {
    number[c] = has_opening(&openings[c]) ? (uint32_t)listed : UINT32_MAX;
    if (!has_opening(&openings[c]))
      continue;
    vxm_box_empty(boxes[listed].low, boxes[listed].high);
    boxes[listed++].component = c;
  }
  if (number && boxes) {
    measure(boxes, number, soup, component);
    compare_boxes(openings, boxes, listed);
  }
  vxm_free(soup->context, boxes);
  vxm_free(soup->context, number);
  if (local.code != VXM_OK)
    vxm_error_pass(error, &local);
  return local.code;
}

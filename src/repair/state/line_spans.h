/* SPDX-License-Identifier: BSD-3-Clause */
/** Where lines are inside the parts of a mesh that they cross. */
#ifndef VXM_REPAIR_STATE_LINE_SPANS_H
#define VXM_REPAIR_STATE_LINE_SPANS_H

#include "base/context.h"

typedef struct vxm_crossing {
  size_t line;
  uint32_t part;
  int turn; /**< -1 where the line enters, 1 where it leaves */
  double height;
} vxm_crossing;

typedef struct vxm_line_crossings {
  vxm_crossing *items;
  size_t count, capacity;
} vxm_line_crossings;

/** @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_line_crossings_add(vxm_line_crossings *list, vxm_context *context, const vxm_crossing *one,
                                  vxm_error *error);
/** Sorts by line, then by part, then by height. */
void vxm_line_crossings_sort(vxm_line_crossings *list);

/** The crossings of one part with one line. */
typedef struct vxm_stretch {
  const vxm_crossing *begin, *end;
  bool winds, alternates; /**< with respect to winding, and to parity, it ends outside */
} vxm_stretch;

/** The first one of sorted crossings that are not none. */
vxm_stretch vxm_stretch_next(const vxm_crossing *begin, const vxm_crossing *end);

/** Ways along a line, in order and apart. */
typedef struct vxm_spans {
  struct vxm_span {
    double low, high;
  } * items;
  size_t count, capacity;
} vxm_spans;

/**
 * Lists where a line is inside one of the parts or several.
 *
 * @param begin, end all crossings of the line, sorted
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_spans_find(vxm_spans *spans, vxm_context *context, const vxm_crossing *begin,
                          const vxm_crossing *end, vxm_error *error);
/**
 * How much of the way from `low` to `high` the spans cover.
 *
 * @param next 0 at first; what is asked next begins no lower, and all together takes linear time
 */
double vxm_spans_cover(const vxm_spans *spans, size_t *next, double low, double high);

#endif

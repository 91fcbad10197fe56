/* SPDX-License-Identifier: BSD-3-Clause */
#include "repair/state/line_spans.h"

#include <math.h>
#include <stdlib.h>

/* ---- Crossings ---- */

vxm_status vxm_line_crossings_add(vxm_line_crossings *list, vxm_context *context, const vxm_crossing *one,
                                  vxm_error *error) {
  void *block = list->items;
  vxm_status status = list->count < list->capacity ? VXM_OK
                                                   : vxm_grow(context, &block, &list->capacity,
                                                              list->count + 1, sizeof *list->items, error);
  if (status != VXM_OK)
    return status;
  list->items = block;
  list->items[list->count++] = *one;
  return VXM_OK;
}

static int by_line_part_height(const void *a, const void *b) {
  const vxm_crossing *p = a, *q = b;
  if (p->line != q->line)
    return p->line < q->line ? -1 : 1;
  if (p->part != q->part)
    return p->part < q->part ? -1 : 1;
  return p->height < q->height ? -1 : p->height > q->height;
}

void vxm_line_crossings_sort(vxm_line_crossings *list) {
  if (list->count > 0)
    qsort(list->items, list->count, sizeof *list->items, by_line_part_height);
}

vxm_stretch vxm_stretch_next(const vxm_crossing *begin, const vxm_crossing *end) {
  vxm_stretch s = {.begin = begin, .end = begin};
  int sum = 0;
  for (; s.end < end && s.end->line == begin->line && s.end->part == begin->part; s.end++)
    sum += s.end->turn;
  s.winds = sum == 0;
  s.alternates = (s.end - s.begin) % 2 == 0;
  return s;
}

/* ---- Spans ---- */

static vxm_status add_span(vxm_spans *spans, vxm_context *context, double low, double high,
                           vxm_error *error) {
  void *block = spans->items;
  vxm_status status =
      spans->count < spans->capacity
          ? VXM_OK
          : vxm_grow(context, &block, &spans->capacity, spans->count + 1, sizeof *spans->items, error);
  if (status != VXM_OK)
    return status;
  spans->items = block;
  spans->items[spans->count++] = (struct vxm_span){low, high};
  return VXM_OK;
}

static int by_low(const void *a, const void *b) {
  const struct vxm_span *s = a, *t = b;
  return s->low < t->low ? -1 : s->low > t->low;
}

static void join_overlapping(vxm_spans *spans) {
  if (spans->count == 0)
    return;
  qsort(spans->items, spans->count, sizeof *spans->items, by_low);
  struct vxm_span *last = spans->items;
  for (const struct vxm_span *s = last + 1; s < spans->items + spans->count; s++) {
    if (s->low <= last->high)
      last->high = fmax(last->high, s->high);
    else
      *++last = *s;
  }
  spans->count = (size_t)(last - spans->items) + 1;
}

vxm_status vxm_spans_find(vxm_spans *spans, vxm_context *context, const vxm_crossing *begin,
                          const vxm_crossing *end, vxm_error *error) {
  spans->count = 0;
  for (const vxm_crossing *c = begin; c < end;) {
    vxm_stretch s = vxm_stretch_next(c, end);
    int winding = 0;
    for (const vxm_crossing *k = s.begin; k + 1 < s.end; k++) {
      winding += k->turn;
      bool inside = (s.winds && winding != 0) || (s.alternates && (k - s.begin) % 2 == 0);
      vxm_status status = inside ? add_span(spans, context, k->height, k[1].height, error) : VXM_OK;
      if (status != VXM_OK)
        return status;
    }
    c = s.end;
  }
  join_overlapping(spans);
  return VXM_OK;
}

double vxm_spans_cover(const vxm_spans *spans, size_t *next, double low, double high) {
  double sum = 0;
  while (*next < spans->count && spans->items[*next].high <= low)
    ++*next;
  for (size_t i = *next; i < spans->count && spans->items[i].low < high; i++)
    sum += fmin(spans->items[i].high, high) - fmax(spans->items[i].low, low);
  return sum;
}

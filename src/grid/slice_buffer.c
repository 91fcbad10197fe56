/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/slice_buffer.h"

#include <string.h>

/** Room for slices begin..end-1, those of them that are there already moved to the front. */
static vxm_status make_room(vxm_slice_buffer *b, const vxm_window *window, int64_t begin, int64_t end,
                            vxm_context *context, vxm_error *error) {
  size_t slice = window->slice_words, needed = (size_t)(end - begin) * slice;
  if (begin < b->begin || begin > b->end)
    b->end = begin;
  else if (begin > b->begin)
    memmove(b->words, b->words + (size_t)(begin - b->begin) * slice,
            (size_t)(b->end - begin) * slice * sizeof *b->words);
  b->begin = begin;
  if (needed <= b->capacity)
    return VXM_OK;
  vxm_error local = VXM_ERROR_INIT;
  uint64_t *words = vxm_realloc(context, b->words, needed, sizeof *words, &local);
  if (!words) {
    vxm_error_pass(error, &local);
    return local.code;
  }
  b->words = words;
  b->capacity = needed;
  return VXM_OK;
}

vxm_status vxm_slice_buffer_fill(vxm_slice_buffer *buffer, vxm_window *out, const vxm_window *window,
                                 int64_t margin, vxm_fill_fn fill, void *payload, vxm_context *context,
                                 vxm_error *error) {
  int64_t begin = vxm_max(window->begin - margin, 0), end = vxm_min(window->end + margin, window->slow_dim);
  vxm_status status = make_room(buffer, window, begin, end, context, error);
  if (status != VXM_OK)
    return status;
  *out = *window;
  if (buffer->end < end) {
    out->begin = buffer->end;
    out->end = end;
    out->words = buffer->words + (size_t)(out->begin - begin) * out->slice_words;
    status = fill(out, payload, error);
    if (status != VXM_OK)
      return status;
    buffer->end = end;
  }
  out->begin = begin;
  out->end = end;
  out->words = buffer->words;
  return VXM_OK;
}

void vxm_slice_buffer_destroy(vxm_slice_buffer *buffer, vxm_context *context) {
  vxm_free(context, buffer->words);
}

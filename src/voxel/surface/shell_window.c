/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/surface/shell_window.h"

#include <string.h>

/** Room for slices begin..end-1, those of them that are there already moved to the front. */
static vxm_status make_room(vxm_shell_window *s, const vxm_window *window, int64_t begin, int64_t end,
                            vxm_context *context, vxm_error *error) {
  size_t slice = window->slice_words, needed = (size_t)(end - begin) * slice;
  if (begin < s->begin || begin > s->end)
    s->end = begin;
  else if (begin > s->begin)
    memmove(s->words, s->words + (size_t)(begin - s->begin) * slice,
            (size_t)(s->end - begin) * slice * sizeof *s->words);
  s->begin = begin;
  if (needed <= s->capacity)
    return VXM_OK;
  vxm_error local = VXM_ERROR_INIT;
  uint64_t *words = vxm_realloc(context, s->words, needed, sizeof *words, &local);
  if (!words) {
    vxm_error_pass(error, &local);
    return local.code;
  }
  s->words = words;
  s->capacity = needed;
  return VXM_OK;
}

vxm_status vxm_shell_window_fill(vxm_shell_window *shelling, const vxm_window *window,
                                 vxm_adjacency adjacency, vxm_fill_fn fill, void *payload,
                                 vxm_context *context, vxm_error *error) {
  int64_t begin = vxm_max(window->begin - 1, 0), end = vxm_min(window->end + 1, window->slow_dim);
  vxm_status status = make_room(shelling, window, begin, end, context, error);
  if (status != VXM_OK)
    return status;
  vxm_window solid = *window;
  if (shelling->end < end) {
    solid.begin = shelling->end;
    solid.end = end;
    solid.words = shelling->words + (size_t)(solid.begin - begin) * solid.slice_words;
    status = fill(&solid, payload, error);
    if (status != VXM_OK)
      return status;
    shelling->end = end;
  }
  solid.begin = begin;
  solid.words = shelling->words;
  vxm_shell_fill(window, &solid, adjacency, context);
  return VXM_OK;
}

void vxm_shell_window_destroy(vxm_shell_window *shelling, vxm_context *context) {
  vxm_free(context, shelling->words);
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/thin_window.h"

#include <string.h>

static vxm_status add(vxm_thin_window *thin, const vxm_window *to, int64_t begin, int64_t end,
                      const vxm_thin_grid *grid, bool *too_many, vxm_error *error) {
  return vxm_thin_add(&thin->thin, to, begin, end, grid->triangles, grid->placed, grid->separating,
                      grid->confidence, too_many, error);
}

static void copy_slices(const vxm_window *to, const vxm_window *from, int64_t begin, int64_t end) {
  if (begin < end)
    memcpy(vxm_window_row(to, 0, begin), vxm_window_row(from, 0, begin),
           (size_t)(end - begin) * from->slice_words * sizeof *from->words);
}

/** The solid as it is made, and the slices before those to come, which may have been replaced in it. */
typedef struct source {
  vxm_window solid, before;
} source;

/** Slices begin..end-1 of the solid with those around them, in the words kept for that. */
static vxm_status take_slices(vxm_thin_window *thin, vxm_window *out, const source *from, int64_t begin,
                              int64_t end, int64_t margin, vxm_error *error) {
  *out = from->solid;
  out->begin = vxm_max(begin - margin, from->solid.begin);
  out->end = vxm_min(end + margin, from->solid.end);
  vxm_status status =
      vxm_renew(thin->thin.context, (void **)&thin->words, &thin->capacity,
                (size_t)(out->end - out->begin) * out->slice_words, sizeof *thin->words, error);
  out->words = thin->words;
  if (status != VXM_OK)
    return status;
  copy_slices(out, &from->before, out->begin, vxm_min(begin, from->before.end));
  copy_slices(out, &from->solid, vxm_max(out->begin, from->before.end), out->end);
  return VXM_OK;
}

/** Some slices after others, as many as can be looked at at once. The solid may lie in the window itself. */
static vxm_status add_by_slices(vxm_thin_window *thin, const vxm_window *window, const vxm_window *solid,
                                int64_t slices, const vxm_thin_grid *grid, vxm_error *error) {
  const int64_t margin = vxm_thin_margin(grid->separating);
  source from = {*solid, *solid};
  vxm_status status = vxm_renew(thin->thin.context, (void **)&thin->before, &thin->before_capacity,
                                (size_t)margin * solid->slice_words, sizeof *thin->before, error);
  from.before.begin = from.before.end = solid->begin; /* none yet: all is in the solid */
  from.before.words = thin->before;
  for (int64_t begin = window->begin; begin < window->end && status == VXM_OK;) {
    int64_t end = vxm_min(begin + slices, window->end);
    bool too_many = false;
    vxm_window part;
    status = take_slices(thin, &part, &from, begin, end, margin, error);
    if (status == VXM_OK)
      status = add(thin, &part, begin, end, grid, end - begin > 1 ? &too_many : NULL, error);
    if (status != VXM_OK)
      return status;
    if (too_many) {
      slices = (end - begin + 1) / 2;
      continue;
    }
    vxm_window kept = from.before; /* of the solid, before they are replaced */
    kept.begin = vxm_max(end - margin, solid->begin);
    kept.end = end;
    uint64_t *to = kept.words;
    for (int64_t slice = kept.begin; slice < end; slice++, to += solid->slice_words) {
      const vxm_window *has = slice < from.before.end ? &from.before : solid;
      memmove(to, vxm_window_row(has, 0, slice), solid->slice_words * sizeof *to);
    }
    from.before = kept;
    copy_slices(window, &part, begin, end);
    begin = end;
    if (thin->thin.is_slack)
      slices = vxm_min(2 * slices, window->end - window->begin);
  }
  return status;
}

vxm_status vxm_thin_window_fill(vxm_thin_window *thin, const vxm_window *window, const vxm_thin_grid *grid,
                                vxm_error *error) {
  vxm_status status;
  if (window->begin == 0 && window->end == window->slow_dim) {
    bool too_many = false;
    status = grid->fill(window, grid->payload, error);
    if (status == VXM_OK)
      status = add(thin, window, window->begin, window->end, grid, window->end > 1 ? &too_many : NULL, error);
    return status == VXM_OK && too_many
               ? add_by_slices(thin, window, window, (window->end + 1) / 2, grid, error)
               : status;
  }
  vxm_window solid;
  status = vxm_slice_buffer_fill(&thin->solid, &solid, window, vxm_thin_margin(grid->separating), grid->fill,
                                 grid->payload, thin->thin.context, error);
  return status == VXM_OK ? add_by_slices(thin, window, &solid, window->end - window->begin, grid, error)
                          : status;
}

void vxm_thin_window_destroy(vxm_thin_window *window) {
  vxm_context *context = window->thin.context;
  vxm_slice_buffer_destroy(&window->solid, context);
  vxm_free(context, window->words);
  vxm_free(context, window->before);
  vxm_thin_destroy(&window->thin);
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/common/slab.h"

#include "base/size_text.h"

#include <string.h>

vxm_slab vxm_slab_of(const vxm_window *window, int64_t begin, int64_t slices) {
  vxm_slab slab = {.window = window,
                   .begin = begin,
                   .end = vxm_min(begin + slices, window->end),
                   .row_words = window->row_words};
  slab.words = slab.row_words * (size_t)window->middle_dim * (size_t)(slab.end - begin);
  return slab;
}

vxm_status vxm_slab_slices(int64_t *out, const vxm_engine *engine, const vxm_window *window,
                           int64_t slice_most, int64_t most, vxm_error *error) {
  int64_t slice = (int64_t)window->row_words * window->middle_dim * (int64_t)sizeof(uint64_t);
  if (slice > slice_most)
    return vxm_fail(error, VXM_ERROR_RANGE, "one slice of the grid takes %s; %s can do %s; use --engine cpu",
                    vxm_size_text_of((uint64_t)slice).text, engine->info.renderer,
                    vxm_size_text_of((uint64_t)slice_most).text);
  *out = vxm_max(1, vxm_min(most / slice, window->end - window->begin));
  return VXM_OK;
}

int64_t vxm_slab_share(vxm_context *context, size_t held, int buffers) {
  size_t left = vxm_memory_left(context);
  if (left > INT64_MAX / 2) /* there is no limit */
    return INT64_MAX;
  return (int64_t)((left + held) / (size_t)buffers);
}

size_t vxm_slab_slice_words(const vxm_slab *slab) {
  return slab->row_words * (size_t)slab->window->middle_dim;
}

size_t vxm_slab_offset(const vxm_slab *slab) {
  return (size_t)(slab->begin - slab->window->begin) * vxm_slab_slice_words(slab) * sizeof(uint64_t);
}

uint64_t *vxm_slab_slice_at(const vxm_slab *slab, uint64_t *words, int64_t slice) {
  return words + (size_t)(slice - slab->window->begin) * slab->window->slice_words;
}

vxm_progress_part vxm_slab_progress(const vxm_slab *slab) {
  const vxm_window *window = slab->window;
  double all = (double)(window->end - window->begin);
  return vxm_progress_enter((double)(slab->begin - window->begin) / all,
                            (double)(slab->end - window->begin) / all);
}

void vxm_slab_take(const vxm_slab *slab, uint64_t *words, const uint64_t *from, bool is_or) {
  size_t count = vxm_slab_slice_words(slab);
  for (int64_t k = slab->begin; k < slab->end; k++, from += count) {
    uint64_t *to = vxm_slab_slice_at(slab, words, k);
    if (!is_or)
      memcpy(to, from, count * sizeof *to);
    else
      for (size_t w = 0; w < count; w++)
        to[w] |= from[w];
  }
}

vxm_slab_columns vxm_slab_columns_of(const vxm_slab *slab, const vxm_parity_union_job *job) {
  vxm_window part = *slab->window;
  part.begin = slab->begin;
  part.end = slab->end;
  part.slice_words = vxm_slab_slice_words(slab);
  vxm_columns columns = vxm_columns_of(&part, job->axis);
  const int axes[3] = {columns.u, columns.v, columns.w};
  vxm_slab_columns out = {.bits = job->placed->lattice.bits, .keep_before = columns.keep_before};
  for (int i = 0; i < 3; i++) {
    out.axes[i] = axes[i];
    out.first[i] = (int32_t)columns.begin[axes[i]];
    out.last[i] = (int32_t)columns.end[axes[i]];
    out.step[i] = (uint32_t)columns.step[axes[i]];
  }
  return out;
}

vxm_slab_surface vxm_slab_surface_of(const vxm_slab *slab, const vxm_surface *surface,
                                     vxm_surface_kind kind) {
  const vxm_layout *layout = &slab->window->layout;
  uint32_t row_bits = (uint32_t)(64 * slab->row_words);
  vxm_slab_surface out = {.bits = surface->lattice.bits,
                          .thin = kind == VXM_SURFACE_THIN,
                          .triangle_count = (uint32_t)surface->triangle_count};
  out.last[layout->fast] = (int32_t)slab->window->fast_dim;
  out.last[layout->middle] = (int32_t)slab->window->middle_dim;
  out.first[layout->slow] = (int32_t)slab->begin;
  out.last[layout->slow] = (int32_t)slab->end;
  out.step[layout->fast] = 1;
  out.step[layout->middle] = row_bits;
  out.step[layout->slow] = row_bits * (uint32_t)slab->window->middle_dim;
  return out;
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "gpu/common/slice_job.h"

#include <string.h>

vxm_slice_job vxm_slice_job_of(const vxm_window *window, int64_t begin, int64_t slices) {
  vxm_slice_job tile = {.window = window,
                        .begin = begin,
                        .end = vxm_min(begin + slices, window->end),
                        .row_words = window->row_words};
  tile.words = tile.row_words * (size_t)window->middle_dim * (size_t)(tile.end - begin);
  return tile;
}

size_t vxm_slice_job_slice_words(const vxm_slice_job *tile) {
  return tile->row_words * (size_t)tile->window->middle_dim;
}

uint64_t *vxm_slice_job_slice_at(const vxm_slice_job *tile, uint64_t *words, int64_t slice) {
  return words + (size_t)(slice - tile->window->begin) * tile->window->slice_words;
}

vxm_progress_part vxm_slice_job_progress(const vxm_slice_job *tile) {
  const vxm_window *window = tile->window;
  double all = (double)(window->end - window->begin);
  return vxm_progress_enter((double)(tile->begin - window->begin) / all,
                            (double)(tile->end - window->begin) / all);
}

void vxm_slice_job_take(const vxm_slice_job *tile, uint64_t *words, const uint64_t *from, bool is_or) {
  size_t count = vxm_slice_job_slice_words(tile);
  for (int64_t k = tile->begin; k < tile->end; k++, from += count) {
    uint64_t *to = vxm_slice_job_slice_at(tile, words, k);
    if (!is_or)
      memcpy(to, from, count * sizeof *to);
    else
      for (size_t w = 0; w < count; w++)
        to[w] |= from[w];
  }
}

vxm_slice_job_columns vxm_slice_job_columns_of(const vxm_slice_job *tile, const vxm_parity_union_job *job) {
  vxm_window part = *tile->window;
  part.begin = tile->begin;
  part.end = tile->end;
  part.slice_words = vxm_slice_job_slice_words(tile);
  vxm_columns columns = vxm_columns_of(&part, job->axis);
  const int axes[3] = {columns.u, columns.v, columns.w};
  vxm_slice_job_columns out = {.bits = job->placed->lattice.bits, .keep_before = columns.keep_before};
  for (int i = 0; i < 3; i++) {
    out.axes[i] = axes[i];
    out.first[i] = (int32_t)columns.begin[axes[i]];
    out.last[i] = (int32_t)columns.end[axes[i]];
    out.step[i] = (uint32_t)columns.step[axes[i]];
  }
  return out;
}

vxm_slice_job_surface vxm_slice_job_surface_of(const vxm_slice_job *tile, const vxm_surface *surface,
                                               vxm_surface_kind kind) {
  const vxm_layout *layout = &tile->window->layout;
  uint32_t row_bits = (uint32_t)(64 * tile->row_words);
  vxm_slice_job_surface out = {.bits = surface->lattice.bits,
                               .thin = kind == VXM_SURFACE_THIN,
                               .triangle_count = (uint32_t)surface->triangle_count};
  out.last[layout->fast] = (int32_t)tile->window->fast_dim;
  out.last[layout->middle] = (int32_t)tile->window->middle_dim;
  out.first[layout->slow] = (int32_t)tile->begin;
  out.last[layout->slow] = (int32_t)tile->end;
  out.step[layout->fast] = 1;
  out.step[layout->middle] = row_bits;
  out.step[layout->slow] = row_bits * (uint32_t)tile->window->middle_dim;
  return out;
}

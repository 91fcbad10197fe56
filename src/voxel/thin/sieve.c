/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/sieve.h"
#include "voxel/thin/sieve_kernels.h"

#include <string.h>

bool vxm_sieve_of(vxm_sieve *sieve, const vxm_thin_job *job) {
  const vxm_view *view = &job->view;
  *sieve = (vxm_sieve){.points = (const int32_t(*)[4])job->placed->narrow,
                       .corners = job->corners,
                       .order = job->order,
                       .words = view->words,
                       .bits = job->placed->lattice.bits};
  if (!view->words || job->placed->wide)
    return false;
  int slow = job->slow, fast = view->step[(slow + 1) % 3] == 1 ? (slow + 1) % 3 : (slow + 2) % 3;
  const int axis[3] = {fast, 3 - fast - slow, slow};
  const int64_t most = INT64_C(1) << 30;
  int64_t bytes = (view->end[slow] - view->begin[slow]) * view->step[slow] / 8;
  if (bytes > most || bytes == 0)
    return false;
  for (int i = 0; i < 3; i++) {
    sieve->axis[i] = axis[i];
    sieve->begin[i] = (int32_t)view->begin[axis[i]];
    sieve->end[i] = (int32_t)view->end[axis[i]];
    sieve->step[i] = (int32_t)(view->step[axis[i]] / 8);
  }
  sieve->cells = job->placed->cells;
  sieve->middles = job->middles;
  sieve->short_cells = job->short_cells;
  sieve->map_bits = (uint32_t)(64 * (int64_t)vxm_middle_words((size_t)bytes / 8));
  sieve->short_origin = (uint32_t)view->origin;
  sieve->row_bits = (uint32_t)view->step[axis[1]];
  sieve->slice_bits = (uint32_t)view->step[slow];
  for (int i = 0; i < 3 && job->middles; i++) {
    sieve->short_first |= (uint32_t)sieve->begin[i] << (VXM_SHORT_BITS * i);
    sieve->short_last |= (uint32_t)sieve->end[i] << (VXM_SHORT_BITS * i);
  }
  sieve->last = (int32_t)(bytes - 4);
  return true;
}

bool vxm_cells_fit_short(const vxm_window *window) {
  const int64_t longest = (1 << (VXM_SHORT_BITS - 1)) - 1;
  return window->fast_dim < longest && window->middle_dim < longest && window->slow_dim < longest;
}

bool vxm_middles_fit(const vxm_window *window) {
  const size_t most = 1 << 22; /* words, so that bits of all maps have numbers of 32 bits */
  return window->slice_words == window->row_words * (size_t)window->middle_dim &&
         vxm_cells_fit_short(window) && (size_t)(window->end - window->begin) * window->slice_words < most;
}

void vxm_middles_fill(uint64_t *middles, const vxm_window *window) {
  size_t words = (size_t)(window->end - window->begin) * window->slice_words;
  const size_t each = vxm_middle_words(words);
  uint64_t *neither = middles, *two_middle = neither + each, *two_slow = two_middle + each,
           *both = two_slow + each;
  const vxm_sieve_kernels *kernels = vxm_sieve_kernels_of(NULL);
  memcpy(both, window->words, words * sizeof *both);
  kernels->join(two_slow, both, window->row_words, words);
  kernels->join(two_middle, both, window->slice_words, words);
  kernels->join(neither, two_slow, window->slice_words, words);
}

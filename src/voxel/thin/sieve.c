/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/sieve.h"
#include "voxel/thin/sieve_kernels.h"

bool vxm_sieve_of(vxm_sieve *sieve, const vxm_thin_job *job) {
  const vxm_view *view = &job->view;
  *sieve = (vxm_sieve){.points = (const int32_t(*)[4])job->placed->narrow,
                       .corners = (const uint32_t(*)[3])job->triangles->corners,
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
  for (int m = 0; m < 8; m++)
    sieve->middles[m] = job->middles[m];
  sieve->cells = job->placed->cells;
  sieve->origin = (uint64_t)view->origin;
  for (int a = 0; a < 3; a++) {
    sieve->cell_step[a] = (uint64_t)view->step[a];
    sieve->first_cell |= (uint64_t)(view->begin[a] + 1) << (VXM_CELL_BITS * a);
    sieve->last_cell |= (uint64_t)(view->end[a] - 1) << (VXM_CELL_BITS * a);
  }
  sieve->last = (int32_t)(bytes - 4);
  return true;
}

void vxm_middles_fill(uint64_t *const middles[8], const vxm_window *window) {
  const int axis[3] = {window->layout.fast, window->layout.middle, window->layout.slow};
  const size_t step[3] = {0, window->row_words, window->slice_words};
  size_t words = (size_t)(window->end - window->begin) * window->slice_words;
  for (int two = 6; two >= 0; two--) {
    int a = 0; /* along which the voxel before is added, to what is there for both axes with two cells */
    while (two >> axis[a] & 1)
      a++;
    vxm_sieve_kernels_of(NULL)->join(middles[two], middles[two | 1 << axis[a]], step[a], words);
  }
}

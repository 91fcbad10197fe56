/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/thin/sieve.h"

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
  int64_t bits = (view->end[slow] - view->begin[slow]) * view->step[slow];
  if (bits > INT32_MAX || bits == 0)
    return false;
  for (int i = 0; i < 3; i++) {
    sieve->axis[i] = axis[i];
    sieve->begin[i] = (int32_t)view->begin[axis[i]];
    sieve->end[i] = (int32_t)view->end[axis[i]];
    sieve->step[i] = (int32_t)view->step[axis[i]];
  }
  sieve->last = (int32_t)(bits / 8 - 4);
  return true;
}

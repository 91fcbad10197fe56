/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/solid/confidence.h"
#include "base/threads.h"
#include "voxel/solid/self_overlap_fill.h"

#include <string.h>

enum { VOTERS = 4 };

typedef struct confidence_job {
  uint8_t *confidence;
  const vxm_window *window;
  const uint64_t *closed, *settled, *voters[VOTERS];
} confidence_job;

static bool bit(const uint64_t *row, int64_t i) {
  return row[i / 64] >> (i % 64) & 1;
}

static void fill_slice(size_t slice, int worker, void *payload) {
  (void)worker;
  const confidence_job *job = payload;
  const vxm_window *w = job->window;
  for (int64_t j = 0; j < w->middle_dim; j++) {
    uint8_t *out = job->confidence + ((int64_t)slice * w->middle_dim + j) * w->fast_dim;
    size_t row = slice * w->slice_words + (size_t)j * w->row_words;
    for (int64_t i = 0; i < w->fast_dim; i++) {
      int agree = 0;
      for (int v = 0; v < VOTERS; v++)
        agree += (bit(job->closed + row, i) || bit(job->voters[v] + row, i)) == bit(w->words + row, i);
      if (!job->settled || !bit(job->settled + row, i))
        out[i] = (uint8_t)(255 * agree / VOTERS);
    }
  }
}

vxm_status vxm_confidence_fill(vxm_voxel_pass *pass, const vxm_window *window, vxm_error *error) {
  const vxm_mesh_analysis *analysis = pass->analysis;
  vxm_method method = pass->options.method;
  size_t end = analysis->triangles.split.part_count;
  size_t begin = method == VXM_METHOD_VOTE ? analysis->triangles.split.kind_end[VXM_PART_CLOSED] : 0;
  if (method == VXM_METHOD_WINDING)
    return VXM_OK; /* which decided every voxel */
  if (begin == end) {
    memset(pass->confidence, 255,
           (size_t)window->fast_dim * (size_t)window->middle_dim * (size_t)window->slow_dim);
    return VXM_OK;
  }
  confidence_job job = {.confidence = pass->confidence, .window = window};
  job.settled = pass->winding_decided > 0 ? pass->buffers[VXM_BUFFER_MASK].words : NULL;
  atomic_uchar *has_voxels = pass->has_voxels;
  pass->has_voxels = NULL; /* what these voters see says nothing about the result */
  vxm_window made;
  vxm_status status = vxm_voxel_pass_buffer(pass, VXM_BUFFER_CLOSED, window, &made, error);
  if (status == VXM_OK)
    status = vxm_voxel_pass_unite(pass, &made, 0, 0, begin, VXM_ROLE_FACE, error);
  if (status == VXM_OK && method == VXM_METHOD_VOTE)
    status = vxm_self_overlap_fill(pass, &made, error);
  job.closed = made.words;
  for (int v = 0; v < VOTERS && status == VXM_OK; v++) {
    status = vxm_voxel_pass_buffer(pass, VXM_BUFFER_VOTERS + v, window, &made, error);
    unsigned roles = v == 3 ? VXM_ROLE_FACE | VXM_ROLE_CONE : VXM_ROLE_FACE;
    if (status == VXM_OK)
      status = vxm_voxel_pass_unite(pass, &made, v == 3 ? 0 : v, begin, end, roles, error);
    job.voters[v] = made.words;
  }
  pass->has_voxels = has_voxels;
  if (status == VXM_OK)
    status = vxm_parallel_cancellable(pass->context, (size_t)(window->end - window->begin), fill_slice, &job,
                                      error);
  return status;
}

/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/slices.h"
#include "gridio/sparse_io.h"

/** Bytes of the windows between an octree and its file, unless a few slices are more. */
static const uint64_t window_bytes = UINT64_C(1) << 24;
/** What is asked for at least, so that most bricks are visited once. */
enum { SLICES_LEAST = 4 };

static vxm_status put_windows(vxm_slices *slices, const vxm_sparse *sparse, vxm_error *error) {
  vxm_window window = vxm_window_of(&sparse->space, vxm_slices_layout(slices), 0, 0);
  uint64_t slice = window.slice_words * sizeof *window.words;
  int64_t step = (int64_t)(window_bytes / slice) / SLICES_LEAST * SLICES_LEAST;
  step = vxm_min(vxm_max(step, SLICES_LEAST), window.slow_dim);
  vxm_error local = VXM_ERROR_INIT;
  window.words = vxm_alloc(sparse->context, window.slice_words * (size_t)step, sizeof *window.words, &local);
  vxm_status status = local.code;
  if (!window.words && error)
    *error = local;
  for (int64_t begin = 0; begin < window.slow_dim && status == VXM_OK; begin += step) {
    window.begin = begin;
    window.end = vxm_min(begin + step, window.slow_dim);
    vxm_octree_fill(sparse, &window);
    status = vxm_slices_put(slices, &window, error);
  }
  vxm_free(sparse->context, window.words);
  return status;
}

vxm_status vxm_gridio_write_sparse(const vxm_sparse *sparse, const char *path, const char *format,
                                   vxm_error *error) {
  vxm_slices *slices;
  vxm_status status = vxm_slices_open(&slices, sparse->context, &sparse->space, path, format, error);
  if (status != VXM_OK)
    return status;
  vxm_slices_report(slices);
  status = put_windows(slices, sparse, error);
  if (status == VXM_OK)
    return vxm_slices_commit(slices, error);
  vxm_slices_abort(slices);
  return status;
}

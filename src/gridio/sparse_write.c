/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/sparse_write.h"
#include "gridio/common/format.h"

/** Bytes of the windows between an octree and its file, unless a few slices are more. */
static const uint64_t window_bytes = UINT64_C(1) << 24;
/** What is asked for at least, so that most bricks are visited once. */
enum { SLICES_LEAST = 4 };

static vxm_status put_window(const vxm_window *window, void *payload, vxm_error *error) {
  return vxm_grid_writer_put(payload, window, error);
}

vxm_status vxm_gridio_write_sparse(const vxm_sparse *sparse, const char *path, const char *format,
                                   vxm_error *error) {
  const vxm_grid_format *found = vxm_grid_format_for(path, format, error);
  if (!found)
    return VXM_ERROR_ARGUMENT;
  if (found->write_sparse)
    return found->write_sparse(sparse, path, error);
  vxm_grid_writer *writer;
  vxm_status status = vxm_grid_writer_open(&writer, sparse->context, &sparse->space, path, format, error);
  if (status != VXM_OK)
    return status;
  vxm_grid_writer_report(writer);
  vxm_layout layout = vxm_grid_writer_layout(writer);
  uint64_t slice = vxm_window_of(&sparse->space, layout, 0, 0).slice_words * sizeof(uint64_t);
  int64_t step = (int64_t)(window_bytes / slice) / SLICES_LEAST * SLICES_LEAST;
  step = vxm_max(step, SLICES_LEAST);
  status = vxm_octree_each_window(sparse, layout, step, put_window, writer, error);
  if (status == VXM_OK)
    return vxm_grid_writer_commit(writer, error);
  vxm_grid_writer_abort(writer);
  return status;
}

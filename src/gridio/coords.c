/* SPDX-License-Identifier: BSD-3-Clause */
/** The coordinates of set voxels as a .npy file, from windows that run along z, y and x. */
#include "gridio/bytes.h"
#include "gridio/npy_header.h"
#include "gridio/planes.h"
#include "gridio/sparse_io.h"

enum { SLICES = 16 /**< of a window of an octree, at most */, ROOM = 4096 };

static const vxm_layout layout = VXM_PLANE_Z_FAST;

static void put_row(vxm_output *output, const uint64_t *row, size_t words, int64_t i, int64_t j) {
  enum { BYTES = 12 };
  for (size_t w = 0; w < words; w++) {
    if (!row[w])
      continue;
    unsigned char *room = (unsigned char *)vxm_output_reserve(output, ROOM);
    size_t used = 0;
    for (uint64_t left = row[w]; left; left &= left - 1, used += BYTES) {
      vxm_store_le32(room + used, (uint32_t)i);
      vxm_store_le32(room + used + 4, (uint32_t)j);
      vxm_store_le32(room + used + 8, (uint32_t)(64 * w + (unsigned)__builtin_ctzll(left)));
    }
    vxm_output_advance(output, used);
  }
}

/** Writes the voxels of a window; stops early after a failed write, which the end reports. */
static vxm_status put_window(vxm_output *output, vxm_context *context, const vxm_window *window,
                             vxm_error *error) {
  for (int64_t i = window->begin; i < window->end && !vxm_output_failed(output); i++)
    for (int64_t j = 0; j < window->middle_dim; j++)
      put_row(output, vxm_window_row(window, j, i), window->row_words, i, j);
  return vxm_progress(context, "writing", (double)window->end / (double)window->slow_dim, error);
}

static vxm_status put_sparse(vxm_output *output, const vxm_sparse *sparse, vxm_error *error) {
  vxm_window window = vxm_window_of(&sparse->space, layout, 0, 0);
  int64_t step = vxm_min(SLICES, window.slow_dim);
  vxm_error local = VXM_ERROR_INIT;
  window.words = vxm_alloc(sparse->context, window.slice_words * (size_t)step, sizeof *window.words, &local);
  vxm_status status = local.code;
  if (!window.words && error)
    *error = local;
  for (int64_t begin = 0; begin < window.slow_dim && status == VXM_OK; begin += step) {
    window.begin = begin;
    window.end = vxm_min(begin + step, window.slow_dim);
    vxm_octree_fill(sparse, &window);
    status = put_window(output, sparse->context, &window, error);
  }
  vxm_free(sparse->context, window.words);
  return status;
}

static vxm_status put_grid(vxm_output *output, const vxm_grid *grid, vxm_error *error) {
  vxm_planes planes;
  vxm_status status = vxm_planes_create(&planes, grid->context, &grid->space, layout, error);
  if (status != VXM_OK)
    return status;
  for (size_t w = 0; w < grid->row_words && status == VXM_OK; w++) {
    vxm_planes_gather(&planes, grid, w, NULL);
    vxm_window window = vxm_planes_window(&planes, grid, w);
    status = put_window(output, grid->context, &window, error);
  }
  vxm_planes_destroy(&planes);
  return status;
}

static vxm_status begin(vxm_output **output, vxm_context *context, const char *path, int64_t count,
                        vxm_error *error) {
  if (!vxm_text_equal_nocase(vxm_path_extension(path), "npy"))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "%s: coordinates are written as .npy only", path);
  vxm_status status = vxm_output_open(output, context, path, error);
  if (status == VXM_OK)
    vxm_npy_header_write_table(*output, "<i4", count, 3);
  return status;
}

static vxm_status end(vxm_output *output, vxm_status status, vxm_error *error) {
  if (status == VXM_OK)
    return vxm_output_commit(output, error);
  vxm_output_abort(output);
  return status;
}

vxm_status vxm_gridio_coords_sparse(const vxm_sparse *sparse, const char *path, vxm_error *error) {
  int64_t count;
  uint64_t hash;
  vxm_output *output;
  vxm_octree_sum(sparse, &count, &hash);
  vxm_status status = begin(&output, sparse->context, path, count, error);
  return status == VXM_OK ? end(output, put_sparse(output, sparse, error), error) : status;
}

vxm_status vxm_gridio_coords_grid(const vxm_grid *grid, const char *path, vxm_error *error) {
  vxm_output *output;
  vxm_status status = begin(&output, grid->context, path, vxm_grid_count(grid), error);
  return status == VXM_OK ? end(output, put_grid(output, grid, error), error) : status;
}

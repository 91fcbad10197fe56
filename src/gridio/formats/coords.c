/* SPDX-License-Identifier: BSD-3-Clause */
/** The coordinates of set voxels as a .npy file, from windows that run along z, y and x. */
#include "gridio/formats/coords.h"
#include "base/endian.h"
#include "grid/bit_transpose.h"
#include "gridio/formats/npy_header.h"

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

typedef struct target {
  vxm_output *output;
  vxm_context *context; /**< for progress */
} target;

/** Writes the voxels of a window; stops early after a failed write, which the end reports. */
static vxm_status put_window(const vxm_window *window, void *payload, vxm_error *error) {
  const target *to = payload;
  vxm_output *output = to->output;
  for (int64_t i = window->begin; i < window->end && !vxm_output_failed(output); i++)
    for (int64_t j = 0; j < window->middle_dim; j++)
      put_row(output, vxm_window_row(window, j, i), window->row_words, i, j);
  return vxm_progress(to->context, "writing", (double)window->end / (double)window->slow_dim, error);
}

static vxm_status put_grid(vxm_output *output, const vxm_grid *grid, vxm_error *error) {
  target to = {output, grid->context};
  vxm_bit_transpose planes;
  vxm_status status = vxm_bit_transpose_create(&planes, grid->context, &grid->space, layout, error);
  if (status != VXM_OK)
    return status;
  for (size_t w = 0; w < grid->row_words && status == VXM_OK; w++) {
    vxm_bit_transpose_gather(&planes, grid, w, NULL);
    vxm_window window = vxm_bit_transpose_window(&planes, grid, w);
    status = put_window(&window, &to, error);
  }
  vxm_bit_transpose_destroy(&planes);
  return status;
}

static vxm_status begin(vxm_output **output, vxm_context *context, const char *path, int64_t count,
                        vxm_error *error) {
  if (!vxm_text_equal_nocase(vxm_path_extension(path), "npy"))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "%s: coordinates are written as .npy only", path);
  vxm_status status = vxm_output_open(output, context, path, error);
  if (status != VXM_OK)
    return status;
  status = vxm_output_expect(*output, (uint64_t)count * 12, error);
  if (status == VXM_OK)
    vxm_npy_header_write_table(*output, "<i4", count, 3);
  else
    vxm_output_abort(*output);
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
  vxm_octree_count_hash(sparse, &count, &hash);
  vxm_status status = begin(&output, sparse->context, path, count, error);
  if (status != VXM_OK)
    return status;
  target to = {output, sparse->context};
  return end(output, vxm_octree_each_window(sparse, layout, SLICES, put_window, &to, error), error);
}

vxm_status vxm_gridio_coords_grid(const vxm_grid *grid, const char *path, vxm_error *error) {
  vxm_output *output;
  vxm_status status = begin(&output, grid->context, path, vxm_grid_count(grid), error);
  return status == VXM_OK ? end(output, put_grid(output, grid, error), error) : status;
}

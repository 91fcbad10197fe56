/* SPDX-License-Identifier: BSD-3-Clause */
/** .octree as a grid format: dense grids go by way of an octree. */
#include "grid/octree_build.h"
#include "gridio/common/format.h"
#include "gridio/formats/octree_file.h"

/** The mapping stays with the input. */
static vxm_status open_borrowed(vxm_sparse_file **out, const vxm_input *input, vxm_error *error) {
  vxm_input borrowed = *input;
  borrowed.mapping = borrowed.block = NULL;
  return vxm_octree_file_open(out, &borrowed, error);
}

static vxm_status read_sparse(vxm_sparse **out, const vxm_input *input, vxm_error *error) {
  vxm_sparse_file *file;
  vxm_status status = open_borrowed(&file, input, error);
  if (status == VXM_OK)
    status = vxm_octree_file_load(out, file, (int64_t[3]){0, 0, 0}, file->space.dims, error);
  vxm_sparse_file_close(file);
  return status;
}

static vxm_status read_grid(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  vxm_sparse_file *file;
  vxm_sparse *sparse = NULL;
  vxm_status status = open_borrowed(&file, input, error);
  if (status == VXM_OK)
    status = vxm_grid_create(out, input->context, &file->space, error);
  if (status == VXM_OK && rule != VXM_BITS_NONE)
    status = vxm_octree_file_load(&sparse, file, (int64_t[3]){0, 0, 0}, file->space.dims, error);
  if (sparse) {
    vxm_window window = vxm_window_of_grid(*out);
    vxm_octree_fill(sparse, &window);
  }
  vxm_sparse_destroy(sparse);
  vxm_sparse_file_close(file);
  if (status != VXM_OK) {
    vxm_grid_destroy(*out);
    *out = NULL;
  }
  return status;
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** .octree as a grid format: slices become an octree before they are written; see octree_values.h for values.
 */
#include "gridio/common/format.h"
#include "gridio/common/raster.h"
#include "gridio/formats/octree/octree_file.h"
#include "gridio/formats/octree/octree_slices.h"
#include "gridio/formats/octree/octree_values.h"

/* ---- Reading ---- */

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
    status = vxm_octree_file_need_bits(file, error);
  if (status == VXM_OK)
    status = vxm_octree_file_load(out, file, (int64_t[3]){0, 0, 0}, file->space.dims, error);
  vxm_sparse_file_close(file);
  return status;
}

static vxm_status read_field(vxm_field **out, const vxm_input *input, vxm_error *error) {
  vxm_sparse_file *file;
  vxm_status status = open_borrowed(&file, input, error);
  if (status == VXM_OK)
    status = vxm_octree_values_load(out, file, (int64_t[3]){0, 0, 0}, file->space.dims, error);
  vxm_sparse_file_close(file);
  return status;
}

/** Values that may be bits. */
static vxm_status read_mask(vxm_grid **out, const vxm_sparse_file *file, vxm_bits_rule rule,
                            vxm_error *error) {
  vxm_field *field;
  if (rule == VXM_BITS_STORED && (file->channels == 4 || file->scalar != VXM_UINT8)) /* as vxm_raster_bits */
    return vxm_fail_numbers(error, file->name,
                            file->channels == 4 ? "colors" : vxm_scalar_name(file->scalar));
  vxm_status status = vxm_octree_values_load(&field, file, (int64_t[3]){0, 0, 0}, file->space.dims, error);
  if (status == VXM_OK)
    status = vxm_raster_bits(out, field, rule, file->name, error);
  vxm_field_destroy(field);
  return status;
}

static vxm_status read_grid(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error) {
  vxm_sparse_file *file;
  vxm_sparse *sparse = NULL;
  vxm_status status = open_borrowed(&file, input, error);
  if (status == VXM_OK && file->values != 0 && rule != VXM_BITS_NONE) {
    status = read_mask(out, file, rule, error);
    vxm_sparse_file_close(file);
    return status;
  }
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

/* ---- Writing ---- */

static vxm_status write_sparse(const vxm_sparse *sparse, const char *path, vxm_error *error) {
  vxm_output *output;
  vxm_status status = vxm_output_open(&output, sparse->context, path, error);
  if (status != VXM_OK)
    return status;
  status = vxm_octree_file_put(output, sparse, NULL, error);
  if (status == VXM_OK)
    return vxm_output_commit(output, error);
  vxm_output_abort(output);
  return status;
}

static vxm_status end(vxm_grid_writer *writer, vxm_error *error) {
  vxm_sparse *sparse;
  vxm_status status = vxm_octree_slices_end(&sparse, writer, error);
  if (status == VXM_OK)
    status = vxm_octree_file_put(writer->output, sparse, NULL, error);
  vxm_sparse_destroy(sparse);
  return status;
}

static const vxm_grid_writer_kind writer_kind = {
    .layout = VXM_LAYOUT_GRID,
    .state_bytes = vxm_octree_slices_state_bytes,
    .begin = vxm_octree_slices_begin,
    .put = vxm_octree_slices_put,
    .end = end,
    .drop = vxm_octree_slices_drop,
    .held_bytes = vxm_octree_slices_held_bytes,
};

const vxm_grid_format vxm_format_octree = {
    .name = "octree",
    .holds = VXM_HOLDS_ALL,
    .sniff = vxm_octree_sniff,
    .read = read_grid,
    .read_field = read_field,
    .read_sparse = read_sparse,
    .writer = &writer_kind,
    .write_sparse = write_sparse,
    .values = &vxm_octree_values,
};

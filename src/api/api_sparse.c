/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions of sparse sets of voxels: they check arguments and call down. */
#include "base/sized.h"
#include "grid/crop.h"
#include "grid/octree_crop.h"
#include "gridio/formats/coords.h"
#include "gridio/formats/octree/octree_values.h"
#include "gridio/gridio.h"
#include "gridio/sparse_coverage.h"
#include "gridio/sparse_write.h"
#include "voxel/sparse/sparse.h"

vxm_status vxm_model_sparse(vxm_sparse **out, vxm_voxelize_report *report, vxm_model *model,
                            const vxm_space *space, const double transform[12], vxm_error *error) {
  if (out)
    *out = NULL;
  VXM_RESULT_CLEAR(report);
  if (!out || !model || !space)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sparse: an argument is NULL");
  vxm_status status = vxm_space_check(space, error);
  vxm_voxelize_report made = {0};
  if (status == VXM_OK)
    status = vxm_sparse_make(out, report ? &made : NULL, model, space, transform, error);
  if (status == VXM_OK)
    VXM_RESULT_WRITE(report, &made);
  return status;
}

const vxm_space *vxm_sparse_space(const vxm_sparse *sparse) {
  return sparse ? &sparse->space : NULL;
}

bool vxm_sparse_get(const vxm_sparse *sparse, int64_t i, int64_t j, int64_t k) {
  return sparse && vxm_octree_get(sparse, i, j, k);
}

int64_t vxm_sparse_count(const vxm_sparse *sparse) {
  int64_t count = 0;
  uint64_t hash = 0;
  if (sparse)
    vxm_octree_count_hash(sparse, &count, &hash);
  return count;
}

uint64_t vxm_sparse_hash(const vxm_sparse *sparse) {
  int64_t count = 0;
  uint64_t hash = 0;
  if (sparse)
    vxm_octree_count_hash(sparse, &count, &hash);
  return hash;
}

int64_t vxm_sparse_bricks(const vxm_sparse *sparse) {
  return sparse ? (int64_t)sparse->brick_count : 0;
}

int64_t vxm_sparse_nodes(const vxm_sparse *sparse) {
  return sparse ? (int64_t)vxm_octree_nodes(sparse) : 0;
}

uint64_t vxm_sparse_bytes(const vxm_sparse *sparse) {
  return sparse ? vxm_octree_bytes(sparse) : 0;
}

vxm_status vxm_sparse_from_grid(vxm_sparse **out, const vxm_grid *grid, vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !grid)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sparse: an argument is NULL");
  return vxm_octree_from_grid(out, grid, error);
}

vxm_status vxm_sparse_to_grid(vxm_grid **out, const vxm_sparse *sparse, vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !sparse)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sparse: an argument is NULL");
  vxm_status status = vxm_grid_create(out, sparse->context, &sparse->space, error);
  if (status != VXM_OK)
    return status;
  vxm_window window = vxm_window_of_grid(*out);
  vxm_octree_fill(sparse, &window);
  return VXM_OK;
}

void vxm_sparse_visit(const vxm_sparse *sparse, vxm_sparse_fn function, void *payload) {
  if (sparse && function)
    vxm_octree_walk_layers(sparse, 2, 0, sparse->space.dims[2], function, payload);
}

vxm_status vxm_sparse_write(const vxm_sparse *sparse, const char *path, const vxm_grid_write_options *options,
                            vxm_error *error) {
  if (!sparse || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sparse: an argument is NULL");
  vxm_grid_write_options chosen = VXM_GRID_WRITE_OPTIONS_INIT;
  vxm_status status = VXM_OPTIONS_READ(&chosen, options, "sparse", error);
  return status == VXM_OK ? vxm_gridio_write_sparse(sparse, path, chosen.format, error) : status;
}

vxm_status vxm_sparse_write_coords(const vxm_sparse *sparse, const char *path, vxm_error *error) {
  if (!sparse || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "coordinates: an argument is NULL");
  return vxm_gridio_coords_sparse(sparse, path, error);
}

vxm_status vxm_grid_write_coords(const vxm_grid *grid, const char *path, vxm_error *error) {
  if (!grid || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "coordinates: an argument is NULL");
  return vxm_gridio_coords_grid(grid, path, error);
}

int64_t vxm_sparse_warning_count(const vxm_sparse *sparse) {
  return sparse ? sparse->warnings.count : 0;
}

const char *vxm_sparse_warning(const vxm_sparse *sparse, int64_t index) {
  return sparse && index >= 0 && index < sparse->warnings.count ? sparse->warnings.text[index] : "";
}

vxm_status vxm_sparse_window(vxm_grid **out, const vxm_sparse *sparse, const int64_t begin[3],
                             const int64_t end[3], vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !sparse || !begin || !end)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sparse: an argument is NULL");
  vxm_status status = vxm_space_check_box(&sparse->space, begin, end, error);
  return status == VXM_OK ? vxm_octree_crop(out, sparse, begin, end, error) : status;
}

vxm_status vxm_sparse_coverage(vxm_field **out, const vxm_sparse *sparse, const vxm_coverage_options *options,
                               const int64_t begin[3], const int64_t end[3], vxm_error *error) {
  vxm_coverage_options chosen = VXM_COVERAGE_OPTIONS_INIT;
  if (out)
    *out = NULL;
  if (!out || !sparse)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sparse: an argument is NULL");
  vxm_status status = VXM_OPTIONS_READ(&chosen, options, "coverage", error);
  return status == VXM_OK ? vxm_gridio_coverage(out, sparse, &chosen, begin, end, error) : status;
}

/* ---- Files ---- */

vxm_status vxm_sparse_read(vxm_sparse **out, vxm_context *context, const char *path, vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sparse: an argument is NULL");
  vxm_context *owner;
  vxm_status status = vxm_context_acquire(&owner, context, error);
  if (status != VXM_OK)
    return status;
  status = vxm_gridio_read_sparse(out, owner, path, error);
  vxm_context_release(owner);
  return status;
}

vxm_status vxm_sparse_file_open(vxm_sparse_file **out, vxm_context *context, const char *path,
                                vxm_error *error) {
  vxm_input input;
  if (out)
    *out = NULL;
  if (!out || !path)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sparse: an argument is NULL");
  vxm_context *owner;
  vxm_status status = vxm_context_acquire(&owner, context, error);
  if (status != VXM_OK)
    return status;
  status = vxm_input_open_in_parts(&input, owner, path, error);
  if (status == VXM_OK)
    status = vxm_octree_file_open(out, &input, error);
  vxm_context_release(owner);
  return status;
}

const vxm_space *vxm_sparse_file_space(const vxm_sparse_file *file) {
  return file ? &file->space : NULL;
}

bool vxm_sparse_file_has_values(const vxm_sparse_file *file) {
  return file && file->values != 0;
}

int64_t vxm_sparse_file_count(const vxm_sparse_file *file) {
  return file ? (int64_t)file->voxels : 0;
}

vxm_status vxm_sparse_file_window(vxm_grid **out, const vxm_sparse_file *file, const int64_t begin[3],
                                  const int64_t end[3], vxm_error *error) {
  vxm_sparse *part;
  if (out)
    *out = NULL;
  if (!out || !file || !begin || !end)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sparse: an argument is NULL");
  vxm_status status = vxm_octree_file_need_bits(file, error);
  if (status == VXM_OK)
    status = vxm_space_check_box(&file->space, begin, end, error);
  if (status == VXM_OK)
    status = vxm_octree_file_load(&part, file, begin, end, error);
  if (status != VXM_OK)
    return status;
  status = vxm_octree_crop(out, part, begin, end, error);
  vxm_sparse_destroy(part);
  return status;
}

vxm_status vxm_sparse_file_coverage(vxm_field **out, const vxm_sparse_file *file,
                                    const vxm_coverage_options *options, const int64_t begin[3],
                                    const int64_t end[3], vxm_error *error) {
  vxm_coverage_options chosen = VXM_COVERAGE_OPTIONS_INIT;
  if (out)
    *out = NULL;
  if (!out || !file)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sparse: an argument is NULL");
  vxm_status status = VXM_OPTIONS_READ(&chosen, options, "coverage", error);
  if (status == VXM_OK)
    status = vxm_octree_file_need_bits(file, error);
  return status == VXM_OK ? vxm_gridio_coverage_file(out, file, &chosen, begin, end, error) : status;
}

/** Set voxels as 0 and 1. */
static vxm_status bits_as_field(vxm_field **out, const vxm_sparse_file *file, const int64_t begin[3],
                                const int64_t end[3], vxm_error *error) {
  vxm_grid *grid;
  vxm_status status = vxm_sparse_file_window(&grid, file, begin, end, error);
  if (status != VXM_OK)
    return status;
  status = vxm_field_make(out, file->context, &grid->space, VXM_FIELD_NUMBERS, VXM_UINT8, error);
  if (status == VXM_OK)
    vxm_field_put_grid(*out, grid);
  vxm_grid_destroy(grid);
  return status;
}

vxm_status vxm_sparse_file_field(vxm_field **out, const vxm_sparse_file *file, const int64_t begin[3],
                                 const int64_t end[3], vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !file || !begin || !end)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "sparse: an argument is NULL");
  vxm_status status = vxm_space_check_box(&file->space, begin, end, error);
  if (status != VXM_OK)
    return status;
  return file->values != 0 ? vxm_octree_values_load(out, file, begin, end, error)
                           : bits_as_field(out, file, begin, end, error);
}

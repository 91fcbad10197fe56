/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions that combine voxels and values: they check arguments and call down. */
#include "gridio/values_combine.h"

#include <inttypes.h>

static vxm_status check_dims(const char *what, const vxm_space *a, const vxm_space *b, vxm_error *error) {
  const int64_t *m = a->dims, *n = b->dims;
  if (m[0] == n[0] && m[1] == n[1] && m[2] == n[2])
    return VXM_OK;
  return vxm_fail(error, VXM_ERROR_ARGUMENT,
                  "combine: %s of %" PRId64 " x %" PRId64 " x %" PRId64 " and %" PRId64 " x %" PRId64
                  " x %" PRId64 " voxels cannot be combined",
                  what, m[0], m[1], m[2], n[0], n[1], n[2]);
}

/** Of sets; spaces are NULL where a set is. */
static vxm_status check_sets(const vxm_space *a, const vxm_space *b, vxm_set_operation operation,
                             vxm_error *error) {
  if (!a || (!b && operation != VXM_SET_COMPLEMENT))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "combine: an argument is NULL");
  if ((int)operation < VXM_SET_UNION || (int)operation > VXM_SET_COMPLEMENT)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "combine: operation %d is unknown", (int)operation);
  return operation == VXM_SET_COMPLEMENT ? VXM_OK : check_dims("sets", a, b, error);
}

vxm_status vxm_grid_combine(vxm_grid **out, const vxm_grid *a, const vxm_grid *b, vxm_set_operation operation,
                            vxm_error *error) {
  if (!out)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "combine: an argument is NULL");
  *out = NULL;
  vxm_status status = check_sets(vxm_grid_space(a), vxm_grid_space(b), operation, error);
  return status == VXM_OK ? vxm_bitgrid_combine(out, a, b, operation, error) : status;
}

vxm_status vxm_sparse_combine(vxm_sparse **out, const vxm_sparse *a, const vxm_sparse *b,
                              vxm_set_operation operation, vxm_error *error) {
  if (!out)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "combine: an argument is NULL");
  *out = NULL;
  vxm_status status = check_sets(vxm_sparse_space(a), vxm_sparse_space(b), operation, error);
  return status == VXM_OK ? vxm_octree_combine(out, a, b, operation, error) : status;
}

vxm_status vxm_field_combine(vxm_field **out, const vxm_field *a, const vxm_field *b,
                             vxm_set_operation operation, vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !a || !b)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "combine: an argument is NULL");
  vxm_status status = check_dims("values", &a->space, &b->space, error);
  return status == VXM_OK ? vxm_gridio_combine_fields(out, a, b, operation, error) : status;
}

vxm_status vxm_sparse_file_combine(const char *path, const vxm_sparse_file *const *files, int64_t count,
                                   const vxm_set_operation *operations, vxm_error *error) {
  if (!path || !files || !operations)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "combine: an argument is NULL");
  if (count < 2)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "combine: %" PRId64 " files are less than two", count);
  for (int64_t f = 0; f < count; f++)
    if (!files[f])
      return vxm_fail(error, VXM_ERROR_ARGUMENT, "combine: a file is NULL");
  for (int64_t f = 0; f < count; f++) {
    vxm_status status = check_dims("values", &files[0]->space, &files[f]->space, error);
    if (status != VXM_OK)
      return status;
    if (files[f]->values == 0)
      return vxm_fail(error, VXM_ERROR_ARGUMENT,
                      "combine: %s has set and clear voxels, and no values; only values of one kind and type "
                      "go together",
                      files[f]->name);
  }
  return vxm_gridio_combine_files(path, files, (size_t)count, operations, error);
}

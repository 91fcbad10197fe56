/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/common/values_crop.h"
#include "grid/crop.h"

#include <string.h>

static void copy_values(vxm_field *out, const vxm_field *field, const int64_t begin[3]) {
  const int64_t *n = field->space.dims, *m = out->space.dims;
  size_t size = vxm_field_voxel_bytes(field), row = size * (size_t)m[2];
  unsigned char *to = out->values;
  for (int64_t i = 0; i < m[0]; i++)
    for (int64_t j = 0; j < m[1]; j++, to += row)
      memcpy(to, field->values + size * (size_t)(((begin[0] + i) * n[1] + begin[1] + j) * n[2] + begin[2]),
             row);
}

vxm_status vxm_field_add_table(vxm_field *out, const vxm_label_table *table, vxm_error *error) {
  size_t labels = table->count, length = (size_t)out->space.dims[2];
  vxm_error local = VXM_ERROR_INIT;
  int64_t *voxels = vxm_calloc(out->context, labels + 1, sizeof *voxels, &local);
  double *row = voxels ? vxm_alloc(out->context, length, sizeof *row, &local) : NULL;
  vxm_status status = local.code;
  for (size_t at = 0; status == VXM_OK && at < vxm_field_count(out); at += length) {
    vxm_field_doubles(row, out, at, length);
    for (size_t v = 0; v < length; v++)
      if (row[v] >= 1 && row[v] <= (double)labels)
        voxels[(size_t)row[v]]++;
  }
  for (size_t label = 1; status == VXM_OK && label <= labels; label++)
    status = vxm_field_put_label(out, vxm_label_table_name(table, label), voxels[label], &local);
  vxm_free(out->context, row);
  vxm_free(out->context, voxels);
  if (status != VXM_OK)
    vxm_error_pass(error, &local);
  return status;
}

vxm_status vxm_field_crop(vxm_field **out, const vxm_field *field, const int64_t begin[3],
                          const int64_t end[3], vxm_error *error) {
  const vxm_about *about = &field->about;
  vxm_space space = vxm_space_of_box(&field->space, begin, end);
  vxm_field *made;
  *out = NULL;
  vxm_status status = vxm_field_make(&made, field->context, &space, about->kind, field->scalar, error);
  if (status != VXM_OK)
    return status;
  made->about.is_declared = about->is_declared;
  copy_values(made, field, begin);
  if (about->table.count > 0)
    status = vxm_field_add_table(made, &about->table, error);
  for (const char *key = NULL; status == VXM_OK && (key = vxm_metadata_next(&about->pairs, key)) != NULL;)
    status = vxm_field_put_pair(made, key, vxm_metadata_value(key), error);
  return vxm_field_hand_over(out, made, status, error);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Set operations on values. Labels, colours and numbers belong to the voxels that have one: a voxel of the
 * result has that of the first operand, or if that has none that of the second. Signed distances are combined
 * as those of solids are: the least of both, the greatest, or the greatest of one and the other's negative
 * (A. Ricci, A Constructive Geometry for Computer Graphics, The Computer Journal 16, 1973).
 */
#ifndef VXM_GRIDIO_VALUES_COMBINE_H
#define VXM_GRIDIO_VALUES_COMBINE_H

#include "gridio/common/values.h"
#include "gridio/formats/octree/octree_file.h"

/** What values are, for both operands. */
typedef struct vxm_values_type {
  vxm_field_kind kind;
  vxm_scalar scalar;
} vxm_values_type;

/** Whether two can be combined; labels may be of one byte or two. @return VXM_OK, VXM_ERROR_ARGUMENT */
vxm_status vxm_values_check(vxm_values_type a, vxm_values_type b, vxm_set_operation operation,
                            vxm_error *error);
/** What comes of them: labels are of VXM_UINT16. */
vxm_values_type vxm_values_result(vxm_values_type a);
/** Bytes of a value. */
static inline size_t vxm_values_bytes(vxm_values_type type) {
  return vxm_scalar_bytes(type.scalar) * (type.kind == VXM_FIELD_COLORS ? 4 : 1);
}

/** Combines values of a type that is a result, into the first. */
void vxm_values_combine(void *a, const void *b, size_t count, vxm_values_type type,
                        vxm_set_operation operation);
/** Copies values as those of a result. @param numbers of labels in the result; NULL = as they are */
void vxm_values_convert(void *out, const void *values, size_t count, vxm_values_type type,
                        const uint16_t *numbers);

enum { VXM_LABEL_NUMBERS = VXM_LABELS_MAX + 1 };

/**
 * Adds a table of labels to another. Those of one name are one; new ones are put behind the others. Without
 * names, in either table, labels of one number are one.
 *
 * @param[out] numbers of the labels of `from` in `to`, VXM_LABEL_NUMBERS of them
 * @return VXM_OK; VXM_ERROR_RANGE beyond VXM_LABELS_MAX; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_label_table_merge(vxm_label_table *to, uint16_t *numbers, const vxm_label_table *from,
                                 vxm_context *context, vxm_error *error);

/** See vxm_field_combine in voxmend.h; the dimensions are equal. */
vxm_status vxm_gridio_combine_fields(vxm_field **out, const vxm_field *a, const vxm_field *b,
                                     vxm_set_operation operation, vxm_error *error);
/** See vxm_sparse_file_combine in voxmend.h; the dimensions are equal, and all files have values. */
vxm_status vxm_gridio_combine_files(const char *path, const vxm_sparse_file *const *files, size_t count,
                                    const vxm_set_operation *operations, vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** A box of a field's values as a field of its own. */
#ifndef VXM_GRIDIO_COMMON_VALUES_CROP_H
#define VXM_GRIDIO_COMMON_VALUES_CROP_H

#include "gridio/common/values.h"

/** See vxm_field_window in voxmend.h; the box has been checked. */
vxm_status vxm_field_crop(vxm_field **out, const vxm_field *field, const int64_t begin[3],
                          const int64_t end[3], vxm_error *error);
/** Gives a field the labels of a table, with the voxels that it has of each. */
vxm_status vxm_field_add_table(vxm_field *out, const vxm_label_table *table, vxm_error *error);

#endif

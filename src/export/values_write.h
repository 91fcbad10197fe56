/* SPDX-License-Identifier: BSD-3-Clause */
/** Fields out: .npy, .nrrd, .vdb, labels as .binvox, and colours also as .ply and .vox. */
#ifndef VXM_EXPORT_VALUES_WRITE_H
#define VXM_EXPORT_VALUES_WRITE_H

#include "gridio/common/values.h"

/** Writes a field; see vxm_field_write in voxmend.h. @param format NULL = by the extension of `path` */
vxm_status vxm_gridio_write_field(const vxm_field *field, const char *path, const char *format,
                                  vxm_error *error);

#endif

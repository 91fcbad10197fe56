/* SPDX-License-Identifier: BSD-3-Clause */
/** Octrees as grid files. */
#ifndef VXM_GRIDIO_SPARSE_WRITE_H
#define VXM_GRIDIO_SPARSE_WRITE_H

#include "grid/octree.h"

/** See vxm_sparse_write in voxmend.h; `format` NULL = by the extension. */
vxm_status vxm_gridio_write_sparse(const vxm_sparse *sparse, const char *path, const char *format,
                                   vxm_error *error);

#endif

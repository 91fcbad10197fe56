/* SPDX-License-Identifier: BSD-3-Clause */
/** Grid files as octrees. */
#ifndef VXM_GRIDIO_SPARSE_READ_H
#define VXM_GRIDIO_SPARSE_READ_H

#include "grid/octree.h"

/** See vxm_sparse_read in voxmend.h. */
vxm_status vxm_gridio_read_sparse(vxm_sparse **out, vxm_context *context, const char *path, vxm_error *error);

#endif

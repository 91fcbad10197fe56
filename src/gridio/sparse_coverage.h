/* SPDX-License-Identifier: BSD-3-Clause */
/** The coverage of a coarser grid, counted in an octree or its file. */
#ifndef VXM_GRIDIO_SPARSE_COVERAGE_H
#define VXM_GRIDIO_SPARSE_COVERAGE_H

#include "grid/octree.h"
#include "gridio/common/values.h"

/** See vxm_sparse_coverage in voxmend.h; the options are complete. */
vxm_status vxm_gridio_coverage(vxm_field **out, const vxm_sparse *sparse, const vxm_coverage_options *options,
                               const int64_t begin[3], const int64_t end[3], vxm_error *error);
/** The same of a file, of which at most a layer of tiles is in memory. */
vxm_status vxm_gridio_coverage_file(vxm_field **out, const vxm_sparse_file *file,
                                    const vxm_coverage_options *options, const int64_t begin[3],
                                    const int64_t end[3], vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** .bt files in, through OctoMap in a process of its own. */
#ifndef VXM_GRIDIO_FORMATS_OCTOMAP_READ_H
#define VXM_GRIDIO_FORMATS_OCTOMAP_READ_H

#include "gridio/common/values.h"
#include "voxmend/sparse.h"

/** What the JSON beside a file calls it. */
#define VXM_OCTOMAP_JSON "voxmend octomap"

/** Whether the content is that of the format (vxm_grid_format.sniff). */
bool vxm_octomap_sniff(const vxm_input *input);
/** The reader of the format (vxm_grid_format.read). */
vxm_status vxm_octomap_read(vxm_grid **out, const vxm_input *input, vxm_bits_rule rule, vxm_error *error);
/** And of octrees (vxm_grid_format.read_sparse). */
vxm_status vxm_octomap_read_sparse(vxm_sparse **out, const vxm_input *input, vxm_error *error);

#endif

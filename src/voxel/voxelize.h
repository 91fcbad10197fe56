/* SPDX-License-Identifier: BSD-3-Clause */
/** The solid of a mesh: parts, voters, votes. */
#ifndef VXM_VOXEL_VOXELIZE_H
#define VXM_VOXEL_VOXELIZE_H

#include "grid/bitgrid.h"
#include "mesh/soup.h"

/** See vxm_voxelize in voxmend.h; the space is chosen and the options are checked. `report` is filled. */
vxm_status vxm_voxelize_run(vxm_grid **out, vxm_voxelize_report *report, const vxm_soup *soup,
                            const vxm_space *space, const vxm_voxelize_options *options, vxm_error *error);

#endif

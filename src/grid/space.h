/* SPDX-License-Identifier: BSD-3-Clause */
/** Choosing the voxel space of a mesh. */
#ifndef VXM_GRID_SPACE_H
#define VXM_GRID_SPACE_H

#include "mesh/soup.h"
#include "voxmend/voxelize.h"

/** See vxm_space_fit in voxmend.h. */
vxm_status vxm_space_choose(vxm_space *out, const vxm_soup *soup, const vxm_space_options *options,
                            vxm_error *error);

/** The longest side of the whole, model units. */
double vxm_space_longest_side(const vxm_space *space);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** A closed surface of a solid, at the resolution of a grid. */
#ifndef VXM_REMESH_REMESH_H
#define VXM_REMESH_REMESH_H

#include "mesh/soup.h"
#include "voxmend/voxelize.h"

/** See vxm_mesh_remesh in voxmend.h; the space is chosen and the options are checked. `report` is filled. */
vxm_status vxm_remesh(vxm_soup **out, vxm_voxelize_report *report, const vxm_soup *soup,
                      const vxm_space *space, const vxm_voxelize_options *options, vxm_error *error);

#endif

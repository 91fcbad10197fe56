/* SPDX-License-Identifier: BSD-3-Clause */
/** The oriented triangles of some parts on a lattice, and the tree of their winding numbers. */
#ifndef VXM_VOXEL_WOUND_H
#define VXM_VOXEL_WOUND_H

#include "voxel/outward.h"
#include "voxel/winding.h"

typedef struct vxm_wound {
  vxm_context *context;
  vxm_triangle *triangles;
  vxm_winding *tree; /**< NULL = not made */
} vxm_wound;

/** @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_wound_create(vxm_wound *out, const vxm_facets *facets, const vxm_placed *placed,
                            const vxm_turns *turns, bool mirrored, vxm_error *error);
void vxm_wound_destroy(vxm_wound *wound);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/oriented_chain.h"

vxm_status vxm_oriented_chain_create(vxm_winding_chain *out, const vxm_triangle_set *triangles,
                                     const vxm_facings *facings, vxm_error *error) {
  vxm_context *context = triangles->context;
  vxm_status status = VXM_OK;
  *out = (vxm_winding_chain){.context = context};
  uint32_t(*corners)[3] = vxm_try_alloc(context, facings->count, sizeof *corners, &status, error);
  if (!corners)
    return status;
  size_t t = 0, seen = 0;
  for (size_t p = facings->part_begin; p < facings->part_end; p++)
    for (size_t f = triangles->parts[p].begin; f < triangles->parts[p].caps; f++) {
      int facing = facings->facing[seen++];
      if (facing == VXM_FACING_UNTOLD)
        continue;
      for (int k = 0; k < 3; k++)
        corners[t][k] = triangles->corners[f][facing == VXM_FACING_IN ? (3 - k) % 3 : k];
      t++;
    }
  status =
      vxm_winding_chain_create(out, context, (const uint32_t(*)[3])corners, t, triangles->first_apex, error);
  vxm_free(context, corners);
  return status;
}

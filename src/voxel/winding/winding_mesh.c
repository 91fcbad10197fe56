/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/winding_mesh.h"

vxm_status vxm_winding_mesh_create(vxm_winding_mesh *out, const vxm_triangle_set *triangles,
                                   const vxm_snapped_points *placed, const vxm_flip_mask *turns,
                                   bool mirrored, vxm_error *error) {
  *out = (vxm_winding_mesh){.context = placed->context};
  vxm_error local = VXM_ERROR_INIT;
  out->triangles = vxm_alloc(out->context, turns->count, sizeof *out->triangles, &local);
  if (!out->triangles) {
    vxm_error_pass(error, &local);
    return local.code;
  }
  size_t t = 0;
  for (size_t p = turns->part_begin; p < turns->part_end; p++)
    for (size_t f = triangles->parts[p].begin; f < triangles->parts[p].caps; f++, t++)
      for (int k = 0; k < 3; k++) {
        bool turn = (turns->turned[t] != 0) != mirrored;
        vxm_point at = vxm_snapped_points_at(placed, triangles->corners[f][turn ? (3 - k) % 3 : k]);
        for (int a = 0; a < 3; a++)
          out->triangles[t].corner[k][a] = (double)at.at[a] / (double)placed->lattice.unit;
      }
  vxm_status status = vxm_winding_create(&out->tree, out->context, out->triangles, turns->count, error);
  if (status != VXM_OK)
    vxm_winding_mesh_destroy(out);
  return status;
}

void vxm_winding_mesh_destroy(vxm_winding_mesh *wound) {
  vxm_winding_destroy(wound->tree);
  vxm_free(wound->context, wound->triangles);
  *wound = (vxm_winding_mesh){.context = wound->context};
}

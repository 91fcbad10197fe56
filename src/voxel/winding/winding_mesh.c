/* SPDX-License-Identifier: BSD-3-Clause */
#include "voxel/winding/winding_mesh.h"

vxm_winding_mesh vxm_winding_mesh_of(vxm_context *context) {
  return (vxm_winding_mesh){.context = context,
                            .tree = {.context = context},
                            .closed = {.context = context},
                            .asked = {.context = context},
                            .doubted = {.context = context}};
}

vxm_status vxm_winding_mesh_place(vxm_winding_mesh *mesh, const vxm_winding_chain *chain,
                                  const vxm_snapped_points *placed, int axis, bool mirrored,
                                  vxm_error *error) {
  vxm_winding_tree_destroy(&mesh->tree);
  vxm_status status = vxm_winding_tree_create(&mesh->tree, mesh->context, (const uint32_t(*)[3])chain->rest,
                                              chain->rest_count, placed, mirrored, error);
  if (status == VXM_OK)
    status = vxm_chain_winding_place(&mesh->closed, chain, placed, axis, mirrored, error);
  mesh->chain = status == VXM_OK ? chain : NULL;
  mesh->placed = placed;
  return status;
}

void vxm_winding_mesh_destroy(vxm_winding_mesh *mesh) {
  vxm_brick_mask_destroy(&mesh->doubted);
  vxm_brick_mask_destroy(&mesh->asked);
  vxm_chain_winding_destroy(&mesh->closed);
  vxm_winding_tree_destroy(&mesh->tree);
  *mesh = vxm_winding_mesh_of(mesh->context);
}

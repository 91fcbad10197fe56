/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions about what a mesh looks like. */
#include "base/error.h"
#include "base/sized.h"
#include "mesh/soup.h"

vxm_status vxm_mesh_look(vxm_look *out, const vxm_mesh *mesh, vxm_error *error) {
  VXM_RESULT_CLEAR(out);
  if (!out || !mesh)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "look: an argument is NULL");
  const vxm_appearance *look = mesh->appearance;
  vxm_look found = {0};
  if (look)
    found = (vxm_look){.has_colors = vxm_appearance_has_colors(look),
                       .vertex_colors = look->vertex_colors != NULL,
                       .face_colors = look->face_colors != NULL,
                       .materials = look->face_materials ? (int64_t)look->material_count : 0,
                       .textures = look->face_materials ? (int64_t)look->image_count : 0};
  VXM_RESULT_WRITE(out, &found);
  return VXM_OK;
}

vxm_status vxm_mesh_texture(vxm_texture *out, const vxm_mesh *mesh, int64_t index, vxm_error *error) {
  VXM_RESULT_CLEAR(out);
  if (!out || !mesh)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "look: an argument is NULL");
  const vxm_appearance *look = mesh->appearance;
  if (!look || index < 0 || index >= (int64_t)look->image_count)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "look: the mesh has no texture %lld", (long long)index);
  const vxm_image *image = &look->images[index];
  vxm_texture found = {
      .name = image->name, .width = image->width, .height = image->height, .failure = image->failure};
  VXM_RESULT_WRITE(out, &found);
  return VXM_OK;
}

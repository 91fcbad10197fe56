/* SPDX-License-Identifier: BSD-3-Clause */
/** The public functions about what a mesh looks like. */
#include "base/error.h"
#include "base/sized.h"
#include "mesh/soup.h"

/** Materials that say anything. */
static int64_t count_materials(const vxm_appearance *appearance) {
  int64_t count = 0;
  for (size_t m = 0; m < appearance->material_count && appearance->face_materials; m++)
    count += appearance->materials[m].has_color || appearance->materials[m].image != VXM_APPEARANCE_NONE;
  return count;
}

vxm_status vxm_mesh_look(vxm_look *out, const vxm_mesh *mesh, vxm_error *error) {
  VXM_RESULT_CLEAR(out);
  if (!out || !mesh)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "look: an argument is NULL");
  const vxm_appearance *appearance = mesh->appearance;
  vxm_look found = {0};
  if (appearance)
    found = (vxm_look){.has_colors = vxm_appearance_has_colors(appearance),
                       .vertex_colors = appearance->vertex_colors != NULL,
                       .face_colors = appearance->face_colors != NULL,
                       .materials = count_materials(appearance),
                       .textures = appearance->face_materials ? (int64_t)appearance->image_count : 0};
  VXM_RESULT_WRITE(out, &found);
  return VXM_OK;
}

vxm_status vxm_mesh_texture(vxm_texture *out, const vxm_mesh *mesh, int64_t index, vxm_error *error) {
  VXM_RESULT_CLEAR(out);
  if (!out || !mesh)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "look: an argument is NULL");
  const vxm_appearance *appearance = mesh->appearance;
  vxm_texture found = {.name = "", .failure = "there is no such texture"};
  if (appearance && index >= 0 && index < (int64_t)appearance->image_count) {
    const vxm_image *image = &appearance->images[index];
    found = (vxm_texture){
        .name = image->name, .width = image->width, .height = image->height, .failure = image->failure};
  }
  VXM_RESULT_WRITE(out, &found);
  return VXM_OK;
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** Of an OBJ file what gives colours: numbers behind a vertex, texture coordinates, names of materials. */
#ifndef VXM_MESHIO_FORMATS_OBJ_COLORS_H
#define VXM_MESHIO_FORMATS_OBJ_COLORS_H

#include "meshio/common/tokenizer.h"

/** What is gathered beside a soup that is to have an appearance; all zeros to begin with. */
typedef struct vxm_obj_colors {
  float (*uvs)[2];
  uint32_t *corner_uvs; /**< for each corner; VXM_NO_VERTEX = none */
  size_t uv_count, uv_capacity, corner_count, corner_capacity;
  uint32_t material; /**< of the faces to come, + 1; 0 = none */
} vxm_obj_colors;

/** Takes the colour behind the coordinates of the vertex that is about to be added. */
vxm_status vxm_obj_colors_vertex(vxm_tokenizer *scan, vxm_error *error);
/** Takes the numbers behind "vt". */
vxm_status vxm_obj_colors_uv(vxm_obj_colors *colors, vxm_tokenizer *scan, vxm_error *error);
/** Takes the texture coordinates of the soup's last face, which stands between `first` and the cursor. */
vxm_status vxm_obj_colors_face(vxm_obj_colors *colors, const vxm_tokenizer *scan, const unsigned char *first,
                               vxm_error *error);
/** Takes the name behind "usemtl", or those behind "mtllib". */
vxm_status vxm_obj_colors_material(vxm_obj_colors *colors, vxm_soup *soup, const unsigned char *name,
                                   size_t length, vxm_error *error);
vxm_status vxm_obj_colors_library(vxm_soup *soup, const unsigned char *names, size_t length,
                                  vxm_error *error);
/** Hands over what was gathered, before faces are left out. */
vxm_status vxm_obj_colors_finish(vxm_obj_colors *colors, vxm_soup *soup, vxm_error *error);
void vxm_obj_colors_destroy(vxm_obj_colors *colors, vxm_context *context);

#endif

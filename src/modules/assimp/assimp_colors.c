/* SPDX-License-Identifier: BSD-3-Clause */
/** What a scene of Assimp looks like: colours of vertices, materials, and pictures within or beside it. */
#include <assimp/material.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "modules/assimp/assimp.h"
#include "modules/assimp/uri.h"

/* ---- Pictures ---- */

/** Takes a picture within the file: its bytes as they stand there, or pixels that are decoded by now. */
static vxm_status take_embedded(vxm_image *image, vxm_context *context, const struct aiTexture *texture,
                                vxm_error *error) {
  vxm_status status = VXM_OK;
  bool is_file = texture->mHeight == 0;
  uint64_t pixels = is_file ? 0 : (uint64_t)texture->mWidth * texture->mHeight;
  if (!texture->pcData || texture->mWidth == 0 || pixels > VXM_PIXELS_MAX) {
    snprintf(image->failure, sizeof image->failure, "the file holds nothing that could be it");
    return VXM_OK;
  }
  image->size = is_file ? texture->mWidth : 4 * pixels;
  image->bytes = vxm_try_alloc(context, (size_t)image->size, 1, &status, error);
  if (!image->bytes)
    return status;
  if (is_file)
    memcpy(image->bytes, texture->pcData, (size_t)image->size);
  for (uint64_t p = 0; p < pixels; p++) {
    const struct aiTexel *texel = &texture->pcData[p];
    const unsigned char rgba[4] = {texel->r, texel->g, texel->b, texel->a};
    memcpy(image->bytes + 4 * p, rgba, 4);
  }
  image->width = is_file ? 0 : texture->mWidth;
  image->height = is_file ? 0 : texture->mHeight;
  return VXM_OK;
}

/** The picture within the file that a name stands for: "*3", or the name of one. */
static const struct aiTexture *find_embedded(const struct aiScene *scene, const char *name) {
  if (name[0] == '*') {
    long number = strtol(name + 1, NULL, 10);
    return number >= 0 && (unsigned long)number < scene->mNumTextures ? scene->mTextures[number] : NULL;
  }
  for (unsigned t = 0; t < scene->mNumTextures; t++)
    if (scene->mTextures[t] && strcmp(scene->mTextures[t]->mFilename.data, name) == 0)
      return scene->mTextures[t];
  return NULL;
}

/** Names are URIs, and those of other systems; the file is looked for as it is called. */
static void decode_name(char *name) {
  for (char *c = name; *c; c++)
    *c = *c == '\\' ? '/' : *c;
  vxm_uri_decode(name);
}

static vxm_status take_texture(vxm_appearance *appearance, const struct aiScene *scene, const char *path,
                               uint32_t *image, vxm_error *error) {
  char name[VXM_APPEARANCE_NAME];
  const struct aiTexture *texture = find_embedded(scene, path);
  if (texture && path[0] == '*')
    snprintf(name, sizeof name, "embedded %.20s", path + 1);
  else
    snprintf(name, sizeof name, "%.*s", VXM_APPEARANCE_NAME - 1, path);
  if (!texture)
    decode_name(name);
  size_t known = appearance->image_count;
  vxm_status status = vxm_appearance_image(appearance, name, strlen(name), image, error);
  bool is_new = appearance->image_count > known;
  return status == VXM_OK && is_new && texture
             ? take_embedded(&appearance->images[*image], appearance->context, texture, error)
             : status;
}

/* ---- Materials ---- */

static uint8_t wrap_of(enum aiTextureMapMode mode) {
  return mode == aiTextureMapMode_Mirror                                    ? VXM_WRAP_MIRROR
         : mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal ? VXM_WRAP_CLAMP
                                                                            : VXM_WRAP_REPEAT;
}

static vxm_status take_material(vxm_appearance *appearance, const struct aiScene *scene,
                                const struct aiMaterial *from, vxm_error *error) {
  struct aiString name = {.length = 0}, path = {.length = 0};
  uint32_t index, image;
  aiGetMaterialString(from, AI_MATKEY_NAME, &name);
  bool is_made_up = strcmp(name.data, AI_DEFAULT_MATERIAL_NAME) == 0; /* where the file has none */
  vxm_status status =
      vxm_appearance_add_material(appearance, name.data, is_made_up ? 0 : strlen(name.data), &index, error);
  if (status != VXM_OK || is_made_up)
    return status;
  vxm_material *material = &appearance->materials[index];
  struct aiColor4D color;
  /* Assimp gives the base colour of glTF under this name too. */
  if (aiGetMaterialColor(from, AI_MATKEY_COLOR_DIFFUSE, &color) == aiReturn_SUCCESS) {
    const double rgb[3] = {(double)color.r, (double)color.g, (double)color.b};
    /* White without a name is what Assimp gives to glTF without materials. */
    material->has_color =
        name.length > 0 || !appearance->is_product || rgb[0] < 1 || rgb[1] < 1 || rgb[2] < 1;
    for (int c = 0; c < 3; c++) {
      double value = rgb[c] > 0 ? rgb[c] < 1 ? rgb[c] : 1 : 0;
      material->color[c] = (float)(appearance->is_product ? value : vxm_srgb_decode(value));
    }
  }
  enum aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
  if (aiGetMaterialTexture(from, aiTextureType_DIFFUSE, 0, &path, NULL, NULL, NULL, NULL, modes, NULL) !=
          aiReturn_SUCCESS ||
      path.data[0] == '\0')
    return VXM_OK;
  status = take_texture(appearance, scene, path.data, &image, error);
  material->image = image;
  for (int a = 0; a < 2; a++)
    material->wrap[a] = wrap_of(modes[a]);
  return status;
}

vxm_status vxm_assimp_materials(vxm_appearance *appearance, const struct aiScene *scene, vxm_error *error) {
  vxm_status status = VXM_OK;
  for (unsigned m = 0; m < scene->mNumMaterials && status == VXM_OK; m++) {
    uint32_t index;
    if (scene->mMaterials[m])
      status = take_material(appearance, scene, scene->mMaterials[m], error);
    else
      status = vxm_appearance_add_material(appearance, "", 0, &index, error);
  }
  return status;
}

/* ---- Vertices and faces ---- */

vxm_status vxm_assimp_vertex_colors(vxm_soup *soup, const struct aiMesh *mesh, vxm_error *error) {
  vxm_appearance *appearance = soup->appearance;
  vxm_status status = VXM_OK;
  if (!mesh->mColors[0])
    return VXM_OK;
  appearance->vertices.unit = 1;
  for (unsigned v = 0; v < mesh->mNumVertices && status == VXM_OK; v++) {
    const struct aiColor4D *color = &mesh->mColors[0][v];
    double rgba[4] = {(double)color->r, (double)color->g, (double)color->b, 0};
    /* The colours of glTF are light itself. */
    for (int c = 0; c < 3 && appearance->is_product; c++)
      rgba[c] = (double)vxm_srgb_encode(rgba[c]) / 255;
    status = vxm_gather_color(&appearance->vertices, soup->context, soup->vertex_count + v, rgba, error);
  }
  return status;
}

vxm_status vxm_assimp_face_look(vxm_soup *soup, size_t *capacity, const struct aiMesh *mesh, uint32_t first,
                                vxm_error *error) {
  vxm_appearance *appearance = soup->appearance;
  size_t face = soup->face_count - 1;
  vxm_status status = VXM_OK;
  if (mesh->mMaterialIndex < appearance->material_count)
    status = vxm_appearance_set_material(appearance, face, mesh->mMaterialIndex, error);
  if (status == VXM_OK)
    status = vxm_grow(soup->context, (void **)&appearance->corner_uvs, capacity, soup->corner_count,
                      sizeof *appearance->corner_uvs, error);
  for (size_t c = (size_t)soup->offsets[face]; c < soup->corner_count && status == VXM_OK; c++) {
    const struct aiVector3D *uvs = mesh->mTextureCoords[0];
    uint32_t v = soup->indices[c] - first;
    appearance->corner_uvs[c][0] = uvs ? (float)uvs[v].x : NAN;
    appearance->corner_uvs[c][1] = uvs ? (float)uvs[v].y : NAN;
    appearance->corner_uv_count = c + 1;
  }
  return status;
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** What the files of the Assimp module share. */
#ifndef VXM_MODULES_ASSIMP_ASSIMP_H
#define VXM_MODULES_ASSIMP_ASSIMP_H

#include <assimp/cfileio.h>
#include <assimp/scene.h>

#include "modules/assimp/gltf.h"
#include "sandbox/reader.h"

/** The file in memory and those that it refers to, as Assimp sees them. */
typedef struct vxm_assimp_files {
  struct aiFileIO io;
  const vxm_reader_request *request;
  vxm_context *context;
  const char *path;     /**< name under which Assimp asks for the file in memory */
  const vxm_gltf *gltf; /**< what takes its place if it is glTF; else NULL */
} vxm_assimp_files;

void vxm_assimp_files_init(vxm_assimp_files *files, const vxm_reader_request *request, vxm_context *context,
                           const char *path, const vxm_gltf *gltf);

/* For a soup that is to have an appearance. */

/** Takes all materials, in their order, and the pictures within the file. */
vxm_status vxm_assimp_materials(vxm_appearance *appearance, const struct aiScene *scene, vxm_error *error);
/** Takes the colours of the vertices that are about to be added. */
vxm_status vxm_assimp_vertex_colors(vxm_soup *soup, const struct aiMesh *mesh, vxm_error *error);
/** Takes material and texture coordinates of the soup's last face, of a mesh that begins at vertex `first`.
 */
vxm_status vxm_assimp_face_look(vxm_soup *soup, size_t *capacity, const struct aiMesh *mesh, uint32_t first,
                                vxm_error *error);

/** Adds the meshes of all nodes to an empty soup, each where its node puts it. */
vxm_status vxm_assimp_flatten(vxm_soup *soup, const struct aiScene *scene, vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** What the files of the Assimp module share. */
#ifndef VXM_MODULES_ASSIMP_ASSIMP_H
#define VXM_MODULES_ASSIMP_ASSIMP_H

#include <assimp/cfileio.h>
#include <assimp/scene.h>

#include "sandbox/reader.h"

/** The file in memory and those that it refers to, as Assimp sees them. */
typedef struct vxm_assimp_files {
  struct aiFileIO io;
  const vxm_reader_request *request;
  vxm_context *context;
  const char *path; /**< name under which Assimp asks for the file in memory */
} vxm_assimp_files;

void vxm_assimp_files_init(vxm_assimp_files *files, const vxm_reader_request *request, vxm_context *context,
                           const char *path);

/** Adds the meshes of all nodes to an empty soup, each where its node puts it. */
vxm_status vxm_assimp_flatten(vxm_soup *soup, const struct aiScene *scene, vxm_error *error);

#endif

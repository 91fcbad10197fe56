/* SPDX-License-Identifier: BSD-3-Clause */
/** glTF as Assimp can read it: what Assimp passes over without a word is refused here, or put into other
 * words. */
#ifndef VXM_MODULES_ASSIMP_GLTF_H
#define VXM_MODULES_ASSIMP_GLTF_H

#include "base/warnings.h"
#include "sandbox/reader.h"

/** The buffer that holds what was made of whole numbers, for the file that asks for it by this name. */
#define VXM_GLTF_FLOATS "voxmend-floats.bin"

/** The file for Assimp, and a buffer more. Free with vxm_gltf_destroy. */
typedef struct vxm_gltf {
  unsigned char *data; /**< NULL where Assimp can read the file as it is */
  size_t size;
  unsigned char *floats; /**< NULL if there are none */
  size_t floats_size;
} vxm_gltf;

/** What takes time or files when it is first done. */
void vxm_gltf_start(void);

/**
 * Looks at a file that is glTF.
 *
 * @return VXM_OK, also for what is damaged in ways that Assimp finds; VXM_ERROR_FORMAT, VXM_ERROR_MEMORY
 */
vxm_status vxm_gltf_prepare(vxm_gltf *out, const vxm_reader_request *request, vxm_context *context,
                            vxm_warnings *warnings, vxm_error *error);
void vxm_gltf_destroy(vxm_gltf *gltf, vxm_context *context);

#endif

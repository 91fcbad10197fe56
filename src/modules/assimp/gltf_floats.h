/* SPDX-License-Identifier: BSD-3-Clause */
/** KHR_mesh_quantization: positions and texture coordinates that are whole numbers become floats. */
#ifndef VXM_MODULES_ASSIMP_GLTF_FLOATS_H
#define VXM_MODULES_ASSIMP_GLTF_FLOATS_H

#include "base/warnings.h"
#include "modules/assimp/gltf_buffers.h"

/**
 * Assimp takes the bytes of all of them for floats, whatever they are. So floats are made of whole numbers,
 * in a buffer more, and the accessors in the JSON changed to tell of them.
 *
 * @param floats becomes the content of the buffer VXM_GLTF_FLOATS, a block of the context; NULL if nothing
 * was to be done, and nothing was changed
 * @return VXM_OK; VXM_ERROR_FORMAT, VXM_ERROR_MEMORY
 */
vxm_status vxm_gltf_make_floats(unsigned char **floats, size_t *size, json_t *root, vxm_gltf_buffers *buffers,
                                vxm_warnings *warnings, vxm_error *error);

#endif

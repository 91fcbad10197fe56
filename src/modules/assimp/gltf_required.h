/* SPDX-License-Identifier: BSD-3-Clause */
/** Extensions of glTF without which a file is another one. */
#ifndef VXM_MODULES_ASSIMP_GLTF_REQUIRED_H
#define VXM_MODULES_ASSIMP_GLTF_REQUIRED_H

#include <jansson.h>

#include "base/error.h"

/**
 * Refuses a file that cannot be read right without an extension that neither we know nor Assimp: Assimp looks
 * at none of what a file says to require, but Draco's, and reads on.
 *
 * @return VXM_OK; VXM_ERROR_FORMAT, which names the extension and what helps
 */
vxm_status vxm_gltf_check_required(const json_t *root, const char *name, vxm_error *error);

#endif

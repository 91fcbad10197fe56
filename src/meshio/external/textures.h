/* SPDX-License-Identifier: BSD-3-Clause */
/** What a mesh's appearance lies in beside the mesh: files of materials, and pictures. */
#ifndef VXM_MESHIO_EXTERNAL_TEXTURES_H
#define VXM_MESHIO_EXTERNAL_TEXTURES_H

#include "mesh/soup.h"
#include "sandbox/references.h"

/**
 * Completes the appearance of a soup that has been read: settles its colours, reads its files of materials,
 * and decodes its pictures, each in a process of its own (module images). What cannot be had is a warning,
 * and an image's failure.
 *
 * @return VXM_OK; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_textures_read(vxm_soup *soup, vxm_references *references, vxm_error *error);

#endif

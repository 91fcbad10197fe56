/* SPDX-License-Identifier: BSD-3-Clause */
/** Material files of OBJ (.mtl): the diffuse colour and its texture; the rest is passed over. */
#ifndef VXM_MESHIO_FORMATS_MTL_H
#define VXM_MESHIO_FORMATS_MTL_H

#include "mesh/appearance.h"

/**
 * Gives the materials that faces have asked for by name their colours and images; those that nobody asked for
 * are left out. Of several materials of one name the first counts.
 *
 * @param name of the file, as the mesh says it: images lie where it does
 */
vxm_status vxm_mtl_read(vxm_appearance *appearance, const unsigned char *data, size_t size, const char *name,
                        vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Which faces of a mesh that nobody has repaired have the solid before them instead of behind them. */
#ifndef VXM_MESH_INWARD_FACES_H
#define VXM_MESH_INWARD_FACES_H

#include "mesh/soup.h"

/**
 * Marks the faces of components that came inside out: closed ones by the sign of their volume, but for
 * cavities, which go with what is around them; all others where the mesh as a whole came so.
 *
 * @param[out] inward face_count elements that become 0 or 1
 * @return VXM_OK; VXM_ERROR_RANGE; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_inward_faces(uint8_t *inward, const vxm_soup *soup, vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Which faces of a mesh a repair has taken away, and which it has added. */
#ifndef VXM_GRIDIO_PAGE_CHANGES_H
#define VXM_GRIDIO_PAGE_CHANGES_H

#include "mesh/soup.h"

/**
 * Compares the faces of two meshes by the positions of their corners, whichever way they run; positions count
 * as one within a millionth of the diagonal, as a repair moves some apart by less.
 *
 * @param removed faces of `before` that `after` does not have: a byte each, 0 or 1
 * @param added   the same the other way
 * @return VXM_OK, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_mesh_changes(uint8_t *removed, uint8_t *added, const vxm_soup *before, const vxm_soup *after,
                            vxm_error *error);

#endif

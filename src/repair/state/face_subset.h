/* SPDX-License-Identifier: BSD-3-Clause */
/** Some faces of a soup, as a soup. */
#ifndef VXM_REPAIR_STATE_FACE_SUBSET_H
#define VXM_REPAIR_STATE_FACE_SUBSET_H

#include "mesh/soup.h"

/**
 * The faces of a soup that have a mark, with the numbers of their tags, and all its vertices.
 *
 * @param[out] numbers per face of `out`: that of `soup`; a block of the context with room for all of them
 * @param marks        per face
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_face_subset_create(vxm_soup **out, uint64_t **numbers, const vxm_soup *soup,
                                  const uint8_t *marks, uint8_t mark, vxm_error *error);

#endif

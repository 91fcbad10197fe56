/* SPDX-License-Identifier: BSD-3-Clause */
/** Exact welding of a soup where it lies, for those that have a vertex for every corner. */
#ifndef VXM_MESH_WELD_SOUP_H
#define VXM_MESH_WELD_SOUP_H

#include "mesh/soup.h"

/**
 * Merges vertices of the same position (vxm_weld_exact) into the first of each and gives their memory back:
 * six in seven bytes of what was read from an .stl. The others keep their order, also those that no face has.
 *
 * @param[out] merged vertices that are gone
 * @return VXM_OK; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED, and the soup is as it was
 */
vxm_status vxm_weld_soup(vxm_soup *soup, size_t *merged, vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Where vertices of a solid go that are at one place, so that its faces meet no more. */
#ifndef VXM_REPAIR_MANIFOLD_CONTACT_DIRECTION_H
#define VXM_REPAIR_MANIFOLD_CONTACT_DIRECTION_H

#include "mesh/geometry.h"
#include "mesh/soup.h"

/**
 * For each of some vertices the direction in which all faces about it move away from those about the others
 * at its place: to their backs, so that the solid shrinks, where these lie before them, and to their fronts
 * where these lie behind them, as at two notches whose points touch. The middles of faces would not do: in a
 * notch they lie on the side of what touches it.
 *
 * @param out    count vectors of length 1, or 0 where there is no such direction, as on a saddle
 * @param map    of each vertex of the soup: the first one at its place
 * @param number of each vertex of the soup: its place in `out`, or VXM_NO_VERTEX
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_contact_directions(vxm_vec3 *out, const vxm_soup *soup, const uint32_t *map,
                                  const uint32_t *number, size_t count, vxm_error *error);

#endif

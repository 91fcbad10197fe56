/* SPDX-License-Identifier: BSD-3-Clause */
/** Open sheets become plates. */
#ifndef VXM_REPAIR_SHEETS_THICKEN_H
#define VXM_REPAIR_SHEETS_THICKEN_H

#include "mesh/soup.h"

/**
 * Adds to a soup the surface of plates around faces of another one: each face moved to both sides by half the
 * thickness, mitred at folds, with a strip of triangles along each rim. Sheets that meet at an edge, three or
 * more of them, or one that turns like a Moebius strip, are one plate with corners there: around each edge
 * the sides of faces that see each other are joined. So the surface is closed and turned outward, whatever
 * the faces are, and each of its edges has two triangles. It does not run through itself where the faces are
 * large against the thickness and farther apart than that.
 *
 * @param out        the same context as `soup`'s; its tags and parts are left to the caller
 * @param origin     per face of `out`, a block of the context; grows: the face of `soup` that each is from
 * @param faces      per face of `soup`: whether it is taken; vertices at the same position are the same
 * @param thickness  model units, above 0
 * @return VXM_OK, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_thicken(vxm_soup *out, uint64_t **origin, const vxm_soup *soup, const uint8_t *faces,
                       double thickness, vxm_error *error);

#endif

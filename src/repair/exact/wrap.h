/* SPDX-License-Identifier: BSD-3-Clause */
/** A closed surface around a soup, whatever its size. */
#ifndef VXM_REPAIR_EXACT_WRAP_H
#define VXM_REPAIR_EXACT_WRAP_H

#include "mesh/soup.h"

/**
 * As `wrap` in repair/external/cgal.h, with lengths as fractions of the diagonal of the bounds of what faces
 * use.
 *
 * @param soup   is scaled meanwhile and as it was after
 * @param offset 0 = a thirtieth of alpha
 */
vxm_status vxm_wrap_soup(vxm_soup **out, uint64_t **nearest, vxm_soup *soup, double alpha, double offset,
                         vxm_error *error);

#endif

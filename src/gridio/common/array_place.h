/* SPDX-License-Identifier: BSD-3-Clause */
/** What arrays of HDF5 and Zarr, mostly of other programs, say beside their values of where these lie. */
#ifndef VXM_GRIDIO_COMMON_ARRAY_PLACE_H
#define VXM_GRIDIO_COMMON_ARRAY_PLACE_H

#include "base/warnings.h"
#include "sandbox/voxel_sink.h"

#include <stdbool.h>
#include <stddef.h>

/**
 * Takes x, y and z in any order, large or small, with or without commas and blanks between them, and c for
 * the channels of colours behind them.
 *
 * @param[out] axis of the grid, for each of the array's; left as it is after false
 * @return false if that is not what the text has
 */
bool vxm_axes_parse(int axis[3], const char *text, size_t size);

/** Warns of an attribute that does not name the axes: they are taken as x, y, z, which may be wrong. */
void vxm_axes_warn(vxm_warnings *warnings);

/** Warns if the origin or the voxel size is missing. @param known VXM_PLACE_... that are there */
void vxm_place_warn(vxm_warnings *warnings, unsigned known);

#endif

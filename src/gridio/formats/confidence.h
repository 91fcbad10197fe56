/* SPDX-License-Identifier: BSD-3-Clause */
/** How sure each voxel is, as a file of its own. */
#ifndef VXM_GRIDIO_FORMATS_CONFIDENCE_H
#define VXM_GRIDIO_FORMATS_CONFIDENCE_H

#include "grid/bitgrid.h"

/** Writes the confidence of a grid as .npy; see vxm_grid_write_confidence in voxmend.h. */
vxm_status vxm_gridio_confidence(const vxm_grid *grid, const char *path, vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Colours of voxels from a volume that is sampled at their centres. */
#ifndef VXM_EXPORT_VOLUME_COLORS_H
#define VXM_EXPORT_VOLUME_COLORS_H

#include "grid/bitgrid.h"
#include "gridio/common/values.h"

/** Refuses labels, and a volume that lies beside the grid. @return VXM_OK, VXM_ERROR_ARGUMENT */
vxm_status vxm_volume_colors_check(const vxm_field *volume, const vxm_space *space, vxm_error *error);

/** A volume, and the range of its numbers. */
typedef struct vxm_volume_sampler {
  const vxm_field *volume;
  double low, high;
} vxm_volume_sampler;

/** Of a volume that has passed the check. */
vxm_volume_sampler vxm_volume_sampler_of(const vxm_field *volume);
/** What lies at the centre of a voxel of a space. */
void vxm_volume_color(uint8_t value[4], const vxm_volume_sampler *sampler, const vxm_space *space,
                      const int64_t voxel[3]);

/**
 * Gives each set voxel what lies at its centre in a volume that has passed the check; see VXM_COLOR_VOLUME.
 *
 * @param values [x][y][z][4] in C order
 * @return VXM_OK, VXM_ERROR_CANCELLED
 */
vxm_status vxm_volume_colors(uint8_t *values, const vxm_grid *grid, const vxm_field *volume,
                             vxm_error *error);

#endif

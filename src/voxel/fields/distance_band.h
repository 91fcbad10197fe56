/* SPDX-License-Identifier: BSD-3-Clause */
/** Distances within a band, tile by tile, from the triangles near each. */
#ifndef VXM_VOXEL_FIELDS_DISTANCE_BAND_H
#define VXM_VOXEL_FIELDS_DISTANCE_BAND_H

#include "grid/window.h"
#include "voxel/closest/band_tile.h"
#include "voxel/fields/field.h"

typedef struct vxm_distance_band vxm_distance_band;

/** Lists the clusters that reach a tile out of those that reach its row of tiles; returns how many. */
size_t vxm_distance_band_near(const vxm_band_clusters *clusters, uint32_t *near, const uint32_t *entries,
                              size_t count, const vxm_band_tile *tile);

/**
 * Makes what distances within a band are measured with; the clusters must outlive it.
 *
 * @param workers that it is measured by at most
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_distance_band_create(vxm_distance_band **out, const vxm_band_clusters *clusters, int workers,
                                    vxm_error *error);
/** NULL is allowed. */
void vxm_distance_band_destroy(vxm_distance_band *band);
/** Bytes that it takes at most, the clusters beside, with `slices` of a grid at once. */
uint64_t vxm_distance_band_bytes(size_t triangles, int workers, const int64_t dims[3]);

/**
 * Measures the slices begin..end-1 of a grid.
 *
 * @param target  takes tiles; NULL = `values` are written
 * @param values  of the first slice; NULL with a target
 * @param solid   a window of these slices; its words NULL = no signs
 * @param side    the longest of a voxel
 * @param tallies of each worker; what is seen is added
 * @return VXM_OK, VXM_ERROR_CANCELLED, what the target returns
 */
vxm_status vxm_distance_band_measure(vxm_distance_band *band, const vxm_field_target *target, float *values,
                                     const vxm_window *solid, int64_t begin, int64_t end, double side,
                                     vxm_band_tally *tallies, vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** What distances to the faces of a mesh are measured with: clusters of triangles for a narrow band, a tree
 * for a wider one and for all of space. Both give the same squares to the bit. */
#ifndef VXM_VOXEL_FIELDS_DISTANCE_SEARCH_H
#define VXM_VOXEL_FIELDS_DISTANCE_SEARCH_H

#include "grid/window.h"
#include "voxel/closest/band_tile.h"
#include "voxel/closest/distance_bvh.h"
#include "voxel/surface/surface.h"
#include "voxmend/field.h"

typedef struct vxm_distance_search {
  vxm_context *context;
  const vxm_space *space;
  vxm_surface *surface;
  int axes[3];                 /**< of the values: the one that varies fastest, the next, the slices */
  double side;                 /**< the longest of a voxel, model units: lengths are counted in it */
  double band;                 /**< INFINITY = none */
  double (*places)[3];         /**< of the vertices, for clusters; else while triangles are taken */
  vxm_band_clusters *clusters; /**< of a narrow band, else NULL */
  vxm_distance_bvh *tree;      /**< without one */
} vxm_distance_search;

/**
 * Takes the triangles of a soup.
 *
 * @param[out] out destroyed with vxm_distance_search_destroy, also after a failure
 * @param space    kept; must outlive it
 * @param options  checked
 * @return VXM_OK, VXM_ERROR_EMPTY, VXM_ERROR_RANGE, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 * VXM_ERROR_CANCELLED
 */
vxm_status vxm_distance_search_create(vxm_distance_search *out, vxm_context *context, const vxm_soup *soup,
                                      const vxm_space *space, vxm_layout layout,
                                      const vxm_distance_options *options, vxm_error *error);
void vxm_distance_search_destroy(vxm_distance_search *search);
/** Bytes that it takes at most. @param[out] triangles of the soup */
uint64_t vxm_distance_search_bytes(const vxm_soup *soup, const vxm_distance_options *options,
                                   size_t *triangles);

/** Whether a band is one that clusters are for. */
bool vxm_distance_is_narrow(const vxm_distance_options *options);
/** The distance of voxels beyond the band, in model units; INFINITY where there is none. */
float vxm_distance_limit(const vxm_distance_options *options, const vxm_space *space);

/** Some values in a row, 64 at most, from squares that are `stride` apart; `inside` has a bit for each. */
void vxm_distance_finish(const vxm_distance_search *search, float *values, const double *squares,
                         ptrdiff_t stride, uint64_t inside, int count, vxm_band_tally *tally);

#endif

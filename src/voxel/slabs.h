/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Working in slabs: the grid is cut along one axis into slabs whose scratch bits stay in cache. A slab is
 * done by one thread, which alone writes the grid words in it, and takes the facets that touch it, part after
 * part.
 */
#ifndef VXM_VOXEL_SLABS_H
#define VXM_VOXEL_SLABS_H

#include "voxel/facets.h"
#include "voxel/raster.h"

#include <stdatomic.h>

/** Which facets are to be united into a grid, and how. */
typedef struct vxm_unite_job {
  const vxm_facets *facets;
  const vxm_lattice *lattice;
  vxm_axes axes;               /**< slabs are cut along v */
  size_t part_begin, part_end; /**< these parts only */
  unsigned roles;              /**< facets of these roles count, or-ed vxm_facet_role */
  bool to_apex;                /**< a facet reaches from its triangle to the part's apex */
  atomic_uchar *touched;       /**< per part: set to 1 if it sets a voxel; may be NULL */
  const char *phase;           /**< for progress */
} vxm_unite_job;

/** Puts one facet into the bits of a part within a slab. */
typedef void (*vxm_facet_fn)(const vxm_unite_job *job, const vxm_facet *facet, const vxm_raster *raster);
/** Moves those bits into the grid and clears words and spans; says whether any voxel was set. */
typedef bool (*vxm_fold_fn)(vxm_grid *grid, const vxm_raster *raster);

/**
 * Runs `draw` for every facet of the job and `fold` for every part in every slab, in parallel over slabs.
 *
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_unite(vxm_grid *grid, const vxm_unite_job *job, vxm_facet_fn draw, vxm_fold_fn fold,
                     vxm_error *error);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Where rows come into what a closed chain is wound around at least once, and out of it again: flips as
 * those of a part by parity (voxel/parity/columns.h), so that it can be united with parts. */
#ifndef VXM_VOXEL_WINDING_CHAIN_FLIPS_H
#define VXM_VOXEL_WINDING_CHAIN_FLIPS_H

#include "voxel/winding/chain_winding.h"

/** Of a slab; start from zeros, and keep it from one slab to the next. */
typedef struct vxm_chain_flips {
  uint64_t *places; /**< of the flips in the slab, in order */
  size_t count, capacity;
  uint32_t *ends; /**< of each row */
  size_t row_capacity;
} vxm_chain_flips;

/**
 * Takes a slab's crossings out of the chain's bins (vxm_chain_winding_raster), whose columns run along rows.
 *
 * @param rows       of the slab
 * @param place_bits a row has 2^place_bits places, and the next one those behind them
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_chain_flips_take(vxm_chain_flips *out, const vxm_chain_winding *chain, size_t slab,
                                size_t rows, int place_bits);
void vxm_chain_flips_destroy(vxm_chain_flips *flips, vxm_context *context);

#endif

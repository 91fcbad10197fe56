/* SPDX-License-Identifier: BSD-3-Clause */
/** What a tool cuts: the bits of a grid, or those of an octree as far as they have changed. */
#ifndef VXM_CARVE_STOCK_H
#define VXM_CARVE_STOCK_H

#include "grid/octree.h"

/** Voxels along a tile of an octree. */
enum { VXM_STOCK_TILE = 64 };

/** A cube of an octree's voxels that a tool has come to. */
typedef struct vxm_stock_tile {
  int64_t at[3];  /**< its number along each axis */
  vxm_grid *bits; /**< as they are now, fewer at the end of the octree; NULL = no tile */
} vxm_stock_tile;

/** Start with vxm_stock_of_grid or vxm_stock_of_sparse. */
typedef struct vxm_stock {
  vxm_context *context; /**< lent, and so are the next two, one of which is NULL */
  vxm_grid *grid;
  const vxm_sparse *sparse;
  vxm_stock_tile *tiles; /**< a table with open addressing; its size is a power of two */
  size_t tile_count, tile_capacity;
  vxm_stock_tile last; /**< the one that was looked for last */
  /* Since vxm_stock_begin. */
  int64_t removed;
  int64_t low[3], high[3]; /**< of the voxels that were removed; low > high if there is none */
  vxm_status status;       /**< of a tile that could not be made; from then on nothing is cut */
  vxm_error *error;
} vxm_stock;

vxm_stock vxm_stock_of_grid(vxm_grid *grid);
vxm_stock vxm_stock_of_sparse(vxm_context *context, const vxm_sparse *sparse);
void vxm_stock_destroy(vxm_stock *stock);

static inline const vxm_space *vxm_stock_space(const vxm_stock *stock) {
  return stock->grid ? &stock->grid->space : &stock->sparse->space;
}

/** Begins to count. @param error stays in use until the count is read */
void vxm_stock_begin(vxm_stock *stock, vxm_error *error);
/** Whether the stock has no voxel set in first..last along each axis, which lies within it. */
bool vxm_stock_is_clear(vxm_stock *stock, const int64_t first[3], const int64_t last[3]);
/** Clears the bits of a mask in word `word` of row (j,k), which lie within the stock. */
void vxm_stock_clear(vxm_stock *stock, int64_t word, int64_t j, int64_t k, uint64_t mask);
/** Clears voxels begin..end-1 of row (j,k), which lie within the stock. */
void vxm_stock_clear_span(vxm_stock *stock, int64_t j, int64_t k, int64_t begin, int64_t end);

/** The octree as it is now. @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_stock_octree(vxm_sparse **out, const vxm_stock *stock, vxm_error *error);

#endif

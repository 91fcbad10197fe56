/* SPDX-License-Identifier: BSD-3-Clause */
/** The distances of a tile of voxels to clusters of triangles that are near. */
#ifndef VXM_VOXEL_CLOSEST_BAND_TILE_H
#define VXM_VOXEL_CLOSEST_BAND_TILE_H

#include "voxel/closest/band_clusters.h"

/** Voxels along an edge of a tile. Its rows of squares lie farther apart, and so do its slices, so that
 * neighbours share no lines of the cache. A brick has VXM_BAND_VECTOR voxels at most, and four at least. */
enum {
  VXM_BAND_TILE = 32,
  VXM_BAND_ROW = VXM_BAND_TILE + 8,
  VXM_BAND_SLICE = VXM_BAND_ROW * (VXM_BAND_TILE + 1),
  VXM_BAND_VOXELS = VXM_BAND_SLICE * VXM_BAND_TILE,
  VXM_BAND_CANDIDATES = 1 << 12,
  VXM_BAND_GROUPS = 1 << 11,
  VXM_BAND_VECTOR = 16,
  VXM_BAND_BRICKS = VXM_BAND_TILE * VXM_BAND_TILE * VXM_BAND_TILE / 4,
  VXM_BAND_GATHERED = 1 << 10,
  VXM_BAND_PAIRS = 1 << 9,
  VXM_BAND_PLACE_SHIFT = 32
};

/** Voxels in which a cluster may be the nearest. */
typedef struct vxm_band_gathered {
  _Alignas(64) float at[3][VXM_BAND_GATHERED + VXM_BAND_VECTOR];   /**< as seen from the cluster */
  _Alignas(64) int32_t place[VXM_BAND_GATHERED + VXM_BAND_VECTOR]; /**< in the order of bricks */
} vxm_band_gathered;

/** Some of them, which are one vector. */
typedef struct vxm_band_group {
  int32_t place[VXM_BAND_VECTOR]; /**< behind the last one any */
  uint32_t cluster;
  uint16_t count;
  bool is_brick; /**< they follow one another from a multiple of their number on */
} vxm_band_group;

/** A triangle that, as far as floats tell, may be the nearest to some of a group of voxels: to be measured in
 * doubles. */
typedef struct vxm_band_candidate {
  uint16_t group, triangle; /**< indices within its cluster */
} vxm_band_candidate;

/** A candidate that later bounds have not ruled out, and a bit for each voxel for which they have not. */
typedef struct vxm_band_survivor {
  uint32_t candidate, voxels;
} vxm_band_survivor;

/** Single voxels for which one of a few triangles is looked at. */
typedef struct vxm_band_pairs {
  double square[VXM_BAND_PAIRS];
  int32_t triangle[VXM_BAND_PAIRS + VXM_BAND_VECTOR];
  int32_t place[VXM_BAND_PAIRS + VXM_BAND_VECTOR]; /**< in the order of bricks */
  uint32_t to[VXM_BAND_PAIRS];                     /**< the voxel's square */
} vxm_band_pairs;

/** What a worker makes a tile in. */
typedef struct vxm_band_tile {
  _Alignas(64) float lower[VXM_BAND_CANDIDATES]
                          [VXM_BAND_VECTOR]; /**< of candidates: squared distances are not below that */
  /** No less than what is to come, squared: brick after brick. */
  _Alignas(64) float upper[VXM_BAND_TILE * VXM_BAND_TILE * VXM_BAND_TILE];
  double squares[VXM_BAND_VOXELS];   /**< the result, band^2 where nothing is nearer */
  double places[3][VXM_BAND_ROW];    /**< of the voxels, along fast, middle and slow */
  double bricks_at[3][VXM_BAND_ROW]; /**< of the first voxels of bricks */
  vxm_band_candidate candidates[VXM_BAND_CANDIDATES];
  vxm_band_survivor survivors[VXM_BAND_CANDIDATES + 1];
  vxm_band_group groups[VXM_BAND_GROUPS];
  vxm_band_gathered gathered;
  vxm_band_pairs pairs;
  uint32_t bricks[VXM_BAND_BRICKS + 1]; /**< of a cluster: their numbers, above a bit for each voxel */
  size_t candidate_count, group_count;
  int64_t first[3];
  int count[3]; /**< 1 to VXM_BAND_TILE */
} vxm_band_tile;

/** Where its values go, and the signs they get. Of threes as of strides the order is fast, middle, slow. */
typedef struct vxm_band_values {
  float *values; /**< of the first voxel */
  size_t row, slice;
  const uint64_t *words; /**< of the solid: that of the first voxel; NULL = no signs */
  size_t row_words, slice_words;
  int shift;         /**< the first voxel's bit */
  bool is_streaming; /**< so many that what is beyond the band is written past the cache */
  double band, side;
} vxm_band_values;

/** Of values: how many were measured, how many lie inside, and their range. */
typedef struct vxm_band_tally {
  _Alignas(64) int64_t exact, inside;
  float min, max;
} vxm_band_tally;

/** Counts a value in the range. */
static inline void vxm_band_tally_add(vxm_band_tally *tally, float value) {
  tally->min = value < tally->min ? value : tally->min;
  tally->max = value > tally->max ? value : tally->max;
}

typedef struct vxm_band_kernels {
  /** Keys of the triangles begin..end-1: where they lie, from bit VXM_BAND_PLACE_SHIFT on, and which they
   * are. */
  void (*make_keys)(uint64_t *keys, const vxm_band_soup *soup, const vxm_band_grid *grid, size_t begin,
                    size_t end);
  /** Lists where clusters begin among the triangles that have the keys begin..end-1; returns how many. */
  size_t (*find_starts)(uint32_t *starts, const vxm_band_soup *soup, const uint64_t *keys, size_t begin,
                        size_t end);
  /**
   * Makes a cluster that has `first` and `count`, and its triangles, whose keys are handed over: all but its
   * margin and voxels, with a low, high and half that are not widened yet. Returns how far it reaches from
   * its origin.
   */
  double (*make_cluster)(vxm_band_cluster *cluster, vxm_band_triangle *triangles, const vxm_band_soup *soup,
                         const uint64_t *keys, const vxm_band_grid *grid);
  /**
   * The squared distances of a tile that has `first` and `count` to the nearest triangle of the clusters
   * listed: the least that vxm_triangle_distance2 gives, to the bit, where that is below band^2, or band^2.
   */
  void (*measure)(vxm_band_tile *tile, const vxm_band_clusters *clusters, const uint32_t *list, size_t count);
  /** Roots, scales and rounds, and gives the signs. */
  void (*finish)(const vxm_band_values *out, const vxm_band_tile *tile, vxm_band_tally *tally);
  /** Values of a block beyond the band. */
  void (*fill)(const vxm_band_values *out, const int64_t count[3], vxm_band_tally *tally);
} vxm_band_kernels;

/** The build for this processor. */
const vxm_band_kernels *vxm_band_kernels_best(void);
/** All builds that run on it; returns how many. */
size_t vxm_band_kernels_all(const vxm_band_kernels *out[3]);

#endif

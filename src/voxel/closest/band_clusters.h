/* SPDX-License-Identifier: BSD-3-Clause */
/** Triangles in clusters of up to eight neighbours, which are tested together for the voxels near them. */
#ifndef VXM_VOXEL_CLOSEST_BAND_CLUSTERS_H
#define VXM_VOXEL_CLOSEST_BAND_CLUSTERS_H

#include "base/context.h"

/** Triangles: lengths in voxels, as vxm_band_grid has them. */
typedef struct vxm_band_soup {
  const double (*points)[3];
  const uint32_t (*corners)[3];
  size_t count;
} vxm_band_soup;

/** The voxels whose distances are asked for: that of (i,j,k) is ((i + 1/2) * step[0], ...). */
typedef struct vxm_band_grid {
  int axes[3];     /**< x, y or z = 0, 1 or 2: the one that rows run along, the next, the slices */
  int64_t dims[3]; /**< in that order */
  double step[3];  /**< of x, y and z; the longest is 1 */
  double band;     /**< what is as far as that, or farther, does not matter */
} vxm_band_grid;

enum { VXM_BAND_CLUSTER = 8 /**< triangles in a cluster at most */ };

/** A triangle, and vxm_distance_triangle in floats, as seen from its cluster's origin; the columns are fast,
 * middle, slow. */
typedef struct vxm_band_triangle {
  /** A point q lies at axis q + offset in a frame that begins on the longest edge below the apex, where the
   * edge cuts the triangle in two: what is nearest to a point lies on its own side. Along the second axis the
   * apex is below 0. Twos are of the sides above 0 along the first axis, and below. */
  float axis[3][3], offset[3];
  float base[2];      /**< how far the longest edge reaches */
  float leg[2][2];    /**< from its ends to the apex, away from 0 and down the second axis; unit */
  float leg_half[2];  /**< half of their lengths */
  uint32_t corner[3]; /**< points of the soup */
  uint32_t rest;      /**< so that whole vectors are stored */
} vxm_band_triangle;

/** Triangles side by side. All threes that are not doubles are in the order fast, middle, slow. */
typedef struct vxm_band_cluster {
  double origin[3]; /**< amid them; x, y, z */
  float axis[3][3]; /**< of a box about them */
  float low[3], high[3];
  float half[3];  /**< of the box along the grid's axes, whose middle is the origin */
  float point[3]; /**< of the surface, about amid the cluster; fast, middle, slow */
  bool has_point; /**< none of triangles that are so wide that it would say little */
  float margin;   /**< of rounding: what squared distances that matter may be wrong by */
  uint32_t first, count;
  int32_t box[3][2]; /**< the voxels that may be nearer than the band; empty if box[0][0] >= box[0][1] */
} vxm_band_cluster;

typedef struct vxm_band_clusters {
  vxm_context *context;
  vxm_band_grid grid;
  const double (*points)[3]; /**< of the soup */
  size_t count, triangle_count;
  vxm_band_cluster *clusters;
  vxm_band_triangle *triangles; /**< in the order of the clusters */
} vxm_band_clusters;

/**
 * Makes the clusters of one triangle or more.
 *
 * @param soup its points must outlive the clusters
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_band_clusters_create(vxm_band_clusters **out, vxm_context *context, const vxm_band_soup *soup,
                                    const vxm_band_grid *grid, vxm_error *error);
/** NULL is allowed. */
void vxm_band_clusters_destroy(vxm_band_clusters *clusters);
/** Bytes that clusters of so many triangles take at most. */
uint64_t vxm_band_clusters_bytes(size_t count);

#endif

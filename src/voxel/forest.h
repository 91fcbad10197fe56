/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Trees of boxes over triangles, one for each label, and a tree over these: for the label whose faces are the
 * nearest to a point, or how near those of one label are.
 *
 * Lengths are in the longest side of a voxel, from the minimum corner of the space on. A nearness is a float
 * made of the exact squared distance: distances that agree to its seven digits, or both lie below 1/3000000
 * of a voxel, are the same nearness, so that coincident faces tie whatever their corners are rounded to.
 */
#ifndef VXM_VOXEL_FOREST_H
#define VXM_VOXEL_FOREST_H

#include "voxel/labelling.h"

typedef struct vxm_forest vxm_forest;

/** What a search found. */
typedef struct vxm_near {
  float nearness;
  uint32_t label;    /**< 0 = nothing */
  uint32_t triangle; /**< of that label: the next search begins with it */
} vxm_near;

/**
 * Makes the trees over the faces of a labelling, whose polygons are cut into triangles. Triangles with a
 * corner that is not finite are left out.
 *
 * @param space whose origin and sides lengths are in
 * @return VXM_OK; VXM_ERROR_RANGE; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT, VXM_ERROR_CANCELLED
 */
vxm_status vxm_forest_create(vxm_forest **out, const vxm_labelling *labelling, const vxm_space *space,
                             vxm_error *error);
/** NULL is allowed. */
void vxm_forest_destroy(vxm_forest *forest);
/** Bytes that the trees of a labelling take at most, also while they are made. */
uint64_t vxm_forest_bytes(const vxm_labelling *labelling);

/** The lowest label of those with the least nearness. @param from a search nearby, or NULL */
vxm_near vxm_forest_nearest(const vxm_forest *forest, const double p[3], const vxm_near *from);
/** The least nearness of the faces of a label; INFINITY if it has none. */
float vxm_forest_nearness(const vxm_forest *forest, const double p[3], uint32_t label);
/** Whether a face of another label is no farther than `reach`. */
bool vxm_forest_has_other(const vxm_forest *forest, const double p[3], uint32_t label, double reach);

/** The distance that a nearness stands for, to 1e-7 of it and 1e-6. */
double vxm_forest_distance(float nearness);

#endif

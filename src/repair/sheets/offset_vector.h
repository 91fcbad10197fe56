/* SPDX-License-Identifier: BSD-3-Clause */
/** Where a vertex goes when the faces about it are moved along their normals. */
#ifndef VXM_REPAIR_SHEETS_OFFSET_VECTOR_H
#define VXM_REPAIR_SHEETS_OFFSET_VECTOR_H

#include "mesh/geometry.h"

/** An offset vector is at most this long, where the faces move by 1: mitres end there. */
#define VXM_MITRE_LIMIT 2.0

#define VXM_FLAT 0.01

/** Sums over the planes of faces, each moved by 1 along its unit normal. */
typedef struct vxm_offset_sums {
  double normals[6]; /**< of products of the normal's coordinates: xx yy zz xy yz zx */
  double moved[3];   /**< of normals */
  double weight;
} vxm_offset_sums;

void vxm_offset_sums_add(vxm_offset_sums *sums, vxm_vec3 normal, double weight);

/** a - b: the sums of those planes that are in `a` and not in `b`. */
vxm_offset_sums vxm_offset_sums_without(const vxm_offset_sums *a, const vxm_offset_sums *b);

/**
 * The shortest of the vectors whose end is nearest to all moved planes, by least squares; no longer than
 * VXM_MITRE_LIMIT. Zero without planes.
 *
 * @param flat directions in which the sum of squared normals is below this share of the largest one are left
 *             alone: VXM_FLAT, as normals that differ by some ten degrees tell little about where their
 * planes meet, or less where planes face each other
 */
vxm_vec3 vxm_offset_vector(const vxm_offset_sums *sums, double flat);

/** Sum of the squared distances of the end of a vector to the moved planes. */
double vxm_offset_residual(const vxm_offset_sums *sums, vxm_vec3 vector);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** How the exposed faces about a lattice point hang together, so that what touches there diagonally is apart.
 */
#ifndef VXM_GRIDIO_MESH_LATTICE_FANS_H
#define VXM_GRIDIO_MESH_LATTICE_FANS_H

#include <stdbool.h>
#include <stdint.h>

/** At most four voxels about a point touch in it alone. */
enum { VXM_LATTICE_FANS_MAX = 4, VXM_LATTICE_FACES = 12, VXM_LATTICE_CASES = 256 };

/**
 * For each choice of set voxels about a point: bit x + 2 y + 4 z is that of the voxel on the far (1) or near
 * (0) side along each axis. The faces about the point are numbered by vxm_lattice_face.
 *
 * Where four faces meet in an edge, those of one voxel belong together. What is connected then is a fan: a
 * closed walk of faces about the point. Its vertex is moved into the voxels that touch others along edges of
 * the fan, so that these come apart; if there are none, to the back of its faces.
 */
typedef struct vxm_lattice_fans {
  uint8_t count[VXM_LATTICE_CASES];
  uint8_t fan[VXM_LATTICE_CASES][VXM_LATTICE_FACES];         /**< of an exposed face */
  int8_t toward[VXM_LATTICE_CASES][VXM_LATTICE_FANS_MAX][3]; /**< where to: -1, 0 or 1 along each axis */
} vxm_lattice_fans;

void vxm_lattice_fans_fill(vxm_lattice_fans *out);

/** The face across `axis` on the far or near side along the two other axes, in their order. */
static inline unsigned vxm_lattice_face(int axis, bool far_u, bool far_v) {
  return 4 * (unsigned)axis + 2 * far_v + far_u;
}

/**
 * The face across `across` that has the edge from the point along `along`, on the far side or not, and lies
 * on the side `far` along the third axis.
 */
static inline unsigned vxm_lattice_face_at(int across, int along, bool far_along, bool far) {
  bool along_is_u = along < 3 - across - along;
  return vxm_lattice_face(across, along_is_u ? far_along : far, along_is_u ? far : far_along);
}

/** Whether four faces meet in the edge from the point along an axis: two of its voxels touch there alone. */
bool vxm_lattice_edge_pinched(unsigned set, int along, bool far);

#endif

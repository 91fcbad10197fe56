/* SPDX-License-Identifier: BSD-3-Clause */
/** Faces on their way to an output: as they are, or as the triangles that voxmend itself takes them for. */
#ifndef VXM_MESHIO_COMMON_FACES_OUT_H
#define VXM_MESHIO_COMMON_FACES_OUT_H

#include "mesh/triangulate.h"

/** What is written of one face after another. */
typedef struct vxm_faces_out {
  const vxm_soup *soup;
  vxm_triangulator tri;
  bool polygons;           /**< faces as they are, of any number of corners */
  const uint32_t *corners; /**< of the face: `pieces` times `each` */
  size_t pieces, each;
} vxm_faces_out;

void vxm_faces_out_open(vxm_faces_out *out, const vxm_soup *soup, bool polygons);
void vxm_faces_out_close(vxm_faces_out *out);

/**
 * Sets corners, pieces and each for a face. As triangles, a face of n corners has n - 2 pieces, which are
 * split by the exact positions (vxm_triangulate), and one of fewer than three has none.
 *
 * @return VXM_OK, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT
 */
vxm_status vxm_faces_out_take(vxm_faces_out *out, size_t face, vxm_error *error);

/** See vxm_mesh_triangulate in voxmend.h. */
vxm_status vxm_faces_out_triangles(vxm_soup **out, const vxm_soup *soup, vxm_error *error);

/** The pieces of all faces together. */
uint64_t vxm_faces_out_count(const vxm_soup *soup, bool polygons);

#endif

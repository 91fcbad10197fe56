/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The vertices of a surface where voxels touch in an edge or a corner alone: one for each side, so that no
 * edge has more than two faces and no vertex more than one fan.
 */
#ifndef VXM_GRIDIO_MESH_SPLIT_VERTICES_H
#define VXM_GRIDIO_MESH_SPLIT_VERTICES_H

#include "gridio/mesh/lattice_fans.h"
#include "gridio/mesh/quad_vertices.h"

/** Of a voxel, along each axis: how far such vertices lie within their own voxels. */
#define VXM_SPLIT_SHARE (1.0 / 256)

/**
 * A lattice vertex becomes one for each fan of faces about it. An edge of four faces whose ends have one fan
 * each (a hole through two voxels that touch in an edge, of an edge's length) has a vertex in its middle for
 * either side beside.
 */
typedef struct vxm_split_vertices {
  const vxm_quad_vertices *lattice;
  vxm_context *context;
  vxm_lattice_fans fans;
  uint8_t
      *set; /**< of each lattice vertex: the set voxels about it, see vxm_lattice_fans; NULL = none split */
  uint32_t *first; /**< and its first vertex; NULL = none is split, and vertices are those of the lattice */
  size_t vertex_count;
  size_t middles; /**< edges that have vertices in their middles */
} vxm_split_vertices;

/** @return VXM_OK; VXM_ERROR_RANGE for too many vertices; VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT */
vxm_status vxm_split_vertices_find(vxm_split_vertices *out, const vxm_quad_vertices *lattice,
                                   const vxm_grid *grid, vxm_error *error);
void vxm_split_vertices_destroy(vxm_split_vertices *split);

/** The vertex that a face has at a lattice vertex. @param face as vxm_lattice_face numbers it there */
uint32_t vxm_split_vertex(const vxm_split_vertices *split, uint32_t at, unsigned face);
/** The vertex that a face has in the middle of the edge along `along` from a lattice vertex to the next one,
 * or VXM_NO_CORNER. @param face as seen from there */
uint32_t vxm_split_middle(const vxm_split_vertices *split, uint32_t at, int along, unsigned face);
/** Fills vertex_count positions in model units. */
void vxm_split_vertices_place(const vxm_split_vertices *split, const vxm_space *space, double *positions);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Both sides of the faces of sheets, and which of them see each other across an edge. */
#ifndef VXM_REPAIR_SHEETS_SHEET_SIDES_H
#define VXM_REPAIR_SHEETS_SHEET_SIDES_H

#include "mesh/edges.h"

#define VXM_NO_CORNER UINT32_MAX

/**
 * Around an edge with k faces there are k wedges of space, each between a side of one face and a side of the
 * next: these see each other. Where an edge has one face, its front sees its back around the rim.
 *
 * The corners of both sides of triangle f are numbered 6 f + 2 j + s: of its corner j, s = 0 on the front
 * (where the normal points) and 1 on the back. The same number names the edge from corner j to corner j + 1,
 * as seen from that side.
 */
typedef struct vxm_sheet_sides {
  const vxm_soup *soup; /**< triangles */
  uint32_t *across;     /**< per edge of a side: that of the side it sees */
  uint8_t *cut; /**< per edge of a side: bit e is set where at end e of it (0 = corner j, 1 = corner j + 1)
                   the offset surface has vertices of their own on both sides */
  size_t count; /**< of corners of sides */
} vxm_sheet_sides;

/**
 * Sorts the faces around each edge. Faces that lie upon each other see each other.
 *
 * @param soup lives as long as `out`; triangles with three different corners each
 * @return VXM_OK, VXM_ERROR_RANGE beyond 2^29 triangles, VXM_ERROR_MEMORY, VXM_ERROR_MEMORY_LIMIT,
 *         VXM_ERROR_CANCELLED
 */
vxm_status vxm_sheet_sides_build(vxm_sheet_sides *out, const vxm_soup *soup, double scale, vxm_error *error);
void vxm_sheet_sides_destroy(vxm_sheet_sides *sides);

/** The number of corner j + 1 where `corner` is j, or of j - 1, on the same side. */
static inline uint32_t vxm_sheet_next(uint32_t corner) {
  uint32_t first = corner - corner % 6;
  return first + (corner - first + 2) % 6;
}

static inline uint32_t vxm_sheet_previous(uint32_t corner) {
  uint32_t first = corner - corner % 6;
  return first + (corner - first + 4) % 6;
}

static inline uint32_t vxm_sheet_vertex(const vxm_sheet_sides *sides, uint32_t corner) {
  return sides->soup->indices[corner / 2];
}

static inline bool vxm_sheet_is_rim(const vxm_sheet_sides *sides, uint32_t edge) {
  return sides->across[edge] == (edge ^ 1);
}

/** The end of an edge (0 or 1) at which a vertex is. */
static inline int vxm_sheet_end(const vxm_sheet_sides *sides, uint32_t edge, uint32_t vertex) {
  return vxm_sheet_vertex(sides, edge) != vertex;
}

/** The other edge of the side's face at a corner. */
static inline uint32_t vxm_sheet_other_edge(uint32_t corner, uint32_t edge) {
  return edge == corner ? vxm_sheet_previous(corner) : corner;
}

/**
 * Goes from a corner of a side to that of the side it sees across `*edge`, and makes `*edge` the next one
 * about the vertex. False, and nowhere gone, where the edge is a rim or cut at the vertex.
 */
bool vxm_sheet_step(const vxm_sheet_sides *sides, uint32_t *corner, uint32_t *edge);

/** The first corner of the walk about a vertex that a corner is in, and the edge that leads on from it; of a
 * walk that is closed the corner itself. */
uint32_t vxm_sheet_walk_begin(const vxm_sheet_sides *sides, uint32_t corner, uint32_t *edge);

/** Cuts an edge at a vertex, on both sides. */
void vxm_sheet_cut(vxm_sheet_sides *sides, uint32_t edge, uint32_t vertex);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** C++ only: the rims of holes on half-edges. */
#ifndef VXM_MODULES_OPENMESH_HOLES_H
#define VXM_MODULES_OPENMESH_HOLES_H

#include "modules/openmesh/mesh.h"

#include <map>
#include <utility>

namespace voxmend {

/** Twins: vertices of a rim at the same position, by each of them; those without are not listed. */
using twins = std::map<uint32_t, std::vector<uint32_t>>;

/** The rim of one hole, in the direction in which faces that fill it run along it. */
struct rim_loop {
  std::vector<uint32_t> vertices; /**< at different positions unless these had to stay apart */
  std::vector<size_t> beyond;     /**< the face across the edge to the next vertex */
  /** Vertices that have to become one for the loop to be closed. */
  std::vector<std::pair<uint32_t, uint32_t>> seams;
};

/**
 * Follows the boundary from a half-edge, and takes it apart where it meets itself. Holes that touch at a
 * vertex are one in a manifold, as that vertex is two there; filled as one they would have to be folded.
 * Once they are filled, each for itself, the two vertices can be one again. Twins that have neighbours at the
 * same position, or a face in common, do not count as such.
 */
std::vector<rim_loop> rim_loops(twins &found, const halfedges &linked, const vxm_soup *soup,
                                halfedges::halfedge first);

} // namespace voxmend

#endif

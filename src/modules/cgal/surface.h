/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Surfaces of several parts together. */
#ifndef VXM_MODULES_CGAL_SURFACE_H
#define VXM_MODULES_CGAL_SURFACE_H

#include "modules/cgal/triangles.h"

namespace vxm {

/** A triangle of a part, which lies where a triangle or a piece of one lies that is taken for it. */
struct Cover {
  uint32_t part;
  int32_t sign;  /**< 1, or -1 if it is turned the other way round */
  uint64_t face; /**< of the soup that it came from */
};

/** Triangles, each with what covers it. */
struct Sheet {
  std::vector<Corners> corners;
  std::vector<size_t> begin; /**< triangle t has covers begin[t] to begin[t + 1] - 1 */
  std::vector<Cover> covers;

  Sheet() : begin(1, 0) {
  }
  size_t size() const {
    return corners.size();
  }
  void add(const Corners &corner) {
    corners.push_back(corner);
    begin.push_back(covers.size());
  }
  /** For the triangle added last. */
  void cover(const Cover &one) {
    covers.push_back(one);
    begin.back() = covers.size();
  }
};

/** Triangles over points that are all different; no two have the same three corners, and all have area. */
struct Surface {
  std::vector<Position> points;
  Sheet sheet;
};

/** Pairs of triangles that meet elsewhere than in corners and edges they share, sorted. */
using Meetings = std::vector<std::pair<uint32_t, uint32_t>>;

} // namespace vxm

#endif

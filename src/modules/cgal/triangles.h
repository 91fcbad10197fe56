/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Soups as the module works on them: triangles whose corners are the same where their positions are. */
#ifndef VXM_MODULES_CGAL_TRIANGLES_H
#define VXM_MODULES_CGAL_TRIANGLES_H

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "mesh/soup.h"
#include "modules/cgal/budget.h"

namespace vxm {

struct DestroySoup {
  void operator()(vxm_soup *soup) const {
    vxm_soup_destroy(soup);
  }
};
/** A soup that goes away with its owner. */
using Owner = std::unique_ptr<vxm_soup, DestroySoup>;

using Position = std::array<double, 3>;
using Corners = std::array<uint32_t, 3>;

struct Triangles {
  std::vector<Position> points;
  std::vector<Corners> corners;
  std::vector<uint64_t> face; /**< of the soup; not less than that of the triangle before */
};

/** What the corners of triangles name: the first vertex of each position, or the vertices of the soup as they
 * are. */
enum class Naming { by_position, by_vertex };

/**
 * Splits the faces of a soup into triangles; points are the soup's vertices. Triangles that name a point
 * twice are left out. Throws Stopped, with VXM_ERROR_ARGUMENT for a position that is not finite.
 */
Triangles triangles_of(const vxm_soup *soup, Naming naming, Meter &meter);

/** For each vertex of a soup the first one of the same position. */
std::vector<uint32_t> same_positions(const std::vector<Position> &points, Meter &meter);

/** Takes two triangles, first < second; false ends the search. */
using Found = std::function<bool(uint32_t first, uint32_t second)>;

/**
 * Finds all pairs of triangles that meet elsewhere than in the corners and edges that they share, exactly.
 * Triangles without area take no part; two with the same three corners meet. Pairs come in an order that
 * depends on the triangles alone.
 */
void find_meetings(const std::vector<Position> &points, const std::vector<Corners> &corners, Meter &meter,
                   const Found &found);

/** As find_meetings, only for pairs with a triangle from `first` on. */
void find_meetings_from(size_t first, const std::vector<Position> &points,
                        const std::vector<Corners> &corners, Meter &meter, const Found &found);

/** Whether two triangles lie in one plane, exactly. */
bool in_one_plane(const std::vector<Position> &points, const Corners &one, const Corners &other);

/** Whether the corners of a triangle are not on one line, exactly. */
bool has_area(const std::vector<Position> &points, const Corners &corners);

} // namespace vxm

#endif

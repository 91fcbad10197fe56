/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>

#include "modules/cgal/triangles.h"

namespace vxm {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
/* Boxes are told apart by where the corners of their triangle lie, which is their order in the list. */
using Box = CGAL::Box_intersection_d::Box_with_handle_d<double, 3, const Corners *>;

/** Leaves the search for boxes. */
struct Enough {};

Point point(const Position &p) {
  return Point(p[0], p[1], p[2]);
}

class Search {
public:
  Search(const std::vector<Position> &points, const std::vector<Corners> &corners, Meter &meter,
         const Found &found)
      : points_(points), corners_(corners), meter_(meter), found_(found) {
  }

  std::vector<Box> boxes(size_t begin, size_t end) const {
    std::vector<Box> out;
    out.reserve(end - begin);
    for (size_t t = begin; t < end; t++) {
      meter_.tick();
      if (!has_area(points_, corners_[t]))
        continue;
      const Position &a = points_[corners_[t][0]], &b = points_[corners_[t][1]], &c = points_[corners_[t][2]];
      double low[3], high[3];
      for (size_t axis = 0; axis < 3; axis++) {
        low[axis] = std::min({a[axis], b[axis], c[axis]});
        high[axis] = std::max({a[axis], b[axis], c[axis]});
      }
      out.emplace_back(low, high, &corners_[t]);
    }
    return out;
  }

  void operator()(const Box &one, const Box &other) const {
    meter_.tick();
    size_t i = (size_t)(one.handle() - corners_.data()), j = (size_t)(other.handle() - corners_.data());
    if (i > j)
      std::swap(i, j);
    if (i != j && meet(corners_[i], corners_[j]) && !found_((uint32_t)i, (uint32_t)j))
      throw Enough();
  }

private:
  Kernel::Triangle_3 triangle(const Corners &t) const {
    return Kernel::Triangle_3(point(points_[t[0]]), point(points_[t[1]]), point(points_[t[2]]));
  }

  /** Whether the side of `t` opposite to its corner k meets triangle u. */
  bool side_meets(const Corners &t, size_t k, const Corners &u) const {
    Kernel::Segment_3 side(point(points_[t[(k + 1) % 3]]), point(points_[t[(k + 2) % 3]]));
    return CGAL::do_intersect(side, triangle(u));
  }

  /** With a common edge they overlap if they lie in one plane and on the same side of it. */
  bool fold(const Corners &t, size_t single, const Corners &u, size_t other) const {
    Point a = point(points_[t[(single + 1) % 3]]), b = point(points_[t[(single + 2) % 3]]),
          c = point(points_[t[single]]), d = point(points_[u[other]]);
    return CGAL::coplanar(a, b, c, d) && CGAL::coplanar_orientation(a, b, c, d) == CGAL::POSITIVE;
  }

  /** Whether all of u lies beyond the plane of t. */
  bool apart(const Corners &t, const Corners &u) const {
    Point a = point(points_[t[0]]), b = point(points_[t[1]]), c = point(points_[t[2]]);
    CGAL::Orientation side = CGAL::orientation(a, b, c, point(points_[u[0]]));
    return side != CGAL::COPLANAR && side == CGAL::orientation(a, b, c, point(points_[u[1]])) &&
           side == CGAL::orientation(a, b, c, point(points_[u[2]]));
  }

  bool meet(const Corners &t, const Corners &u) const {
    size_t shared = 0, in_t = 0, in_u = 0;
    for (size_t i = 0; i < 3; i++)
      for (size_t j = 0; j < 3; j++)
        if (t[i] == u[j]) {
          shared++;
          /* of a single common corner these are the places, of two the sums of them */
          in_t += i;
          in_u += j;
        }
    switch (shared) {
    case 0:
      return !apart(t, u) && !apart(u, t) && CGAL::do_intersect(triangle(t), triangle(u));
    case 1:
      /* What they share besides the corner reaches the side opposite to it in one of them. */
      return side_meets(t, in_t, u) || side_meets(u, in_u, t);
    case 2:
      return fold(t, 3 - in_t, u, 3 - in_u);
    default:
      return true;
    }
  }

  const std::vector<Position> &points_;
  const std::vector<Corners> &corners_;
  Meter &meter_;
  const Found &found_;
};

} // namespace

bool in_one_plane(const std::vector<Position> &points, const Corners &one, const Corners &other) {
  for (uint32_t corner : other)
    if (CGAL::orientation(point(points[one[0]]), point(points[one[1]]), point(points[one[2]]),
                          point(points[corner])) != CGAL::COPLANAR)
      return false;
  return true;
}

bool has_area(const std::vector<Position> &points, const Corners &corners) {
  return !CGAL::collinear(point(points[corners[0]]), point(points[corners[1]]), point(points[corners[2]]));
}

void find_meetings(const std::vector<Position> &points, const std::vector<Corners> &corners, Meter &meter,
                   const Found &found) {
  Search search(points, corners, meter, found);
  std::vector<Box> boxes = search.boxes(0, corners.size());
  try {
    CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), std::cref(search));
  } catch (const Enough &) {
  }
}

void find_meetings_from(size_t first, const std::vector<Position> &points,
                        const std::vector<Corners> &corners, Meter &meter, const Found &found) {
  Search search(points, corners, meter, found);
  std::vector<Box> fresh = search.boxes(first, corners.size()), old = search.boxes(0, first);
  try {
    CGAL::box_self_intersection_d(fresh.begin(), fresh.end(), std::cref(search));
    CGAL::box_intersection_d(fresh.begin(), fresh.end(), old.begin(), old.end(), std::cref(search));
  } catch (const Enough &) {
  }
}

} // namespace vxm

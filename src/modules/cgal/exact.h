/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Points in exact coordinates. */
#ifndef VXM_MODULES_CGAL_EXACT_H
#define VXM_MODULES_CGAL_EXACT_H

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <unordered_map>

#include "modules/cgal/rays.h"

namespace vxm {

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using ExactPoint = Exact::Point_3;
/** Rational numbers, computed at once. */
using Rational = Exact::FT::Exact_type;
using RationalPoint = std::array<Rational, 3>;

inline ExactPoint exact_point(const Position &p) {
  return ExactPoint(p[0], p[1], p[2]);
}

/** Numbers exact points so that equal ones have the same number. */
class ExactPoints {
public:
  /** Numbers the points, which are all different, 0, 1, ... */
  explicit ExactPoints(const std::vector<Position> &points);

  /** The number of a point, which may be a new one. */
  uint32_t add(const RationalPoint &point);

  const ExactPoint &operator[](uint32_t point) const {
    return exact_[point];
  }
  /** The nearest position in doubles, or one next to it. */
  const Position &rounded(uint32_t point) const {
    return rounded_[point];
  }
  size_t size() const {
    return exact_.size();
  }

private:
  std::vector<ExactPoint> exact_;
  std::vector<Position> rounded_;
  std::unordered_multimap<uint64_t, uint32_t> by_hash_;
};

/** A ray that begins at an exact point. */
struct ExactRay {
  ExactPoint from;
  size_t axis;
};

/** As for rays from positions. */
void cast_rays(const std::vector<Position> &points, const std::vector<Corners> &corners,
               const std::vector<ExactRay> &rays, Meter &meter, const Crossed &crossed);

} // namespace vxm

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modules/cgal/exact.h"

#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "base/hash.h"

namespace vxm {

namespace {

/* ---- Points ---- */

/* Rounding takes the value alone, so equal points have equal hashes. */
uint64_t hash_of(const Position &p) {
  uint64_t hash = 0;
  for (double x : p) {
    double clean = x == 0 ? 0 : x;
    uint64_t bits;
    std::memcpy(&bits, &clean, sizeof bits);
    hash = vxm_hash_word(hash, bits);
  }
  return hash;
}

/* ---- Rays ---- */

struct Item {
  uint32_t number;
};
using Box = CGAL::Box_intersection_d::Box_with_handle_d<double, 3, const Item *>;

/*
 * The same questions are asked in intervals first, which answer nearly all of them, and in exact numbers
 * where an interval has 0 inside.
 */
using Interval = CGAL::Interval_nt_advanced;
using Quick = CGAL::Simple_cartesian<Interval>;
template <class Kernel> using Flat = typename Kernel::Point_2;

struct Undecided {};

int certain(CGAL::Uncertain<CGAL::Sign> sign) {
  if (!sign.is_certain())
    throw Undecided();
  return (int)sign.make_certain();
}

int certain(CGAL::Sign sign) {
  return (int)sign;
}

/** A point as it is seen along an axis. */
template <class Kernel> Flat<Kernel> flat(const typename Kernel::Point_3 &p, size_t axis) {
  return Flat<Kernel>(p[(int)((axis + 1) % 3)], p[(int)((axis + 2) % 3)]);
}

/**
 * On which side of a b the point lies after it was moved by (e, e * e); 0 only if a and b are the same. A
 * decision between two triangles depends on their common edge alone, so exactly one has the point.
 */
template <class Kernel> int side(const Flat<Kernel> &a, const Flat<Kernel> &b, const Flat<Kernel> &point) {
  int at = certain(CGAL::orientation(a, b, point));
  if (at != 0)
    return at;
  int along = certain(CGAL::compare_y(a, b));
  return along != 0 ? along : certain(CGAL::compare_x(b, a));
}

/** 0 if the ray does not pass through the triangle, or the sign of the crossing. */
template <class Kernel>
int crossing(const typename Kernel::Point_3 &from, size_t axis, const typename Kernel::Point_3 &a,
             const typename Kernel::Point_3 &b, const typename Kernel::Point_3 &c) {
  Flat<Kernel> p = flat<Kernel>(a, axis), q = flat<Kernel>(b, axis), r = flat<Kernel>(c, axis),
               at = flat<Kernel>(from, axis);
  int area = certain(CGAL::orientation(p, q, r));
  if (area == 0 || side<Kernel>(p, q, at) != area || side<Kernel>(q, r, at) != area ||
      side<Kernel>(r, p, at) != area)
    return 0;
  int above = certain(CGAL::orientation(a, b, c, from));
  return above * area < 0 ? area : 0;
}

Quick::Point_3 quick(const Position &p) {
  return Quick::Point_3(Interval(p[0]), Interval(p[1]), Interval(p[2]));
}

Quick::Point_3 quick(const ExactPoint &p) {
  const auto &known = p.approx();
  return Quick::Point_3(Interval(known.x().inf(), known.x().sup()),
                        Interval(known.y().inf(), known.y().sup()),
                        Interval(known.z().inf(), known.z().sup()));
}

int crossing(const ExactRay &ray, const Position &a, const Position &b, const Position &c) {
  try {
    CGAL::Protect_FPU_rounding<true> upward;
    return crossing<Quick>(quick(ray.from), ray.axis, quick(a), quick(b), quick(c));
  } catch (const Undecided &) {
    return crossing<Exact>(ray.from, ray.axis, exact_point(a), exact_point(b), exact_point(c));
  }
}

std::vector<Box> boxes_of_rays(const std::vector<ExactRay> &rays, size_t axis, std::vector<Item> *items) {
  std::vector<Box> out;
  for (size_t r = 0; r < rays.size(); r++) {
    if (rays[r].axis != axis)
      continue;
    CGAL::Bbox_3 around = rays[r].from.bbox();
    double low[3], high[3];
    for (size_t k = 0; k < 3; k++) {
      low[k] = (around.min)((int)k);
      high[k] = k == axis ? std::numeric_limits<double>::max() : (around.max)((int)k);
    }
    out.emplace_back(low, high, &(*items)[r]);
  }
  return out;
}

std::vector<Box> boxes_of_triangles(const std::vector<Position> &points, const std::vector<Corners> &corners,
                                    std::vector<Item> *items) {
  std::vector<Box> out;
  out.reserve(corners.size());
  for (size_t t = 0; t < corners.size(); t++) {
    const Position &a = points[corners[t][0]], &b = points[corners[t][1]], &c = points[corners[t][2]];
    double low[3], high[3];
    for (size_t k = 0; k < 3; k++) {
      low[k] = std::min({a[k], b[k], c[k]});
      high[k] = std::max({a[k], b[k], c[k]});
    }
    out.emplace_back(low, high, &(*items)[t]);
  }
  return out;
}

std::vector<Item> numbered(size_t count) {
  std::vector<Item> out(count);
  for (size_t i = 0; i < count; i++)
    out[i].number = (uint32_t)i;
  return out;
}

} // namespace

ExactPoints::ExactPoints(const std::vector<Position> &points) : rounded_(points) {
  exact_.reserve(points.size());
  by_hash_.reserve(points.size());
  for (const Position &p : points) {
    by_hash_.emplace(hash_of(p), (uint32_t)exact_.size());
    exact_.push_back(exact_point(p));
  }
}

uint32_t ExactPoints::add(const RationalPoint &point) {
  Position rounded = {CGAL::to_double(point[0]), CGAL::to_double(point[1]), CGAL::to_double(point[2])};
  Exact::FT x(point[0]), y(point[1]), z(point[2]);
  ExactPoint exact(x, y, z);
  uint64_t hash = hash_of(rounded);
  auto range = by_hash_.equal_range(hash);
  for (auto at = range.first; at != range.second; ++at)
    if (rounded_[at->second] == rounded && exact_[at->second] == exact)
      return at->second;
  auto number = (uint32_t)exact_.size();
  if (number == UINT32_MAX)
    throw std::length_error("more points than can be numbered");
  by_hash_.emplace(hash, number);
  exact_.push_back(exact);
  rounded_.push_back(rounded);
  return number;
}

void cast_rays(const std::vector<Position> &points, const std::vector<Corners> &corners,
               const std::vector<ExactRay> &rays, Meter &meter, const Crossed &crossed) {
  std::vector<Item> ray_items = numbered(rays.size()), triangle_items = numbered(corners.size());
  std::vector<Box> triangles;
  for (size_t axis = 0; axis < 3; axis++) {
    std::vector<Box> lines = boxes_of_rays(rays, axis, &ray_items);
    if (lines.empty())
      continue;
    if (triangles.empty())
      triangles = boxes_of_triangles(points, corners, &triangle_items);
    CGAL::box_intersection_d(
        lines.begin(), lines.end(), triangles.begin(), triangles.end(), [&](const Box &line, const Box &box) {
          meter.tick();
          uint32_t r = line.handle()->number, t = box.handle()->number;
          const Corners &corner = corners[t];
          int sign = crossing(rays[r], points[corner[0]], points[corner[1]], points[corner[2]]);
          if (sign != 0)
            crossed(r, t, sign);
        });
  }
}

void cast_rays(const std::vector<Position> &points, const std::vector<Corners> &corners,
               const std::vector<Ray> &rays, Meter &meter, const Crossed &crossed) {
  std::vector<ExactRay> exact;
  exact.reserve(rays.size());
  for (const Ray &ray : rays)
    exact.push_back({exact_point(ray.from), ray.axis});
  cast_rays(points, corners, exact, meter, crossed);
}

} // namespace vxm

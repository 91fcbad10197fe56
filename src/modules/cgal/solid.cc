/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modules/cgal/solid.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "modules/cgal/outer_boundary.h"
#include "repair/state/merge_rule.h"

namespace vxm {

namespace {

/*
 * The cut surface is exact; once rounded its thinnest slivers may turn over and meet. If cutting it again for
 * a few rounds does not help, the same is done from the beginning with all points on a lattice, coarser by so
 * many bits than the doubles of the largest coordinate (of which 32-bit floats have 29 less): what is thinner
 * than its spacing is then gone, and what is left has room.
 */
constexpr int LATTICES[] = {0, 18, 24, 30}, SINGLE_LATTICES[] = {0, 31, 33, 35};
constexpr int ROUNDS = 3, SINGLE_ROUNDS = 6;

/** Collects triangles into a surface without repetitions. */
class Collector {
public:
  void add(const std::vector<Position> &points, const Corners &corners, const Cover &cover) {
    Corners local;
    for (size_t k = 0; k < 3; k++)
      local[k] = number(points[corners[k]]);
    if (local[0] == local[1] || local[1] == local[2] || local[2] == local[0] ||
        !has_area(surface_.points, local)) {
      dropped_++;
      return;
    }
    /* Turned so that the smallest corner is first, the same triangle differs by its direction alone. */
    std::rotate(local.begin(), std::min_element(local.begin(), local.end()), local.end());
    bool backward = local[1] > local[2];
    if (backward)
      std::swap(local[1], local[2]);
    all_.emplace_back(local, Cover{cover.part, backward ? -cover.sign : cover.sign, cover.face});
  }

  /** Triangles that were left out because they have no area. */
  size_t dropped() const {
    return dropped_;
  }

  Surface take() {
    std::stable_sort(all_.begin(), all_.end(),
                     [](const auto &a, const auto &b) { return a.first < b.first; });
    for (size_t i = 0; i < all_.size(); i++) {
      if (i == 0 || all_[i].first != all_[i - 1].first)
        surface_.sheet.add(all_[i].first);
      surface_.sheet.cover(all_[i].second);
    }
    return std::move(surface_);
  }

private:
  uint32_t number(Position p) {
    for (double &x : p)
      x = x == 0 ? 0 : x;
    auto known = numbers_.emplace(p, (uint32_t)surface_.points.size());
    if (known.second)
      surface_.points.push_back(p);
    return known.first->second;
  }

  Surface surface_;
  std::map<Position, uint32_t> numbers_;
  std::vector<std::pair<Corners, Cover>> all_;
  size_t dropped_ = 0;
};

double largest(const std::vector<Position> &points) {
  double out = 0;
  for (const Position &p : points)
    for (double x : p)
      out = std::max(out, std::abs(x));
  return out;
}

std::vector<Position> on_lattice(const std::vector<Position> &points, int bits) {
  if (bits == 0)
    return points;
  double spacing = std::ldexp(1.0, std::ilogb(largest(points)) - 52 + bits);
  std::vector<Position> out = points;
  for (Position &p : out)
    for (double &x : p)
      x = std::round(x / spacing) * spacing;
  return out;
}

Meetings meetings_of(const Surface &surface, Meter &meter) {
  Meetings out;
  find_meetings(surface.points, surface.sheet.corners, meter, [&](uint32_t first, uint32_t second) {
    out.emplace_back(first, second);
    return true;
  });
  std::sort(out.begin(), out.end());
  return out;
}

/** A surface that is that of material, which winds around all so often without it. */
class OnePart : public Material {
public:
  explicit OnePart(int everywhere) : everywhere_(everywhere) {
  }
  bool inside(const std::vector<int> &windings) const override {
    return windings[0] + everywhere_ > 0;
  }

private:
  int everywhere_;
};

void round_to_singles(std::vector<Position> *points) {
  for (Position &p : *points)
    for (double &x : p)
      x = vxm_single(x);
}

/** One attempt; true if the outcome is good in the numbers that are to hold it. */
bool bound_in_numbers(const std::vector<Position> &points, const std::vector<PartTriangle> &triangles,
                      size_t part_count, bool single, Material *material, Meter &meter, Skin *out) {
  Collector input;
  for (const PartTriangle &t : triangles)
    input.add(points, t.corners, Cover{t.part, 1, t.face});
  Surface surface = input.take();
  Meetings meetings = meetings_of(surface, meter);
  *out = find_skin(surface, meetings, part_count, material, meter);
  /* Far away from all parts there may be material too, around cavities. */
  OnePart rest(material->inside(std::vector<int>(part_count)) ? 1 : 0);
  size_t last = SIZE_MAX;
  for (int round = 0;; round++) {
    if (single)
      round_to_singles(&out->points);
    Collector rounded;
    for (size_t t = 0; t < out->corners.size(); t++)
      rounded.add(out->points, out->corners[t], Cover{0, 1, out->face[t]});
    surface = rounded.take();
    meetings = meetings_of(surface, meter);
    size_t bad = meetings.size() + rounded.dropped();
    if (bad == 0)
      return true;
    if (bad >= last || round == (single ? SINGLE_ROUNDS : ROUNDS))
      return false;
    last = bad;
    /* The surface is that of the material now, a part by itself. */
    Skin next = find_skin(surface, meetings, 1, &rest, meter);
    next.altered = out->altered;
    *out = std::move(next);
  }
}

} // namespace

bool bound_solid(const std::vector<Position> &points, const std::vector<PartTriangle> &triangles,
                 size_t part_count, bool single, Material *material, Meter &meter, Skin *out) {
  for (int bits : single ? SINGLE_LATTICES : LATTICES)
    if (bound_in_numbers(on_lattice(points, bits), triangles, part_count, single, material, meter, out))
      return true;
  return false;
}

} // namespace vxm

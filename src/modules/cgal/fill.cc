/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modules/cgal/functions.h"

#include <algorithm>

#include "modules/cgal/exception_barrier.h"
#include "modules/cgal/holes.h"
#include "modules/cgal/result.h"

namespace vxm {

namespace {

/** How a hole is filled, the best way first. */
enum class Way { faired, refined, plain, not_at_all };

struct Hole {
  const Rim *rim;
  Patch patch;
  Way way;

  const std::vector<Corners> &corners() const {
    return way == Way::plain ? patch.plain : patch.refined;
  }
  const std::vector<Position> &points() const {
    static const std::vector<Position> none;
    return way == Way::faired ? patch.faired : way == Way::refined ? patch.flat : none;
  }
};

/** A hole's triangles among all: points of the soup, then new ones. */
struct Added {
  std::vector<Position> points;
  std::vector<Corners> corners;
  std::vector<uint32_t> hole; /**< of each triangle */
};

class Filling {
public:
  Filling(const vxm_soup *soup, Meter &meter)
      : soup_(soup), meter_(meter), whole_(triangles_of(soup, Naming::by_vertex, meter)),
        rims_(soup, whole_, meter) {
  }

  void run(size_t max_edges, int64_t *filled, int64_t *left) {
    meter_.phase("filling holes");
    std::vector<uint32_t> map = same_positions(whole_.points, meter_);
    for (const Rim &rim : rims_.all()) {
      meter_.progress((double)holes_.size() / (double)rims_.all().size());
      holes_.push_back({&rim, Patch(), Way::not_at_all});
      size_t length = rim.vertices.size();
      if (length < 3 || (max_edges != 0 && length > max_edges) || length > LONGEST ||
          touches_itself(rim, map))
        continue;
      holes_.back().patch = make_patch(rims_.around(rim, RINGS), meter_);
      holes_.back().way = best_way(holes_.back().patch);
    }
    /* A filling may run through the surface or through another filling: then the next way is tried. */
    while (step_back())
      ;
    for (const Hole &hole : holes_)
      *(hole.way == Way::not_at_all ? left : filled) += 1;
  }

  void finish(vxm_soup **out, uint64_t **origin) const {
    Added added = add_all();
    Result result(soup_, meter_);
    result.keep_vertices();
    for (size_t f = 0; f < soup_->face_count; f++)
      result.keep(f);
    result.add_vertices(added.points);
    for (size_t t = 0; t < added.corners.size(); t++)
      result.add_face(added.corners[t], holes_[added.hole[t]].rim->face);
    std::vector<uint64_t> origins;
    Owner made(result.finish(&origins));
    if (origin != nullptr)
      *origin = copy_list(origins, meter_).release();
    *out = made.release();
  }

private:
  /* Faces around a hole that its filling takes into account: fairing looks at two rings of vertices. */
  static constexpr int RINGS = 3;
  /* CGAL calls itself once for each edge; a longer rim could use up the stack. */
  static constexpr size_t LONGEST = 10000;

  /** Where a rim lies upon itself there is no hole to fill but a seam to stitch. */
  static bool touches_itself(const Rim &rim, const std::vector<uint32_t> &map) {
    std::vector<uint32_t> at;
    for (uint32_t v : rim.vertices)
      at.push_back(map[v]);
    std::sort(at.begin(), at.end());
    return std::adjacent_find(at.begin(), at.end()) != at.end();
  }

  static Way best_way(const Patch &patch) {
    if (!patch.faired.empty())
      return Way::faired;
    if (!patch.flat.empty())
      return Way::refined;
    return patch.plain.empty() ? Way::not_at_all : Way::plain;
  }

  Added add_all() const {
    Added out;
    for (uint32_t h = 0; h < holes_.size(); h++) {
      const Hole &hole = holes_[h];
      if (hole.way == Way::not_at_all)
        continue;
      size_t rim = hole.rim->vertices.size(), first = soup_->vertex_count + out.points.size();
      out.points.insert(out.points.end(), hole.points().begin(), hole.points().end());
      for (Corners corners : hole.corners()) {
        for (uint32_t &v : corners)
          v = v < rim ? hole.rim->vertices[v] : (uint32_t)(first + v - rim);
        out.corners.push_back(corners);
        out.hole.push_back(h);
      }
    }
    return out;
  }

  /** Takes the next way for holes whose filling meets something; false if there are none. */
  bool step_back() {
    Added added = add_all();
    std::vector<Position> points = whole_.points;
    points.insert(points.end(), added.points.begin(), added.points.end());
    std::vector<Corners> corners = whole_.corners;
    size_t first = corners.size();
    corners.insert(corners.end(), added.corners.begin(), added.corners.end());
    std::vector<uint32_t> map = same_positions(points, meter_);
    for (Corners &corner : corners)
      for (uint32_t &v : corner)
        v = map[v];
    std::vector<bool> meets(holes_.size()), covers(holes_.size());
    for (size_t t = 0; t < added.corners.size(); t++)
      if (!has_area(points, corners[first + t]))
        meets[added.hole[t]] = true;
    find_meetings_from(first, points, corners, meter_, [&](uint32_t one, uint32_t other) {
      bool flat = in_one_plane(points, corners[one], corners[other]);
      for (uint32_t t : {one, other})
        if (t >= first) {
          meets[added.hole[t - first]] = true;
          if (flat)
            covers[added.hole[t - first]] = true;
        }
      return true;
    });
    bool changed = false;
    for (size_t h = 0; h < holes_.size(); h++) {
      Hole *hole = &holes_[h];
      Way last = hole->way;
      if (!meets[h] || last == Way::not_at_all)
        continue;
      if (last == Way::faired)
        hole->way = Way::refined;
      else if (last == Way::refined)
        hole->way = Way::plain;
      else if (covers[h])
        hole->way = Way::not_at_all; /* it would lie on the faces around: a sheet has no hole */
      changed = changed || hole->way != last;
    }
    return changed;
  }

  const vxm_soup *soup_;
  Meter &meter_;
  Triangles whole_;
  Rims rims_;
  std::vector<Hole> holes_;
};

} // namespace

vxm_status fill(vxm_soup **out, uint64_t **origin, int64_t *filled, int64_t *left, const vxm_soup *soup,
                size_t max_edges, vxm_error *error) {
  *out = nullptr;
  if (origin != nullptr)
    *origin = nullptr;
  *filled = *left = 0;
  return guarded(soup->context, "looking for holes", error, [&](Meter &meter) {
    Filling filling(soup, meter);
    filling.run(max_edges, filled, left);
    filling.finish(out, origin);
  });
}

} // namespace vxm

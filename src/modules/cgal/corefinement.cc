/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_plus_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

#include "base/hash.h"
#include "modules/cgal/corefinement.h"

namespace vxm {

namespace {

constexpr uint32_t NONE = UINT32_MAX;

/* ---- Whole numbers ---- */

using Integer = boost::multiprecision::mpz_int;
using IntegerPoint = std::array<Integer, 3>;

/** Positions as multiples of a power of two. */
class Scaled {
public:
  explicit Scaled(std::initializer_list<Position> positions) {
    lowest_ = INT_MAX;
    for (const Position &p : positions)
      for (double x : p)
        if (x != 0)
          lowest_ = std::min(lowest_, std::ilogb(x) - 52);
    for (const Position &p : positions) {
      points.emplace_back();
      for (size_t axis = 0; axis < 3; axis++) {
        if (p[axis] == 0)
          continue;
        int exponent = std::ilogb(p[axis]) - 52;
        points.back()[axis] = (int64_t)std::ldexp(p[axis], -exponent);
        points.back()[axis] <<= (unsigned)(exponent - lowest_);
      }
    }
  }

  /** A multiple that is a fraction, as the number it stands for. */
  Rational back(Integer over, Integer under) const {
    if (lowest_ > 0)
      over <<= (unsigned)lowest_;
    else
      under <<= (unsigned)-lowest_;
    return Rational(over, under);
  }

  std::vector<IntegerPoint> points;

private:
  int lowest_;
};

IntegerPoint normal_of(const IntegerPoint &a, const IntegerPoint &b, const IntegerPoint &c) {
  IntegerPoint p, q, out;
  for (size_t k = 0; k < 3; k++) {
    p[k] = b[k] - a[k];
    q[k] = c[k] - a[k];
  }
  for (size_t k = 0; k < 3; k++)
    out[k] = p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3];
  return out;
}

/* ---- Where two triangles meet ---- */

/** A segment between two points, or a point if they are the same. */
using Line = std::pair<uint32_t, uint32_t>;

class Crossings {
public:
  Crossings(const Surface &surface, ExactPoints *points) : surface_(surface), points_(points) {
  }

  /** Side of plane (u) on which each corner of t lies. */
  std::array<int, 3> sides(uint32_t t, uint32_t u) const {
    const Corners &a = surface_.sheet.corners[t], &b = surface_.sheet.corners[u];
    std::array<int, 3> side;
    for (size_t k = 0; k < 3; k++)
      side[k] = a[k] == b[0] || a[k] == b[1] || a[k] == b[2]
                    ? 0
                    : (int)CGAL::orientation(point(b[0]), point(b[1]), point(b[2]), point(a[k]));
    return side;
  }

  /** What two triangles in different planes share; false if nothing. `t_sides` are those of t to u. */
  bool shared(uint32_t t, const std::array<int, 3> &t_sides, uint32_t u, const std::array<int, 3> &u_sides,
              Line *out) {
    Line a, b;
    if (!within_plane(t, t_sides, u, &a) || !within_plane(u, u_sides, t, &b))
      return false;
    /* All lie on the line of both planes, where the order by coordinates is that along the line. */
    out->first = before(a.first, b.first) ? b.first : a.first;
    out->second = before(a.second, b.second) ? a.second : b.second;
    return !before(out->second, out->first);
  }

private:
  using Quick = CGAL::Exact_predicates_inexact_constructions_kernel;

  Quick::Point_3 point(uint32_t p) const {
    const Position &at = surface_.points[p];
    return Quick::Point_3(at[0], at[1], at[2]);
  }

  bool before(uint32_t p, uint32_t q) const {
    return p != q && CGAL::lexicographically_xyz_smaller((*points_)[p], (*points_)[q]);
  }

  /** What triangle t has in the plane of u, in order. */
  bool within_plane(uint32_t t, const std::array<int, 3> &side, uint32_t u, Line *out) {
    const Corners &corner = surface_.sheet.corners[t];
    uint32_t found[3];
    size_t count = 0;
    for (size_t k = 0; k < 3; k++) {
      size_t next = (k + 1) % 3;
      if (side[k] == 0)
        found[count++] = corner[k];
      else if (side[k] * side[next] < 0)
        found[count++] = crossing(corner[k], corner[next], u);
    }
    if (count == 0)
      return false;
    *out = Line(found[0], found[count - 1]);
    if (before(out->second, out->first))
      std::swap(out->first, out->second);
    return true;
  }

  /** Where the edge between two points passes through the plane of triangle u. */
  uint32_t crossing(uint32_t a, uint32_t b, uint32_t u) {
    if (a > b)
      std::swap(a, b);
    auto known = known_.emplace(Key{a, b, u}, NONE);
    if (known.second)
      known.first->second = points_->add(compute(a, b, u));
    return known.first->second;
  }

  /*
   * In integers, because rational numbers look for common factors at every step: all coordinates are
   * multiples of one power of two.
   */
  RationalPoint compute(uint32_t a, uint32_t b, uint32_t u) const {
    const Corners &t = surface_.sheet.corners[u];
    Scaled scaled({surface_.points[a], surface_.points[b], surface_.points[t[0]], surface_.points[t[1]],
                   surface_.points[t[2]]});
    const IntegerPoint &from = scaled.points[0], &to = scaled.points[1], &o = scaled.points[2];
    IntegerPoint normal = normal_of(o, scaled.points[3], scaled.points[4]);
    Integer above = 0, below = 0;
    for (size_t axis = 0; axis < 3; axis++) {
      above += normal[axis] * (from[axis] - o[axis]);
      below += normal[axis] * (to[axis] - o[axis]);
    }
    Integer whole = above - below;
    RationalPoint out;
    for (size_t axis = 0; axis < 3; axis++)
      out[axis] = scaled.back(from[axis] * whole + above * (to[axis] - from[axis]), whole);
    return out;
  }

  struct Key {
    uint32_t a, b, u;
    bool operator==(const Key &other) const {
      return a == other.a && b == other.b && u == other.u;
    }
  };
  struct Hash {
    size_t operator()(const Key &key) const {
      return (size_t)vxm_hash_word(vxm_hash_word(0, (uint64_t)key.a << 32 | key.b), key.u);
    }
  };

  const Surface &surface_;
  ExactPoints *points_;
  std::unordered_map<Key, uint32_t, Hash> known_;
};

/* ---- One plane ---- */

/** Triangles of one plane, cut together so that their pieces are the same where they overlap. */
class Plane {
  struct Number {
    uint32_t value = NONE; /**< stays so for vertices that the triangulation makes where lines cross */
  };
  using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<Number, Exact>;
  using FaceBase =
      CGAL::Triangulation_face_base_with_info_2<size_t, Exact,
                                                CGAL::Constrained_triangulation_face_base_2<Exact>>;
  using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
  using Delaunay =
      CGAL::Constrained_Delaunay_triangulation_2<Exact, Structure, CGAL::Exact_intersections_tag>;
  using Triangulation = CGAL::Constrained_triangulation_plus_2<Delaunay>;
  using Vertex = Triangulation::Vertex_handle;
  using Face = Triangulation::Face_handle;
  using Edge = std::pair<uint32_t, uint32_t>;

public:
  Plane(const Surface &surface, ExactPoints *points, Meter &meter)
      : surface_(surface), points_(points), meter_(meter) {
  }

  void cut(const std::vector<uint32_t> &members, const std::vector<std::vector<Line>> &lines, Sheet *out) {
    choose_axis(surface_.sheet.corners[members[0]]);
    for (uint32_t t : members)
      for (size_t k = 0; k < 3; k++) {
        const Corners &corner = surface_.sheet.corners[t];
        insert(Line(corner[k], corner[(k + 1) % 3]));
      }
    for (uint32_t t : members)
      for (const Line &line : lines[t])
        insert(line);
    number_crossings(surface_.sheet.corners[members[0]]);
    if (members.size() == 1)
      take_all(members[0], out);
    else
      take_covered(members, out);
  }

private:
  /** The axis to look along: one along which the triangle is seen with area. */
  void choose_axis(const Corners &corner) {
    const Position &a = surface_.points[corner[0]], &b = surface_.points[corner[1]],
                   &c = surface_.points[corner[2]];
    std::array<double, 3> size;
    for (size_t k = 0; k < 3; k++) {
      size_t v = (k + 1) % 3, w = (k + 2) % 3;
      size[k] = std::abs((b[v] - a[v]) * (c[w] - a[w]) - (b[w] - a[w]) * (c[v] - a[v]));
    }
    std::array<size_t, 3> order = {0, 1, 2};
    std::sort(order.begin(), order.end(), [&](size_t p, size_t q) { return size[p] > size[q]; });
    for (size_t k : order) {
      axis_ = k;
      if (turn(corner) != 0)
        return;
    }
  }

  Exact::Point_2 flat(uint32_t p) const {
    const ExactPoint &at = (*points_)[p];
    return Exact::Point_2(at[(int)((axis_ + 1) % 3)], at[(int)((axis_ + 2) % 3)]);
  }

  /** 1 if the triangle turns left as it is seen. */
  int turn(const Corners &corner) const {
    return (int)CGAL::orientation(flat(corner[0]), flat(corner[1]), flat(corner[2]));
  }

  Vertex vertex(uint32_t p) {
    auto known = vertices_.emplace(p, Vertex());
    if (known.second) {
      auto at = flat(p);
      Meter::Whole whole(meter_);
      known.first->second = triangulation_.insert(at);
      known.first->second->info().value = p;
    }
    return known.first->second;
  }

  void insert(Line line) {
    meter_.tick();
    if (line.first > line.second)
      std::swap(line.first, line.second);
    Vertex a = vertex(line.first), b = vertex(line.second);
    if (a == b || constraints_.count(line) != 0)
      return;
    auto &constraint = constraints_[line];
    {
      Meter::Whole whole(meter_);
      constraint = triangulation_.insert_constraint(a, b);
    }
    if (triangulation_.number_of_vertices() > vertices_.size() + CROSSINGS)
      throw std::length_error("a plane with too many lines that cross");
  }

  /** Vertices that the triangulation made where lines cross get their numbers. */
  void number_crossings(const Corners &corner) {
    Scaled scaled({surface_.points[corner[0]], surface_.points[corner[1]], surface_.points[corner[2]]});
    const IntegerPoint &o = scaled.points[0];
    IntegerPoint normal = normal_of(o, scaled.points[1], scaled.points[2]);
    size_t u = (axis_ + 1) % 3, v = (axis_ + 2) % 3;
    Rational constant = scaled.back(normal[0] * o[0] + normal[1] * o[1] + normal[2] * o[2], normal[axis_]),
             by_u(normal[u], normal[axis_]), by_v(normal[v], normal[axis_]);
    for (Vertex at : triangulation_.finite_vertex_handles()) {
      if (at->info().value != NONE)
        continue;
      RationalPoint place;
      place[u] = at->point().x().exact();
      place[v] = at->point().y().exact();
      place[axis_] = constant - by_u * place[u] - by_v * place[v];
      at->info().value = points_->add(place);
    }
  }

  static uint32_t number(Vertex vertex) {
    return vertex->info().value;
  }

  static Edge edge(Vertex a, Vertex b) {
    return std::minmax(number(a), number(b));
  }

  Corners corners_of(Face face) const {
    return {number(face->vertex(0)), number(face->vertex(1)), number(face->vertex(2))};
  }

  void cover(uint32_t t, int sign, Sheet *out) const {
    const Sheet &sheet = surface_.sheet;
    for (size_t c = sheet.begin[t]; c < sheet.begin[t + 1]; c++) {
      Cover one = sheet.covers[c];
      one.sign *= sign;
      out->cover(one);
    }
  }

  void take_all(uint32_t t, Sheet *out) {
    int sign = turn(surface_.sheet.corners[t]);
    for (Face face : triangulation_.finite_face_handles()) {
      out->add(corners_of(face));
      cover(t, sign, out);
    }
  }

  void take_covered(const std::vector<uint32_t> &members, Sheet *out) {
    size_t count = 0;
    for (Face face : triangulation_.finite_face_handles())
      face->info() = count++;
    std::vector<std::vector<std::pair<uint32_t, int>>> over(count);
    for (uint32_t t : members) {
      int sign = turn(surface_.sheet.corners[t]);
      for (Face face : faces_within(t, sign))
        over[face->info()].emplace_back(t, sign);
    }
    for (Face face : triangulation_.finite_face_handles()) {
      if (over[face->info()].empty())
        continue;
      out->add(corners_of(face));
      for (const auto &one : over[face->info()])
        cover(one.first, one.second, out);
    }
  }

  /** The faces that a member consists of: all that are reached from one of its sides without crossing any. */
  std::vector<Face> faces_within(uint32_t t, int sign) {
    const Corners &corner = surface_.sheet.corners[t];
    std::vector<Edge> rim;
    std::vector<Face> found;
    for (size_t k = 0; k < 3; k++) {
      Line side = std::minmax(corner[k], corner[(k + 1) % 3]);
      auto id = constraints_.at(side);
      auto at = triangulation_.vertices_in_constraint_begin(id),
           end = triangulation_.vertices_in_constraint_end(id);
      bool along = number(*at) == corner[k];
      for (Vertex last = *at++; at != end; last = *at++) {
        rim.push_back(edge(last, *at));
        if (found.empty())
          found.push_back(beside(last, *at, along == (sign > 0)));
      }
    }
    std::sort(rim.begin(), rim.end());
    seen_.resize(triangulation_.number_of_faces(), NONE);
    seen_[found[0]->info()] = t;
    for (size_t i = 0; i < found.size(); i++)
      for (int k = 0; k < 3; k++) {
        Face face = found[i], next = face->neighbor(k);
        Edge between = edge(face->vertex(Triangulation::cw(k)), face->vertex(Triangulation::ccw(k)));
        if (std::binary_search(rim.begin(), rim.end(), between) || seen_[next->info()] == t)
          continue;
        seen_[next->info()] = t;
        found.push_back(next);
      }
    return found;
  }

  /** The face on the left or right of the edge from one vertex to another. */
  Face beside(Vertex from, Vertex to, bool left) const {
    Face face;
    int k;
    triangulation_.is_edge(from, to, face, k);
    /* Seen from the face, the edge runs against the clock from ccw(k) to cw(k). */
    bool is_left = face->vertex(Triangulation::ccw(k)) == from;
    return is_left == left ? face : face->neighbor(k);
  }

  /* Each costs up to a millisecond. A mesh has more in a plane where large parts of it lie there in heaps. */
  static constexpr size_t CROSSINGS = 20000;

  const Surface &surface_;
  ExactPoints *points_;
  Meter &meter_;
  size_t axis_ = 0;
  Triangulation triangulation_;
  std::unordered_map<uint32_t, Vertex> vertices_;
  std::vector<uint32_t> seen_; /**< per face: the member that reached it last */
  std::map<Line, Triangulation::Constraint_id> constraints_;
};

/* ---- All planes ---- */

/** Points that are made where triangles meet, at most, beside four for each vertex. */
constexpr size_t FRESH = 1000000;

void check_count(const ExactPoints &points, size_t most) {
  if (points.size() > most)
    throw std::length_error("a part that cuts through itself nearly everywhere");
}

class Planes {
public:
  explicit Planes(size_t count) : leader_(count) {
    std::iota(leader_.begin(), leader_.end(), 0U);
  }
  uint32_t find(uint32_t t) {
    while (leader_[t] != t)
      t = leader_[t] = leader_[leader_[t]];
    return t;
  }
  void join(uint32_t t, uint32_t u) {
    uint32_t a = find(t), b = find(u);
    leader_[std::max(a, b)] = std::min(a, b);
  }

private:
  std::vector<uint32_t> leader_;
};

} // namespace

Pieces arrange(const Surface &surface, const Meetings &meetings, Meter &meter) {
  const Sheet &sheet = surface.sheet;
  Pieces out(surface);
  /* Each takes some 70 us and a kilobyte for exact numbers: the largest heap of faces is given up after a
   * minute or two. */
  size_t most = FRESH + 4 * surface.points.size();
  Crossings crossings(surface, &out.points);
  Planes planes(sheet.size());
  std::vector<std::vector<Line>> lines(sheet.size());
  for (size_t m = 0; m < meetings.size(); m++) {
    meter.progress(0.5 * (double)m / (double)meetings.size());
    check_count(out.points, most);
    uint32_t t = meetings[m].first, u = meetings[m].second;
    std::array<int, 3> t_sides = crossings.sides(t, u);
    if (t_sides[0] == 0 && t_sides[1] == 0 && t_sides[2] == 0) {
      planes.join(t, u);
      continue;
    }
    Line line;
    if (crossings.shared(t, t_sides, u, crossings.sides(u, t), &line)) {
      lines[t].push_back(line);
      lines[u].push_back(line);
    }
  }
  std::vector<std::vector<uint32_t>> members(sheet.size());
  for (uint32_t t = 0; t < sheet.size(); t++)
    members[planes.find(t)].push_back(t);
  for (uint32_t t = 0; t < sheet.size(); t++) {
    meter.progress(0.5 + 0.5 * (double)t / (double)sheet.size());
    if (members[t].empty())
      continue;
    if (members[t].size() == 1 && lines[t].empty()) {
      out.sheet.add(sheet.corners[t]);
      for (size_t c = sheet.begin[t]; c < sheet.begin[t + 1]; c++)
        out.sheet.cover(sheet.covers[c]);
      continue;
    }
    Plane(surface, &out.points, meter).cut(members[t], lines, &out.sheet);
    check_count(out.points, most); /* lines that cross make more of them */
  }
  return out;
}

} // namespace vxm

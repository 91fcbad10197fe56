/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modules/cgal/outer_boundary.h"

#include <algorithm>
#include <numeric>

#include "modules/cgal/corefinement.h"

namespace vxm {

namespace {

constexpr uint32_t NONE = UINT32_MAX;

/** A side of a piece: from corner k to the next one. */
struct Side {
  uint32_t low, high; /**< points; low < high */
  uint32_t piece;
  uint8_t k;
  bool forward; /**< from low to high */

  bool same_edge(const Side &other) const {
    return low == other.low && high == other.high;
  }
  bool operator<(const Side &other) const {
    return low != other.low ? low < other.low : high != other.high ? high < other.high : piece < other.piece;
  }
};

class Selection {
public:
  Selection(const Surface &surface, const Pieces &pieces, size_t part_count, Meter &meter)
      : surface_(surface), pieces_(pieces), sheet_(pieces.sheet), part_count_(part_count), meter_(meter),
        kept_(sheet_.size(), 0) {
    if (sheet_.size() > UINT32_MAX / 3 - 1)
      throw std::length_error("more pieces than can be numbered");
  }

  Skin run(Material *material) {
    find_sides();
    find_patches();
    cast();
    if (material->measures())
      measure(material);
    classify(*material);
    return build();
  }

private:
  void find_sides() {
    sides_.reserve(3 * sheet_.size());
    for (uint32_t piece = 0; piece < sheet_.size(); piece++)
      for (uint8_t k = 0; k < 3; k++) {
        uint32_t a = sheet_.corners[piece][k], b = sheet_.corners[piece][(k + 1) % 3];
        sides_.push_back({std::min(a, b), std::max(a, b), piece, k, a < b});
      }
    std::sort(sides_.begin(), sides_.end());
    place_.resize(3 * sheet_.size());
    for (size_t s = 0; s < sides_.size(); s++)
      place_[3 * (size_t)sides_[s].piece + sides_[s].k] = s;
  }

  size_t end_of_edge(size_t begin) const {
    size_t end = begin;
    while (end < sides_.size() && sides_[end].same_edge(sides_[begin]))
      end++;
    return end;
  }

  /* ---- Patches: pieces that have the same on both sides ---- */

  size_t covers(uint32_t piece) const {
    return sheet_.begin[piece + 1] - sheet_.begin[piece];
  }

  /** How often each part covers a piece, counted with sign. */
  std::vector<std::pair<uint32_t, int>> net_cover(uint32_t piece, int sign) const {
    std::vector<std::pair<uint32_t, int>> out;
    for (size_t c = sheet_.begin[piece]; c < sheet_.begin[piece + 1]; c++) {
      uint32_t part = sheet_.covers[c].part;
      auto at = std::find_if(out.begin(), out.end(), [=](const auto &one) { return one.first == part; });
      if (at == out.end())
        at = out.emplace(at, part, 0);
      at->second += sign * sheet_.covers[c].sign;
    }
    std::sort(out.begin(), out.end());
    return out;
  }

  /** The other piece at a side if there is exactly one, with the same cover; its turn against this one. */
  uint32_t neighbour(uint32_t piece, size_t k, bool *turned) const {
    size_t s = place_[3 * (size_t)piece + k], begin = s;
    while (begin > 0 && sides_[begin - 1].same_edge(sides_[s]))
      begin--;
    if (begin + 1 >= sides_.size() || !sides_[begin + 1].same_edge(sides_[s]) ||
        (begin + 2 < sides_.size() && sides_[begin + 2].same_edge(sides_[s])))
      return NONE;
    const Side &other = sides_[begin == s ? begin + 1 : begin];
    *turned = other.forward == sides_[s].forward;
    const Cover &one = sheet_.covers[sheet_.begin[piece]], &two = sheet_.covers[sheet_.begin[other.piece]];
    if (covers(piece) == 1 && covers(other.piece) == 1)
      return one.part == two.part && one.sign == (*turned ? -two.sign : two.sign) ? other.piece : NONE;
    return net_cover(piece, 1) == net_cover(other.piece, *turned ? -1 : 1) ? other.piece : NONE;
  }

  void find_patches() {
    patch_.assign(sheet_.size(), NONE);
    turned_.assign(sheet_.size(), false);
    for (uint32_t first = 0; first < sheet_.size(); first++) {
      if (patch_[first] != NONE)
        continue;
      auto number = (uint32_t)representative_.size();
      std::vector<uint32_t> queue(1, first);
      patch_[first] = number;
      uint32_t largest = first;
      for (size_t i = 0; i < queue.size(); i++) {
        uint32_t piece = queue[i];
        meter_.tick();
        if (area(piece) > area(largest))
          largest = piece;
        for (size_t k = 0; k < 3; k++) {
          bool turned = false;
          uint32_t next = neighbour(piece, k, &turned);
          if (next == NONE || patch_[next] != NONE)
            continue;
          patch_[next] = number;
          turned_[next] = turned_[piece] != turned;
          queue.push_back(next);
        }
      }
      representative_.push_back(largest);
    }
  }

  Position normal(uint32_t piece) const {
    const Corners &corner = sheet_.corners[piece];
    const Position &a = pieces_.points.rounded(corner[0]), &b = pieces_.points.rounded(corner[1]),
                   &c = pieces_.points.rounded(corner[2]);
    Position out;
    for (size_t k = 0; k < 3; k++) {
      size_t v = (k + 1) % 3, w = (k + 2) % 3;
      out[k] = (b[v] - a[v]) * (c[w] - a[w]) - (b[w] - a[w]) * (c[v] - a[v]);
    }
    return out;
  }

  double area(uint32_t piece) const {
    Position n = normal(piece);
    return n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
  }

  /* ---- Material on either side of each patch ---- */

  /** Sign of the piece's normal along an axis, exactly. */
  int facing(uint32_t piece, size_t axis) const {
    const Corners &corner = sheet_.corners[piece];
    Exact::Point_2 flat[3];
    for (size_t k = 0; k < 3; k++) {
      const ExactPoint &p = pieces_.points[corner[k]];
      flat[k] = Exact::Point_2(p[(int)((axis + 1) % 3)], p[(int)((axis + 2) % 3)]);
    }
    return (int)CGAL::orientation(flat[0], flat[1], flat[2]);
  }

  size_t best_axis(uint32_t piece) const {
    Position n = normal(piece);
    std::array<size_t, 3> order = {0, 1, 2};
    std::sort(order.begin(), order.end(),
              [&](size_t a, size_t b) { return std::abs(n[a]) > std::abs(n[b]); });
    for (size_t axis : order)
      if (facing(piece, axis) != 0)
        return axis;
    throw std::logic_error("a piece without area");
  }

  /** Sends a ray from each patch. */
  void cast() {
    for (uint32_t piece : representative_) {
      const Corners &corner = sheet_.corners[piece];
      const ExactPoints &points = pieces_.points;
      rays_.push_back(
          {CGAL::centroid(points[corner[0]], points[corner[1]], points[corner[2]]), best_axis(piece)});
    }
    hits_.resize(rays_.size());
    const Sheet &whole = surface_.sheet;
    cast_rays(surface_.points, whole.corners, rays_, meter_, [&](size_t ray, uint32_t t, int sign) {
      for (size_t c = whole.begin[t]; c < whole.begin[t + 1]; c++)
        hits_[ray].emplace_back(whole.covers[c].part, sign * whole.covers[c].sign);
    });
  }

  /** Tells of both sides of each patch how often parts wind around what is there: in front of its first piece
   * and behind that. */
  template <typename Take> void look_at_sides(Take take) const {
    std::vector<int> beyond(part_count_), before;
    for (size_t r = 0; r < rays_.size(); r++) {
      uint32_t piece = representative_[r];
      int facing_ray = facing(piece, rays_[r].axis);
      std::fill(beyond.begin(), beyond.end(), 0);
      for (const auto &hit : hits_[r])
        beyond[hit.first] += hit.second;
      before = beyond;
      for (size_t c = sheet_.begin[piece]; c < sheet_.begin[piece + 1]; c++)
        before[sheet_.covers[c].part] += facing_ray * sheet_.covers[c].sign;
      bool front_beyond = (facing_ray > 0) != turned_[piece];
      take(r, front_beyond ? beyond : before, front_beyond ? before : beyond);
    }
  }

  /** Of the cone from a point to a piece, seen as the first piece of its patch is. */
  double cone(uint32_t piece, const Position &tip) const {
    const Corners &corner = sheet_.corners[piece];
    const Position &at = pieces_.points.rounded(corner[0]);
    Position n = normal(piece);
    double out = 0;
    for (size_t k = 0; k < 3; k++)
      out += n[k] * (at[k] - tip[k]);
    return (turned_[piece] ? -out : out) / 6;
  }

  /** The volume of a place is that of the cones to all that bounds it. */
  void measure(Material *material) const {
    std::vector<double> volume(representative_.size(), 0);
    for (uint32_t piece = 0; piece < sheet_.size(); piece++)
      volume[patch_[piece]] += cone(piece, pieces_.points.rounded(sheet_.corners[0][0]));
    material->begin_measure();
    look_at_sides([&](size_t patch, const std::vector<int> &front, const std::vector<int> &back) {
      material->measure(front, -volume[patch]);
      material->measure(back, volume[patch]);
    });
    material->end_measure();
  }

  void classify(const Material &material) {
    std::vector<int8_t> side(representative_.size());
    look_at_sides([&](size_t patch, const std::vector<int> &front, const std::vector<int> &back) {
      bool in_front = material.inside(front), behind = material.inside(back);
      side[patch] = (int8_t)(in_front == behind ? 0 : behind ? 1 : -1);
    });
    for (uint32_t piece = 0; piece < sheet_.size(); piece++)
      kept_[piece] = (int8_t)(turned_[piece] ? -side[patch_[piece]] : side[patch_[piece]]);
  }

  /* ---- The skin ---- */

  uint32_t find(uint32_t corner) {
    while (leader_[corner] != corner)
      corner = leader_[corner] = leader_[leader_[corner]];
    return corner;
  }

  void join(uint32_t a, uint32_t b) {
    a = find(a);
    b = find(b);
    leader_[std::max(a, b)] = std::min(a, b);
  }

  /** Two sides of an edge become one edge of the skin: their corners at each end are the same vertex. */
  void join_sides(const Side &one, const Side &other) {
    auto corner = [](const Side &side, bool low) {
      return 3 * side.piece + (side.forward == low ? side.k : (side.k + 1U) % 3);
    };
    join(corner(one, true), corner(other, true));
    join(corner(one, false), corner(other, false));
  }

  /** Whether a kept piece runs along a side from the lower point to the higher one. */
  bool runs_up(const Side &side) const {
    return side.forward == (kept_[side.piece] > 0);
  }

  /**
   * Joins the kept pieces at an edge two by two, those with the material between them. About the edge, seen
   * with its direction towards the eye, pieces that run up have the material before them in counter-clockwise
   * order, the others after them.
   */
  void join_around(std::vector<Side> *around) {
    std::vector<Side> &sides = *around;
    if (sides.size() == 2) {
      join_sides(sides[0], sides[1]);
      return;
    }
    const ExactPoints &points = pieces_.points;
    const ExactPoint &low = points[sides[0].low], &high = points[sides[0].high];
    auto third = [&](const Side &side) -> const ExactPoint & {
      return points[sheet_.corners[side.piece][(side.k + 2) % 3]];
    };
    const ExactPoint &start = third(sides[0]);
    /* 0: at the start, 1: less than half a turn from it, 2: half a turn, 3: more */
    auto half = [&](const Side &side) {
      int turn = (int)CGAL::orientation(low, high, start, third(side));
      if (turn != 0)
        return turn > 0 ? 1 : 3;
      return CGAL::coplanar_orientation(low, high, start, third(side)) == CGAL::POSITIVE ? 0 : 2;
    };
    std::sort(sides.begin(), sides.end(), [&](const Side &a, const Side &b) {
      int in_a = half(a), in_b = half(b);
      if (in_a != in_b)
        return in_a < in_b;
      return CGAL::orientation(low, high, third(a), third(b)) == CGAL::POSITIVE;
    });
    for (size_t s = 0; s < sides.size(); s++) {
      const Side &next = sides[(s + 1) % sides.size()];
      if (!runs_up(sides[s])) {
        if (!runs_up(next))
          throw std::logic_error("material without an end");
        join_sides(sides[s], next);
      }
    }
  }

  Skin build() {
    leader_.resize(3 * sheet_.size());
    std::iota(leader_.begin(), leader_.end(), 0U);
    std::vector<Side> around;
    for (size_t begin = 0, end; begin < sides_.size(); begin = end) {
      end = end_of_edge(begin);
      around.clear();
      for (size_t s = begin; s < end; s++)
        if (kept_[sides_[s].piece] != 0)
          around.push_back(sides_[s]);
      if (around.size() % 2 != 0)
        throw std::logic_error("an edge with an odd number of faces");
      if (!around.empty())
        join_around(&around);
    }
    Skin out;
    out.altered.resize(part_count_);
    std::vector<uint32_t> vertex(leader_.size(), NONE);
    for (uint32_t piece = 0; piece < sheet_.size(); piece++) {
      note_altered(piece, &out);
      if (kept_[piece] == 0)
        continue;
      Corners corners;
      for (uint32_t k = 0; k < 3; k++) {
        uint32_t leader = find(3 * piece + k);
        if (vertex[leader] == NONE) {
          vertex[leader] = (uint32_t)out.points.size();
          out.points.push_back(pieces_.points.rounded(sheet_.corners[piece][k]));
        }
        corners[k] = vertex[leader];
      }
      if (kept_[piece] < 0)
        std::swap(corners[1], corners[2]);
      out.corners.push_back(corners);
      uint64_t face = UINT64_MAX;
      for (size_t c = sheet_.begin[piece]; c < sheet_.begin[piece + 1]; c++)
        face = std::min(face, sheet_.covers[c].face);
      out.face.push_back(face);
    }
    return out;
  }

  void note_altered(uint32_t piece, Skin *out) const {
    size_t begin = sheet_.begin[piece], end = sheet_.begin[piece + 1];
    for (size_t c = begin; c < end; c++)
      if (kept_[piece] == 0 || sheet_.covers[c].part != sheet_.covers[begin].part)
        for (size_t d = begin; d < end; d++)
          out->altered[sheet_.covers[d].part] = true;
  }

  const Surface &surface_;
  const Pieces &pieces_;
  const Sheet &sheet_;
  size_t part_count_;
  Meter &meter_;
  std::vector<Side> sides_;   /**< in the order of their edges */
  std::vector<size_t> place_; /**< of side k of a piece in sides_ */
  std::vector<uint32_t> patch_, representative_;
  std::vector<bool> turned_;                                /**< against the first piece of its patch */
  std::vector<ExactRay> rays_;                              /**< per patch, from its representative */
  std::vector<std::vector<std::pair<uint32_t, int>>> hits_; /**< per ray: parts, and how it leaves them */
  std::vector<int8_t> kept_;                                /**< 0: no, 1: as it is, -1: turned */
  std::vector<uint32_t> leader_;
};

} // namespace

Skin find_skin(const Surface &surface, const Meetings &meetings, size_t part_count, Material *material,
               Meter &meter) {
  Pieces pieces = arrange(surface, meetings, meter);
  return Selection(surface, pieces, part_count, meter).run(material);
}

} // namespace vxm

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modules/cgal/parts.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "mesh/components.h"
#include "mesh/edges.h"
#include "mesh/voids.h"
#include "modules/cgal/rays.h"

namespace vxm {

namespace {

/* A volume below this share of what is added and taken away to find it is what rounding leaves of none. */
constexpr double FLAT = 1e-12;

class Edges {
public:
  Edges(const vxm_soup *soup, Meter &meter) {
    check(vxm_edges_build(&edges_, meter.context(), soup, nullptr, meter.error()));
  }
  ~Edges() {
    vxm_edges_destroy(&edges_);
  }
  Edges(const Edges &) = delete;
  Edges &operator=(const Edges &) = delete;
  const vxm_edge *begin() const {
    return edges_.edges;
  }
  const vxm_edge *end() const {
    return edges_.edges + edges_.count;
  }

private:
  vxm_edges edges_;
};

/** Gives every part that is wound inward the one that it is a cavity of (mesh/voids.h). */
class Hosts {
public:
  /**
   * @param solid  parts that bound a volume, the smallest first
   * @param around per part: those that it lies inside of without touching them, in that order
   */
  Hosts(Parts &parts, const std::vector<uint32_t> &solid, std::vector<std::vector<uint32_t>> around,
        const std::set<std::pair<uint32_t, uint32_t>> &touching, Meter &meter)
      : parts_(parts), solid_(solid), around_(std::move(around)), touching_(touching), meter_(meter) {
  }

  void run() {
    size_t count = parts_.parts.size();
    std::vector<uint32_t> parent(count, VXM_NO_COMPONENT), body(count);
    std::vector<double> volume(count, 0);
    for (uint32_t part : solid_) {
      volume[part] = parts_.parts[part].sign * parts_.parts[part].volume;
      if (!around_[part].empty())
        parent[part] = around_[part][0];
    }
    vxm_void_search search = {};
    search.context = meter_.context();
    search.count = count;
    search.order = solid_.data();
    search.order_count = solid_.size();
    search.parent = parent.data();
    search.volume = volume.data();
    search.list_around = list_around;
    search.may_have_several = [](void *payload, uint32_t part) {
      return static_cast<Hosts *>(payload)->around_[part].size() > 1;
    };
    search.may_overlap = [](void *payload, uint32_t a, uint32_t b) {
      return static_cast<Hosts *>(payload)->overlap(a, b);
    };
    search.payload = this;
    check(vxm_voids_find(body.data(), &search, meter_.error()));
    for (uint32_t part : solid_)
      if (parts_.parts[part].sign < 0)
        parts_.host[part] = body[part] != VXM_NO_COMPONENT ? body[part] : smallest_outward(part);
  }

private:
  static vxm_status list_around(void *payload, uint32_t part, uint32_t **around, size_t *count,
                                vxm_error *error) {
    Hosts *hosts = static_cast<Hosts *>(payload);
    const std::vector<uint32_t> &list = hosts->around_[part];
    *count = list.size();
    *around =
        static_cast<uint32_t *>(vxm_alloc(hosts->meter_.context(), list.size(), sizeof **around, error));
    if (*around == nullptr)
      return error->code;
    std::copy(list.begin(), list.end(), *around);
    return VXM_OK;
  }

  bool overlap(uint32_t a, uint32_t b) const {
    return touching_.count(std::minmax(a, b)) != 0 || lies_in(a, b) || lies_in(b, a);
  }

  bool lies_in(uint32_t part, uint32_t other) const {
    return std::find(around_[part].begin(), around_[part].end(), other) != around_[part].end();
  }

  /** Of the parts around one. */
  uint32_t smallest_outward(uint32_t part) const {
    for (uint32_t other : around_[part])
      if (parts_.parts[other].sign > 0)
        return other;
    return NO_PART;
  }

  Parts &parts_;
  const std::vector<uint32_t> &solid_;
  std::vector<std::vector<uint32_t>> around_;
  const std::set<std::pair<uint32_t, uint32_t>> &touching_;
  Meter &meter_;
};

class Builder {
public:
  Builder(const vxm_soup *soup, const Triangles &triangles, bool outward_only, Meter &meter)
      : soup_(soup), triangles_(triangles), outward_only_(outward_only), meter_(meter) {
  }

  Parts run() {
    find_parts();
    find_closed();
    measure();
    find_groups();
    find_around();
    find_hosts();
    return std::move(out_);
  }

private:
  uint32_t part_of(size_t triangle) const {
    return out_.of_face[triangles_.face[triangle]];
  }

  void find_parts() {
    out_.of_face.resize(soup_->face_count);
    size_t count = 0;
    check(vxm_components(meter_.context(), soup_, nullptr, out_.of_face.data(), &count, meter_.error()));
    out_.parts.assign(count, Part{false, 0, 0, UINT64_MAX, 0, outward_only_});
    for (size_t f = soup_->face_count; f-- > 0;)
      out_.parts[out_.of_face[f]].first_face = f;
  }

  void find_closed() {
    std::vector<uint32_t> of_vertex(soup_->vertex_count, NO_PART);
    for (size_t f = 0; f < soup_->face_count; f++) {
      size_t count;
      const uint32_t *corners = vxm_face(soup_, f, &count);
      for (size_t c = 0; c < count; c++)
        of_vertex[corners[c]] = out_.of_face[f];
    }
    for (size_t t = 0; t < triangles_.corners.size(); t++)
      out_.parts[part_of(t)].closed = true;
    Edges edges(soup_, meter_);
    for (const vxm_edge &edge : edges)
      if (2 * (uint64_t)edge.forward != edge.count)
        out_.parts[of_vertex[edge.a]].closed = false;
  }

  void measure() {
    std::vector<Position> origin(out_.parts.size());
    for (size_t t = triangles_.corners.size(); t-- > 0;)
      origin[part_of(t)] = triangles_.points[triangles_.corners[t][0]];
    std::vector<double> volume(out_.parts.size(), 0), moved(out_.parts.size(), 0);
    for (size_t t = 0; t < triangles_.corners.size(); t++) {
      uint32_t part = part_of(t);
      Position p[3];
      for (size_t k = 0; k < 3; k++)
        for (size_t axis = 0; axis < 3; axis++)
          p[k][axis] = triangles_.points[triangles_.corners[t][k]][axis] - origin[part][axis];
      for (size_t a = 0; a < 3; a++) {
        size_t b = (a + 1) % 3, c = (a + 2) % 3;
        double cone = p[0][a] * (p[1][b] * p[2][c] - p[1][c] * p[2][b]) / 6;
        volume[part] += cone;
        moved[part] += std::abs(cone);
      }
    }
    for (size_t p = 0; p < out_.parts.size(); p++) {
      Part &part = out_.parts[p];
      part.volume = std::abs(volume[p]);
      if (part.closed && part.volume > FLAT * moved[p])
        part.sign = volume[p] > 0 ? 1 : -1;
    }
  }

  uint32_t find(uint32_t part) {
    while (leader_[part] != part)
      part = leader_[part] = leader_[leader_[part]];
    return part;
  }

  void join(uint32_t a, uint32_t b) {
    a = find(a);
    b = find(b);
    leader_[std::max(a, b)] = std::min(a, b);
  }

  void touch(uint32_t a, uint32_t b) {
    if (a == b)
      return;
    touching_.insert(std::minmax(a, b));
    join(a, b);
  }

  /** Triangles of parts that bound a volume. */
  std::vector<uint32_t> solid_triangles() const {
    std::vector<uint32_t> out;
    for (uint32_t t = 0; t < triangles_.corners.size(); t++)
      if (out_.parts[part_of(t)].sign != 0)
        out.push_back(t);
    return out;
  }

  void find_groups() {
    leader_.resize(out_.parts.size());
    std::iota(leader_.begin(), leader_.end(), 0U);
    solid_ = solid_triangles();
    corners_.reserve(solid_.size());
    std::vector<uint32_t> user(triangles_.points.size(), NO_PART);
    for (uint32_t t : solid_) {
      corners_.push_back(triangles_.corners[t]);
      for (uint32_t point : triangles_.corners[t]) {
        if (user[point] == NO_PART)
          user[point] = part_of(t);
        touch(user[point], part_of(t));
      }
    }
    find_meetings(triangles_.points, corners_, meter_, [&](uint32_t first, uint32_t second) {
      uint32_t t = solid_[first], u = solid_[second];
      meeting_.insert(part_of(t));
      touch(part_of(t), part_of(u));
      return true;
    });
    for (uint32_t p = 0; p < out_.parts.size(); p++) {
      if (find(p) == p) {
        out_.parts[p].group = (uint32_t)out_.groups.size();
        out_.groups.emplace_back();
      }
      out_.parts[p].group = out_.parts[find(p)].group;
      out_.groups[out_.parts[p].group].parts.push_back(p);
    }
    for (uint32_t p : meeting_)
      out_.groups[out_.parts[p].group].meets = true;
  }

  /** For each of some parts, by its first corner: the other parts that wind around that. */
  std::vector<std::vector<uint32_t>> parts_around(const std::vector<uint32_t> &parts) {
    std::vector<std::vector<uint32_t>> out(parts.size());
    std::vector<size_t> ray_of(out_.parts.size(), SIZE_MAX);
    std::vector<Ray> rays(parts.size());
    for (size_t i = 0; i < parts.size(); i++)
      ray_of[parts[i]] = i;
    for (size_t i = solid_.size(); i-- > 0;)
      if (ray_of[part_of(solid_[i])] != SIZE_MAX)
        rays[ray_of[part_of(solid_[i])]] = {triangles_.points[corners_[i][0]], 2};
    std::vector<std::vector<std::pair<uint32_t, int>>> hits(parts.size());
    cast_rays(triangles_.points, corners_, rays, meter_,
              [&](size_t ray, uint32_t t, int sign) { hits[ray].emplace_back(part_of(solid_[t]), sign); });
    for (size_t r = 0; r < rays.size(); r++) {
      std::sort(hits[r].begin(), hits[r].end());
      for (size_t begin = 0, end; begin < hits[r].size(); begin = end) {
        int winding = 0;
        for (end = begin; end < hits[r].size() && hits[r][end].first == hits[r][begin].first; end++)
          winding += hits[r][end].second;
        uint32_t part = hits[r][begin].first;
        if (out_.parts[part].encloses(winding) && part != parts[r])
          out[r].push_back(part);
      }
    }
    return out;
  }

  /** Groups do not touch, so that one point of each tells where all of it lies. */
  void find_around() {
    std::vector<uint32_t> first;
    for (const Group &group : out_.groups)
      if (out_.parts[group.parts[0]].sign != 0)
        first.push_back(group.parts[0]);
    if (first.size() < 2)
      return;
    std::vector<std::vector<uint32_t>> around = parts_around(first);
    for (size_t i = 0; i < first.size(); i++) {
      uint32_t group = out_.parts[first[i]].group;
      for (uint32_t part : around[i])
        if (out_.parts[part].group != group)
          out_.groups[group].around.push_back(part);
    }
  }

  void find_hosts() {
    out_.host.assign(out_.parts.size(), NO_PART);
    std::vector<uint32_t> solid;
    bool is_some_inward = false;
    for (uint32_t p = 0; p < out_.parts.size(); p++)
      if (out_.parts[p].sign != 0) {
        solid.push_back(p);
        is_some_inward = is_some_inward || out_.parts[p].sign < 0;
      }
    if (!is_some_inward)
      return;
    std::stable_sort(solid.begin(), solid.end(),
                     [this](uint32_t a, uint32_t b) { return out_.parts[a].volume < out_.parts[b].volume; });
    Hosts(out_, solid, around_untouched(solid), touching_, meter_).run();
  }

  /** For each part, those that it lies inside of without touching them, in the order of the parts given. */
  std::vector<std::vector<uint32_t>> around_untouched(const std::vector<uint32_t> &solid) {
    std::vector<uint32_t> place(out_.parts.size());
    for (uint32_t i = 0; i < solid.size(); i++)
      place[solid[i]] = i;
    std::vector<std::vector<uint32_t>> around = parts_around(solid), out(out_.parts.size());
    for (size_t i = 0; i < solid.size(); i++) {
      std::copy_if(around[i].begin(), around[i].end(), std::back_inserter(out[solid[i]]),
                   [&](uint32_t part) { return touching_.count(std::minmax(part, solid[i])) == 0; });
      std::sort(out[solid[i]].begin(), out[solid[i]].end(),
                [&](uint32_t a, uint32_t b) { return place[a] < place[b]; });
    }
    return out;
  }

  const vxm_soup *soup_;
  const Triangles &triangles_;
  bool outward_only_;
  Meter &meter_;
  Parts out_;
  std::vector<uint32_t> leader_, solid_;
  std::vector<Corners> corners_;                     /**< of solid_ */
  std::set<std::pair<uint32_t, uint32_t>> touching_; /**< parts */
  std::set<uint32_t> meeting_;                       /**< parts, one of each pair at least */
};

} // namespace

Parts parts_of(const vxm_soup *soup, const Triangles &triangles, bool outward_only, Meter &meter) {
  return Builder(soup, triangles, outward_only, meter).run();
}

} // namespace vxm

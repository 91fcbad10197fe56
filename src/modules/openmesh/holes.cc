/* SPDX-License-Identifier: BSD-3-Clause */
#include "modules/openmesh/holes.h"

#include <algorithm>
#include <array>

namespace voxmend {

namespace {

using point = std::array<double, 3>;

class rim_walk {
public:
  rim_walk(const halfedges &linked, const vxm_soup *soup) : linked_(linked), soup_(soup) {
  }

  void follow(halfedges::halfedge first);
  void find_twins(twins &found) const;
  std::vector<rim_loop> take_apart(const twins &found) const;

private:
  const halfedges::mesh_type &mesh() const {
    return linked_.mesh();
  }
  /** Both zeros are the same position. */
  point position(uint32_t v) const {
    const double *p = vxm_position(soup_, v);
    return {p[0] + 0.0, p[1] + 0.0, p[2] + 0.0};
  }
  std::vector<point> neighbours(uint32_t v) const;
  bool share_face(uint32_t v, uint32_t w) const;
  bool may_be_one(const std::vector<uint32_t> &group) const;
  rim_loop loop_of(const std::vector<size_t> &steps) const;

  const halfedges &linked_;
  const vxm_soup *soup_;
  std::vector<uint32_t> vertices_; /**< of the whole rim */
  std::vector<size_t> beyond_;
};

void rim_walk::follow(halfedges::halfedge first) {
  auto h = first;
  do {
    vertices_.push_back(static_cast<uint32_t>(mesh().from_vertex_handle(h).idx()));
    beyond_.push_back(static_cast<size_t>(mesh().face_handle(mesh().opposite_halfedge_handle(h)).idx()));
    h = mesh().next_halfedge_handle(h);
  } while (h != first);
}

std::vector<point> rim_walk::neighbours(uint32_t v) const {
  std::vector<point> around;
  for (const auto w : mesh().vv_range(linked_.vertex_of(v)))
    around.push_back(position(static_cast<uint32_t>(w.idx())));
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  return around;
}

bool rim_walk::share_face(uint32_t v, uint32_t w) const {
  for (const auto f : mesh().vf_range(linked_.vertex_of(v))) {
    size_t count;
    const uint32_t *corners = vxm_face(soup_, static_cast<size_t>(f.idx()), &count);
    if (std::find(corners, corners + count, w) != corners + count)
      return true;
  }
  return false;
}

bool rim_walk::may_be_one(const std::vector<uint32_t> &group) const {
  std::vector<point> all;
  for (const uint32_t v : group) {
    const auto around = neighbours(v);
    all.insert(all.end(), around.begin(), around.end());
    for (const uint32_t w : group)
      if (v != w && share_face(v, w))
        return false;
  }
  std::sort(all.begin(), all.end());
  return std::adjacent_find(all.begin(), all.end()) == all.end();
}

void rim_walk::find_twins(twins &found) const {
  std::vector<uint32_t> sorted = vertices_;
  std::sort(sorted.begin(), sorted.end(), [this](uint32_t v, uint32_t w) {
    const point p = position(v), q = position(w);
    return p != q ? p < q : v < w;
  });
  for (auto first = sorted.begin(); first != sorted.end();) {
    const point at = position(*first);
    const auto last = std::find_if(first, sorted.end(), [&](uint32_t v) { return position(v) != at; });
    const std::vector<uint32_t> group(first, last);
    if (group.size() > 1 && may_be_one(group))
      for (const uint32_t v : group)
        found[v] = group;
    first = last;
  }
}

/** The loop of some steps of the rim: each goes from a vertex to the next one of the rim. */
rim_loop rim_walk::loop_of(const std::vector<size_t> &steps) const {
  rim_loop loop;
  for (size_t i = 0; i < steps.size(); i++) {
    const size_t before = steps[i > 0 ? i - 1 : steps.size() - 1];
    const uint32_t from = vertices_[steps[i]], reached = vertices_[(before + 1) % vertices_.size()];
    loop.vertices.push_back(from);
    loop.beyond.push_back(beyond_[steps[i]]);
    if (from != reached)
      loop.seams.emplace_back(reached, from);
  }
  return loop;
}

std::vector<rim_loop> rim_walk::take_apart(const twins &found) const {
  std::vector<rim_loop> loops;
  std::vector<size_t> steps; /* of what is not yet closed */
  for (size_t i = 0; i < vertices_.size(); i++) {
    const auto group = found.find(vertices_[i]);
    if (group != found.end()) {
      /* back at a position where steps began: they are a loop */
      const auto begins = [&](size_t step) {
        return std::binary_search(group->second.begin(), group->second.end(), vertices_[step]);
      };
      const auto first = std::find_if(steps.begin(), steps.end(), begins);
      if (first != steps.end()) {
        loops.push_back(loop_of(std::vector<size_t>(first, steps.end())));
        steps.erase(first, steps.end());
      }
    }
    steps.push_back(i);
  }
  loops.push_back(loop_of(steps));
  return loops;
}

} // namespace

std::vector<rim_loop> rim_loops(twins &found, const halfedges &linked, const vxm_soup *soup,
                                halfedges::halfedge first) {
  rim_walk walk(linked, soup);
  walk.follow(first);
  found.clear();
  walk.find_twins(found);
  return walk.take_apart(found);
}

} // namespace voxmend

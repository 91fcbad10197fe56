/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modules/cgal/holes.h"

#include <algorithm>
#include <unordered_map>

#include "mesh/boundary_loops.h"

namespace vxm {

namespace {

/** The odd edges of a soup and the loops that they form. */
class Loops {
public:
  Loops(const vxm_soup *soup, Meter &meter) {
    check(vxm_edges_build(&edges_, meter.context(), soup, nullptr, meter.error()));
    vxm_status status = vxm_boundary_loops_build(&loops_, soup, &edges_, meter.error());
    if (status != VXM_OK) {
      vxm_edges_destroy(&edges_);
      throw Stopped(status);
    }
  }
  ~Loops() {
    vxm_boundary_loops_destroy(&loops_);
    vxm_edges_destroy(&edges_);
  }
  Loops(const Loops &) = delete;
  Loops &operator=(const Loops &) = delete;

  size_t count() const {
    return loops_.count;
  }

  /** The vertices of a loop against the direction of the faces along it, or none. */
  std::vector<uint32_t> rim(size_t loop) const {
    std::vector<uint32_t> out(loops_.vertex + loops_.begin[loop], loops_.vertex + loops_.begin[loop + 1]);
    size_t along = 0;
    for (size_t step = loops_.begin[loop]; step < loops_.begin[loop + 1]; step++) {
      const vxm_edge &edge = edges_.edges[loops_.edge[step]];
      if (edge.count != 1)
        return {};
      bool up = loops_.vertex[step] == edge.a;
      along += up == (edge.forward == 1);
    }
    if (along != 0 && along != out.size())
      return {};
    if (along != 0)
      std::reverse(out.begin(), out.end());
    return out;
  }

private:
  vxm_edges edges_;
  vxm_boundary_loops loops_;
};

} // namespace

Rims::Rims(const vxm_soup *soup, const Triangles &triangles, Meter &meter)
    : soup_(soup), triangles_(triangles) {
  find_triangles_of_vertices();
  find_rims(meter);
}

void Rims::find_triangles_of_vertices() {
  begin_.assign(soup_->vertex_count + 1, 0);
  for (const Corners &t : triangles_.corners)
    for (uint32_t v : t)
      begin_[v + 1]++;
  for (size_t v = 0; v < soup_->vertex_count; v++)
    begin_[v + 1] += begin_[v];
  users_.resize(3 * triangles_.corners.size());
  std::vector<size_t> next(begin_.begin(), begin_.end() - 1);
  for (uint32_t t = 0; t < triangles_.corners.size(); t++)
    for (uint32_t v : triangles_.corners[t])
      users_[next[v]++] = t;
}

void Rims::find_rims(Meter &meter) {
  Loops loops(soup_, meter);
  for (size_t l = 0; l < loops.count(); l++) {
    Rim rim = {loops.rim(l), 0};
    if (!rim.vertices.empty() && begin_[rim.vertices[0]] < begin_[rim.vertices[0] + 1])
      rim.face = triangles_.face[users_[begin_[rim.vertices[0]]]];
    rims_.push_back(rim);
  }
}

Surroundings Rims::around(const Rim &rim, int rings) const {
  Surroundings out;
  out.rim = rim.vertices.size();
  std::vector<uint32_t> vertices = rim.vertices;
  std::unordered_map<uint32_t, uint32_t> number;
  std::unordered_map<uint32_t, bool> seen;
  for (uint32_t v : vertices)
    number.emplace(v, (uint32_t)number.size());
  size_t begin = 0;
  for (int ring = 0; ring < rings; ring++) {
    size_t end = vertices.size();
    for (size_t i = begin; i < end; i++)
      for (size_t user = begin_[vertices[i]]; user < begin_[vertices[i] + 1]; user++) {
        uint32_t t = users_[user];
        if (!seen.emplace(t, true).second)
          continue;
        Corners local;
        for (size_t k = 0; k < 3; k++) {
          auto known = number.emplace(triangles_.corners[t][k], (uint32_t)number.size());
          if (known.second)
            vertices.push_back(triangles_.corners[t][k]);
          local[k] = known.first->second;
        }
        out.corners.push_back(local);
      }
    begin = end;
  }
  for (uint32_t v : vertices) {
    const double *p = vxm_position(soup_, v);
    out.points.push_back({p[0], p[1], p[2]});
  }
  return out;
}

} // namespace vxm

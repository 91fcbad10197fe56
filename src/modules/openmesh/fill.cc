/* SPDX-License-Identifier: BSD-3-Clause */
/** Holes of a manifold soup, found on its half-edges and filled. */
#include "mesh/geometry.h"
#include "mesh/hole_triangulation.h"
#include "mesh/unit_scale.h"
#include "modules/openmesh/holes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace voxmend {

namespace {

using point = std::array<double, 3>;
using triangle = std::array<uint32_t, 3>;

/** Sets of vertices, each known by its lowest one. */
class vertex_sets {
public:
  explicit vertex_sets(size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  uint32_t root(uint32_t v) {
    for (; parent_[v] != v; v = parent_[v])
      parent_[v] = parent_[parent_[v]];
    return v;
  }
  void unite(uint32_t v, uint32_t w) {
    v = root(v);
    w = root(w);
    parent_[std::max(v, w)] = std::min(v, w);
  }

private:
  std::vector<uint32_t> parent_;
};

/** Area and vector area of what hangs together. */
struct component {
  double area = 0;
  vxm_vec3 vector = {0, 0, 0};
};

class filling {
public:
  filling(const vxm_soup *soup, size_t max_edges)
      : soup_(soup), max_edges_(max_edges), linked_(soup), component_of_(soup->vertex_count),
        becomes_(soup->vertex_count) {
  }

  /** Finds all holes and plans the new faces. */
  void plan();
  /** Makes the soup with the new faces. */
  void make(vxm_soup **out, uint64_t **origin);

  int64_t filled = 0, left = 0;

private:
  void measure();
  void measure_components();
  std::vector<halfedges::halfedge> find_rims() const;
  void fill(const rim_loop &loop, double fraction);
  bool is_outer_rim_of_sheet(const rim_loop &loop);
  bool triangulate(const rim_loop &loop, double fraction);
  bool has_edge(uint32_t v, uint32_t w) const;
  size_t lender(std::vector<size_t> faces) const;
  vxm_vec3 area_of(size_t face) const {
    size_t count;
    const uint32_t *corners = vxm_face(soup_, face, &count);
    return vxm_polygon_area(soup_->positions, corners, count, frame_.scale);
  }

  const vxm_soup *soup_;
  size_t max_edges_;
  halfedges linked_;
  vxm_unit_scale frame_{};
  vertex_sets component_of_;
  std::vector<component> components_; /**< at the vertices that their sets are known by */
  vertex_sets becomes_;               /**< vertices that become one */

  /* of the rim in hand */
  twins twins_;
  std::vector<triangle> triangles_;

  /* planned */
  std::vector<triangle> faces_;
  std::vector<size_t> lenders_; /**< per face: where its tag comes from */
};

void filling::measure() {
  vxm_error error = VXM_ERROR_INIT;
  vxm_extent extent;
  if (vxm_extent_find(&extent, soup_->context, soup_, &error) != VXM_OK)
    throw failure{error};
  frame_ = vxm_unit_scale_of(extent.bounds);
}

void filling::measure_components() {
  for (const auto e : linked_.mesh().edges())
    component_of_.unite(static_cast<uint32_t>(e.v0().idx()), static_cast<uint32_t>(e.v1().idx()));
  components_.resize(soup_->vertex_count);
  for (size_t f = 0; f < soup_->face_count; f++) {
    component &c = components_[component_of_.root(soup_->indices[soup_->offsets[f]])];
    const vxm_vec3 area = area_of(f);
    c.area += vxm_vec3_length(area);
    c.vector = {c.vector.x + area.x, c.vector.y + area.y, c.vector.z + area.z};
  }
}

std::vector<halfedges::halfedge> filling::find_rims() const {
  std::vector<halfedges::halfedge> rims;
  std::vector<bool> seen(linked_.mesh().n_halfedges());
  for (const auto first : linked_.mesh().halfedges()) {
    if (!first.is_boundary() || seen[static_cast<size_t>(first.idx())])
      continue;
    rims.push_back(first);
    for (auto h = first; !seen[static_cast<size_t>(h.idx())]; h = h.next())
      seen[static_cast<size_t>(h.idx())] = true;
  }
  return rims;
}

/**
 * Whether there is an edge already, also between twins, which become one with these vertices perhaps. New
 * edges need no look: two loops of a rim have at most one vertex in common.
 */
bool filling::has_edge(uint32_t v, uint32_t w) const {
  const auto joined = [this](uint32_t p, uint32_t q) {
    return linked_.mesh().find_halfedge(linked_.vertex_of(p), linked_.vertex_of(q)).is_valid();
  };
  if (twins_.empty())
    return joined(v, w);
  /* asked from many threads, where nothing may be thrown */
  const auto group_v = twins_.find(v), group_w = twins_.find(w);
  const uint32_t *some_v = group_v == twins_.end() ? &v : group_v->second.data();
  const uint32_t *some_w = group_w == twins_.end() ? &w : group_w->second.data();
  const size_t count_v = group_v == twins_.end() ? 1 : group_v->second.size();
  const size_t count_w = group_w == twins_.end() ? 1 : group_w->second.size();
  for (size_t i = 0; i < count_v; i++)
    for (size_t j = 0; j < count_w; j++)
      if (joined(some_v[i], some_w[j]))
        return true;
  return false;
}

/* ---- One hole ---- */

bool filling::is_outer_rim_of_sheet(const rim_loop &loop) {
  const component &c = components_[component_of_.root(loop.vertices[0])];
  const vxm_vec3 area =
      vxm_polygon_area(soup_->positions, loop.vertices.data(), loop.vertices.size(), frame_.scale);
  /* the fillings of a flat sheet's rims have minus its vector area together: a hole adds to the outer one's
   */
  const double whole = vxm_vec3_dot(c.vector, c.vector);
  return std::sqrt(whole) >= VXM_SHEET_PART * c.area && vxm_vec3_dot(area, c.vector) <= -whole / 4;
}

/** The first of those faces that have the tag of most of them. */
size_t filling::lender(std::vector<size_t> faces) const {
  if (!soup_->face_tags)
    return faces[0];
  const auto tag = [this](size_t face) { return soup_->face_tags[face]; };
  std::sort(faces.begin(), faces.end(),
            [&](size_t p, size_t q) { return tag(p) != tag(q) ? tag(p) < tag(q) : p < q; });
  size_t best = faces[0];
  std::ptrdiff_t most = 0;
  for (auto first = faces.begin(); first != faces.end();) {
    const auto last = std::find_if(first, faces.end(), [&](size_t f) { return tag(f) != tag(*first); });
    if (last - first > most) {
      most = last - first;
      best = *first;
    }
    first = last;
  }
  return best;
}

bool filling::triangulate(const rim_loop &loop, double fraction) {
  std::vector<point> points, normals;
  for (size_t i = 0; i < loop.vertices.size(); i++) {
    const double *p = vxm_position(soup_, loop.vertices[i]);
    const vxm_vec3 at = vxm_vec3_between(p, frame_.centre, frame_.scale), area = area_of(loop.beyond[i]);
    const double size = vxm_vec3_length(area);
    points.push_back({at.x, at.y, at.z});
    normals.push_back(size > frame_.no_area ? point{area.x / size, area.y / size, area.z / size} : point{});
  }
  triangles_.resize(loop.vertices.size() - 2);
  auto question = [this, &loop](size_t i, size_t j) { return has_edge(loop.vertices[i], loop.vertices[j]); };
  vxm_rim rim{};
  rim.context = soup_->context;
  rim.fraction = fraction;
  rim.count = points.size();
  rim.points = reinterpret_cast<const double(*)[3]>(points.data());
  rim.normals = reinterpret_cast<const double(*)[3]>(normals.data());
  rim.is_edge = [](size_t i, size_t j, void *payload) {
    return (*static_cast<decltype(question) *>(payload))(i, j);
  };
  rim.payload = &question;
  rim.no_area = 2 * frame_.no_area; /* so that rounding does not decide whether a face has area */
  bool done = false;
  vxm_error error = VXM_ERROR_INIT;
  check(vxm_hole_triangulate(reinterpret_cast<uint32_t(*)[3]>(triangles_.data()), &done, &rim, &error),
        error);
  return done;
}

void filling::fill(const rim_loop &loop, double fraction) {
  if (max_edges_ > 0 && loop.vertices.size() > max_edges_)
    return;
  if (is_outer_rim_of_sheet(loop) || !triangulate(loop, fraction)) {
    left++;
    return;
  }
  filled++;
  const size_t tagged = lender(loop.beyond);
  for (const auto &t : triangles_) {
    faces_.push_back({loop.vertices[t[0]], loop.vertices[t[1]], loop.vertices[t[2]]});
    lenders_.push_back(tagged);
  }
  for (const auto &seam : loop.seams)
    becomes_.unite(seam.first, seam.second);
}

/* ---- All of it ---- */

void filling::plan() {
  vxm_error error = VXM_ERROR_INIT;
  if (linked_.add_all() > 0 || !linked_.is_manifold())
    check(vxm_fail(&error, VXM_ERROR_ARGUMENT,
                   "only holes of a manifold mesh can be filled: separate it first"),
          error);
  measure();
  measure_components();
  const auto rims = find_rims();
  for (size_t i = 0; i < rims.size(); i++) {
    const double fraction = static_cast<double>(i) / static_cast<double>(rims.size());
    check(vxm_progress(soup_->context, "filling holes", fraction, &error), error);
    for (const auto &loop : rim_loops(twins_, linked_, soup_, rims[i]))
      fill(loop, fraction);
  }
}

void filling::make(vxm_soup **out, uint64_t **origin) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_context *context = soup_->context;
  const size_t total = soup_->face_count + faces_.size();
  struct owner {
    vxm_soup *soup = nullptr;
    ~owner() {
      vxm_soup_destroy(soup);
    }
  } made;
  check(vxm_soup_copy(&made.soup, soup_, &error), error);
  check(vxm_soup_reserve(made.soup, 0, total, soup_->corner_count + 3 * faces_.size(), &error), error);
  if (soup_->face_tags) {
    void *tags = vxm_realloc(context, made.soup->face_tags, total, sizeof *soup_->face_tags, &error);
    if (!tags)
      throw failure{error};
    made.soup->face_tags = static_cast<uint32_t *>(tags);
    for (size_t f = 0; f < faces_.size(); f++)
      made.soup->face_tags[soup_->face_count + f] = soup_->face_tags[lenders_[f]];
  }
  for (const auto &face : faces_)
    check(vxm_soup_add_face(made.soup, face.data(), 3, &error), error);
  for (size_t c = 0; c < made.soup->corner_count; c++)
    made.soup->indices[c] = becomes_.root(made.soup->indices[c]);
  if (origin) {
    *origin = static_cast<uint64_t *>(vxm_alloc(context, total, sizeof **origin, &error));
    if (!*origin)
      throw failure{error};
    std::iota(*origin, *origin + soup_->face_count, uint64_t{0});
    std::copy(lenders_.begin(), lenders_.end(), *origin + soup_->face_count);
  }
  *out = made.soup;
  made.soup = nullptr;
}

} // namespace

vxm_status fill_holes(vxm_soup **out, uint64_t **origin, int64_t *filled, int64_t *left, const vxm_soup *soup,
                      size_t max_edges, vxm_error *error) {
  *out = nullptr;
  if (origin)
    *origin = nullptr;
  *filled = *left = 0;
  return guarded(error, [&] {
    filling work(soup, max_edges);
    work.plan();
    work.make(out, origin);
    *filled = work.filled;
    *left = work.left;
  });
}

} // namespace voxmend

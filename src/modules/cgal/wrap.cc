/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modules/cgal/functions.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <unistd.h>

#include "modules/cgal/exception_barrier.h"
#include "modules/cgal/result.h"

namespace vxm {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

/*
 * Measured: a surface of area A gets about 2 (flat) to 16 (curved, wrapped on both sides) times A / alpha^2
 * facets, and the work takes about 1600 bytes for each. What needs more than the estimate meets the limit on
 * its way.
 */
constexpr double FACETS = 4, BYTES = 1600;

/** CGAL calls it at every step. */
class Visitor {
public:
  Visitor(Meter &meter, double expected) : meter_(meter), expected_(expected) {
  }
  template <class Wrapper> void on_alpha_wrapping_begin(const Wrapper &) {
  }
  template <class Wrapper> void on_flood_fill_begin(const Wrapper &) {
  }
  template <class Wrapper, class Gate> void before_facet_treatment(const Wrapper &wrapper, const Gate &) {
    double done = (double)wrapper.triangulation().number_of_vertices() / expected_;
    meter_.progress(done < 0.95 ? done : 0.95);
  }
  template <class Wrapper, class Point> void before_Steiner_point_insertion(const Wrapper &, const Point &) {
  }
  template <class Wrapper, class Vertex> void after_Steiner_point_insertion(const Wrapper &, Vertex) {
  }
  template <class Wrapper> void on_flood_fill_end(const Wrapper &) {
  }
  template <class Wrapper> void on_alpha_wrapping_end(const Wrapper &) {
  }

private:
  Meter &meter_;
  double expected_;
};

/** Leaves out triangles without area, which the search for the nearest point cannot take. */
void drop_flat(Triangles *triangles) {
  size_t kept = 0;
  for (size_t t = 0; t < triangles->corners.size(); t++)
    if (has_area(triangles->points, triangles->corners[t])) {
      triangles->face[kept] = triangles->face[t];
      triangles->corners[kept++] = triangles->corners[t];
    }
  triangles->face.resize(kept);
  triangles->corners.resize(kept);
}

/** The face of the input nearest to the middle of each face of the skin. */
std::vector<uint64_t> nearest_faces(const vxm_soup *skin, const Triangles &triangles, Meter &meter) {
  using List = std::vector<Kernel::Triangle_3>;
  using Primitive = CGAL::AABB_triangle_primitive<Kernel, List::const_iterator>;
  meter.phase("looking for what lies beneath");
  auto point = [](const double *p) { return Kernel::Point_3(p[0], p[1], p[2]); };
  List list;
  list.reserve(triangles.corners.size());
  for (const Corners &t : triangles.corners)
    list.emplace_back(point(triangles.points[t[0]].data()), point(triangles.points[t[1]].data()),
                      point(triangles.points[t[2]].data()));
  CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> tree(list.cbegin(), list.cend());
  tree.accelerate_distance_queries();
  std::vector<uint64_t> out;
  out.reserve(skin->face_count);
  for (size_t f = 0; f < skin->face_count; f++) {
    size_t count;
    const uint32_t *corner = vxm_face(skin, f, &count);
    Kernel::Point_3 middle =
        CGAL::centroid(point(vxm_position(skin, corner[0])), point(vxm_position(skin, corner[1])),
                       point(vxm_position(skin, corner[2])));
    auto nearest = tree.closest_point_and_primitive(middle).second;
    out.push_back(triangles.face[(size_t)(nearest - list.cbegin())]);
    meter.progress((double)f / (double)skin->face_count);
  }
  return out;
}

double area_of(const std::vector<Position> &points, const std::vector<Corners> &corners) {
  double out = 0;
  for (const Corners &t : corners) {
    const Position &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
    double square = 0;
    for (size_t k = 0; k < 3; k++) {
      size_t v = (k + 1) % 3, w = (k + 2) % 3;
      double n = (b[v] - a[v]) * (c[w] - a[w]) - (b[w] - a[w]) * (c[v] - a[v]);
      square += n * n;
    }
    out += 0.5 * std::sqrt(square);
  }
  return out;
}

/** Refuses what would run out of memory after hours. */
void check_size(double area, double alpha, Meter &meter) {
  double bytes = FACETS * BYTES * area / (alpha * alpha);
  auto room = (double)vxm_memory_left(meter.context());
  room = std::min(room, (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE));
  if (bytes <= room)
    return;
  double fits = std::sqrt(FACETS * BYTES * area / room);
  check(vxm_fail(meter.error(), VXM_ERROR_MEMORY_LIMIT,
                 "wrapping as finely as that may need %.3g GB of memory, and there are %.3g; an alpha %.3g "
                 "times as large "
                 "would fit",
                 bytes * 1e-9, room * 1e-9, 1.05 * fits / alpha));
}

vxm_soup *soup_of(const Mesh &mesh, const vxm_soup *like, Meter &meter) {
  vxm_soup *made;
  check(vxm_soup_create(&made, like->context, like->format, meter.error()));
  Owner owner(made);
  made->warnings = like->warnings;
  check(vxm_soup_reserve(made, mesh.number_of_vertices(), mesh.number_of_faces(), 3 * mesh.number_of_faces(),
                         meter.error()));
  std::vector<uint32_t> number(mesh.num_vertices());
  for (Mesh::Vertex_index v : mesh.vertices()) {
    number[v] = (uint32_t)made->vertex_count;
    const Kernel::Point_3 &p = mesh.point(v);
    check(vxm_soup_add_vertex(made, p.x(), p.y(), p.z(), meter.error()));
  }
  for (Mesh::Face_index f : mesh.faces()) {
    Mesh::Halfedge_index h = mesh.halfedge(f);
    uint32_t corners[3] = {number[mesh.source(h)], number[mesh.target(h)], number[mesh.target(mesh.next(h))]};
    check(vxm_soup_add_face(made, corners, 3, meter.error()));
  }
  return owner.release();
}

} // namespace

vxm_status wrap(vxm_soup **out, uint64_t **origin, const vxm_soup *soup, double alpha, double offset,
                vxm_error *error) {
  *out = nullptr;
  if (origin != nullptr)
    *origin = nullptr;
  if (!(alpha > 0) || !(offset > 0) || !std::isfinite(alpha) || !std::isfinite(offset))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "wrapping takes an alpha and an offset above 0, not %g and %g",
                    alpha, offset);
  return guarded(soup->context, "wrapping", error, [&](Meter &meter) {
    Triangles triangles = triangles_of(soup, Naming::by_position, meter);
    drop_flat(&triangles);
    const std::vector<Corners> &corners = triangles.corners;
    if (corners.empty())
      check(vxm_fail(meter.error(), VXM_ERROR_EMPTY, "there is no face with an area to wrap"));
    double area = area_of(triangles.points, corners);
    check_size(area, alpha, meter);
    std::vector<Kernel::Point_3> points;
    points.reserve(triangles.points.size());
    for (const Position &p : triangles.points)
      points.emplace_back(p[0], p[1], p[2]);
    Mesh mesh;
    Visitor visitor(meter, FACETS * area / (alpha * alpha) + 1);
    CGAL::alpha_wrap_3(points, corners, alpha, offset, mesh, CGAL::parameters::default_values(),
                       CGAL::parameters::visitor(visitor));
    Owner made(soup_of(mesh, soup, meter));
    if (origin != nullptr)
      *origin = copy_list(nearest_faces(made.get(), triangles, meter), meter).release();
    *out = made.release();
  });
}

} // namespace vxm

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "repair/cgal_functions.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <unistd.h>

#include "repair/cgal_guard.h"
#include "repair/cgal_triangles.h"

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
std::vector<Corners> with_area(const Triangles &triangles) {
  std::vector<Corners> out;
  for (const Corners &corners : triangles.corners)
    if (has_area(triangles.points, corners))
      out.push_back(corners);
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
  check(vxm_fail(
      meter.error(), VXM_ERROR_MEMORY_LIMIT,
      "wrapping with alpha %.3g may need %.3g GB of memory, and there are %.3g; alpha %.3g would fit", alpha,
      bytes * 1e-9, room * 1e-9, 1.05 * fits));
}

vxm_soup *soup_of(const Mesh &mesh, const vxm_soup *like, Meter &meter) {
  vxm_soup *made;
  check(vxm_soup_create(&made, like->context, like->format, meter.error()));
  Owner owner(made);
  made->notes = like->notes;
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

vxm_status wrap(vxm_soup **out, const vxm_soup *soup, double alpha, double offset, vxm_error *error) {
  *out = nullptr;
  if (!(alpha > 0) || !(offset > 0) || !std::isfinite(alpha) || !std::isfinite(offset))
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "wrapping takes an alpha and an offset above 0, not %g and %g",
                    alpha, offset);
  return guarded(soup->context, "wrapping", error, [&](Meter &meter) {
    Triangles triangles = triangles_of(soup, Naming::by_position, meter);
    std::vector<Corners> corners = with_area(triangles);
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
    *out = soup_of(mesh, soup, meter);
  });
}

} // namespace vxm

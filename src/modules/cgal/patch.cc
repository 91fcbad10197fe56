/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modules/cgal/patch.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/fair.h>
#include <CGAL/Polygon_mesh_processing/refine.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace vxm {

namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
namespace named = CGAL::parameters;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Vertex = Mesh::Vertex_index;
using Face = Mesh::Face_index;

/* The search through all triangulations takes the cube of the length; beyond this only Delaunay triangles are
 * tried. */
constexpr size_t CUBIC = 300;
/* The equations of fairing are solved in one go, which cannot be stopped: more new points stay where they
 * are. */
constexpr size_t FAIRED = 50000;

Mesh mesh_of(const Surroundings &around) {
  Mesh mesh;
  for (const Position &p : around.points)
    mesh.add_vertex(Kernel::Point_3(p[0], p[1], p[2]));
  /* A face that does not fit is left out: if it belongs to the rim, that is noticed. */
  for (const Corners &c : around.corners)
    mesh.add_face(Vertex(c[0]), Vertex(c[1]), Vertex(c[2]));
  return mesh;
}

/** The border of the hole, if the mesh has it as the rim is given. */
Mesh::Halfedge_index find_border(const Mesh &mesh, size_t rim) {
  Mesh::Halfedge_index first, last;
  for (size_t i = 0; i < rim; i++) {
    Mesh::Halfedge_index h = mesh.halfedge(Vertex((uint32_t)i), Vertex((uint32_t)((i + 1) % rim)));
    if (h == Mesh::null_halfedge() || !mesh.is_border(h) || (i > 0 && mesh.next(last) != h))
      return Mesh::null_halfedge();
    first = i == 0 ? h : first;
    last = h;
  }
  return mesh.next(last) == first ? first : Mesh::null_halfedge();
}

std::vector<Corners> corners_of(const Mesh &mesh, const std::vector<Face> &faces,
                                const std::vector<uint32_t> &number) {
  std::vector<Corners> out;
  for (Face face : faces) {
    Mesh::Halfedge_index h = mesh.halfedge(face);
    out.push_back({number[mesh.source(h)], number[mesh.target(h)], number[mesh.target(mesh.next(h))]});
  }
  return out;
}

std::vector<Position> positions(const Mesh &mesh, const std::vector<Vertex> &vertices) {
  std::vector<Position> out;
  for (Vertex v : vertices)
    out.push_back({mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z()});
  return out;
}

bool are_finite(const std::vector<Position> &points) {
  for (const Position &p : points)
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
      return false;
  return true;
}

/**
 * Cotangents of the angles opposite to an edge, held within bounds for slivers, over the area about a vertex
 * (a third of its faces). CGAL's own weights look at the whole mesh for each edge where its checks are on.
 */
class Weights {
public:
  explicit Weights(const Mesh &mesh) : mesh_(&mesh) {
  }
  double w_i(Vertex v) const {
    double area = 0;
    for (Mesh::Halfedge_index h : mesh_->halfedges_around_target(mesh_->halfedge(v)))
      if (!mesh_->is_border(h))
        area += std::sqrt(CGAL::squared_area(point(mesh_->source(h)), point(v),
                                             point(mesh_->target(mesh_->next(h))))) /
                3;
    return area > 0 ? 0.5 / area : 0;
  }
  double w_ij(Mesh::Halfedge_index h) const {
    return cotangent(h) + cotangent(mesh_->opposite(h));
  }

private:
  const Kernel::Point_3 &point(Vertex v) const {
    return mesh_->point(v);
  }
  /** Of the angle opposite to a side; 0 at a border. */
  double cotangent(Mesh::Halfedge_index h) const {
    if (mesh_->is_border(h))
      return 0;
    const Kernel::Point_3 &tip = point(mesh_->target(mesh_->next(h)));
    Kernel::Vector_3 a = point(mesh_->source(h)) - tip, b = point(mesh_->target(h)) - tip;
    double along = a * b, area = std::sqrt(CGAL::cross_product(a, b).squared_length());
    return area > 0 ? std::max(-STEEPEST, std::min(STEEPEST, along / area)) : 0;
  }

  static constexpr double STEEPEST = 100; /* an angle of half a degree */
  const Mesh *mesh_;
};

void fill(Mesh *mesh, Mesh::Halfedge_index border, size_t rim, Patch *out) {
  std::vector<Face> faces;
  pmp::triangulate_hole(*mesh, border, std::back_inserter(faces),
                        named::do_not_use_cubic_algorithm(rim > CUBIC));
  std::vector<uint32_t> number(mesh->number_of_vertices());
  for (uint32_t v = 0; v < rim; v++)
    number[v] = v;
  out->plain = corners_of(*mesh, faces, number);
  if (faces.empty())
    return;
  std::vector<Vertex> fresh;
  pmp::refine(*mesh, faces, std::back_inserter(faces), std::back_inserter(fresh));
  if (fresh.empty())
    return;
  number.resize(mesh->number_of_vertices());
  for (size_t i = 0; i < fresh.size(); i++)
    number[fresh[i]] = (uint32_t)(rim + i);
  std::vector<Position> flat = positions(*mesh, fresh);
  if (!are_finite(flat))
    return;
  out->refined = corners_of(*mesh, faces, number);
  out->flat = flat;
  if (fresh.size() > FAIRED ||
      !pmp::fair(*mesh, fresh, named::weight_calculator(Weights(*mesh)).fairing_continuity(1U)))
    return;
  std::vector<Position> faired = positions(*mesh, fresh);
  if (are_finite(faired))
    out->faired = faired;
}

} // namespace

Patch make_patch(const Surroundings &around, Meter &meter) {
  Patch out;
  meter.tick();
  try {
    Mesh mesh = mesh_of(around);
    Mesh::Halfedge_index border = find_border(mesh, around.rim);
    if (border != Mesh::null_halfedge())
      fill(&mesh, border, around.rim, &out);
  } catch (const std::bad_alloc &) {
    throw; /* also to stop */
  } catch (const std::exception &) {
    /* what was found until then holds */
  }
  return out;
}

} // namespace vxm

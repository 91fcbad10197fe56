/* SPDX-License-Identifier: BSD-3-Clause */
/** The table of the module, and the second opinion on whether a soup is manifold. */
#include "base/module.h"
#include "config.h"
#include "modules/openmesh/mesh.h"

#include <numeric>

namespace voxmend {

namespace {

int64_t count_components(const halfedges::mesh_type &mesh) {
  std::vector<int> parent(mesh.n_vertices());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&parent](int v) {
    for (; parent[size_t(v)] != v; v = parent[size_t(v)])
      parent[size_t(v)] = parent[size_t(parent[size_t(v)])];
    return v;
  };
  int64_t count = 0;
  for (const auto v : mesh.vertices())
    count += !mesh.is_isolated(v);
  for (const auto e : mesh.edges()) {
    const int p = root(e.v0().idx()), q = root(e.v1().idx());
    count -= p != q;
    parent[size_t(p)] = q;
  }
  return count;
}

int64_t count_holes(const halfedges::mesh_type &mesh) {
  std::vector<bool> seen(mesh.n_halfedges());
  int64_t count = 0;
  for (const auto first : mesh.halfedges()) {
    if (!first.is_boundary() || seen[size_t(first.idx())])
      continue;
    count++;
    for (auto h = first; !seen[size_t(h.idx())]; h = h.next())
      seen[size_t(h.idx())] = true;
  }
  return count;
}

vxm_status inspect(vxm_halfedge_report *out, const vxm_soup *soup, vxm_error *error) {
  *out = vxm_halfedge_report{};
  return guarded(error, [&] {
    halfedges linked(soup);
    vxm_halfedge_report report{};
    report.rejected = static_cast<int64_t>(linked.add_all());
    report.faces = static_cast<int64_t>(soup->face_count) - report.rejected;
    for (const auto e : linked.mesh().edges())
      report.boundary_edges += e.is_boundary();
    report.holes = count_holes(linked.mesh());
    report.components = count_components(linked.mesh());
    report.manifold = report.rejected == 0 && linked.is_manifold();
    *out = report;
  });
}

const vxm_openmesh functions = {inspect, fill_holes};

} // namespace

} // namespace voxmend

extern "C" {
extern VXM_API const vxm_module vxm_module_table;
const vxm_module vxm_module_table = {VXM_BUILD, "OpenMesh " VXM_OPENMESH_VERSION, "BSD-3-Clause",
                                     &voxmend::functions};
}

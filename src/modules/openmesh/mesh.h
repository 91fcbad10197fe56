/* SPDX-License-Identifier: BSD-3-Clause */
/** C++ only: OpenMesh's half-edges of a soup, and the border between its exceptions and our statuses. */
#ifndef VXM_MODULES_OPENMESH_MESH_H
#define VXM_MODULES_OPENMESH_MESH_H

#include "mesh/soup.h"
#include "repair/external/openmesh.h"

#include <OpenMesh/Core/Mesh/PolyConnectivity.hh>

#include <exception>
#include <new>
#include <vector>

namespace voxmend {

/** A failure on its way out. */
struct failure {
  vxm_error error;
};

/** Throws unless the status is VXM_OK, with which the error goes that was filled. */
void check(vxm_status status, const vxm_error &error);

/** Runs something that may throw, and gives its status. */
template <class Work> vxm_status guarded(vxm_error *error, Work work) {
  try {
    work();
    return VXM_OK;
  } catch (const failure &failed) {
    vxm_error_pass(error, &failed.error);
    return failed.error.code;
  } catch (const std::bad_alloc &) {
    return vxm_fail(error, VXM_ERROR_MEMORY, "OpenMesh: out of memory; free some");
  } catch (const std::exception &unexpected) {
    return vxm_fail(error, VXM_ERROR_RANGE, "OpenMesh: %s", unexpected.what());
  }
}

/**
 * The half-edges of a soup's faces. OpenMesh keeps positions if asked to; here only the connections are
 * wanted. Its readers take no part: faces come one by one.
 */
class halfedges {
public:
  using mesh_type = OpenMesh::PolyConnectivity;
  using vertex = mesh_type::VertexHandle;
  using halfedge = mesh_type::HalfedgeHandle;

  /** Makes the vertices, and room for the faces. */
  explicit halfedges(const vxm_soup *soup);
  ~halfedges();
  halfedges(const halfedges &) = delete;
  halfedges &operator=(const halfedges &) = delete;

  /** Adds a face; false if OpenMesh, or the face itself, does not allow it. */
  bool add(const uint32_t *corners, size_t count);
  /** Adds all faces of the soup; returns how many were not taken. */
  size_t add_all();
  /** Whether every vertex has one fan of faces. */
  bool is_manifold() const;

  const mesh_type &mesh() const {
    return mesh_;
  }
  vertex vertex_of(uint32_t number) const {
    return vertex(static_cast<int>(number));
  }

private:
  const vxm_soup *soup_;
  void *booked_ = nullptr; /**< a block that is never written, as large as what OpenMesh holds */
  mesh_type mesh_;
  std::vector<vertex> corners_;
  std::vector<uint32_t> seen_; /**< per vertex: the last face that came by */
  uint32_t faces_seen_ = 0;
};

/** vxm_openmesh.fill */
vxm_status fill_holes(vxm_soup **out, uint64_t **origin, int64_t *filled, int64_t *left, const vxm_soup *soup,
                      size_t max_edges, vxm_error *error);

} // namespace voxmend

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
#include "modules/openmesh/mesh.h"

#include <OpenMesh/Core/System/omstream.hh>

#include <mutex>

namespace voxmend {

namespace {

constexpr size_t CORNERS_MAX = size_t{1} << 30; /* half-edges are numbered by int */
constexpr size_t FACES_PER_LOOK = 1 << 16;

/**
 * OpenMesh tells on std::cerr which faces it does not take. Its streams belong to the whole process, so they
 * are given back as they were when the last of those who want quiet has gone.
 */
class quiet {
public:
  quiet() {
    const std::lock_guard<std::mutex> lock(mutex());
    if (count()++ > 0)
      return;
    was_enabled() = omerr().is_enabled();
    omerr().disable();
  }
  ~quiet() {
    const std::lock_guard<std::mutex> lock(mutex());
    if (--count() == 0 && was_enabled())
      omerr().enable();
  }
  quiet(const quiet &) = delete;
  quiet &operator=(const quiet &) = delete;

private:
  static std::mutex &mutex() {
    static std::mutex one;
    return one;
  }
  static int &count() {
    static int users = 0;
    return users;
  }
  static bool &was_enabled() {
    static bool before = true;
    return before;
  }
};

} // namespace

void check(vxm_status status, const vxm_error &error) {
  if (status != VXM_OK)
    throw failure{error};
}

halfedges::halfedges(const vxm_soup *soup) : soup_(soup) {
  vxm_error error = VXM_ERROR_INIT;
  if (soup->corner_count > CORNERS_MAX || soup->vertex_count > CORNERS_MAX)
    check(vxm_fail(&error, VXM_ERROR_RANGE, "OpenMesh: more than %zu corners or vertices: split the mesh",
                   CORNERS_MAX),
          error);
  /* every side of a face may be an edge of its own */
  const size_t vertices = soup->vertex_count, edges = soup->corner_count, faces = soup->face_count;
  const size_t bytes = vertices * (sizeof(mesh_type::Vertex) + sizeof seen_[0]) +
                       edges * sizeof(mesh_type::Edge) + faces * sizeof(mesh_type::Face);
  booked_ = vxm_alloc(soup->context, bytes, 1, &error);
  if (!booked_)
    throw failure{error};
  mesh_.reserve(static_cast<unsigned>(vertices), static_cast<unsigned>(edges), static_cast<unsigned>(faces));
  mesh_.resize(static_cast<unsigned>(vertices), 0, 0);
  seen_.assign(vertices, 0);
}

halfedges::~halfedges() {
  vxm_free(soup_->context, booked_);
}

bool halfedges::add(const uint32_t *corners, size_t count) {
  faces_seen_++;
  corners_.clear();
  for (size_t i = 0; i < count; i++) {
    if (seen_[corners[i]] == faces_seen_)
      return false;
    seen_[corners[i]] = faces_seen_;
    corners_.push_back(vertex_of(corners[i]));
  }
  return count >= 3 && mesh_.add_face(corners_.data(), count).is_valid();
}

size_t halfedges::add_all() {
  const quiet silence;
  size_t rejected = 0;
  for (size_t f = 0; f < soup_->face_count; f++) {
    size_t count;
    const uint32_t *corners = vxm_face(soup_, f, &count);
    rejected += !add(corners, count);
    if (f % FACES_PER_LOOK != 0)
      continue;
    vxm_error error = VXM_ERROR_INIT;
    const double fraction = static_cast<double>(f) / static_cast<double>(soup_->face_count);
    check(vxm_progress(soup_->context, "linking faces", fraction, &error), error);
  }
  return rejected;
}

bool halfedges::is_manifold() const {
  for (size_t v = 0; v < mesh_.n_vertices(); v++)
    if (!mesh_.is_manifold(vertex_of(static_cast<uint32_t>(v))))
      return false;
  return true;
}

} // namespace voxmend

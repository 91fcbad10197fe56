/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modules/cgal/triangles.h"

#include <cmath>

#include "mesh/triangulate.h"
#include "mesh/weld.h"

namespace vxm {

namespace {

/** A triangulator that is closed whatever happens. */
class Splitter {
public:
  explicit Splitter(vxm_context *context) {
    vxm_triangulator_open(&tri_, context);
  }
  ~Splitter() {
    vxm_triangulator_close(&tri_);
  }
  Splitter(const Splitter &) = delete;
  Splitter &operator=(const Splitter &) = delete;

  const uint32_t *split(const vxm_soup *soup, const uint32_t *corners, size_t count, vxm_error *error) {
    if (count == 3)
      return corners;
    const uint32_t *triangles;
    check(vxm_triangulate(&tri_, soup->positions, corners, count, &triangles, error));
    return triangles;
  }

private:
  vxm_triangulator tri_;
};

void copy_points(Triangles *out, const vxm_soup *soup, Meter &meter) {
  out->points.resize(soup->vertex_count);
  for (size_t v = 0; v < soup->vertex_count; v++) {
    const double *p = vxm_position(soup, v);
    for (size_t axis = 0; axis < 3; axis++)
      out->points[v][axis] = p[axis];
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
      check(vxm_fail(meter.error(), VXM_ERROR_ARGUMENT,
                     "vertex %zu is not finite; remove such vertices first (repair --level clean)", v));
  }
}

} // namespace

std::vector<uint32_t> same_positions(const std::vector<Position> &points, Meter &meter) {
  static_assert(sizeof(Position) == 3 * sizeof(double), "positions follow each other without gaps");
  std::vector<uint32_t> map(points.size());
  if (points.empty())
    return map;
  check(vxm_weld_exact(meter.context(), points.data()->data(), points.size(), map.data(), nullptr,
                       meter.error()));
  return map;
}

Triangles triangles_of(const vxm_soup *soup, Naming naming, Meter &meter) {
  Triangles out;
  copy_points(&out, soup, meter);
  std::vector<uint32_t> map;
  if (naming == Naming::by_position)
    map = same_positions(out.points, meter);
  size_t triangles = 0;
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count = (size_t)(soup->offsets[f + 1] - soup->offsets[f]);
    triangles += count > 2 ? count - 2 : 0;
  }
  if (triangles >= UINT32_MAX)
    check(vxm_fail(meter.error(), VXM_ERROR_RANGE, "%zu triangles; at most %u can be handled: split the mesh",
                   triangles, UINT32_MAX - 1));
  out.corners.reserve(triangles);
  out.face.reserve(triangles);
  Splitter splitter(meter.context());
  for (size_t f = 0; f < soup->face_count; f++) {
    size_t count;
    const uint32_t *corners = vxm_face(soup, f, &count);
    if (count < 3)
      continue;
    const uint32_t *split = splitter.split(soup, corners, count, meter.error());
    for (size_t t = 0; t < count - 2; t++) {
      Corners corner = {split[3 * t], split[3 * t + 1], split[3 * t + 2]};
      if (naming == Naming::by_position)
        for (uint32_t &v : corner)
          v = map[v];
      if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
        continue;
      out.corners.push_back(corner);
      out.face.push_back(f);
    }
    meter.tick();
  }
  return out;
}

} // namespace vxm

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modules/cgal/functions.h"

#include <algorithm>
#include <set>

#include "modules/cgal/exception_barrier.h"
#include "modules/cgal/triangles.h"

namespace vxm {

namespace {

using Pair = std::pair<uint64_t, uint64_t>;

vxm_face_pair *copy_pairs(const std::set<Pair> &pairs, Meter &meter) {
  auto *copy = static_cast<vxm_face_pair *>(
      vxm_alloc(meter.context(), pairs.size(), sizeof(vxm_face_pair), meter.error()));
  if (copy == nullptr)
    throw Stopped(meter.error()->code);
  size_t at = 0;
  for (const Pair &pair : pairs)
    copy[at++] = {pair.first, pair.second};
  return copy;
}

} // namespace

vxm_status self_intersections(vxm_face_pairs *out, const vxm_soup *soup, size_t most, vxm_error *error) {
  *out = vxm_face_pairs();
  return guarded(soup->context, "looking for self-intersections", error, [&](Meter &meter) {
    Triangles triangles = triangles_of(soup, Naming::by_position, meter);
    std::set<Pair> pairs;
    bool complete = true;
    find_meetings(triangles.points, triangles.corners, meter, [&](uint32_t first, uint32_t second) {
      /* Triangles are in the order of their faces, so the pair of faces is ordered as well. */
      Pair pair(triangles.face[first], triangles.face[second]);
      if (pair.first == pair.second || pairs.count(pair) != 0)
        return true;
      if (pairs.size() == most)
        return complete = false;
      pairs.insert(pair);
      return true;
    });
    out->pairs = copy_pairs(pairs, meter);
    out->count = pairs.size();
    out->complete = complete;
  });
}

} // namespace vxm

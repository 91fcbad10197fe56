/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modules/cgal/functions.h"

#include <algorithm>
#include <memory>

#include "modules/cgal/exception_barrier.h"
#include "modules/cgal/parts.h"

namespace vxm {

namespace {

/**
 * Which parts have to be turned: a part has the direction opposite to that of the smallest part around it
 * that it does not touch, and is wound outward where there is none.
 */
std::vector<bool> parts_to_turn(const Parts &parts) {
  std::vector<uint32_t> order;
  for (uint32_t p = 0; p < parts.parts.size(); p++)
    order.push_back(p);
  /* What is around is larger. */
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    double in_a = parts.parts[a].volume, in_b = parts.parts[b].volume;
    return in_a != in_b ? in_a > in_b : a < b;
  });
  std::vector<int> direction(parts.parts.size());
  std::vector<bool> out(parts.parts.size());
  for (uint32_t p : order) {
    uint32_t outer = NO_PART;
    for (uint32_t other : parts.groups[parts.parts[p].group].around)
      if (outer == NO_PART || parts.parts[other].volume < parts.parts[outer].volume)
        outer = other;
    direction[p] = outer == NO_PART ? 1 : -direction[outer];
    out[p] = parts.parts[p].sign != 0 && parts.parts[p].sign != direction[p];
  }
  return out;
}

} // namespace

vxm_status orient(vxm_soup **out, int64_t *turned, const vxm_soup *soup, vxm_error *error) {
  *out = nullptr;
  if (turned != nullptr)
    *turned = 0;
  return guarded(soup->context, "looking for what lies inside of what", error, [&](Meter &meter) {
    Triangles triangles = triangles_of(soup, Naming::by_position, meter);
    Parts parts = parts_of(soup, triangles, false, meter);
    std::vector<bool> turn = parts_to_turn(parts);
    vxm_soup *made;
    check(vxm_soup_copy(&made, soup, meter.error()));
    int64_t count = 0;
    for (size_t f = 0; f < made->face_count; f++) {
      if (!turn[parts.of_face[f]])
        continue;
      std::reverse(made->indices + made->offsets[f], made->indices + made->offsets[f + 1]);
      count++;
    }
    if (turned != nullptr)
      *turned = count;
    *out = made;
  });
}

} // namespace vxm

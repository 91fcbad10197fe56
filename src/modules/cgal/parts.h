/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The parts of a soup: which are closed, which touch, which lie inside of which. */
#ifndef VXM_MODULES_CGAL_PARTS_H
#define VXM_MODULES_CGAL_PARTS_H

#include "modules/cgal/triangles.h"

namespace vxm {

constexpr uint32_t NO_PART = UINT32_MAX;

/** A component of the soup: faces connected by vertices. */
struct Part {
  bool closed; /**< every edge is passed as often in either direction */
  int sign;    /**< 1: wound outward, -1: inward, 0: bounds no volume or is not closed */
  uint32_t group;
  uint64_t first_face; /**< of the soup */
  double volume;       /**< absolute */
  bool outward_only;

  /** Whether a place lies inside, by how often the part winds around it. What runs through itself and is
   * wound the other way somewhere encloses that, too, unless it is outward_only; a cavity is only what is
   * wound inward. */
  bool encloses(int winding) const {
    return winding * sign > 0 || (sign > 0 && winding < 0 && !outward_only);
  }
};

/** Parts with a sign that are connected by touching; other parts are alone. */
struct Group {
  std::vector<uint32_t> parts;
  bool meets; /**< they meet elsewhere than at corners and edges they share, or one of them meets itself */
  std::vector<uint32_t>
      around; /**< parts of other groups that the group lies inside of, in increasing order */
};

struct Parts {
  std::vector<Part> parts;
  std::vector<uint32_t> of_face; /**< of the soup */
  std::vector<Group> groups;
  /** Per part: for one that is wound inward, the outward one that it is a cavity of (mesh/voids.h), out of
   * those that it lies inside of without touching them; else NO_PART. */
  std::vector<uint32_t> host;
};

/** @param outward_only for all parts */
Parts parts_of(const vxm_soup *soup, const Triangles &triangles, bool outward_only, Meter &meter);

} // namespace vxm

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The filling of one hole. */
#ifndef VXM_MODULES_CGAL_PATCH_H
#define VXM_MODULES_CGAL_PATCH_H

#include "modules/cgal/triangles.h"

namespace vxm {

/** A hole with the faces around it. */
struct Surroundings {
  std::vector<Position> points; /**< first those of the rim, with the hole on the left */
  size_t rim;                   /**< points of the rim */
  std::vector<Corners> corners; /**< of the faces */
};

/** Ways to fill it. Corners below the length of the rim are its points, the others the new ones in their
 * order. */
struct Patch {
  std::vector<Corners> plain;   /**< between the points of the rim; empty if there is no way */
  std::vector<Corners> refined; /**< with new points; empty if none are needed */
  std::vector<Position> flat;   /**< the new points where refinement put them */
  std::vector<Position> faired; /**< the same where the surface continues smoothly; empty if that failed */
};

/** Throws Stopped, but nothing else: what CGAL refuses is not there. */
Patch make_patch(const Surroundings &around, Meter &meter);

} // namespace vxm

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Rays along the axes against triangles: what lies inside of what. */
#ifndef VXM_MODULES_CGAL_RAYS_H
#define VXM_MODULES_CGAL_RAYS_H

#include "modules/cgal/triangles.h"

namespace vxm {

/** Begins at a position that a mesh has; in the direction of an axis. */
struct Ray {
  Position from;
  size_t axis;
};

/**
 * Takes a ray and a triangle that it passes through; `sign` is 1 if it leaves through the triangle's front,
 * -1 if it comes in there.
 */
using Crossed = std::function<void(size_t ray, uint32_t triangle, int sign)>;

/**
 * Finds the triangles that lie beyond the beginning of each ray, exactly. Rays are moved by an infinitely
 * small amount across, the same for all, so that they pass no edge and no corner and a closed surface is
 * crossed as often in either direction. Triangles that the beginning lies on do not count.
 */
void cast_rays(const std::vector<Position> &points, const std::vector<Corners> &corners,
               const std::vector<Ray> &rays, Meter &meter, const Crossed &crossed);

} // namespace vxm

#endif

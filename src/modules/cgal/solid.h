/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The solid that the surfaces of several parts enclose, in the numbers that are to hold it. */
#ifndef VXM_MODULES_CGAL_SOLID_H
#define VXM_MODULES_CGAL_SOLID_H

#include "modules/cgal/outer_boundary.h"

namespace vxm {

/** A triangle of a part. */
struct PartTriangle {
  Corners corners;
  uint32_t part;
  uint64_t face;
};

/**
 * Finds the skin of the solid such that no two of its triangles meet elsewhere than in corners and edges they
 * share, with the coordinates as they are in it. Corners of the input may have moved for that, by a few
 * billionths of the largest coordinate.
 *
 * @param single coordinates are to be 32-bit floats, as those of the input are; then corners may have moved
 * by a few millionths
 * @return false if that could not be had
 */
bool bound_solid(const std::vector<Position> &points, const std::vector<PartTriangle> &triangles,
                 size_t part_count, bool single, Material *material, Meter &meter, Skin *out);

} // namespace vxm

#endif

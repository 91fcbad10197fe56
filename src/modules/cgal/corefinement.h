/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Surfaces cut along the lines in which they meet. */
#ifndef VXM_MODULES_CGAL_COREFINEMENT_H
#define VXM_MODULES_CGAL_COREFINEMENT_H

#include "modules/cgal/exact.h"
#include "modules/cgal/surface.h"

namespace vxm {

/** Triangles that share whole edges or corners, or nothing at all. */
struct Pieces {
  ExactPoints points; /**< those of the surface first */
  Sheet sheet;

  explicit Pieces(const Surface &surface) : points(surface.points) {
  }
};

/** Cuts a surface along all lines and points in which its triangles meet, exactly. */
Pieces arrange(const Surface &surface, const Meetings &meetings, Meter &meter);

} // namespace vxm

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The boundary of the solid that the surfaces of several parts enclose. */
#ifndef VXM_MODULES_CGAL_OUTER_BOUNDARY_H
#define VXM_MODULES_CGAL_OUTER_BOUNDARY_H

#include "modules/cgal/surface.h"

namespace vxm {

/** Where there is material, told from how often each part winds around a place. */
class Material {
public:
  virtual ~Material() = default;
  virtual bool inside(const std::vector<int> &windings) const = 0;

  /** Whether the volumes of places are to be told before it is asked what is inside. */
  virtual bool measures() const {
    return false;
  }
  virtual void begin_measure() {
  }
  /** Adds a share, which may be negative, to the volume of the places that parts wind around like this. */
  virtual void measure(const std::vector<int> &windings, double volume) {
    (void)windings;
    (void)volume;
  }
  virtual void end_measure() {
  }
};

/** A closed surface, each of whose edges has two triangles, which run along it in opposite directions. */
struct Skin {
  std::vector<Position>
      points; /**< the nearest doubles to where they are; several vertices may lie at one place */
  std::vector<Corners> corners; /**< with the material behind them */
  std::vector<uint64_t> face;   /**< that each is a piece of, the lowest one if there are several */
  std::vector<bool>
      altered; /**< per part: its surface is not all there, or in one with that of another part */
};

/**
 * Cuts a surface where its triangles meet and takes the pieces that have material on one side only, exactly.
 * Where more than two of them come together at an edge, those that have material between them are joined.
 *
 * @param part_count parts are numbered 0 to part_count - 1
 */
Skin find_skin(const Surface &surface, const Meetings &meetings, size_t part_count, Material *material,
               Meter &meter);

} // namespace vxm

#endif

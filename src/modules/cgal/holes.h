/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The rims of the holes of a soup, and the faces around them. */
#ifndef VXM_MODULES_CGAL_HOLES_H
#define VXM_MODULES_CGAL_HOLES_H

#include "modules/cgal/patch.h"

namespace vxm {

struct Rim {
  std::vector<uint32_t>
      vertices;  /**< of the soup, with the hole on the left; empty if the faces there do not agree */
  uint64_t face; /**< one face at the rim */
};

class Rims {
public:
  Rims(const vxm_soup *soup, const Triangles &triangles, Meter &meter);

  const std::vector<Rim> &all() const {
    return rims_;
  }
  /** The triangles that can be reached from a rim over so many vertices. */
  Surroundings around(const Rim &rim, int rings) const;

private:
  void find_triangles_of_vertices();
  void find_rims(Meter &meter);

  const vxm_soup *soup_;
  const Triangles &triangles_;
  std::vector<size_t>
      begin_; /**< vertex v has the triangles users_[begin_[v]] to users_[begin_[v + 1] - 1] */
  std::vector<uint32_t> users_;
  std::vector<Rim> rims_;
};

} // namespace vxm

#endif

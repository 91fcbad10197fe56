/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Where there is material among parts that touch, by the rules of repair/external/cgal.h. */
#ifndef VXM_MODULES_CGAL_GROUP_MATERIAL_H
#define VXM_MODULES_CGAL_GROUP_MATERIAL_H

#include <map>

#include "modules/cgal/outer_boundary.h"
#include "modules/cgal/parts.h"

namespace vxm {

/** The material of a group. Its windings are those of its parts, in the order in which it has them. */
class GroupMaterial : public Material {
public:
  /** @param body is around the group, or NO_PART */
  GroupMaterial(const Parts &parts, const std::vector<uint32_t> &group, uint32_t body);

  bool inside(const std::vector<int> &windings) const override;
  bool measures() const override {
    return true;
  }
  void begin_measure() override;
  void measure(const std::vector<int> &windings, double volume) override;
  void end_measure() override;

  /** Takes a cavity that has no host, and a solid that it takes from: both parts of the soup. */
  template <typename Take> void carved(Take take) const {
    for (const auto &pair : carves_)
      take(group_[loose_[pair.first]], group_[pair.second]);
  }

private:
  bool encloses(size_t solid, const std::vector<int> &windings) const;
  bool contains(size_t solid, size_t loose) const;
  bool is_within(size_t solid, size_t loose) const;
  bool in_cavity_of(size_t solid, const std::vector<int> &windings) const;
  bool in_cavity_of_body(const std::vector<int> &windings) const;

  const Parts &parts_;
  const std::vector<uint32_t> &group_;
  uint32_t body_;
  std::vector<size_t> solids_, hosted_,
      loose_;                     /**< positions in the group: solids, cavities with and without host */
  std::vector<double> volume_;    /**< per part of the group: of where it is */
  std::vector<double> other_way_; /**< the same, of where a solid is wound inward */
  std::vector<bool> crumbly_;     /**< per part of the group: what is wound inward of it does not count */
  std::map<std::pair<size_t, size_t>, double> shared_; /**< of a loose cavity and a solid */
  std::vector<bool> contained_;                        /**< per loose cavity: by a solid of the group */
  std::vector<std::pair<size_t, size_t>> carves_;      /**< loose cavities and solids, sorted */
};

} // namespace vxm

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modules/cgal/group_material.h"

#include <algorithm>

namespace vxm {

namespace {

/*
 * A part lies in another one if no more than this share of it does not. Where faces that are to lie in one
 * plane are turned, their corners are rounded out of it, by so much where they are 32-bit floats and a
 * thousand times as far from the origin as they are apart.
 */
constexpr double SLACK = 1e-4;

/*
 * What a solid winds round inward is left out if it is no more than this share of it: where faces that close
 * holes or lie on each other cut through the surface here and there, that leaves slivers outside of it, which
 * touch it along lines. To keep those would be to no use, and more than doubles can hold.
 */
constexpr double CRUMBS = 1e-3;

} // namespace

GroupMaterial::GroupMaterial(const Parts &parts, const std::vector<uint32_t> &group, uint32_t body)
    : parts_(parts), group_(group), body_(body) {
  for (size_t i = 0; i < group.size(); i++) {
    if (parts.parts[group[i]].sign > 0)
      solids_.push_back(i);
    else if (parts.parts[group[i]].sign < 0)
      (parts.host[group[i]] == NO_PART ? loose_ : hosted_).push_back(i);
  }
  crumbly_.assign(group.size(), false);
}

void GroupMaterial::begin_measure() {
  volume_.assign(group_.size(), 0);
  other_way_.assign(group_.size(), 0);
  crumbly_.assign(group_.size(), false);
  shared_.clear();
  carves_.clear();
}

void GroupMaterial::measure(const std::vector<int> &windings, double volume) {
  for (size_t solid : solids_) {
    if (encloses(solid, windings))
      volume_[solid] += volume;
    if (windings[solid] < 0)
      other_way_[solid] += volume;
  }
  for (size_t loose = 0; loose < loose_.size(); loose++) {
    if (windings[loose_[loose]] >= 0)
      continue;
    volume_[loose_[loose]] += volume;
    for (size_t solid : solids_)
      if (encloses(solid, windings))
        shared_[{loose, solid}] += volume;
  }
}

bool GroupMaterial::encloses(size_t solid, const std::vector<int> &windings) const {
  return parts_.parts[group_[solid]].encloses(windings[solid]) && !(crumbly_[solid] && windings[solid] < 0);
}

bool GroupMaterial::contains(size_t solid, size_t loose) const {
  auto shared = shared_.find({loose, solid});
  return shared != shared_.end() && shared->second >= (1 - SLACK) * volume_[loose_[loose]];
}

bool GroupMaterial::is_within(size_t solid, size_t loose) const {
  auto shared = shared_.find({loose, solid});
  return shared != shared_.end() && shared->second >= (1 - SLACK) * volume_[solid];
}

/** A cavity takes from the solids that it lies in; where there is none from all, but not from those in it. */
void GroupMaterial::end_measure() {
  for (size_t solid : solids_)
    crumbly_[solid] = other_way_[solid] <= CRUMBS * volume_[solid];
  contained_.assign(loose_.size(), false);
  for (size_t loose = 0; loose < loose_.size(); loose++) {
    for (size_t solid : solids_)
      if (contains(solid, loose) && !is_within(solid, loose))
        contained_[loose] = true;
    for (size_t solid : solids_) {
      bool around = contains(solid, loose), within = is_within(solid, loose);
      if (contained_[loose] ? around && !within : around || !within)
        carves_.emplace_back(loose, solid);
    }
  }
}

bool GroupMaterial::in_cavity_of(size_t solid, const std::vector<int> &windings) const {
  for (size_t cavity : hosted_)
    if (windings[cavity] < 0 && parts_.host[group_[cavity]] == group_[solid])
      return true;
  for (size_t loose = 0; loose < loose_.size(); loose++)
    if (windings[loose_[loose]] < 0 &&
        std::binary_search(carves_.begin(), carves_.end(), std::make_pair(loose, solid)))
      return true;
  return false;
}

bool GroupMaterial::in_cavity_of_body(const std::vector<int> &windings) const {
  for (size_t cavity : hosted_)
    if (windings[cavity] < 0 && parts_.host[group_[cavity]] == body_)
      return true;
  for (size_t loose = 0; loose < loose_.size(); loose++)
    if (windings[loose_[loose]] < 0 && !contained_[loose])
      return true;
  return false;
}

bool GroupMaterial::inside(const std::vector<int> &windings) const {
  if (body_ != NO_PART && !in_cavity_of_body(windings))
    return true;
  for (size_t solid : solids_)
    if (encloses(solid, windings) && !in_cavity_of(solid, windings))
      return true;
  return false;
}

} // namespace vxm

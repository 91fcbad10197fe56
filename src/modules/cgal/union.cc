/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modules/cgal/functions.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <numeric>
#include <set>

#include "modules/cgal/exception_barrier.h"
#include "modules/cgal/group_material.h"
#include "modules/cgal/parts.h"
#include "modules/cgal/result.h"
#include "modules/cgal/solid.h"

namespace vxm {

namespace {

/** What becomes of a group of parts. */
enum class Fate {
  kept,    /**< as it is */
  covered, /**< all of it lies in the material of other parts */
  rebuilt, /**< the surface of its union is in the result */
  failed,  /**< kept as it is, because nothing else could be done */
  crumb    /**< left out: what is thinner than numbers tell, and was not so before */
};

/** Of the largest coordinate: a part that a union leaves, or a cavity without a solid around it, is a crumb
 * if it is no thicker. */
constexpr double CRUMB = 0x1p-22;

double area_of(const std::vector<Position> &points, const Corners &corners) {
  std::array<double, 3> across;
  for (size_t k = 0; k < 3; k++) {
    const Position &a = points[corners[0]], &b = points[corners[1]], &c = points[corners[2]];
    size_t v = (k + 1) % 3, w = (k + 2) % 3;
    across[k] = (b[v] - a[v]) * (c[w] - a[w]) - (b[w] - a[w]) * (c[v] - a[v]);
  }
  return std::hypot(across[0], across[1], across[2]) / 2;
}

/** Per part: whether it is closed and no thicker than a crumb. How thick a body is, tells its volume for its
 * surface: six times that of a cube is its side. */
std::vector<bool> thin_parts(const Triangles &triangles, const Parts &parts) {
  double largest = 0;
  for (const Position &p : triangles.points)
    for (double x : p)
      largest = std::max(largest, std::abs(x));
  std::vector<double> area(parts.parts.size(), 0);
  for (size_t t = 0; t < triangles.corners.size(); t++)
    area[parts.of_face[triangles.face[t]]] += area_of(triangles.points, triangles.corners[t]);
  std::vector<bool> out(parts.parts.size());
  for (size_t p = 0; p < out.size(); p++)
    out[p] = parts.parts[p].closed && 6 * parts.parts[p].volume <= CRUMB * largest * area[p];
  return out;
}

/** Takes the parts of a soup once and unites those that touch. */
class Union {
public:
  /**
   * @param thin   per part, as from thin_parts
   * @param crumbs per part: it is left out
   */
  Union(const vxm_soup *soup, const Triangles &triangles, const Parts &parts, const std::vector<bool> &thin,
        const std::vector<bool> &crumbs, bool single, Meter &meter)
      : soup_(soup), triangles_(triangles), parts_(parts), thin_(thin), crumbs_(crumbs), single_(single),
        meter_(meter), result_(soup, meter), triangles_of_group_(parts.groups.size()),
        skins_(parts.groups.size()), fates_(parts.groups.size(), Fate::kept), altered_(parts.parts.size()) {
    for (uint32_t t = 0; t < triangles.corners.size(); t++)
      if (!crumbs[parts.of_face[triangles.face[t]]])
        triangles_of_group_[group_of(triangles.face[t])].push_back(t);
  }

  /** Whether there are some that are to be left out. */
  bool has_crumbs() const {
    return std::find(crumbs_.begin(), crumbs_.end(), true) != crumbs_.end() ||
           std::any_of(parts_.groups.begin(), parts_.groups.end(), [this](const Group &group) {
             return has_only_cavities(group) && are_all(group, thin_);
           });
  }

  void run() {
    meter_.phase("uniting parts");
    size_t done = 0;
    for (uint32_t g : from_outside()) {
      meter_.progress((double)done / (double)(triangles_.corners.size() + 1));
      done += triangles_of_group_[g].size();
      fates_[g] = settle(g);
      if (fates_[g] == Fate::covered)
        for (uint32_t part : parts_.groups[g].parts)
          altered_[part] = true;
    }
    for (uint32_t g = 0; g < parts_.groups.size(); g++)
      if (fates_[g] == Fate::rebuilt) {
        add(skins_[g]);
        skins_[g] = Skin();
      }
  }

  /** Whether a part's surface is not all in the result, or in one with that of another part. */
  bool altered(uint32_t part) const {
    return altered_[part];
  }
  bool rebuilt(uint32_t part) const {
    return fates_[parts_.parts[part].group] == Fate::rebuilt;
  }
  bool failed(uint32_t part) const {
    return fates_[parts_.parts[part].group] == Fate::failed;
  }

  Owner finish(std::vector<uint64_t> *origin) {
    for (size_t f = 0; f < soup_->face_count; f++) {
      Fate fate = fates_[group_of(f)];
      if ((fate == Fate::kept || fate == Fate::failed) && !crumbs_[parts_.of_face[f]])
        result_.keep(f);
    }
    return Owner(result_.finish(origin));
  }

private:
  uint32_t group_of(uint64_t face) const {
    return parts_.parts[parts_.of_face[face]].group;
  }

  /** Groups, those that others lie in before these: what is taken from them must be known. */
  std::vector<uint32_t> from_outside() const {
    std::vector<uint32_t> out(parts_.groups.size());
    std::iota(out.begin(), out.end(), 0U);
    std::stable_sort(out.begin(), out.end(), [this](uint32_t a, uint32_t b) {
      return parts_.groups[a].around.size() < parts_.groups[b].around.size();
    });
    return out;
  }

  bool is_cavity_of(uint32_t cavity, uint32_t solid) const {
    return parts_.host[cavity] == solid || carved_.count({cavity, solid}) != 0 ||
           (parts_.host[cavity] == NO_PART && failed(cavity) &&
            parts_.parts[cavity].group == parts_.parts[solid].group);
  }

  /** The outward parts of other groups that have a group in their material. */
  std::vector<uint32_t> bodies_around(const Group &group) const {
    std::vector<uint32_t> out;
    for (uint32_t solid : group.around) {
      if (parts_.parts[solid].sign < 0)
        continue;
      bool in_cavity = false;
      for (uint32_t cavity : group.around)
        in_cavity = in_cavity || is_cavity_of(cavity, solid);
      if (!in_cavity)
        out.push_back(solid);
    }
    return out;
  }

  Fate settle(uint32_t g) {
    const Group &group = parts_.groups[g];
    if (are_all(group, crumbs_))
      return Fate::crumb;
    if (parts_.parts[group.parts[0]].sign == 0)
      return Fate::kept;
    std::vector<uint32_t> bodies = bodies_around(group);
    bool cavity_of_body = false;
    for (uint32_t part : group.parts)
      cavity_of_body = cavity_of_body || (bodies.size() == 1 && parts_.host[part] == bodies[0]);
    if (!bodies.empty() && !cavity_of_body)
      return Fate::covered;
    if (bodies.empty() && has_only_cavities(group))
      return are_all(group, thin_) ? Fate::crumb : Fate::failed;
    if (group.parts.size() == 1 && !group.meets)
      return Fate::kept;
    return rebuild(g, bodies.empty() ? NO_PART : bodies[0]);
  }

  bool has_only_cavities(const Group &group) const {
    return std::all_of(group.parts.begin(), group.parts.end(),
                       [this](uint32_t part) { return parts_.parts[part].sign < 0; });
  }

  /** @param marks per part */
  static bool are_all(const Group &group, const std::vector<bool> &marks) {
    return std::all_of(group.parts.begin(), group.parts.end(),
                       [&marks](uint32_t part) { return marks[part]; });
  }

  Fate rebuild(uint32_t g, uint32_t body) {
    const std::vector<uint32_t> &group = parts_.groups[g].parts;
    std::vector<PartTriangle> triangles;
    for (uint32_t t : triangles_of_group_[g]) {
      uint64_t face = triangles_.face[t];
      auto at = std::lower_bound(group.begin(), group.end(), parts_.of_face[face]);
      triangles.push_back({triangles_.corners[t], (uint32_t)(at - group.begin()), face});
    }
    Skin &skin = skins_[g];
    GroupMaterial material(parts_, group, body);
    try {
      if (!bound_solid(triangles_.points, triangles, group.size(), single_, &material, meter_, &skin))
        return Fate::failed;
    } catch (const std::bad_alloc &) {
      throw; /* also to stop */
    } catch (const std::exception &) {
      return Fate::failed;
    }
    for (size_t i = 0; i < group.size(); i++)
      altered_[group[i]] = skin.altered[i];
    material.carved([this](uint32_t cavity, uint32_t solid) { carved_.emplace(cavity, solid); });
    return Fate::rebuilt;
  }

  void add(const Skin &skin) {
    uint32_t first = result_.add_vertices(skin.points);
    for (size_t t = 0; t < skin.corners.size(); t++) {
      Corners corners = skin.corners[t];
      for (uint32_t &v : corners)
        v += first;
      result_.add_piece(corners, skin.face[t]);
    }
  }

  const vxm_soup *soup_;
  const Triangles &triangles_;
  const Parts &parts_;
  const std::vector<bool> &thin_, &crumbs_; /**< per part */
  bool single_;
  Meter &meter_;
  Result result_;
  std::vector<std::vector<uint32_t>> triangles_of_group_;
  std::vector<Skin> skins_; /**< per group: of one that was rebuilt */
  std::vector<Fate> fates_;
  std::set<std::pair<uint32_t, uint32_t>> carved_; /**< cavities without a host, and solids they take from */
  std::vector<bool> altered_;
};

/**
 * The union of all. Rounding moves vertices a little, so that parts which did not touch may do so afterwards:
 * then the result is taken for the input once more.
 */
class Passes {
public:
  Passes(const vxm_soup *soup, const vxm_union_options &options, Meter &meter)
      : soup_(soup), options_(options), meter_(meter), origin_(soup->face_count) {
    std::iota(origin_.begin(), origin_.end(), UINT64_C(0));
  }

  void run() {
    for (int pass = 0; pass < PASSES; pass++) {
      const vxm_soup *now = made_ != nullptr ? made_.get() : soup_;
      Triangles triangles = triangles_of(now, Naming::by_position, meter_);
      Parts parts = parts_of(now, triangles, options_.outward_only, meter_);
      std::vector<bool> thin = thin_parts(triangles, parts);
      if (pass == 0)
        start(parts, thin);
      std::vector<bool> crumbs = crumbs_of(parts, thin);
      Union step(now, triangles, parts, thin, crumbs, options_.single_precision, meter_);
      if (pass > 0 &&
          std::none_of(parts.groups.begin(), parts.groups.end(), [](const Group &g) { return g.meets; }) &&
          !step.has_crumbs())
        return;
      step.run();
      note(parts, step);
      std::vector<uint64_t> origin;
      made_ = step.finish(&origin);
      for (uint64_t &face : origin)
        face = origin_[face];
      origin_ = std::move(origin);
      if (untouched(parts))
        return;
    }
  }

  void finish(vxm_soup **out, uint64_t **origin, vxm_union_report *report) {
    std::vector<uint64_t> failed;
    for (const Known &part : known_) {
      report->parts += part.closed;
      report->cut += part.rebuilt && !part.united && !part.failed;
      report->united += part.united && !part.failed;
      if (part.failed)
        failed.push_back(part.first_face);
    }
    Block origins = copy_list(origin_, meter_), failed_faces = copy_list(failed, meter_);
    if (origin != nullptr)
      *origin = origins.release();
    report->failed = (int64_t)failed.size();
    report->failed_faces = failed.empty() ? nullptr : failed_faces.release();
    *out = made_.release();
  }

private:
  static constexpr int PASSES = 3;

  /** What is known of a part of the input. */
  struct Known {
    bool closed, thin, rebuilt, united, failed;
    uint64_t first_face;
  };

  void start(const Parts &parts, const std::vector<bool> &thin) {
    of_face_ = parts.of_face;
    for (uint32_t p = 0; p < parts.parts.size(); p++)
      known_.push_back({parts.parts[p].closed, thin[p], false, false, false, parts.parts[p].first_face});
  }

  /** Per part: whether it is thin, and left of such as were closed and were not thin. */
  std::vector<bool> crumbs_of(const Parts &parts, const std::vector<bool> &thin) const {
    std::vector<bool> out = thin;
    for (size_t f = 0; f < origin_.size(); f++) {
      const Known &from = known_[of_face_[origin_[f]]];
      if (from.thin || !from.closed)
        out[parts.of_face[f]] = false;
    }
    return out;
  }

  /** Nothing was there to be done. */
  static bool untouched(const Parts &parts) {
    return std::none_of(parts.groups.begin(), parts.groups.end(),
                        [](const Group &g) { return g.meets || g.parts.size() > 1; });
  }

  /** Carries what became of the parts over to those of the input. */
  void note(const Parts &parts, const Union &step) {
    for (size_t f = 0; f < origin_.size(); f++) {
      uint32_t part = parts.of_face[f];
      Known *known = &known_[of_face_[origin_[f]]];
      known->failed = known->failed || step.failed(part);
      known->rebuilt = known->rebuilt || step.rebuilt(part);
      known->united = known->united || (step.altered(part) && united(parts, part));
    }
  }

  /** A part that only meets itself is mended, not united. */
  static bool united(const Parts &parts, uint32_t part) {
    const Group &group = parts.groups[parts.parts[part].group];
    return group.parts.size() > 1 || !group.meets;
  }

  const vxm_soup *soup_;
  vxm_union_options options_;
  Meter &meter_;
  Owner made_;
  std::vector<uint64_t> origin_;
  std::vector<uint32_t> of_face_;
  std::vector<Known> known_;
};

} // namespace

vxm_status unite(vxm_soup **out, uint64_t **origin, vxm_union_report *report, const vxm_soup *soup,
                 const vxm_union_options *options, vxm_error *error) {
  *out = nullptr;
  if (origin != nullptr)
    *origin = nullptr;
  vxm_union_report local;
  vxm_union_report *told = report != nullptr ? report : &local;
  *told = vxm_union_report();
  return guarded(soup->context, "looking for parts that touch", error, [&](Meter &meter) {
    Passes passes(soup, options != nullptr ? *options : vxm_union_options(), meter);
    passes.run();
    passes.finish(out, origin, told);
  });
}

} // namespace vxm

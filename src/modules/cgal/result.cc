/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modules/cgal/result.h"

#include <algorithm>
#include <cstring>
#include <memory>

namespace vxm {

namespace {

constexpr uint32_t NONE = UINT32_MAX;

} // namespace

Block copy_list(const std::vector<uint64_t> &values, Meter &meter) {
  Block out(
      static_cast<uint64_t *>(vxm_alloc(meter.context(), values.size(), sizeof(uint64_t), meter.error())),
      FreeBlock{meter.context()});
  if (out == nullptr)
    throw Stopped(meter.error()->code);
  std::copy(values.begin(), values.end(), out.get());
  return out;
}

uint32_t Result::add_vertices(const std::vector<Position> &points) {
  size_t first = soup_->vertex_count + points_.size();
  if (first + points.size() > VXM_VERTICES_MAX)
    check(vxm_fail(meter_.error(), VXM_ERROR_RANGE, "the result has more than %zu vertices: split the mesh",
                   VXM_VERTICES_MAX));
  points_.insert(points_.end(), points.begin(), points.end());
  return (uint32_t)first;
}

const uint32_t *Result::corners(const Item &item, size_t *count) const {
  if (item.kept)
    return vxm_face(soup_, item.index, count);
  *count = 3;
  return corners_[item.index].data();
}

/** Vertices that are used or to be kept, in their order. */
void Result::make_vertices(vxm_soup *out, std::vector<uint32_t> *number) const {
  number->assign(soup_->vertex_count + points_.size(), NONE);
  if (all_vertices_)
    std::fill_n(number->begin(), soup_->vertex_count, 0U);
  for (const Item &item : items_) {
    size_t count;
    const uint32_t *corner = corners(item, &count);
    for (size_t c = 0; c < count; c++)
      (*number)[corner[c]] = 0;
  }
  for (size_t v = 0; v < number->size(); v++) {
    if ((*number)[v] == NONE)
      continue;
    (*number)[v] = (uint32_t)out->vertex_count;
    const double *p =
        v < soup_->vertex_count ? vxm_position(soup_, v) : points_[v - soup_->vertex_count].data();
    check(vxm_soup_add_vertex(out, p[0], p[1], p[2], meter_.error()));
  }
}

void Result::make_faces(vxm_soup *out, const std::vector<uint32_t> &number) const {
  std::vector<uint32_t> face;
  for (const Item &item : items_) {
    size_t count;
    const uint32_t *corner = corners(item, &count);
    face.clear();
    for (size_t c = 0; c < count; c++)
      face.push_back(number[corner[c]]);
    check(vxm_soup_add_face(out, face.data(), count, meter_.error()));
  }
}

void Result::make_tags(vxm_soup *out) const {
  if (soup_->face_tags == nullptr)
    return;
  uint32_t tag;
  for (size_t t = 0; t < soup_->tag_count; t++)
    check(vxm_soup_add_tag(out, soup_->tags[t], std::strlen(soup_->tags[t]), &tag, meter_.error()));
  out->face_tags = static_cast<uint32_t *>(
      vxm_alloc(meter_.context(), out->face_count, sizeof *out->face_tags, meter_.error()));
  if (out->face_tags == nullptr)
    throw Stopped(meter_.error()->code);
  for (size_t f = 0; f < out->face_count; f++)
    out->face_tags[f] = soup_->face_tags[items_[f].like];
}

vxm_soup *Result::finish(std::vector<uint64_t> *origin) {
  std::stable_sort(items_.begin(), items_.end(),
                   [](const Item &a, const Item &b) { return a.origin < b.origin; });
  vxm_soup *made;
  check(vxm_soup_create(&made, soup_->context, soup_->format, meter_.error()));
  Owner owner(made);
  made->warnings = soup_->warnings;
  std::vector<uint32_t> number;
  make_vertices(made, &number);
  make_faces(made, number);
  make_tags(made);
  for (const Item &item : items_)
    origin->push_back(item.origin);
  return owner.release();
}

} // namespace vxm

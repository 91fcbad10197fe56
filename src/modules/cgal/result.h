/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The soup that a function of the module makes of another one. */
#ifndef VXM_MODULES_CGAL_RESULT_H
#define VXM_MODULES_CGAL_RESULT_H

#include "modules/cgal/triangles.h"
#include "repair/external/cgal.h"

namespace vxm {

struct FreeBlock {
  vxm_context *context;
  void operator()(void *block) const {
    vxm_free(context, block);
  }
};
/** A block of a context that goes away with its owner. */
using Block = std::unique_ptr<uint64_t, FreeBlock>;

/** A list as a block of the meter's context; an empty one has a block too. */
Block copy_list(const std::vector<uint64_t> &values, Meter &meter);

/** Gathers faces that are kept and such that are added; the result has them in the order of what they come
 * from. */
class Result {
public:
  Result(const vxm_soup *soup, Meter &meter) : soup_(soup), meter_(meter) {
  }

  /** Keeps all vertices of the soup, with their numbers. */
  void keep_vertices() {
    all_vertices_ = true;
  }
  /** Keeps a face of the soup, on its vertices. */
  void keep(uint64_t face) {
    items_.push_back({face, face, face, true});
  }
  /** Adds vertices and gives the number of the first; the soup's own come before. */
  uint32_t add_vertices(const std::vector<Position> &points);
  /** Adds a triangle that is a piece of a face; its corners are numbered as add_vertices does. */
  void add_piece(const Corners &corners, uint64_t face) {
    items_.push_back({face, face, corners_.size(), false});
    corners_.push_back(corners);
  }
  /** Adds a triangle that is a piece of no face, with the tag of one. */
  void add_face(const Corners &corners, uint64_t like) {
    items_.push_back({VXM_NO_FACE, like, corners_.size(), false});
    corners_.push_back(corners);
  }

  /** Makes the soup, without vertices that are not used unless all are kept, and tells what each face comes
   * from. */
  vxm_soup *finish(std::vector<uint64_t> *origin);

private:
  struct Item {
    uint64_t origin;
    uint64_t like;  /**< face whose tag it has */
    uint64_t index; /**< of the soup's face, or in corners_ */
    bool kept;
  };

  const uint32_t *corners(const Item &item, size_t *count) const;
  void make_vertices(vxm_soup *out, std::vector<uint32_t> *number) const;
  void make_faces(vxm_soup *out, const std::vector<uint32_t> &number) const;
  void make_tags(vxm_soup *out) const;

  const vxm_soup *soup_;
  Meter &meter_;
  std::vector<Item> items_;
  std::vector<Position> points_;
  std::vector<Corners> corners_;
  bool all_vertices_ = false;
};

} // namespace vxm

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** The module "octomap" (gridio/formats/octomap.h): maps of OctoMap, made of pieces and written to a file.
 * octomap_read.cc reads. */
#include <octomap/OcTree.h>

#include <algorithm>
#include <cstdlib>
#include <new>
#include <ostream>
#include <sstream>
#include <streambuf>
#include <string>

#include "base/context.h"
#include "config.h"
#include "modules/octomap/octomap.h"

namespace {

/** Where a node lies: its first voxel, and its side. */
struct cube {
  int64_t at[3], side;

  cube child(unsigned c) const {
    int64_t half = side / 2;
    return {{at[0] + (c & 1 ? half : 0), at[1] + (c & 2 ? half : 0), at[2] + (c & 4 ? half : 0)}, half};
  }
};

/** A piece where it lies in the map. */
struct body {
  int64_t at[3], side;
  uint64_t bits;

  bool is_full() const {
    return bits == ~UINT64_C(0);
  }

  /** The part of a cube that meets the box of the piece, counted from the first voxel of that. */
  bool clip(const cube &c, int64_t begin[3], int64_t end[3]) const {
    for (int a = 0; a < 3; a++) {
      begin[a] = std::max<int64_t>(c.at[a] - at[a], 0);
      end[a] = std::min(c.at[a] + c.side - at[a], side);
      if (begin[a] >= end[a])
        return false;
    }
    return true;
  }

  bool has_any(const cube &c) const {
    int64_t begin[3], end[3];
    if (!clip(c, begin, end))
      return false;
    for (int64_t z = begin[2]; z < end[2] && !is_full(); z++)
      for (int64_t y = begin[1]; y < end[1]; y++)
        for (int64_t x = begin[0]; x < end[0]; x++)
          if (bits >> (16 * z + 4 * y + x) & 1)
            return true;
    return is_full();
  }

  /** Whether it fills a cube that it meets, told at once: a mixed piece fills voxels alone. */
  bool fills(const cube &c) const {
    int64_t begin[3], end[3];
    if (c.side > 1 && !is_full())
      return false;
    clip(c, begin, end);
    return (end[0] - begin[0]) * (end[1] - begin[1]) * (end[2] - begin[2]) == c.side * c.side * c.side;
  }
};

/** As many digits as a number needs to come back. */
int digits_of(double number) {
  for (int digits = 6; digits < 17; digits++) {
    std::ostringstream text;
    text.precision(digits);
    text << number;
    if (std::strtod(text.str().c_str(), nullptr) == number)
      return digits;
  }
  return 17;
}

/** A map that is made of cubes of any size. OctoMap's own ways to make a leaf begin with a voxel. */
class tree : public octomap::OcTree {
public:
  explicit tree(double resolution_of) : OcTree(resolution_of) {
  }

  void add(const body &piece) {
    const int64_t half = VXM_OCTOMAP_HALF;
    if (!root) {
      root = new octomap::OcTreeNode;
      tree_size++;
      size_changed = true;
    }
    fill(root, {{-half, -half, -half}, 2 * half}, piece);
  }

  /** As OctoMap's own way to write, which also prints, and keeps 6 digits of the resolution. */
  void write(std::ostream &to) const {
    to << binaryFileHeader << "\nid " << getTreeType() << "\nsize " << tree_size << "\nres ";
    to.precision(digits_of(resolution));
    to << resolution << "\ndata\n";
    if (root)
      writeBinaryNode(to, root);
  }

private:
  /** The root stays a node, as the format has no root that is a leaf. */
  void fill(octomap::OcTreeNode *node, const cube &where, const body &piece) {
    node->setLogOdds(clamping_thres_max);
    if (node != root && piece.fills(where))
      return;
    for (unsigned c = 0; c < 8; c++)
      if (piece.has_any(where.child(c))) {
        bool is_there = nodeChildExists(node, c);
        fill(is_there ? getNodeChild(node, c) : createNodeChild(node, c), where.child(c), piece);
      }
    if (node != root)
      pruneNode(node);
  }
};

/** Bytes on their way to a file. */
class sink : public std::streambuf {
public:
  explicit sink(vxm_output *to) : output(to) {
    setp(room, room + sizeof room);
  }

protected:
  int_type overflow(int_type c) override {
    sync();
    if (!traits_type::eq_int_type(c, traits_type::eof())) {
      *pptr() = traits_type::to_char_type(c);
      pbump(1);
    }
    return traits_type::not_eof(c);
  }

  int sync() override {
    vxm_output_write(output, pbase(), size_t(pptr() - pbase()));
    setp(room, room + sizeof room);
    return 0;
  }

private:
  vxm_output *output;
  char room[1 << 16];
};

vxm_status fail_memory(vxm_error *error) {
  return vxm_fail(error, VXM_ERROR_MEMORY, "OctoMap is out of memory");
}

} // namespace

struct vxm_octomap {
  vxm_context *context;
  int64_t first[3];
  tree map;
  size_t held = 0; /* bytes that the context counts */

  vxm_octomap(vxm_context *of, double resolution, const int64_t place[3])
      : context(of), first{place[0], place[1], place[2]}, map(resolution) {
  }
};

namespace {

/** Counts what the tree takes: a node, and for each of some the list of its children. Taken in steps. */
vxm_status hold(vxm_octomap &map, vxm_error *error) {
  constexpr size_t of_node = 64, step = 1 << 20;
  size_t now = map.map.size() * of_node;
  if (now <= map.held)
    return VXM_OK;
  vxm_status status = vxm_memory_take(map.context, now + step - map.held, error);
  if (status == VXM_OK)
    map.held = now + step;
  return status;
}

vxm_status create(vxm_octomap **out, vxm_context *context, double resolution, const int64_t first[3],
                  vxm_error *error) {
  *out = nullptr;
  try {
    *out = new vxm_octomap(context, resolution, first);
    return VXM_OK;
  } catch (const std::bad_alloc &) {
    return fail_memory(error);
  }
}

void destroy(vxm_octomap *map) {
  if (!map)
    return;
  vxm_memory_give(map->context, map->held);
  delete map;
}

vxm_status put(vxm_octomap *map, const vxm_sparse_piece *piece, vxm_error *error) {
  body where = {{0, 0, 0}, piece->side, piece->bits};
  for (int a = 0; a < 3; a++)
    where.at[a] = map->first[a] + piece->position[a];
  try {
    map->map.add(where);
    return hold(*map, error);
  } catch (const std::bad_alloc &) {
    return fail_memory(error);
  }
}

vxm_status write(const vxm_octomap *map, vxm_output *output, vxm_error *error) {
  try {
    sink bytes(output);
    std::ostream stream(&bytes);
    map->map.write(stream);
    stream.flush();
    return VXM_OK;
  } catch (const std::bad_alloc &) {
    return fail_memory(error);
  }
}

const vxm_octomap_functions functions = {vxm_octomap_reader, create, destroy, put, write};

} // namespace

extern "C" {
__attribute__((visibility("default"))) extern const vxm_module vxm_module_table;
const vxm_module vxm_module_table = {VXM_BUILD, "OctoMap " VXM_OCTOMAP_VERSION, "BSD-3-Clause", &functions};
}

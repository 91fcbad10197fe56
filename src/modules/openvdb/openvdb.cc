/* SPDX-License-Identifier: BSD-3-Clause */
/** The module "openvdb" (gridio/formats/vdb/vdb.h): trees of OpenVDB, made of blocks and written to a file.
 * openvdb_read.cc reads. */
#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <ostream>
#include <sstream>
#include <streambuf>

#include "base/hash.h"
#include "base/module.h"
#include "config.h"
#include "modules/openvdb/openvdb.h"

namespace {

using openvdb::BoolTree;
using openvdb::Coord;
using openvdb::FloatTree;

/** Runs `work`; what it throws becomes a status with a message of one line. */
template <typename Work> vxm_status guarded(vxm_error *error, Work &&work) {
  try {
    work();
    return VXM_OK;
  } catch (const vxm_vdb_failure &known) {
    return known.status;
  } catch (const std::bad_alloc &) {
    return vxm_fail(error, VXM_ERROR_MEMORY, "OpenVDB is out of memory");
  } catch (const std::exception &other) {
    return vxm_fail(error, VXM_ERROR_RANGE, "OpenVDB: %s", other.what());
  } catch (...) {
    return vxm_fail(error, VXM_ERROR_RANGE, "OpenVDB failed for a reason that it does not tell");
  }
}

/** OpenVDB counts voxels and frees trees in threads of TBB: no more than the context's, nor than TBB has, of
 * which it would warn on standard error. */
template <typename Work> void in_threads(const vxm_context *context, Work &&work) {
  size_t most = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  tbb::task_arena arena(int(std::min(most, size_t(vxm_context_threads(context)))));
  arena.execute(work);
}

} // namespace

struct vxm_vdb {
  vxm_context *context;
  vxm_vdb_kind kind;
  vxm_space space;
  openvdb::GridBase::Ptr grid;
  BoolTree *bits = nullptr;                         /* that of the grid, */
  FloatTree *numbers = nullptr;                     /* which is one of the two */
  size_t held = 0;                                  /* bytes that the context counts */
  Coord lower = Coord::max(), upper = Coord::max(); /* nodes that were found or made last */
};

namespace {

/* ---- Memory ---- */

/** What an allocation takes beside its size. */
constexpr size_t allocation = 32;

void hold(vxm_vdb &vdb, size_t bytes, vxm_error *error) {
  vxm_vdb_check(vxm_memory_take(vdb.context, bytes, error));
  vdb.held += bytes;
}

/** Counts a node of a level unless it is there already, as the next block or tile would make it. */
template <typename Node, typename Tree>
void hold_node(vxm_vdb &vdb, const Tree &tree, Coord at, Coord &last, vxm_error *error) {
  Coord key = at & ~Coord::ValueType(Node::DIM - 1);
  if (key == last)
    return;
  if (!tree.root().template probeConstNode<Node>(at))
    hold(vdb, sizeof(Node) + allocation, error);
  last = key;
}

/** Counts the nodes above a block, or a tile of a level. */
template <typename Tree>
void hold_path(vxm_vdb &vdb, const Tree &tree, Coord at, openvdb::Index level, vxm_error *error) {
  using upper = typename Tree::RootNodeType::ChildNodeType;
  using lower = typename upper::ChildNodeType;
  if (level <= upper::LEVEL)
    hold_node<upper>(vdb, tree, at, vdb.upper, error);
  if (level <= lower::LEVEL)
    hold_node<lower>(vdb, tree, at, vdb.lower, error);
}

/** The tree may have shrunk. */
void count_again(vxm_vdb &vdb) {
  const openvdb::TreeBase &tree = vdb.grid->constBaseTree();
  vdb.lower = vdb.upper = Coord::max();
  size_t now = size_t(tree.memUsage()) + size_t(tree.leafCount()) * 2 * allocation;
  if (now < vdb.held) {
    vxm_memory_give(vdb.context, vdb.held - now);
    vdb.held = now;
  }
}

/* ---- Blocks ---- */

Coord coord_of(const int64_t at[3]) {
  return Coord(int32_t(at[0]), int32_t(at[1]), int32_t(at[2]));
}

void put_bits(vxm_vdb &vdb, const int64_t at[3], const uint64_t bits[8], vxm_error *error) {
  using leaf_node = BoolTree::LeafNodeType;
  BoolTree &tree = *vdb.bits;
  hold_path(vdb, tree, coord_of(at), 0, error);
  hold(vdb, sizeof(leaf_node) + allocation, error);
  auto leaf = std::make_unique<leaf_node>(coord_of(at));
  for (openvdb::Index x = 0; x < VXM_VDB_SIDE; x++) {
    leaf->getValueMask().getWord<uint64_t>(x) = bits[x];
    leaf->buffer().data()[x] = bits[x];
  }
  tree.root().addLeaf(leaf.release());
}

/** -0 is another number than 0, and would become 0 where it is not active. */
bool is_active(const vxm_vdb &vdb, float number) {
  float background = vdb.kind.background;
  return std::memcmp(&number, &background, sizeof number) != 0 &&
         !(vdb.kind.content == VXM_VDB_LEVEL_SET && number == -background);
}

void put_numbers(vxm_vdb &vdb, const int64_t at[3], const float numbers[VXM_VDB_VOXELS], vxm_error *error) {
  using leaf_node = FloatTree::LeafNodeType;
  FloatTree &tree = *vdb.numbers;
  hold_path(vdb, tree, coord_of(at), 0, error);
  hold(vdb, sizeof(leaf_node) + VXM_VDB_VOXELS * sizeof(float) + 2 * allocation, error);
  auto leaf = std::make_unique<leaf_node>(coord_of(at));
  std::memcpy(leaf->buffer().data(), numbers, VXM_VDB_VOXELS * sizeof(float));
  for (openvdb::Index v = 0; v < VXM_VDB_VOXELS; v++)
    leaf->getValueMask().set(v, is_active(vdb, numbers[v]));
  tree.root().addLeaf(leaf.release());
}

template <typename Tree, typename Value>
void put_tiles(vxm_vdb &vdb, Tree &tree, const int64_t at[3], int64_t side, Value value, bool active,
               vxm_error *error) {
  openvdb::Index level = side >= 4096 ? 3 : side >= 128 ? 2 : 1;
  int64_t step = level == 3 ? 4096 : level == 2 ? 128 : 8, tile[3];
  for (tile[0] = at[0]; tile[0] < at[0] + side; tile[0] += step)
    for (tile[1] = at[1]; tile[1] < at[1] + side; tile[1] += step)
      for (tile[2] = at[2]; tile[2] < at[2] + side; tile[2] += step) {
        hold_path(vdb, tree, coord_of(tile), level, error);
        tree.root().addTile(level, coord_of(tile), value, active);
      }
}

void put_cube(vxm_vdb &vdb, const int64_t at[3], int64_t side, float number, vxm_error *error) {
  if (vdb.bits)
    put_tiles(vdb, *vdb.bits, at, side, true, true, error);
  else
    put_tiles(vdb, *vdb.numbers, at, side, number, is_active(vdb, number), error);
}

/* ---- The grid ---- */

openvdb::Vec3d vector_of(const double v[3]) {
  return openvdb::Vec3d(v[0], v[1], v[2]);
}

/**
 * Index coordinates are those of centres in OpenVDB, so that voxel (0,0,0) is half a voxel from the corner.
 * The transform is read as from a file, because given as a map it would be decomposed, and rounded.
 */
openvdb::math::Transform::Ptr transform_of(const vxm_space &space) {
  openvdb::Vec3d size = vector_of(space.voxel_size), inverse = 1.0 / size;
  bool is_uniform = size[0] == size[1] && size[1] == size[2];
  std::stringstream text;
  openvdb::io::setCurrentVersion(text);
  openvdb::writeString(text, is_uniform ? "UniformScaleTranslateMap" : "ScaleTranslateMap");
  for (const openvdb::Vec3d &part :
       {vector_of(space.origin) + size / 2, size, size, inverse, inverse * inverse, inverse / 2})
    part.write(text);
  auto transform = std::make_shared<openvdb::math::Transform>();
  transform->read(text);
  return transform;
}

/** Whether OpenVDB can copy a transform, which it does before it writes: for that the matrix must be far from
 * singular. */
void check_space(const vxm_space &space, vxm_error *error) {
  openvdb::initialize();
  try {
    transform_of(space)->copy();
  } catch (const openvdb::ArithmeticError &) {
    const double *size = space.voxel_size, *origin = space.origin;
    vxm_vdb_check(vxm_fail(
        error, VXM_ERROR_RANGE,
        "OpenVDB cannot hold voxels of %g x %g x %g at (%g, %g, %g); give the model in another unit, or "
        "choose another format",
        size[0], size[1], size[2], origin[0], origin[1], origin[2]));
  }
}

void describe(openvdb::GridBase &grid, const vxm_vdb &vdb) {
  using namespace openvdb;
  const vxm_space &space = vdb.space;
  grid.setName(vdb.kind.name);
  grid.setCreator(PACKAGE_STRING);
  grid.setTransform(transform_of(space));
  if (vdb.kind.content == VXM_VDB_LEVEL_SET)
    grid.setGridClass(GRID_LEVEL_SET);
  if (vdb.kind.content == VXM_VDB_FOG)
    grid.setGridClass(GRID_FOG_VOLUME);
  for (const char *const *text = vdb.kind.texts; text && *text; text += 2)
    if (!grid[text[0]])
      grid.insertMeta(text[0], StringMetadata(text[1]));
  grid.insertMeta("voxmend_dims",
                  Vec3IMetadata(Vec3i(int(space.dims[0]), int(space.dims[1]), int(space.dims[2]))));
  grid.insertMeta("voxmend_origin", Vec3DMetadata(vector_of(space.origin)));
  grid.insertMeta("voxmend_voxel_size", Vec3DMetadata(vector_of(space.voxel_size)));
}

void create(vxm_vdb &vdb) {
  openvdb::initialize();
  bool is_bits = vdb.kind.content == VXM_VDB_BITS;
  vdb.grid = openvdb::GridBase::createGrid(is_bits ? "Tree_bool_5_4_3" : "Tree_float_5_4_3");
  if (is_bits)
    vdb.bits = static_cast<BoolTree *>(&vdb.grid->baseTree());
  else {
    vdb.numbers = static_cast<FloatTree *>(&vdb.grid->baseTree());
    vdb.numbers->root().setBackground(vdb.kind.background, false);
  }
  describe(*vdb.grid, vdb);
}

/* ---- The identifier ---- */

/**
 * The UUID of a file is to tell files apart. OpenVDB draws it at random; so that equal grids give equal files
 * it is made of their content instead: version 8 of RFC 9562.
 */
constexpr uint64_t id_begin = 21, id_length = 36;

struct identity {
  uint64_t a = 1, b = 2;

  void add(uint64_t word) {
    a = vxm_hash_word(a, word);
    b = vxm_hash_word(b, a);
  }

  void add(const Coord &at) {
    add(uint64_t(uint32_t(at.x())) | uint64_t(uint32_t(at.y())) << 32);
    add(uint64_t(uint32_t(at.z())));
  }

  void text(char out[id_length + 1]) const {
    snprintf(out, id_length + 1, "%08x-%04x-8%03x-%04x-%012llx", unsigned(a >> 32),
             unsigned(a >> 16 & 0xffff), unsigned(a & 0xfff), unsigned(b >> 48 & 0x3fff) | 0x8000u,
             static_cast<unsigned long long>(b & 0xffffffffffff));
  }
};

/** Sums, which the processor makes side by side; where the words stand counts. */
uint64_t hash_of(const void *data, size_t words) {
  uint64_t sum = 0, word;
  for (size_t w = 0; w < words; w++) {
    std::memcpy(&word, static_cast<const char *>(data) + 8 * w, sizeof word);
    sum += vxm_mix(word + (w + 1) * UINT64_C(0x9e3779b97f4a7c15));
  }
  return sum;
}

const void *content_of(const BoolTree::LeafNodeType &leaf, size_t &words) {
  words = VXM_VDB_VOXELS / 64;
  return leaf.buffer().data();
}

const void *content_of(const FloatTree::LeafNodeType &leaf, size_t &words) {
  words = VXM_VDB_VOXELS / 2;
  return leaf.buffer().data();
}

template <typename Node> void add_tiles(identity &id, const Node &node) {
  id.add(node.origin());
  id.add(hash_of(&node.getValueMask(), sizeof node.getValueMask() / 8));
  for (auto child = node.cbeginChildOn(); child; ++child) {
    if constexpr (Node::LEVEL > 1)
      add_tiles(id, *child);
    else {
      size_t words;
      const void *content = content_of(*child, words);
      id.add(child->origin());
      id.add(hash_of(content, words));
    }
  }
}

template <typename Tree> identity identity_of(const vxm_vdb &vdb, const Tree &tree) {
  identity id;
  for (int a = 0; a < 3; a++) {
    uint64_t words[3] = {uint64_t(vdb.space.dims[a]), 0, 0};
    std::memcpy(&words[1], &vdb.space.origin[a], 8);
    std::memcpy(&words[2], &vdb.space.voxel_size[a], 8);
    id.add(hash_of(words, 3));
  }
  id.add(uint64_t(vdb.kind.content));
  for (auto child = tree.root().cbeginChildOn(); child; ++child)
    add_tiles(id, *child);
  for (auto tile = tree.root().cbeginValueOn(); tile; ++tile)
    id.add(tile.getCoord());
  return id;
}

/* ---- Writing ---- */

/** Passes on what OpenVDB writes, with the identifier put in, and reports progress. */
class sink : public std::streambuf {
public:
  sink(vxm_vdb &of, vxm_output *to, const identity &id, uint64_t bytes, vxm_error *why)
      : vdb(of), output(to), expected(bytes), error(why) {
    id.text(text);
  }

  vxm_status status = VXM_OK; /* why a write was refused */

protected:
  std::streamsize xsputn(const char *data, std::streamsize count) override {
    uint64_t size = uint64_t(count);
    if (at != end) {
      vxm_output_patch(output, at, data, size);
      at += size;
    } else {
      append(data, size);
      at = end += size;
    }
    return good() ? count : 0;
  }

  int_type overflow(int_type c) override {
    char byte = traits_type::to_char_type(c);
    return xsputn(&byte, 1) == 1 ? c : traits_type::eof();
  }

  pos_type seekoff(off_type offset, std::ios_base::seekdir way, std::ios_base::openmode) override {
    return seekpos(off_type(way == std::ios_base::beg   ? 0
                            : way == std::ios_base::cur ? at
                                                        : end) +
                       offset,
                   std::ios_base::out);
  }

  pos_type seekpos(pos_type position, std::ios_base::openmode) override {
    at = uint64_t(off_type(position));
    return position;
  }

private:
  static constexpr uint64_t report_step = 1 << 20;

  vxm_vdb &vdb;
  vxm_output *output;
  uint64_t at = 0, end = 0, reported = 0, expected;
  vxm_error *error;
  char text[id_length + 1];

  void append(const char *data, uint64_t size) {
    for (uint64_t i = 0; i < size && end + i < id_begin + id_length; i++)
      vxm_output_write(output, end + i < id_begin ? data + i : text + (end + i - id_begin), 1);
    uint64_t head = id_begin + id_length - std::min(end, id_begin + id_length);
    if (size > head)
      vxm_output_write(output, data + head, size - head);
  }

  bool good() {
    if (status == VXM_OK && end - reported >= report_step) {
      reported = end;
      if (vxm_output_failed(output))
        status = VXM_ERROR_IO;
      else
        status =
            vxm_progress(vdb.context, "packing", double(std::min(end, expected)) / double(expected), error);
    }
    return status == VXM_OK;
  }
};

/** Opens what an archive keeps for its own files. */
struct archive : openvdb::io::Archive {
  void put(std::ostream &stream, const openvdb::GridBase::Ptr &grid, bool seekable) const {
    openvdb::MetaMap about;
    about.insertMeta("creator", openvdb::StringMetadata(PACKAGE_STRING));
    openvdb::io::Archive::write(stream, openvdb::GridCPtrVec{grid}, seekable, about);
  }
};

template <typename Tree> void write_tree(vxm_vdb &vdb, Tree &tree, vxm_output *output, vxm_error *error) {
  tree.root().prune();
  count_again(vdb);
  sink to(vdb, output, identity_of(vdb, tree), vdb.held + 1, error);
  std::ostream stream(&to);
  try {
    stream.exceptions(std::ios_base::badbit | std::ios_base::failbit);
    archive().put(stream, vdb.grid, vxm_output_can_patch(output));
  } catch (const std::exception &) {
    vxm_vdb_check(to.status);
    throw;
  }
}

void write(vxm_vdb &vdb, vxm_output *output, vxm_error *error) {
  if (vdb.bits)
    write_tree(vdb, *vdb.bits, output, error);
  else
    write_tree(vdb, *vdb.numbers, output, error);
}

/* ---- The table ---- */

vxm_status vdb_check(const vxm_space *space, vxm_error *error) {
  return guarded(error, [&] { check_space(*space, error); });
}

vxm_status vdb_create(vxm_vdb **out, vxm_context *context, const vxm_vdb_kind *kind, const vxm_space *space,
                      vxm_error *error) {
  *out = nullptr;
  return guarded(error, [&] {
    auto vdb = std::make_unique<vxm_vdb>();
    vdb->context = context;
    vdb->kind = *kind;
    vdb->space = *space;
    create(*vdb);
    *out = vdb.release();
  });
}

void vdb_destroy(vxm_vdb *vdb) {
  if (!vdb)
    return;
  vxm_memory_give(vdb->context, vdb->held);
  guarded(nullptr, [&] { in_threads(vdb->context, [&] { delete vdb; }); });
}

vxm_status vdb_put_bits(vxm_vdb *vdb, const int64_t at[3], const uint64_t bits[8], vxm_error *error) {
  return guarded(error, [&] { put_bits(*vdb, at, bits, error); });
}

vxm_status vdb_put_numbers(vxm_vdb *vdb, const int64_t at[3], const float numbers[VXM_VDB_VOXELS],
                           vxm_error *error) {
  return guarded(error, [&] { put_numbers(*vdb, at, numbers, error); });
}

vxm_status vdb_put_cube(vxm_vdb *vdb, const int64_t at[3], int64_t side, float number, vxm_error *error) {
  return guarded(error, [&] { put_cube(*vdb, at, side, number, error); });
}

vxm_status vdb_write(vxm_vdb *vdb, vxm_output *output, vxm_error *error) {
  return guarded(error, [&] { in_threads(vdb->context, [&] { write(*vdb, output, error); }); });
}

const vxm_vdb_functions functions = {vxm_vdb_reader, vdb_check,       vdb_create,   vdb_destroy,
                                     vdb_put_bits,   vdb_put_numbers, vdb_put_cube, vdb_write};

} // namespace

extern "C" {
extern VXM_API const vxm_module vxm_module_table;
const vxm_module vxm_module_table = {VXM_BUILD, "OpenVDB " OPENVDB_LIBRARY_VERSION_STRING,
                                     "BSD-3-Clause AND MPL-2.0", &functions};
}

/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Files in, by OpenVDB, in a process that ends afterwards (sandbox/reader_main.c). OpenVDB trusts what it
 * reads. So its stream throws where the file ends; and no grid is ever destroyed, because one that was read
 * in part has pointers to nothing, and because OpenVDB frees trees in threads, which this process may not
 * start.
 */
#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cstring>
#include <istream>
#include <streambuf>
#include <string>
#include <type_traits>
#include <vector>

#include "base/context.h"
#include "modules/openvdb/openvdb.h"

namespace {

using openvdb::Coord;
using openvdb::GridBase;

/** Progress: half of it for OpenVDB's reading, the rest for the sending of what it has read. */
constexpr double reading_part = 0.5;

/* ---- The file ---- */

/** The file in memory, which tells progress as it is read. */
class source : public std::streambuf {
public:
  source(vxm_context *of, const vxm_reader_request &request, vxm_error *why)
      : context(of), begin(const_cast<char *>(reinterpret_cast<const char *>(request.data))),
        size(request.size), error(why) {
    place(0);
  }

  /** How many bytes were read, up to those at which a reader failed. */
  size_t at() const {
    return size_t(gptr() - begin);
  }

protected:
  int_type underflow() override {
    if (at() == size)
      return traits_type::eof();
    vxm_vdb_check(vxm_progress(context, "reading", reading_part * double(at()) / double(size), error));
    place(at());
    return traits_type::to_int_type(*gptr());
  }

  pos_type seekoff(off_type offset, std::ios_base::seekdir way, std::ios_base::openmode which) override {
    off_type from = way == std::ios_base::beg ? 0 : off_type(way == std::ios_base::cur ? at() : size);
    return seekpos(from + offset, which);
  }

  pos_type seekpos(pos_type position, std::ios_base::openmode) override {
    off_type to = position;
    if (to < 0 || uint64_t(to) > size)
      return pos_type(off_type(-1));
    place(size_t(to));
    return position;
  }

private:
  static constexpr size_t step = 1 << 20;

  vxm_context *context;
  char *begin;
  size_t size;
  vxm_error *error;

  void place(size_t to) {
    setg(begin, begin + to, begin + std::min(size, to + step));
  }
};

/** All that reading takes. */
struct reading {
  vxm_voxel_sink *sink;
  vxm_context *context;
  const vxm_reader_request *request;
  vxm_error *error;
  source bytes;
  std::istream stream;
  size_t leaves = 0, sent = 0;

  reading(vxm_voxel_sink *to, vxm_context *of, const vxm_reader_request *file, vxm_error *why)
      : sink(to), context(of), request(file), error(why), bytes(of, *file, why), stream(&bytes) {
    stream.exceptions(std::ios_base::badbit | std::ios_base::failbit);
  }

  [[noreturn]] void fail(size_t at, const std::string &what, vxm_status status = VXM_ERROR_FORMAT) const {
    throw vxm_vdb_failure{
        vxm_fail_at(error, status, vxm_place{request->name, 0, int64_t(at), -1}, "%s", what.c_str())};
  }
};

/** Keeps a grid for ever. */
GridBase::Ptr keep(GridBase::Ptr grid) {
  static auto *kept = new std::vector<GridBase::Ptr>;
  kept->push_back(grid);
  return grid;
}

/* ---- Before the tree ---- */

/** The types that can be read, as OpenVDB names them. */
constexpr const char *bool_type = "Tree_bool_5_4_3", *mask_type = "Tree_mask_5_4_3",
                     *float_type = "Tree_float_5_4_3";

bool is_known(const std::string &type) {
  return type == bool_type || type == mask_type || type == float_type;
}

/** Opens what an archive keeps for its own files. */
struct archive : openvdb::io::Archive {
  int32_t count = 0;
  openvdb::io::StreamMetadata::Ptr metadata{
      new openvdb::io::StreamMetadata}; /* the stream points to this pointer */

  void open(reading &r) {
    std::istream &stream = r.stream;
    readHeader(stream);
    if (fileVersion() < openvdb::OPENVDB_FILE_VERSION_GRID_INSTANCING)
      r.fail(8, "version " + std::to_string(fileVersion()) + " of the format is too old");
    openvdb::io::setStreamMetadataPtr(stream, metadata, false);
    openvdb::io::setVersion(stream, libraryVersion(), fileVersion());
    openvdb::io::setDataCompression(stream, compression());
    openvdb::MetaMap().readMeta(stream);
    count = readGridCount(stream);
    if (count <= 0)
      r.fail(r.bytes.at(), "the file has no grid");
  }

  /** Finds the first grid that can be read. Where the next one begins is told only in files that can be read
   * in any order. */
  GridBase::Ptr find(reading &r, openvdb::io::GridDescriptor &out) {
    size_t begin = 0;
    for (int32_t g = 0; g < count; g++) {
      begin = r.bytes.at();
      out = openvdb::io::GridDescriptor();
      GridBase::Ptr grid = keep(out.read(r.stream));
      int64_t here = int64_t(r.bytes.at()), end = out.getEndPos();
      if (inputHasGridOffsets() && end > int64_t(r.request->size))
        r.fail(size_t(here) - 24, "the file is cut short");
      if (inputHasGridOffsets() && (out.getGridPos() != here || end < here))
        r.fail(size_t(here) - 24, "the offsets of a grid are damaged");
      if (!out.isInstance() && is_known(out.gridType()))
        return grid;
      if (!inputHasGridOffsets())
        break;
      out.seekToEnd(r.stream);
    }
    r.fail(begin, "no grid here can be read (" + std::to_string(count) + " of them, the last a \"" +
                      out.gridType() + "\"): only those of bool, mask and float can");
  }

  /** What stands before the tree: the same again when the grid is read. */
  static void read_front(std::istream &stream, GridBase &grid) {
    readGridCompression(stream);
    grid.readMeta(stream);
  }

  static void read_all(std::istream &stream, const GridBase::Ptr &grid,
                       const openvdb::io::GridDescriptor &what) {
    readGrid(grid, what, stream);
  }
};

void put(double out[3], const openvdb::Vec3d &v) {
  for (int a = 0; a < 3; a++)
    out[a] = v[a];
}

/** The size of voxels, and the centre of the first. Matrices act on row vectors: the translation is their
 * last row. */
bool put_matrix(vxm_sink_grid &out, const openvdb::Mat4d &m) {
  bool is_plain = m(3, 3) == 1;
  for (int row = 0; row < 3; row++)
    for (int column = 0; column < 4; column++)
      is_plain = is_plain && (row == column || m(row, column) == 0);
  put(out.voxel_size, openvdb::Vec3d(m(0, 0), m(1, 1), m(2, 2)));
  put(out.first, openvdb::Vec3d(m(3, 0), m(3, 1), m(3, 2)));
  return is_plain;
}

/** The numbers as they stand in the file: OpenVDB's own ways to ask for them invert matrices, and refuse
 * small ones. */
bool put_map(vxm_sink_grid &out, const openvdb::math::MapBase &map) {
  using namespace openvdb::math;
  put(out.voxel_size, openvdb::Vec3d(1));
  put(out.first, openvdb::Vec3d(0));
  if (map.isType<ScaleTranslateMap>() || map.isType<UniformScaleTranslateMap>()) {
    const auto &known = static_cast<const ScaleTranslateMap &>(map);
    put(out.voxel_size, known.getScale());
    put(out.first, known.getTranslation());
  } else if (map.isType<ScaleMap>() || map.isType<UniformScaleMap>())
    put(out.voxel_size, static_cast<const ScaleMap &>(map).getScale());
  else if (map.isType<TranslationMap>())
    put(out.first, static_cast<const TranslationMap &>(map).getTranslation());
  else
    return put_matrix(out, map.getAffineMap()->getMat4());
  return true;
}

void put_transform(vxm_sink_grid &out, const reading &r, size_t at,
                   const openvdb::math::Transform &transform) {
  if (!transform.isLinear())
    r.fail(at, "its transform is not linear: the grid has no voxels of one size");
  bool is_plain = put_map(out, *transform.baseMap());
  for (int a = 0; a < 3; a++)
    is_plain = is_plain && out.voxel_size[a] > 0;
  if (!is_plain)
    r.fail(at, "its axes are turned or mirrored; only grids along x, y and z can be read");
}

/** NULL if there is none of this type. */
template <typename Type> const Type *metadata_of(const GridBase &grid, const char *name) {
  openvdb::Metadata::ConstPtr found = grid[name];
  return found && found->typeName() == Type::staticTypeName() ? static_cast<const Type *>(found.get())
                                                              : nullptr;
}

/** What voxmend adds to its grids, which counts only together. */
void put_space(vxm_sink_grid &out, const GridBase &grid) {
  auto dims = metadata_of<openvdb::Vec3IMetadata>(grid, "voxmend_dims");
  auto origin = metadata_of<openvdb::Vec3DMetadata>(grid, "voxmend_origin");
  auto size = metadata_of<openvdb::Vec3DMetadata>(grid, "voxmend_voxel_size");
  out.has_space = dims && origin && size;
  if (!out.has_space)
    return;
  for (int a = 0; a < 3; a++)
    out.space.dims[a] = dims->value()[a];
  put(out.space.origin, origin->value());
  put(out.space.voxel_size, size->value());
}

void send_texts(const reading &r, const GridBase &grid) {
  for (auto pair = grid.beginMeta(); pair != grid.endMeta(); ++pair)
    if (pair->second && pair->second->typeName() == openvdb::StringMetadata::staticTypeName()) {
      const std::string &key = pair->first,
                        &value = static_cast<const openvdb::StringMetadata &>(*pair->second).value();
      vxm_vdb_check(
          r.sink->text(r.sink->payload, key.data(), key.size(), value.data(), value.size(), r.error));
    }
}

/** Sends what is known before the tree, and goes back to where the grid begins. */
void send_front(reading &r, GridBase &grid, const archive &file, const openvdb::io::GridDescriptor &what) {
  size_t begin = r.bytes.at();
  vxm_sink_grid out = {};
  file.read_front(r.stream, grid);
  size_t transform = r.bytes.at();
  grid.readTransform(r.stream);
  put_transform(out, r, transform, grid.constTransform());
  what.gridName().copy(out.name, sizeof out.name - 1);
  out.is_numbers = what.gridType() == float_type;
  out.grids = uint32_t(file.count);
  out.at = r.bytes.at();
  put_space(out, grid);
  send_texts(r, grid);
  vxm_vdb_check(r.sink->grid(r.sink->payload, &out, r.error));
  r.stream.seekg(std::streamoff(begin));
}

/* ---- The tree ---- */

/** The most that is believed of a place, so that a box of such places has a size. */
constexpr int32_t farthest = 1 << 30;

/** That nodes lie where their parents have them, so that none lies upon another, and hold what their masks
 * say. */
template <typename Node> void check_node(reading &r, const Node &node, const Coord &at) {
  if (node.origin() != at)
    r.fail(r.bytes.at(), "the place of a node is damaged");
  if constexpr (Node::LEVEL > 0) {
    if (!(node.getChildMask() & node.getValueMask()).isOff())
      r.fail(r.bytes.at(), "the masks of a node are damaged");
    for (auto child = node.cbeginChildOn(); child; ++child)
      check_node(r, *child, child.getCoord());
  } else
    r.leaves++;
}

template <typename Root> void check_place(const reading &r, const Coord &at) {
  for (size_t a = 0; a < 3; a++)
    if (at[a] % int32_t(Root::ChildNodeType::DIM) != 0 || at[a] < -farthest || at[a] > farthest)
      r.fail(r.bytes.at(), "the place of a node is damaged, or beyond 2^30 voxels");
}

template <typename Root> void check_root(reading &r, const Root &root) {
  for (auto tile = root.cbeginValueAll(); tile; ++tile)
    check_place<Root>(r, tile.getCoord());
  for (auto child = root.cbeginChildOn(); child; ++child) {
    check_place<Root>(r, child.getCoord());
    check_node(r, *child, child.getCoord());
  }
}

template <typename Tree> void send_extent(const reading &r, const Tree &tree) {
  vxm_sink_extent out = {};
  openvdb::CoordBBox box;
  out.is_empty = !tree.evalActiveVoxelBoundingBox(box);
  for (size_t a = 0; a < 3 && !out.is_empty; a++) {
    out.low[a] = box.min()[a];
    out.high[a] = box.max()[a];
  }
  if constexpr (std::is_same_v<Tree, openvdb::FloatTree>)
    out.background = tree.background();
  vxm_vdb_check(r.sink->extent(r.sink->payload, &out, r.error));
}

struct place {
  int64_t at[3];
  explicit place(const Coord &c) : at{c.x(), c.y(), c.z()} {
  }
};

/** Of bits those that are active and true; of masks the active ones; of floats whatever is not the
 * background. */
template <typename Tree, typename Tile>
void send_tile(const reading &r, const Tree &tree, const Tile &tile, int64_t side) {
  if constexpr (std::is_same_v<Tree, openvdb::FloatTree>) {
    float number = *tile, background = tree.background();
    if (std::memcmp(&number, &background, sizeof number) != 0) /* -0 is another one than 0 */
      r.sink->cube(r.sink->payload, place(tile.getCoord()).at, side, *tile);
  } else if (tile.isValueOn() && (std::is_same_v<Tree, openvdb::MaskTree> || *tile))
    r.sink->cube(r.sink->payload, place(tile.getCoord()).at, side, 1);
}

void send_leaf(const reading &r, const openvdb::FloatTree &, const openvdb::FloatTree::LeafNodeType &leaf) {
  r.sink->numbers(r.sink->payload, place(leaf.origin()).at, leaf.buffer().data());
}

template <typename Tree>
void send_leaf(const reading &r, const Tree &, const typename Tree::LeafNodeType &leaf) {
  uint64_t bits[VXM_SINK_SIDE];
  for (openvdb::Index x = 0; x < VXM_SINK_SIDE; x++) {
    bits[x] = leaf.getValueMask().template getWord<uint64_t>(x);
    if constexpr (std::is_same_v<Tree, openvdb::BoolTree>)
      bits[x] &= leaf.buffer().data()[x];
  }
  r.sink->bits(r.sink->payload, place(leaf.origin()).at, bits);
}

template <typename Tree, typename Node> void send_node(reading &r, const Tree &tree, const Node &node) {
  constexpr size_t leaves_per_report = 1 << 14;
  if constexpr (Node::LEVEL > 0) {
    for (auto tile = node.cbeginValueAll(); tile; ++tile)
      send_tile(r, tree, tile, int64_t(Node::ChildNodeType::DIM));
    for (auto child = node.cbeginChildOn(); child; ++child)
      send_node(r, tree, *child);
  } else {
    send_leaf(r, tree, node);
    if (++r.sent % leaves_per_report == 0)
      vxm_vdb_check(vxm_progress(r.context, "reading",
                                 reading_part + (1 - reading_part) * double(r.sent) / double(r.leaves),
                                 r.error));
  }
}

template <typename Tree> void send_tree(reading &r, const GridBase &grid) {
  const Tree &tree = static_cast<const Tree &>(grid.constBaseTree());
  check_root(r, tree.root());
  send_extent(r, tree);
  send_node(r, tree, tree.root());
}

void read_file(reading &r) {
  archive file;
  openvdb::io::GridDescriptor what;
  file.open(r);
  GridBase::Ptr grid = file.find(r, what);
  send_front(r, *grid, file, what);
  file.read_all(r.stream, grid, what);
  if (what.gridType() == bool_type)
    send_tree<openvdb::BoolTree>(r, *grid);
  else if (what.gridType() == mask_type)
    send_tree<openvdb::MaskTree>(r, *grid);
  else
    send_tree<openvdb::FloatTree>(r, *grid);
}

/* ---- The table ---- */

vxm_status read_grid(vxm_voxel_sink *sink, vxm_context *context, const vxm_reader_request *request,
                     vxm_error *error) {
  reading r(sink, context, request, error);
  vxm_place here = {request->name, 0, 0, -1};
  try {
    read_file(r);
    return VXM_OK;
  } catch (const vxm_vdb_failure &known) {
    return known.status;
  } catch (const std::bad_alloc &) {
    return vxm_fail(error, VXM_ERROR_MEMORY, "OpenVDB is out of memory");
  } catch (const std::ios_base::failure &) {
    here.offset = int64_t(r.bytes.at());
    return vxm_fail_at(error, VXM_ERROR_FORMAT, here, "the file is cut short, or a length in it is damaged");
  } catch (const std::exception &other) {
    here.offset = int64_t(r.bytes.at());
    return vxm_fail_at(error, VXM_ERROR_FORMAT, here, "OpenVDB cannot read it: %s", other.what());
  } catch (...) {
    return vxm_fail_at(error, VXM_ERROR_FORMAT, here,
                       "OpenVDB cannot read it, for a reason that it does not tell");
  }
}

void prepare() {
  openvdb::initialize();
}

} // namespace

const vxm_reader vxm_vdb_reader = {prepare, nullptr, read_grid};

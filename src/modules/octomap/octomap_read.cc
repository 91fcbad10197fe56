/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * Files in, by OctoMap, in a process that ends afterwards (sandbox/reader_main.c). OctoMap trusts what it
 * reads: it goes as deep as the bytes say, and on where they end. So they are checked before.
 */
#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <istream>
#include <new>
#include <streambuf>
#include <string>

#include "base/context.h"
#include "modules/octomap/octomap.h"

namespace {

/** A failure that is described already. */
struct failure {
  vxm_status status;
};

void check(vxm_status status) {
  if (status != VXM_OK)
    throw failure{status};
}

/** The file in memory. */
class source : public std::streambuf {
public:
  explicit source(const vxm_reader_request &request) {
    char *begin = const_cast<char *>(reinterpret_cast<const char *>(request.data));
    setg(begin, begin, begin + request.size);
  }

  size_t at() const {
    return size_t(gptr() - eback());
  }
};

/** All that reading takes. */
struct reading {
  vxm_voxel_sink *sink;
  const vxm_reader_request *request;
  vxm_error *error;
  source bytes;
  std::istream stream;

  reading(vxm_voxel_sink *to, const vxm_reader_request *file, vxm_error *why)
      : sink(to), request(file), error(why), bytes(*file), stream(&bytes) {
    stream.exceptions(std::ios_base::badbit | std::ios_base::failbit | std::ios_base::eofbit);
  }

  [[noreturn]] void fail(size_t at, const char *what) const {
    throw failure{
        vxm_fail_at(error, VXM_ERROR_FORMAT, vxm_place{request->name, 0, int64_t(at), -1}, "%s", what)};
  }
};

/* ---- The file ---- */

/** Opens what OctoMap keeps for its own files. */
class tree : public octomap::OcTree {
public:
  size_t data = 0; /**< where it begins */

  tree() : OcTree(1) {
  }

  void read(reading &r) {
    std::string line, type;
    unsigned nodes = 0;
    double size = 0;
    std::getline(r.stream, line);
    if (line.compare(0, binaryFileHeader.size(), binaryFileHeader) != 0)
      r.fail(0, "the first line is not that of an OctoMap");
    if (!readHeader(r.stream, type, nodes, size))
      r.fail(r.bytes.at(), "the header is damaged");
    if (type != getTreeType())
      r.fail(r.bytes.at(), "the tree is of another kind; only an OcTree can be read");
    if (!(size > 0) || !std::isfinite(size))
      r.fail(r.bytes.at(), "the resolution is not a number above 0");
    setResolution(size);
    data = r.bytes.at();
    if (nodes == 0)
      return;
    check_depth(r);
    readBinaryData(r.stream);
    if (tree_size != nodes)
      r.fail(data, "the tree does not have as many nodes as the header says");
  }

private:
  /** That the file has all nodes, and none below the voxels. A node has 2 bits for each child, both set where
   * another node follows. */
  void check_depth(const reading &r) const {
    unsigned left[VXM_OCTOMAP_DEPTH] = {1};
    size_t at = data;
    for (int level = 0; level >= 0;) {
      if (left[level] == 0) {
        level--;
        continue;
      }
      left[level]--;
      if (r.request->size - at < 2)
        r.fail(at, "the file is cut short");
      unsigned both = unsigned(r.request->data[at]) | unsigned(r.request->data[at + 1]) << 8,
               below = unsigned(__builtin_popcount(both & both >> 1 & 0x5555));
      if (below > 0 && level + 1 == VXM_OCTOMAP_DEPTH)
        r.fail(at, "the tree has more than 16 levels");
      at += 2;
      if (below > 0)
        left[++level] = below;
    }
  }
};

/* ---- The leaves ---- */

/** A leaf: its first voxel, counted from the origin. */
struct leaf {
  int64_t at[3], side;
};

/** Calls for each leaf that is occupied, in the order in which blocks of 8 x 8 x 8 are whole. */
template <typename Visit>
void each_leaf(const tree &map, const octomap::OcTreeNode *node, const leaf &where, Visit &visit) {
  int64_t half = where.side / 2;
  for (unsigned c = 0; c < 8; c++) {
    if (!map.nodeChildExists(node, c))
      continue;
    const octomap::OcTreeNode *child = map.getNodeChild(node, c);
    leaf here = {{where.at[0] + (c & 1 ? half : 0), where.at[1] + (c & 2 ? half : 0),
                  where.at[2] + (c & 4 ? half : 0)},
                 half};
    if (map.nodeHasChildren(child))
      each_leaf(map, child, here, visit);
    else if (map.isNodeOccupied(child))
      visit(here);
  }
}

template <typename Visit> void each_leaf(const tree &map, Visit &visit) {
  const int64_t half = VXM_OCTOMAP_HALF;
  if (map.getRoot() && map.nodeHasChildren(map.getRoot()))
    each_leaf(map, map.getRoot(), {{-half, -half, -half}, 2 * half}, visit);
}

struct measuring {
  vxm_sink_extent out = {true, {0, 0, 0}, {0, 0, 0}, 0};

  void operator()(const leaf &l) {
    for (int a = 0; a < 3; a++) {
      int64_t high = l.at[a] + l.side - 1;
      out.low[a] = out.is_empty ? l.at[a] : std::min(out.low[a], l.at[a]);
      out.high[a] = out.is_empty ? high : std::max(out.high[a], high);
    }
    out.is_empty = false;
  }
};

/** Sends cubes, and gathers what is smaller than a block. */
struct sending {
  vxm_voxel_sink *sink;
  int64_t at[3] = {0, 0, 0}; /* of the block, */
  bool is_open = false;      /* if there is one */
  uint64_t bits[VXM_SINK_SIDE] = {};

  explicit sending(vxm_voxel_sink *to) : sink(to) {
  }

  void flush() {
    if (is_open)
      sink->bits(sink->payload, at, bits);
    is_open = false;
  }

  void operator()(const leaf &l) {
    if (l.side < VXM_SINK_SIDE)
      gather(l);
    else
      send_cubes(l);
  }

private:
  void send_cubes(const leaf &l) {
    int64_t step = std::min<int64_t>(l.side, VXM_SINK_CUBE_MAX);
    for (int64_t x = 0; x < l.side; x += step)
      for (int64_t y = 0; y < l.side; y += step)
        for (int64_t z = 0; z < l.side; z += step) {
          const int64_t part[3] = {l.at[0] + x, l.at[1] + y, l.at[2] + z};
          sink->cube(sink->payload, part, step, 1);
        }
  }

  void gather(const leaf &l) {
    int64_t block[3], in[3];
    for (int a = 0; a < 3; a++) {
      in[a] = l.at[a] & (VXM_SINK_SIDE - 1); /* of a negative one too */
      block[a] = l.at[a] - in[a];
    }
    if (!is_open || !std::equal(block, block + 3, at)) {
      flush();
      std::copy(block, block + 3, at);
      std::fill(bits, bits + VXM_SINK_SIDE, 0);
      is_open = true;
    }
    for (int64_t x = in[0]; x < in[0] + l.side; x++)
      for (int64_t y = in[1]; y < in[1] + l.side; y++)
        for (int64_t z = in[2]; z < in[2] + l.side; z++)
          bits[x] |= UINT64_C(1) << (8 * y + z);
  }
};

void read_file(reading &r) {
  auto &map = *new tree; /* the process ends; so do its nodes */
  map.read(r);
  vxm_sink_grid grid = {};
  grid.grids = 1;
  grid.at = map.data;
  for (int a = 0; a < 3; a++) {
    grid.voxel_size[a] = map.getResolution();
    grid.first[a] = map.getResolution() / 2;
  }
  check(r.sink->grid(r.sink->payload, &grid, r.error));
  measuring measure;
  each_leaf(map, measure);
  check(r.sink->extent(r.sink->payload, &measure.out, r.error));
  sending send(r.sink);
  each_leaf(map, send);
  send.flush();
}

/* ---- The table ---- */

vxm_status read_grid(vxm_voxel_sink *sink, vxm_context *context, const vxm_reader_request *request,
                     vxm_error *error) {
  (void)context;
  reading r(sink, request, error);
  vxm_place here = {request->name, 0, 0, -1};
  try {
    read_file(r);
    return VXM_OK;
  } catch (const failure &known) {
    return known.status;
  } catch (const std::bad_alloc &) {
    return vxm_fail(error, VXM_ERROR_MEMORY, "OctoMap is out of memory");
  } catch (const std::ios_base::failure &) {
    here.offset = int64_t(r.bytes.at());
    return vxm_fail_at(error, VXM_ERROR_FORMAT, here, "the header is cut short, or damaged");
  } catch (const std::exception &other) {
    here.offset = int64_t(r.bytes.at());
    return vxm_fail_at(error, VXM_ERROR_FORMAT, here, "OctoMap cannot read it: %s", other.what());
  }
}

void prepare() {
}

} // namespace

const vxm_reader vxm_octomap_reader = {prepare, nullptr, read_grid};

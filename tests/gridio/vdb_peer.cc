/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The other side of .vdb files, through OpenVDB alone.
 *
 * vdb_peer dump FILE NX NY NZ: prints type, class, name and transform of the first grid, and writes the
 * values of voxels (0,0,0) to (NX-1,NY-1,NZ-1) to FILE.values, 32-bit floats or bytes, z fastest, then y,
 * then x. vdb_peer write FOLDER: writes grids of many kinds, and what is set in them as .raw grids of
 * voxmend; of floats also the numbers in the box of what is active, as .values.
 */
#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

using namespace openvdb;

/* ---- Reading ---- */

static void put(FILE *to, float value) {
  fwrite(&value, sizeof value, 1, to);
}

static void put(FILE *to, bool value) {
  fputc(value, to);
}

template <typename Tree>
static void dump_values(const Tree &tree, const std::string &path, const CoordBBox &box) {
  FILE *to = fopen(path.c_str(), "wb");
  for (int x = box.min()[0]; x <= box.max()[0]; x++)
    for (int y = box.min()[1]; y <= box.max()[1]; y++)
      for (int z = box.min()[2]; z <= box.max()[2]; z++)
        put(to, tree.root().getValue(Coord(x, y, z)));
  fclose(to);
}

static int dump(const std::string &path, const int dims[3]) {
  io::File file(path);
  file.open(false);
  GridBase::Ptr grid = file.readGrid(file.beginName().gridName());
  Vec3d first = grid->transform().indexToWorld(Coord(0)), size = grid->transform().voxelSize();
  printf("%s, %s, %s, active voxels %llu\n", grid->type().c_str(),
         GridBase::gridClassToString(grid->getGridClass()).c_str(), grid->getName().c_str(),
         static_cast<unsigned long long>(grid->activeVoxelCount()));
  printf("first centre %.9g %.9g %.9g, voxel size %.9g %.9g %.9g\n", first[0], first[1], first[2], size[0],
         size[1], size[2]);
  CoordBBox box = grid->evalActiveVoxelBoundingBox(),
            whole(Coord(0), Coord(dims[0], dims[1], dims[2]) - Coord(1));
  printf("active %d %d %d to %d %d %d\n", box.min()[0], box.min()[1], box.min()[2], box.max()[0],
         box.max()[1], box.max()[2]);
  if (grid->type() == "Tree_bool_5_4_3")
    dump_values(static_cast<const BoolTree &>(grid->constBaseTree()), path + ".values", whole);
  else {
    const auto &tree = static_cast<const FloatTree &>(grid->constBaseTree());
    printf("background %.9g\n", double(tree.root().background()));
    dump_values(tree, path + ".values", whole);
  }
  return 0;
}

/* ---- Writing ---- */

/** What is set, and the box of what is active. */
struct truth {
  std::vector<Coord> set;
  CoordBBox box;
  Vec3d size{0.5, 0.5, 0.5}, first{10, -20, 30};
};

static void write_truth(const std::string &path, const truth &t) {
  Coord dims = t.box.dim();
  std::vector<unsigned char> bits((size_t(dims[0]) * size_t(dims[1]) * size_t(dims[2]) + 7) / 8);
  for (const Coord &at : t.set) {
    Coord p = at - t.box.min();
    size_t n = (size_t(p[2]) * size_t(dims[1]) + size_t(p[1])) * size_t(dims[0]) + size_t(p[0]);
    bits[n / 8] = static_cast<unsigned char>(bits[n / 8] | 1 << n % 8);
  }
  std::ofstream(path + ".raw", std::ios::binary)
      .write(reinterpret_cast<const char *>(bits.data()), std::streamsize(bits.size()));
  FILE *json = fopen((path + ".raw.json").c_str(), "w");
  fprintf(json, "{\"format\":\"voxmend raw\",\"version\":1,\"dims\":[%d,%d,%d],\"origin\":[", dims[0],
          dims[1], dims[2]);
  for (int a = 0; a < 3; a++)
    fprintf(json, "%.17g%s", t.first[a] + (t.box.min()[a] - 0.5) * t.size[a],
            a < 2 ? "," : "],\"voxel_size\":[");
  fprintf(json, "%.17g,%.17g,%.17g]}\n", t.size[0], t.size[1], t.size[2]);
  fclose(json);
}

static math::Transform::Ptr place(const truth &t) {
  math::Transform::Ptr transform = math::Transform::createLinearTransform(t.size[0]);
  transform->postTranslate(t.first);
  return transform;
}

static GridBase::Ptr new_grid(const char *type, const char *name, const truth &t) {
  GridBase::Ptr grid = GridBase::createGrid(type);
  grid->setName(name);
  grid->setTransform(place(t));
  return grid;
}

/** A ball of radius 12 around (3, -2, 140): a level set, or filled. */
static double distance_at(const Coord &at) {
  return (Vec3d(at[0], at[1], at[2]) - Vec3d(3.25, -2.5, 140)).length() - 12;
}

static const CoordBBox around(Coord(-15, -20, 120), Coord(20, 15, 160));

static GridBase::Ptr level_set(truth &t) {
  GridBase::Ptr grid = new_grid("Tree_float_5_4_3", "ball", t);
  auto &root = static_cast<FloatTree &>(grid->baseTree()).root();
  root.setBackground(1.5f, false);
  grid->setGridClass(GRID_LEVEL_SET);
  for (auto at = around.beginXYZ(); at; ++at) {
    float value = float(distance_at(*at) * 0.5);
    if (std::fabs(value) < 1.5f) {
      root.setValueOn(*at, value);
      t.box.expand(*at);
    } else if (value < 0)
      root.setValueOff(*at, -1.5f);
    if (value < 0)
      t.set.push_back(*at);
  }
  root.prune();
  return grid;
}

static GridBase::Ptr fog(truth &t, GridClass grid_class) {
  GridBase::Ptr grid = new_grid("Tree_float_5_4_3", "fog", t);
  auto &root = static_cast<FloatTree &>(grid->baseTree()).root();
  grid->setGridClass(grid_class);
  for (auto at = around.beginXYZ(); at; ++at) {
    double value = std::fmin(1, std::fmax(0, -distance_at(*at) / 7));
    if (value > 0) {
      root.setValueOn(*at, float(value));
      t.box.expand(*at);
    }
    if (float(value) > 0.5f)
      t.set.push_back(*at);
  }
  root.prune();
  return grid;
}

template <typename Tree> static void fill(GridBase &grid, const CoordBBox &box) {
  static_cast<Tree &>(grid.baseTree()).root().fill(box, true, true);
}

/** A box with tiles of all sizes, and some lone voxels. */
template <typename Tree> static GridBase::Ptr bits(const char *type, truth &t) {
  GridBase::Ptr grid = new_grid(type, "bits", t);
  CoordBBox box(Coord(-4100, -9, 100), Coord(200, 2, 111)), thick(Coord(0, 0, 128), Coord(135, 135, 263));
  fill<Tree>(*grid, box);
  fill<Tree>(*grid, thick);
  auto &root = static_cast<Tree &>(grid->baseTree()).root();
  for (int i = 0; i < 60; i++) {
    Coord lone(i * 16 % 400, 20 + i * 7 % 100, 100 + i % 28);
    root.setValueOn(lone, true);
    t.set.push_back(lone);
  }
  t.box = box;
  t.box.expand(thick);
  for (const Coord &lone : t.set)
    t.box.expand(lone);
  for (auto at = box.beginXYZ(); at; ++at)
    t.set.push_back(*at);
  for (auto at = thick.beginXYZ(); at; ++at)
    t.set.push_back(*at);
  return grid;
}

static void write_file(const std::string &path, const GridCPtrVec &grids, uint32_t compression) {
  io::File file(path + ".vdb");
  file.setCompression(compression);
  file.write(grids);
}

/** The numbers of the floats in a file, as OpenVDB reads them again. */
static void write_numbers(const std::string &path) {
  io::File file(path + ".vdb");
  file.open(false);
  GridPtrVecPtr grids = file.getGrids();
  for (const GridBase::Ptr &grid : *grids)
    if (grid->isType<FloatGrid>())
      dump_values(static_cast<const FloatTree &>(grid->constBaseTree()), path + ".values",
                  grid->evalActiveVoxelBoundingBox());
}

static void write_kinds(const std::string &folder) {
  const uint32_t usual = io::COMPRESS_BLOSC | io::COMPRESS_ACTIVE_MASK;
  truth ball, mist, mask, set;
  GridBase::Ptr surface = level_set(ball), cloud = fog(mist, GRID_FOG_VOLUME);
  GridBase::Ptr masked = bits<MaskTree>("Tree_mask_5_4_3", mask),
                bools = bits<BoolTree>("Tree_bool_5_4_3", set);
  static_cast<BoolTree &>(bools->baseTree())
      .root()
      .setValueOff(Coord(190, 2, 103), true); /* true, not active */
  static_cast<BoolTree &>(bools->baseTree())
      .root()
      .setValueOn(Coord(190, 2, 102), false); /* active, not true */
  set.set.erase(
      std::remove_if(set.set.begin(), set.set.end(),
                     [](const Coord &at) { return at == Coord(190, 2, 103) || at == Coord(190, 2, 102); }),
      set.set.end());
  write_file(folder + "/level_set", {surface}, usual);
  write_file(folder + "/zip", {surface}, io::COMPRESS_ZIP | io::COMPRESS_ACTIVE_MASK);
  write_file(folder + "/plain", {surface}, io::COMPRESS_NONE);
  write_file(folder + "/zip_all", {surface}, io::COMPRESS_ZIP);
  write_file(folder + "/fog", {cloud}, usual);
  write_file(folder + "/mask", {masked}, usual);
  write_file(folder + "/bool", {bools}, usual);
  write_file(folder + "/bool_plain", {bools}, io::COMPRESS_NONE);
  write_file(folder + "/second", {new_grid("Tree_vec3s_5_4_3", "wind", ball), surface}, usual);
  std::ofstream stream(folder + "/stream.vdb", std::ios::binary);
  io::Stream(stream).write(GridCPtrVec{surface});
  surface->setSaveFloatAsHalf(true);
  write_file(folder + "/half", {surface}, usual);
  write_file(folder + "/half_plain", {surface}, io::COMPRESS_ACTIVE_MASK);
  for (const char *name : {"level_set", "zip", "plain", "zip_all", "stream", "second", "half", "half_plain"})
    write_truth(folder + "/" + name, ball);
  for (const char *name : {"level_set", "zip", "plain", "zip_all", "second", "half", "half_plain", "fog"})
    write_numbers(folder + "/" + name);
  write_truth(folder + "/fog", mist);
  write_truth(folder + "/mask", mask);
  write_truth(folder + "/bool", set);
  write_truth(folder + "/bool_plain", set);
  truth unnamed;
  write_file(folder + "/unknown", {fog(unnamed, GRID_UNKNOWN)}, usual);
  write_truth(folder + "/unknown", unnamed);
  write_numbers(folder + "/unknown");
}

/** Grids that cannot be read as voxels along x, y and z. */
static void write_others(const std::string &folder) {
  truth t;
  GridBase::Ptr grid = bits<MaskTree>("Tree_mask_5_4_3", t);
  grid->transform().postRotate(0.3);
  write_file(folder + "/turned", {grid}, 0);
  grid->setTransform(place(t));
  grid->transform().preScale(Vec3d(-1, 1, 1));
  write_file(folder + "/mirrored", {grid}, 0);
  grid->setTransform(math::Transform::createFrustumTransform(BBoxd(Vec3d(0), Vec3d(9)), 0.5, 3));
  write_file(folder + "/frustum", {grid}, 0);
  write_file(folder + "/wind", {new_grid("Tree_vec3s_5_4_3", "wind", t)}, 0);
  write_file(folder + "/empty", {new_grid("Tree_bool_5_4_3", "nothing", t)}, 0);
  GridBase::Ptr far = new_grid("Tree_bool_5_4_3", "far", t);
  fill<BoolTree>(*far, CoordBBox(Coord(0), Coord(0)));
  fill<BoolTree>(*far, CoordBBox(Coord(3000000, 0, 0), Coord(3000000, 0, 0)));
  write_file(folder + "/far", {far}, 0);
}

int main(int argc, char **argv) {
  initialize();
  if (argc == 6 && strcmp(argv[1], "dump") == 0) {
    const int dims[3] = {atoi(argv[3]), atoi(argv[4]), atoi(argv[5])};
    return dump(argv[2], dims);
  }
  if (argc == 3 && strcmp(argv[1], "write") == 0) {
    write_kinds(argv[2]);
    write_others(argv[2]);
    return 0;
  }
  fprintf(stderr, "usage: vdb_peer dump FILE NX NY NZ | write FOLDER\n");
  return 2;
}

/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * The other side of .bt files, through OctoMap alone.
 *
 * octomap_peer dump FILE X Y Z NX NY NZ: prints resolution and number of occupied voxels, and writes whether
 * the voxels with the keys (X,Y,Z) to (X+NX-1,...), counted from the origin, are occupied to FILE.values:
 * bytes, z fastest, then y, then x. octomap_peer write FOLDER: writes a map of voxels at random, cubes and
 * free space, as any.bt, and its box from -20,-20,-20 to 43,43,43 as any.values.
 */
#include <octomap/OcTree.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>

using octomap::OcTree;
using octomap::OcTreeKey;

static OcTreeKey key_of(int x, int y, int z) {
  return OcTreeKey(octomap::key_type(x + 32768), octomap::key_type(y + 32768), octomap::key_type(z + 32768));
}

static int dump_values(const OcTree &map, const std::string &path, const int at[3], const int dims[3]) {
  FILE *to = fopen(path.c_str(), "wb");
  if (!to)
    return 1;
  for (int x = at[0]; x < at[0] + dims[0]; x++)
    for (int y = at[1]; y < at[1] + dims[1]; y++)
      for (int z = at[2]; z < at[2] + dims[2]; z++) {
        octomap::OcTreeNode *node = map.search(key_of(x, y, z));
        fputc(node && map.isNodeOccupied(node), to);
      }
  return fclose(to) != 0;
}

static int dump(const std::string &path, const int at[3], const int dims[3]) {
  OcTree map(1);
  if (!map.readBinary(path))
    return 1;
  unsigned long long voxels = 0, free_leaves = 0;
  for (auto leaf = map.begin_leafs(); leaf != map.end_leafs(); ++leaf) {
    unsigned long long side = 1ull << (map.getTreeDepth() - leaf.getDepth());
    if (map.isNodeOccupied(*leaf))
      voxels += side * side * side;
    else
      free_leaves++;
  }
  printf("resolution %.17g, occupied voxels %llu, free leaves %llu\n", map.getResolution(), voxels,
         free_leaves);
  return dump_values(map, path + ".values", at, dims);
}

static int write(const std::string &folder) {
  const int low[3] = {-20, -20, -20}, dims[3] = {64, 64, 64};
  std::mt19937 random(7);
  OcTree map(0.1);
  for (int n = 0; n < 3000; n++)
    map.updateNode(key_of(int(random() % 64) - 20, int(random() % 64) - 20, int(random() % 64) - 20),
                   random() % 3 > 0);
  for (int x = -16; x < 16; x++)
    for (int y = 0; y < 16; y++)
      for (int z = 0; z < 33; z++)
        map.setNodeValue(key_of(x, y, z), x < 0 ? 3.5f : -2.0f);
  /* the corners of the box, so that it is that of what is occupied */
  map.setNodeValue(key_of(-20, -20, -20), 3.5f);
  map.setNodeValue(key_of(43, 43, 43), 3.5f);
  if (!map.writeBinary(folder + "/any.bt"))
    return 1;
  return dump_values(map, folder + "/any.values", low, dims);
}

int main(int count, char **arguments) {
  if (count == 3 && strcmp(arguments[1], "write") == 0)
    return write(arguments[2]);
  if (count != 9 || strcmp(arguments[1], "dump") != 0)
    return 2;
  int numbers[6];
  for (int n = 0; n < 6; n++)
    numbers[n] = atoi(arguments[3 + n]);
  return dump(arguments[2], numbers, numbers + 3);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** The table of targets. The extensions of foreign formats are their names. */
#include "fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const fuzz_target targets[] = {
    {"off", fuzz_mesh, false, NULL},       {"obj", fuzz_mesh, false, NULL},
    {"stl", fuzz_mesh, false, NULL},       {"ply", fuzz_mesh, false, NULL},
    {"any", fuzz_mesh, false, NULL},       {"binvox", fuzz_grid, false, NULL},
    {"npy", fuzz_grid, false, NULL},       {"nrrd", fuzz_grid, false, NULL},
    {"rle", fuzz_grid, false, NULL},       {"vdb", fuzz_grid, true, "openvdb"},
    {"raw", fuzz_raw, false, NULL},        {"sidecar", fuzz_sidecar, false, NULL},
    {"vox", fuzz_grid, false, NULL},       {"schem", fuzz_grid, false, NULL},
    {"wire", fuzz_wire, false, NULL},      {"gltf", fuzz_foreign, true, "assimp"},
    {"glb", fuzz_foreign, true, "assimp"}, {"3mf", fuzz_foreign, true, "assimp"},
    {"dae", fuzz_foreign, true, "assimp"}, {"fbx", fuzz_foreign, true, "assimp"},
    {"3ds", fuzz_foreign, true, "assimp"}, {"x3d", fuzz_foreign, true, "assimp"},
    {"amf", fuzz_foreign, true, "assimp"}, {"blend", fuzz_foreign, true, "assimp"},
    {"lwo", fuzz_foreign, true, "assimp"}, {"x", fuzz_foreign, true, "assimp"},
    {"ac", fuzz_foreign, true, "assimp"},  {"ifc", fuzz_foreign, true, "assimp"},
    {"step", fuzz_foreign, true, "occt"},  {"iges", fuzz_foreign, true, "occt"},
};
enum { TARGETS = sizeof targets / sizeof *targets };

const fuzz_target *fuzz_at(size_t index) {
  return index < TARGETS ? &targets[index] : NULL;
}

const fuzz_target *fuzz_find(const char *name) {
  for (size_t t = 0; t < TARGETS; t++)
    if (strcmp(targets[t].name, name) == 0)
      return &targets[t];
  return NULL;
}

void fuzz_require(bool holds, const char *what) {
  if (holds)
    return;
  fprintf(stderr, "broken promise: %s\n", what);
  abort();
}

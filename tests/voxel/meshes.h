/* SPDX-License-Identifier: BSD-3-Clause */
/** The files of the shared collection, for tests that skip where it is missing. */
#ifndef TEST_VOXEL_MESHES_H
#define TEST_VOXEL_MESHES_H

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

/** Calls `visit` for each file of the first `count` folders (all five at most); returns how many there were,
 * 0 if the collection is not here. MESH_BYTES=N in the environment leaves out what is larger. */
static inline int each_mesh_file(size_t count,
                                 void (*visit)(const char *path, const char *name, void *payload),
                                 void *payload) {
  static const char *const folders[] = {"classic", "cad", "messy", "modelnet", "paper"};
  const char *source = getenv("SRCDIR"), *most = getenv("MESH_BYTES");
  int found = 0;
  for (size_t f = 0; f < count && f < sizeof folders / sizeof *folders; f++) {
    char folder[2048], path[4096];
    snprintf(folder, sizeof folder, "%s/../shared/meshes/%s", source ? source : ".", folders[f]);
    DIR *listing = opendir(folder);
    if (!listing)
      return 0;
    for (struct dirent *entry; (entry = readdir(listing));) {
      if (entry->d_name[0] == '.')
        continue;
      snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
      struct stat about;
      if (most && stat(path, &about) == 0 && about.st_size > atoll(most))
        continue;
      visit(path, entry->d_name, payload);
      found++;
    }
    closedir(listing);
  }
  return found;
}

#endif

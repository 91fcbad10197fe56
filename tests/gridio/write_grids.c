/* SPDX-License-Identifier: BSD-3-Clause */
/** Writes some grids in every format, and their set voxels as text, for readers in other languages. */
#include "grid/bitgrid.h"

#include "base/rng.h"
#include "gridio/gridio.h"

#include <inttypes.h>
#include <stdio.h>

static int fail(const vxm_error *error) {
  fprintf(stderr, "write_grids: %s\n", error->text);
  return 1;
}

static int write_one(const vxm_space *space, const char *folder, int number, vxm_rng *rng) {
  vxm_error error = VXM_ERROR_INIT;
  vxm_grid *grid;
  if (vxm_grid_create(&grid, NULL, space, &error) != VXM_OK)
    return fail(&error);
  char path[1000];
  snprintf(path, sizeof path, "%s/%d.txt", folder, number);
  FILE *text = fopen(path, "w");
  if (!text) {
    vxm_grid_destroy(grid);
    perror(path);
    return 1;
  }
  const int64_t *n = space->dims;
  fprintf(text, "%" PRId64 " %" PRId64 " %" PRId64 "\n", n[0], n[1], n[2]);
  for (int a = 0; a < 3; a++)
    fprintf(text, "%.17g %.17g\n", space->origin[a], space->voxel_size[a]);
  for (int64_t k = 0; k < n[2]; k++)
    for (int64_t j = 0; j < n[1]; j++)
      for (int64_t i = 0; i < n[0]; i++)
        if (vxm_rng_below(rng, 7) == 0) {
          vxm_grid_set(grid, i, j, k, true);
          fprintf(text, "%" PRId64 " %" PRId64 " %" PRId64 "\n", i, j, k);
        }
  int failed = fclose(text) != 0;
  static const char *const formats[] = {"binvox", "npy", "raw", "rle", "nrrd"};
  for (int f = 0; f < 5 && !failed; f++) {
    snprintf(path, sizeof path, "%s/%d.%s", folder, number, formats[f]);
    if (vxm_gridio_write(grid, path, NULL, &error) != VXM_OK)
      failed = fail(&error);
  }
  vxm_grid_destroy(grid);
  return failed;
}

int main(int argc, char **argv) {
  static const vxm_space spaces[] = {
      {{1, 1, 1}, {0, 0, 0}, {1, 1, 1}},
      {{16, 16, 16}, {-0.5, 0.25, 1e-3}, {0.125, 0.125, 0.125}},
      {{70, 65, 33}, {1.0 / 3, -2e7, 12345.678}, {0.1, 0.1, 0.1}},
      {{5, 130, 64}, {-1e-8, 0, 3}, {2.0 / 3, 2.0 / 3, 2.0 / 3}},
  };
  vxm_rng rng = {41};
  if (argc != 2) {
    fprintf(stderr, "usage: write_grids FOLDER\n");
    return 2;
  }
  for (int s = 0; s < 4; s++)
    if (write_one(&spaces[s], argv[1], s, &rng) != 0)
      return 1;
  return 0;
}

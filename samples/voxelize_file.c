/* SPDX-License-Identifier: BSD-3-Clause */
/** voxelize_file MESH GRID [N]: the shortest way from a mesh file to a voxel file. */
#include <voxmend.h>

#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv) {
  if (argc < 3) {
    fprintf(stderr, "usage: voxelize_file MESH GRID [N]\n");
    return 2;
  }
  vxm_mesh *mesh = NULL, *repaired = NULL;
  vxm_grid *grid = NULL;
  vxm_error error = VXM_ERROR_INIT;
  vxm_space_options space = VXM_SPACE_OPTIONS_INIT;
  space.resolution[0] = argc > 3 ? strtoll(argv[3], NULL, 10) : 64;

  if (vxm_mesh_read(&mesh, NULL, argv[1], &error) == VXM_OK &&
      vxm_mesh_prepare(&repaired, NULL, mesh, NULL, &error) == VXM_OK &&
      vxm_voxelize(&grid, NULL, repaired, &space, NULL, &error) == VXM_OK &&
      vxm_grid_write(grid, argv[2], NULL, &error) == VXM_OK)
    printf("%lld voxels\n", (long long)vxm_grid_count(grid));
  else
    fprintf(stderr, "%s\n", error.text);

  vxm_grid_destroy(grid);
  vxm_mesh_destroy(repaired);
  vxm_mesh_destroy(mesh);
  return error.code == VXM_OK ? 0 : 1;
}

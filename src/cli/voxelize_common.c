/* SPDX-License-Identifier: BSD-3-Clause */
/** What is made of a mesh, its inside or its surface: options that voxelize and augment have in common. */
#include "cli/voxelize_common.h"

#include <string.h>

int cli_read_mode(cli_run *cli, vxm_voxelize_options *options, const char *value) {
  static const char *const modes[] = {"solid", "surface", "both", NULL};
  int choice = 0, result = cli_choose(cli, &choice, "mode", value, modes);
  options->mode = (vxm_mode)choice;
  return result;
}

int cli_read_surface(cli_run *cli, vxm_voxelize_options *options, const char *value) {
  static const char *const surfaces[] = {"conservative", "thin", "shell26", "shell18", "shell6", NULL};
  int choice = 0, result = cli_choose(cli, &choice, "surface", value, surfaces);
  options->surface = (vxm_surface_kind)choice;
  return result;
}

int cli_read_voxel_size(cli_run *cli, vxm_space_options *space, const char *value) {
  double sizes[3];
  space->voxel_size = 0;
  memset(space->voxel_sizes, 0, sizeof space->voxel_sizes);
  if (cli_read_number(&sizes[0], value) && sizes[0] > 0)
    space->voxel_size = sizes[0];
  else if (cli_read_numbers(sizes, 3, value) && sizes[0] > 0 && sizes[1] > 0 && sizes[2] > 0)
    memcpy(space->voxel_sizes, sizes, sizeof sizes);
  else
    return cli_usage(cli, "--voxel-size '%s' is neither a positive number nor three such as 0.5,0.5,2",
                     value);
  return CLI_END;
}

int cli_read_thin(cli_run *cli, vxm_voxelize_options *options, const char *value) {
  static const char *const kinds[] = {"keep", "drop", "26", NULL};
  int choice = 0, result = cli_choose(cli, &choice, "thin", value, kinds);
  options->thin = (vxm_thin_parts)(VXM_THIN_KEEP + choice);
  return result;
}

int cli_check_surface(cli_run *cli, const vxm_voxelize_options *options, bool is_given) {
  if (is_given && options->mode == VXM_MODE_SOLID)
    return cli_usage(cli, "--surface goes with --mode surface or both");
  if (options->mode == VXM_MODE_BOTH && options->surface >= VXM_SURFACE_SHELL26)
    return cli_usage(cli, "a shell is a part of the solid; with --mode both leave out --surface");
  return CLI_END;
}

bool cli_makes_solid(const vxm_voxelize_options *options) {
  return options->mode != VXM_MODE_SURFACE || options->surface >= VXM_SURFACE_SHELL26;
}

int cli_check_thin(cli_run *cli, const vxm_voxelize_options *options, bool is_given) {
  if (is_given && !cli_makes_solid(options))
    return cli_usage(cli, "--thin goes with the solid: --mode solid or both, or a shell as --surface");
  return CLI_END;
}

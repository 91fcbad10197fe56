/* SPDX-License-Identifier: BSD-3-Clause */
/** What is made of a mesh, its inside or its surface: options that voxelize and augment have in common. */
#include "cli/voxelize_common.h"

#include <string.h>

const char *const cli_modes[] = {"solid", "surface", "both", NULL};
const char *const cli_surfaces[] = {"conservative", "thin", "shell26", "shell18", "shell6", NULL};
const char *const cli_thin_parts[] = {"keep", "drop", "26", NULL};

int cli_take_voxel_size(cli_run *cli, const cli_option *option, const char *value, void *member) {
  vxm_space_options *space = member;
  double sizes[3];
  space->voxel_size = 0;
  memset(space->voxel_sizes, 0, sizeof space->voxel_sizes);
  if (cli_read_number(&sizes[0], value) && sizes[0] > 0)
    space->voxel_size = sizes[0];
  else if (cli_read_numbers(sizes, 3, value) && sizes[0] > 0 && sizes[1] > 0 && sizes[2] > 0)
    memcpy(space->voxel_sizes, sizes, sizeof sizes);
  else
    return cli_usage(cli, "--%s '%s' is neither a positive number nor three such as 0.5,0.5,2", option->name,
                     value);
  return CLI_END;
}

int cli_check_surface(cli_run *cli, const vxm_voxelize_options *options) {
  if (cli_is_given(cli, "surface") && options->mode == VXM_MODE_SOLID)
    return cli_usage(cli, "--surface goes with --mode surface or both");
  if (options->mode == VXM_MODE_BOTH && options->surface >= VXM_SURFACE_SHELL26)
    return cli_usage(cli, "a shell is a part of the solid; with --mode both leave out --surface");
  return CLI_END;
}

bool cli_makes_solid(const vxm_voxelize_options *options) {
  return options->mode != VXM_MODE_SURFACE || options->surface >= VXM_SURFACE_SHELL26;
}

int cli_check_thin(cli_run *cli, const vxm_voxelize_options *options) {
  if (cli_is_given(cli, "thin") && !cli_makes_solid(options))
    return cli_usage(cli, "--thin goes with the solid: --mode solid or both, or a shell as --surface");
  return CLI_END;
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** What is made of a mesh, its inside or its surface: options that voxelize and augment have in common. */
#include "cli/cli.h"

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

int cli_check_thin(cli_run *cli, const vxm_voxelize_options *options, bool is_given) {
  if (is_given && options->mode == VXM_MODE_SURFACE && options->surface < VXM_SURFACE_SHELL26)
    return cli_usage(cli, "--thin goes with the solid: --mode solid or both, or a shell as --surface");
  return CLI_END;
}

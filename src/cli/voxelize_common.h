/* SPDX-License-Identifier: BSD-3-Clause */
/** Options of what is made of a mesh, which several commands take. */
#ifndef VXM_CLI_VOXELIZE_COMMON_H
#define VXM_CLI_VOXELIZE_COMMON_H

#include "cli/cli.h"

/** The arguments of --mode and --surface: CLI_END or CLI_STOP. */
int cli_read_mode(cli_run *cli, vxm_voxelize_options *options, const char *value);
int cli_read_surface(cli_run *cli, vxm_voxelize_options *options, const char *value);
/** The argument of --voxel-size, "0.5" or "0.5,0.5,2": CLI_END or CLI_STOP. */
int cli_read_voxel_size(cli_run *cli, vxm_space_options *space, const char *value);
/** The argument of --thin: CLI_END or CLI_STOP. */
int cli_read_thin(cli_run *cli, vxm_voxelize_options *options, const char *value);
/** CLI_STOP if --surface, where it was given, does not go with the mode. */
int cli_check_surface(cli_run *cli, const vxm_voxelize_options *options, bool is_given);
/** Whether the voxels follow from the inside: those of a shell too, not those of the surface itself. */
bool cli_makes_solid(const vxm_voxelize_options *options);
/** CLI_STOP if --thin, where it was given, does not go with the mode. */
int cli_check_thin(cli_run *cli, const vxm_voxelize_options *options, bool is_given);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Options of what is made of a mesh, which several commands take. */
#ifndef VXM_CLI_VOXELIZE_COMMON_H
#define VXM_CLI_VOXELIZE_COMMON_H

#include "cli/cli.h"

/** Choices of --mode, --surface and --thin, of which the first is VXM_THIN_KEEP; NULL ends each list. */
extern const char *const cli_modes[], *const cli_surfaces[], *const cli_thin_parts[];
/** Of --voxel-size, "0.5" or "0.5,0.5,2", into vxm_space_options. */
cli_reader cli_take_voxel_size;
/** CLI_STOP if --surface was given and does not go with the mode. */
int cli_check_surface(cli_run *cli, const vxm_voxelize_options *options);
/** Whether the voxels follow from the inside: those of a shell too, not those of the surface itself. */
bool cli_makes_solid(const vxm_voxelize_options *options);
/** CLI_STOP if --thin was given and does not go with the mode. */
int cli_check_thin(cli_run *cli, const vxm_voxelize_options *options);

#endif

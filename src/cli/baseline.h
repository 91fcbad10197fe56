/* SPDX-License-Identifier: BSD-3-Clause */
/** Published methods in place of the library's own: `voxmend voxelize --baseline`, and phases of bench. */
#ifndef VXM_CLI_BASELINE_H
#define VXM_CLI_BASELINE_H

#include "cli/voxelize.h"
#include "voxmend/experimental.h"

/** Names of vxm_baseline, then those of the published OpenCL program's approaches, and NULL. */
extern const char *const cli_baseline_names[];

/** Options that a published method has no use for. */
int cli_baseline_check(cli_run *cli, const voxelize_request *given);
/** Makes the grid and writes it; results->input has the mesh, results->space the grid that was asked for. */
int cli_baseline_write(cli_run *cli, voxelize_request *given, voxelize_outcome *results);
/** What a method counted and timed, without what it does not have. */
json_t *cli_baseline_figures(const vxm_baseline_report *report);
/** "setup_ms 0.3, parts 4", of figures. */
void cli_figures_text(char *text, size_t size, const json_t *figures);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** What came of 'voxmend repair', and how that is told. */
#ifndef VXM_CLI_REPAIR_H
#define VXM_CLI_REPAIR_H

#include "cli/defects.h"

typedef struct repair_outcome {
  vxm_mesh *mesh;
  vxm_repair_report repair;
  vxm_census before, after;
  vxm_level level;
  vxm_sheets sheets;
  bool single_precision; /**< the file has 32-bit floats, as .stl */
  double seconds;        /**< that the repair took */
  vxm_verification verification;
  cli_found found; /**< in the mesh as it was read */
} repair_outcome;

/** Names of the levels, as on the command line. */
extern const char *const repair_levels[];

/** The report for --json and --report. @param output NULL = nothing was written, for the reason in cli->error
 */
json_t *repair_report(const cli_run *cli, const char *input, const char *output,
                      const repair_outcome *outcome);
/** Says which parts could not be united. */
void repair_warn_ununited(cli_run *cli, const char *input, const repair_outcome *outcome);
void repair_summarize(const cli_run *cli, const repair_outcome *outcome);
/** Whether vertices could not be moved apart beside slivers of a union, which level solid takes away. */
bool repair_leaves_slivers(const repair_outcome *outcome);
/** A line for each thing that keeps the level from being reached. */
void repair_say_remains(const cli_run *cli, FILE *stream, const repair_outcome *outcome);

#endif

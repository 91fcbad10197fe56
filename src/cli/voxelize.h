/* SPDX-License-Identifier: BSD-3-Clause */
/** What 'voxmend voxelize' was asked for, what came of it, and how that is told. */
#ifndef VXM_CLI_VOXELIZE_H
#define VXM_CLI_VOXELIZE_H

#include "cli/engine.h"
#include "cli/field.h"

typedef struct voxelize_request {
  const char *input, *output, *like, *confidence, *coords;
  int baseline; /**< its place in cli_baseline_names; -1 = the library's own methods */
  bool no_repair, dry_run, sparse;
  vxm_repair_options repair;
  vxm_space_options space;
  vxm_voxelize_options voxelize;
  vxm_grid_write_options write;
  cli_field field;
  cli_engine engine;
} voxelize_request;

typedef struct voxelize_outcome {
  cli_input input;
  vxm_voxelize_report voxelize;
  vxm_space space;
  vxm_estimate estimate;
  bool octree;     /**< the voxels are made as one: --sparse, or the grid is large */
  json_t *figures; /**< of --baseline, or NULL */
  struct {
    int64_t bricks, nodes; /**< none without an octree */
    uint64_t bytes;
  } sparse;
  double voxelize_ms, write_ms, total_ms;
} voxelize_outcome;

extern const cli_option voxelize_options[];

/** Reads the command line; CLI_STOP if it is at fault, or all has been said. */
int voxelize_read_arguments(cli_run *cli, voxelize_request *out);
/** Whether a format is written slice by slice. */
bool voxelize_is_sliced(const char *format);

/** The report for --json and --report. */
json_t *voxelize_report(const cli_run *cli, const voxelize_request *given, const voxelize_outcome *results);
/** Whether the summary begins before the voxels are made: it is all that is wanted, or they may take long.
 * Else nothing is told of what fails. */
bool voxelize_is_told_before(const voxelize_request *given, const voxelize_outcome *results);
/** What is known before the voxels are made, with the estimate. */
void voxelize_summarize_begin(const cli_run *cli, const voxelize_request *given,
                              const voxelize_outcome *results);
/** What came of it. */
void voxelize_summarize(const cli_run *cli, const voxelize_request *given, const voxelize_outcome *results);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** What the files of `voxmend augment` share. */
#ifndef VXM_CLI_AUGMENT_H
#define VXM_CLI_AUGMENT_H

#include "cli/cli.h"

typedef struct augment_request {
  const char *input, *output, *format;
  const char *rotations; /**< file of a list, or NULL */
  int64_t count, first;  /**< count 0 = a stream without end */
  vxm_variant variant;   /**< model and epoch */
  bool no_repair, repair_options, noise;
  bool surface;
  cli_engine engine;
  vxm_voxels voxels; /**< of a stream */
  vxm_repair_options repair;
  vxm_sampler_options sampler;
} augment_request;

extern const cli_option augment_options[];

/** Reads the command line; CLI_STOP if it is at fault, or all has been said. */
int augment_read_arguments(cli_run *cli, augment_request *out);
/** Whether variants go to standard output. */
bool augment_is_stream(const augment_request *given);

/** Writes the records of a stream to standard output (doc/training.md has its form); CLI_DONE or CLI_FAILED.
 */
int augment_stream(cli_run *cli, const augment_request *given, vxm_sampler *sampler, int64_t *made);

#endif

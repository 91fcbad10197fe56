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
  bool surface, thin;
  cli_engine engine;
  vxm_voxel_format voxels; /**< of a stream */
  vxm_repair_options repair;
  vxm_sampler_options sampler;
  vxm_voxelize_options voxelize; /**< of the sampler */
} augment_request;

extern const cli_option augment_options[];

/** Reads the command line; CLI_STOP if it is at fault, or all has been said. */
int augment_read_arguments(cli_run *cli, augment_request *out);
/** Whether variants go to standard output. */
bool augment_is_stream(const augment_request *given);

/** A folder of files, and how far it has come. */
typedef struct augment_folder {
  int64_t made;
  int64_t replaced;         /**< of these, those that were there before */
  uint64_t bytes;           /**< of all */
  unsigned char *was_there; /**< for each file made or begun; to be freed */
  bool is_new;              /**< the folder was made here */
  bool written[64];         /**< of those that are being made: what is complete */
  uint64_t sizes[64];       /**< of the last that were made */
} augment_folder;

/** CLI_STOP if a file in the folder would be one that is read, or the report. */
int augment_check_folder(cli_run *cli, const augment_request *given);
/** Writes the files; CLI_DONE or CLI_FAILED. */
int augment_write_folder(cli_run *cli, augment_folder *f, const augment_request *given, vxm_sampler *sampler);
/** As vxm_sampler_files, for numbers; a failure is in cli->error. */
vxm_status augment_write_numbers(cli_run *cli, const char *const *paths, vxm_sampler *sampler,
                                 const vxm_variant *variants, size_t count, const char *format,
                                 bool *written);
/** A failed run leaves no file behind that was not there before. */
void augment_remove_files(const augment_folder *f, const augment_request *given);

/** Writes the records of a stream to standard output (doc/training.md has its form); CLI_DONE or CLI_FAILED.
 */
int augment_stream(cli_run *cli, const augment_request *given, vxm_sampler *sampler, int64_t *made);

#endif

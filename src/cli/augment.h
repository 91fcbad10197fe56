/* SPDX-License-Identifier: BSD-3-Clause */
/** What the files of `voxmend augment` share. */
#ifndef VXM_CLI_AUGMENT_H
#define VXM_CLI_AUGMENT_H

#include "cli/engine.h"
#include "cli/field.h"

typedef struct augment_request {
  const char *input, *output, *format;
  bool is_several;       /**< all arguments are inputs, and `input` is NULL until one of them is at work */
  const char *rotations; /**< file of a list, or NULL */
  int64_t count, first;  /**< count 0 = a stream without end */
  vxm_variant variant;   /**< model and epoch */
  bool no_repair;
  bool force; /**< variants that are there may be replaced */
  cli_engine engine;
  vxm_voxel_format voxels; /**< of a stream */
  vxm_repair_options repair;
  vxm_sampler_options sampler;
  vxm_voxelize_options voxelize; /**< of the sampler */
  int64_t model_at,
      model_of; /**< of several models the one at work, from 0, and how many; for the progress */
} augment_request;

extern const cli_option augment_options[];
extern const char *const augment_file_formats[]; /**< ends with NULL */

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

/** CLI_STOP if a file that will be replaced in the folder is one that is read, or the report. */
int augment_check_folder(cli_run *cli, const augment_request *given);
/** CLI_STOP if a variant that will be made is there, of whatever format and options, and --force is not
 * given.
 */
int augment_check_former(cli_run *cli, const augment_request *given);
/** Writes the files; CLI_DONE or CLI_FAILED. */
int augment_write_folder(cli_run *cli, augment_folder *f, const augment_request *given, vxm_sampler *sampler);
/** As vxm_sampler_files, for numbers; a failure is in cli->error. */
vxm_status augment_write_numbers(cli_run *cli, const char *const *paths, vxm_sampler *sampler,
                                 const vxm_variant *variants, size_t count, const char *format,
                                 bool *written);
/** A failed run leaves no file behind that was not there before. */
void augment_remove_files(const augment_folder *f, const augment_request *given);

/* ---- augment_stream.c: records on standard output (doc/training.md has their form) ---- */

/** Records of one model after another. */
typedef struct augment_stream augment_stream;

/** Writes the header, of a stream of so many models; CLI_DONE, or CLI_FAILED and *out is NULL. */
int augment_stream_open(cli_run *cli, augment_stream **out, const augment_request *given,
                        vxm_sampler *sampler);
/** Writes the records of model number given->variant.model; CLI_DONE or CLI_FAILED. */
int augment_stream_write(cli_run *cli, augment_stream *s, const augment_request *given, int64_t *made);
/** After the last, or a failure: the status so far, or CLI_FAILED where it cannot be written to its end. NULL
 * is allowed. */
int augment_stream_close(cli_run *cli, augment_stream *s, int status);

/* ---- augment_model.c: a model, and its variants ---- */

typedef struct augment_outcome {
  cli_input input;
  vxm_census census;
  augment_folder folder;
  int64_t made;
  double prepare_ms, make_ms;
} augment_outcome;

#define AUGMENT_OUTCOME_INIT \
  { .census = VXM_CENSUS_INIT }

/** Makes the sampler and its engine; CLI_FAILED after a line. */
int augment_open_sampler(cli_run *cli, vxm_sampler **out, augment_request *given);
/**
 * Reads and repairs given->input, and makes its variants, into the stream or, where that is NULL, into
 * given->output. CLI_FAILED after a line, and then no file of it is left that was not there before.
 */
int augment_model(cli_run *cli, augment_outcome *out, const augment_request *given, vxm_sampler *sampler,
                  augment_stream *stream);
void augment_outcome_free(augment_outcome *outcome);
/** What the reports of one model and of several have in common: input, repair, triangles, variants. */
json_t *augment_outcome_json(const augment_request *given, const augment_outcome *outcome);
/** Adds what was asked for, and who made it. */
void augment_request_json(json_t *report, const augment_request *given);

/* ---- augment_models.c: several models in a run ---- */

/** Whether the arguments are more than one mesh: several, or a folder, list, table, archive or pattern. */
bool augment_has_several(const cli_run *cli);
/** Makes the variants of all; an exit status. */
int augment_several(cli_run *cli, augment_request *given);

#endif

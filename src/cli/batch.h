/* SPDX-License-Identifier: BSD-3-Clause */
/** What the files of `voxmend batch` share. */
#ifndef VXM_CLI_BATCH_H
#define VXM_CLI_BATCH_H

#include "batch/inputs.h"
#include "batch/supervisor.h"
#include "cli/cli.h"

/** What can be made of a mesh, in the order in which it is made. */
typedef enum batch_product {
  BATCH_REPAIRED,
  BATCH_GRID,
  BATCH_REMESHED,
  BATCH_VARIANTS,
  BATCH_PICTURE,
  BATCH_PRODUCTS
} batch_product;

/** Words of a command line. */
typedef struct batch_words {
  char **words;
  int count, capacity;
} batch_words;

/** Adds a copy; false without memory. */
bool batch_words_add(batch_words *words, const char *format, ...) CLI_PRINTF(2, 3);
/** Adds those of a text, as a shell would take it apart: blanks, quotes and backslashes. False with a message
 * where a quote is not closed. */
bool batch_words_split(batch_words *words, const char *text, batch_error *error);
/** As a shell would have to read them, to be freed. */
char *batch_words_text(char *const *words, int count);
void batch_words_free(batch_words *words);

typedef struct batch_request {
  const char *output, *to, *products[BATCH_PRODUCTS]; /**< products: the options of each, NULL = not wanted */
  batch_words grid_options;                           /**< those given to the batch itself */
  batch_words export_options;
  const char *of_run; /**< an option that is neither of an export nor -o, or NULL */
  const char *format; /**< of grids */
  bool no_grid, reports, dry_run;
  int64_t jobs, shard, shards, threads, sample, pictures;
  double time_limit;
  uint64_t file_limit;
  bool retry[BATCH_STATUSES];
} batch_request;

extern const cli_option batch_options[];
/** Options of voxelize that are about one mesh. */
extern const char *const batch_refused[];

/** Reads the command line; CLI_STOP if it is at fault, or all has been said. */
int batch_read_arguments(cli_run *cli, batch_request *out);

/* ---- batch_job.c: what is made of a mesh, and making it, in a child ---- */

/** What makes jobs, and does them. */
typedef struct batch_maker {
  const batch_request *given;
  const char *output; /**< the folder that is written to */
} batch_maker;

json_t *batch_make_job(const batch_item *item, uint64_t memory, void *maker, batch_error *error);
int batch_do_job(const char *request, int result, void *maker);
/** Adds the option that says which axis is up in a picture of what was made of a mesh; false without memory.
 */
bool batch_add_up(batch_words *words, const batch_request *given, const batch_item *item);
/** What decides about the bytes of outputs, for the plan. */
json_t *batch_make_settings(const batch_request *given);
/** Whether something is made of the colours of a mesh with these options of its own, which may be NULL. */
bool batch_reads_colors(const batch_request *given, const char *options);
/**
 * "voxmend voxelize a.off -o a.binvox ...": repeats what failed of a mesh alone, writing to the present
 * folder; to be freed.
 *
 * @param stage the command that failed; another word, or NULL = all that are run for a mesh, one after
 * another
 */
char *batch_command_line(const batch_item *item, const char *stage, const batch_maker *maker);

/* ---- batch_companions.c ---- */

/**
 * Whether what a mesh file means depends on files beside it: an .obj with materials where colours are wanted,
 * or a .glb whose buffers or pictures are not in it. True, too, where that cannot be told.
 */
bool batch_refers_to_others(const char *path, bool with_colors);
/** A digest of a file, or folder of files, and of the .json beside it; NULL if it is not there. To be freed.
 */
char *batch_file_digest(const char *path);

/* ---- batch_try.c: commands in a child ---- */

/**
 * Runs a command in a child.
 *
 * @param words   ended by NULL
 * @param message descriptor that becomes its standard error; -1 = none
 * @return its exit status; -1 if it crashed or took too long
 */
int batch_run_command(char **words, int message, unsigned seconds);
/**
 * Tries whether the options can be understood, without a mesh; in a child, as they are those of other
 * commands. CLI_STOP after a line.
 */
int batch_try_options(cli_run *cli, const batch_maker *maker);

/* ---- batch_summary.c ---- */

/**
 * Writes summary.json, failures.tsv and index.html, once all shards have come to their end.
 *
 * @param[out] summary to be released
 */
bool batch_tell(json_t **summary, const batch_maker *maker, batch_error *error);

/* ---- batch_dry_run.c ---- */

/** Makes a sample in a folder that is dropped, and tells what all will take. An exit status. */
int batch_dry_run(cli_run *cli, batch_manifest *manifest, const batch_settings *settings, batch_maker *maker);

/* ---- batch_checks.c, batch_export.c: subcommands; exit statuses ---- */

int batch_status_command(cli_run *cli, const char *folder);
int batch_verify_command(cli_run *cli, const char *folder);
int batch_export_command(cli_run *cli, const char *folder, const batch_request *given);

#endif

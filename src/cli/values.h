/* SPDX-License-Identifier: BSD-3-Clause */
/** Files of voxels: the bits or numbers that they hold. */
#ifndef VXM_CLI_VALUES_H
#define VXM_CLI_VALUES_H

#include "cli/cli.h"

/** What a file holds: bits, or numbers; the other is NULL. */
typedef struct cli_values {
  vxm_grid *grid;
  vxm_field *field;
} cli_values;

/** Of CLI_OPTIONS_THRESHOLD. */
cli_reader cli_take_threshold;
/** Whether one of them was given. */
bool cli_threshold_given(const vxm_threshold_options *threshold);
/** Reads either and tells the warnings; a failure is in cli->error. */
vxm_status cli_values_read(cli_run *cli, cli_values *out, const char *path);
void cli_values_free(cli_values *values);
const vxm_space *cli_values_space(const cli_values *values);
/**
 * Makes bits of numbers: by the threshold, or if none is given where nothing is lost by it. CLI_FAILED, and a
 * line that names the options, where something would be.
 *
 * @param why why they have to be bits, for that line
 */
int cli_values_to_bits(cli_run *cli, cli_values *values, const vxm_threshold_options *threshold,
                       const char *path, const char *why);
/** Reads set voxels, as cli_values_read and cli_values_to_bits do. CLI_FAILED, and said so, if not. */
int cli_bits_read(cli_run *cli, vxm_grid **out, const vxm_threshold_options *threshold, const char *path,
                  const char *why);
/** The same as an octree; *out is NULL before. */
int cli_sparse_read(cli_run *cli, vxm_sparse **out, const vxm_threshold_options *threshold, const char *path,
                    const char *why);
/** The row about voxels or numbers, and the keys of the report. */
void cli_values_row(const cli_run *cli, const cli_values *values);
void cli_values_json(json_t *report, const cli_values *values, bool has_hash);

/** "distance, float32 from -0.1 to 0.2" */
void cli_values_text(char text[128], const vxm_field *field);

/* ---- grid_info.c: what info tells of them ---- */

/** Where it stands among several files. */
typedef struct cli_grid_row {
  int width;        /**< of the names */
  bool has_heading; /**< it is the first of the table */
  bool is_next;     /**< something was told before */
} cli_grid_row;

/** Whether a name is that of a grid file that can be read. */
bool cli_is_grid_name(const char *path);
/** Tells of a grid, in full or as a row of a table, and adds its object to `reports`. */
int cli_grid_info(cli_run *cli, json_t *reports, const char *path, const cli_grid_row *row, bool is_row);

#endif

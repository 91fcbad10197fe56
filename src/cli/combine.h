/* SPDX-License-Identifier: BSD-3-Clause */
/** What the parts of combine share. */
#ifndef VXM_CLI_COMBINE_H
#define VXM_CLI_COMBINE_H

#include "cli/cli.h"

typedef struct combine_request {
  const char *output;
  bool sparse;
  vxm_threshold_options threshold;
  vxm_grid_write_options write;
} combine_request;

/** A set of voxels, or values, as one of the three. */
typedef struct combine_operand {
  vxm_grid *grid;
  vxm_sparse *sparse;
  vxm_field *field;
} combine_operand;

void combine_free(combine_operand *operand);
const vxm_space *combine_space(const combine_operand *operand);
/** Reads the next operand, which has to go with the one before; `with` is NULL for the first. */
int combine_read(cli_run *cli, combine_operand *out, const combine_request *given, const char *path,
                 const combine_operand *with);
/** Refuses grids that are not one space: voxels are combined by index. */
int combine_check_spaces(cli_run *cli, const vxm_space *a, const vxm_space *b, const char *const paths[2]);

/** Labels of an operand that have another number in the result, for the report.
 * @param named how many names the operand before had */
void combine_note_labels(json_t *renumbered, const char *path, const vxm_field *from, int64_t named,
                         vxm_set_operation operation, const vxm_field *result);
/** Writes values, and tells what they are. */
int combine_write_field(cli_run *cli, const combine_request *given, const vxm_field *field, json_t *report,
                        const json_t *renumbered);

/** Whether all operands, and the output, are octree files; then those with values go from file to file. */
bool combine_are_octrees(const cli_run *cli, const combine_request *given);
/**
 * Combines octree files with values.
 *
 * @param[out] made false, with CLI_DONE, if none has values
 */
int combine_files(cli_run *cli, const combine_request *given, const vxm_set_operation *operations,
                  json_t *report, bool *made);

#endif

/* SPDX-License-Identifier: BSD-3-Clause */
/** Meshes that are read and repaired before something is made of them. */
#ifndef VXM_CLI_REPAIR_COMMON_H
#define VXM_CLI_REPAIR_COMMON_H

#include "cli/cli.h"

/** A mesh that was read, and repaired unless that was not wanted. */
typedef struct cli_input {
  const char *path;
  char format[48];
  int64_t vertices, faces; /**< as read */
  vxm_mesh *mesh;
  vxm_mesh *as_read;        /**< with its colours, where these are read and the mesh is repaired; or NULL */
  vxm_repair_report repair; /**< no passes without repair */
  double read_ms, repair_ms;
} cli_input;

/** Of --weld, into vxm_repair_options. */
cli_reader cli_take_weld;
/** CLI_STOP if options about the repair were given with --no-repair. */
int cli_check_repair(cli_run *cli);
json_t *cli_passes_json(const vxm_repair_report *report);
/** Says what may help after what the error says. */
void cli_advise(cli_run *cli, const char *advice);

/** Makes the error say why no face is left of a mesh, which had so many before its repair. */
void cli_no_face(cli_run *cli, const char *path, int64_t faces, const vxm_repair_report *report);

/** Warns of parts that the repair has lost. */
void cli_warn_lost(cli_run *cli, const char *path, const vxm_repair_report *report);
/** Reads, and repairs unless `options` is NULL. After CLI_FAILED a line was printed and input->mesh is NULL.
 */
int cli_read_repaired(cli_run *cli, cli_input *input, const char *path, const vxm_repair_options *options);
/** The same, taken apart by labels before it is repaired; by VXM_LABEL_PART it stays together. */
int cli_read_divided(cli_run *cli, cli_input *input, const char *path, vxm_label_by by,
                     const vxm_repair_options *options);

#endif

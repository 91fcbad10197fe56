/* SPDX-License-Identifier: BSD-3-Clause */
/** The path of a tool in a file, for voxmend carve. */
#ifndef VXM_CLI_TOOLPATH_H
#define VXM_CLI_TOOLPATH_H

#include "cli/cli.h"

/** A file of poses, line by line, as they come. */
typedef struct cli_toolpath {
  FILE *file;
  const char *name; /**< for messages */
  int64_t line;     /**< read so far */
  int columns;      /**< of the first pose: 3, 7 or 12; 0 before it */
  bool has_heading; /**< a line of names has been passed over; there is no second */
} cli_toolpath;

/** Opens it, '-' for standard input; CLI_FAILED after a line. */
int cli_toolpath_open(cli_run *cli, cli_toolpath *toolpath, const char *path);
/**
 * Reads the next pose, as vxm_carver_move takes it.
 *
 * @param[out] is_lifted whether an empty line stands before it
 * @param[out] is_end    whether there is none
 * @return CLI_DONE, CLI_FAILED after a line
 */
int cli_toolpath_next(cli_run *cli, cli_toolpath *toolpath, double pose[12], bool *is_lifted, bool *is_end);
/** Closes it, also where it is not open. */
void cli_toolpath_close(cli_toolpath *toolpath);

#endif

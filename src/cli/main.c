/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend: finds the subcommand, runs it and ends with its exit status. */
#include "cli/cli.h"

#include <string.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

const cli_command *const cli_commands[CLI_COMMANDS_MAX + 1] = {
    &cli_command_info,    &cli_command_repair,  &cli_command_remesh,  &cli_command_voxelize,
    &cli_command_convert, &cli_command_combine, &cli_command_compare, &cli_command_carve,
    &cli_command_augment, &cli_command_batch,   &cli_command_view,    &cli_command_bench,
    &cli_command_engines, &cli_command_binvox,  &cli_command_help};

static int refuse(const char *name) {
  static const char *const options[] = {"help", "version", NULL};
  char hint[CLI_LIST_MAX];
  cli_run none = {0};
  if (strncmp(name, "--", 2) == 0)
    cli_usage(&none, "unknown option %s%s", name, cli_suggestion(hint, name + 2, "--", options));
  else if (name[0] == '-')
    cli_usage(&none, "unknown option %s", name);
  else
    cli_usage(&none, "unknown command '%s'%s", name, cli_suggest_command(hint, name));
  return none.status;
}

/** Keeps freed memory for the next step. A page that is given back to the system and asked for again costs as
 * much time as a step that fills it. */
static void keep_memory(void) {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 64 << 20);
#endif
}

int main(int argc, char **argv) {
  keep_memory();
  cli_run none = {0};
  if (argc < 2) {
    cli_usage(&none, "a command is missing");
    return none.status;
  }
  const char *name = argv[1];
  if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) {
    cli_help_overview();
    return cli_flush_output(&none, CLI_DONE);
  }
  if (strcmp(name, "--version") == 0 || strcmp(name, "-V") == 0) {
    printf("voxmend %s\n", vxm_version());
    return cli_flush_output(&none, CLI_DONE);
  }
  const cli_command *command = cli_find_command(name);
  if (!command)
    return refuse(name);
  return cli_run_command(command, argc - 1, argv + 1);
}

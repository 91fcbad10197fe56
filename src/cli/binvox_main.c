/* SPDX-License-Identifier: BSD-3-Clause */
/** binvox: the command 'voxmend binvox' as a program of its own, by the name that scripts call. */
#include "cli/binvox.h"

const cli_command *const cli_commands[CLI_COMMANDS_MAX + 1] = {&cli_command_binvox};

int main(int argc, char **argv) {
  return cli_run_command(&cli_command_binvox, argc, argv);
}

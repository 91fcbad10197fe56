/* SPDX-License-Identifier: BSD-3-Clause */
/** How a program runs one of its commands, and ends. */
#include "cli/cli.h"

#include <errno.h>
#include <signal.h>
#include <string.h>

int cli_flush_output(cli_run *cli, int status) {
  if (fflush(stdout) == 0 && !ferror(stdout))
    return status;
  int reason = errno;
  return status == CLI_DONE || status == CLI_WARNED
             ? cli_fail_text(cli, "<stdout>: cannot write: %s", strerror(reason))
             : status;
}

static int run(const cli_command *command, int argc, char **argv, cli_capture *capture) {
  cli_run cli = {.command = command,
                 .argc = argc,
                 .argv = argv,
                 .progress = "auto",
                 .limits = VXM_CONTEXT_OPTIONS_INIT,
                 .read = VXM_MESH_READ_OPTIONS_INIT,
                 .error = VXM_ERROR_INIT,
                 .warnings = json_array(),
                 .capture = capture,
                 .text = stdout};
  if (capture)
    cli.read.format = capture->format;
  int status = cli_flush_output(&cli, command->run(&cli));
  vxm_context_drop_files(cli.context); /* a failed run leaves no output file */
  vxm_context_destroy(cli.context);
  json_decref(cli.warnings);
  if (capture)
    capture->error = cli.error;
  return status;
}

int cli_capture_command(const char *name, int count, char **words, cli_capture *capture) {
  const cli_command *command = cli_find_command(name);
  return command ? run(command, count, words, capture) : CLI_WRONG_USAGE;
}

int cli_run_command(const cli_command *command, int argc, char **argv) {
  cli_json_start();
  signal(SIGXFSZ, SIG_IGN); /* a write beyond ulimit -f fails, and says so */
  int status = run(command, argc, argv, NULL);
  if (status == CLI_FAILED && cli_signal()) {
    signal(cli_signal(), SIG_DFL); /* ends as the sender of the signal expects */
    raise(cli_signal());
  }
  return status;
}

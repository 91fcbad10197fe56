/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend batch: commands that are tried in a child of their own, as they may end the process. */
#include "cli/batch.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

int batch_run_command(char **words, int message, unsigned seconds) {
  int count = 0, status;
  while (words[count])
    count++;
  fflush(NULL);
  pid_t id = fork();
  if (id == 0) {
    int null = open("/dev/null", O_RDWR | O_CLOEXEC);
    cli_capture capture = {.error = VXM_ERROR_INIT};
    dup2(null, STDIN_FILENO);
    dup2(null, STDOUT_FILENO);
    dup2(message >= 0 ? message : null, STDERR_FILENO);
    alarm(seconds);
    int result = cli_capture_command(words[0], count, words, &capture);
    fflush(NULL);
    _exit(result);
  }
  while (id > 0 && waitpid(id, &status, 0) < 0)
    if (errno != EINTR)
      return -1;
  return id > 0 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* ---- Trying options ---- */

/** What the child said about its options: its last line, without the program's name, as ours. */
static int tell_usage(cli_run *cli, int pipe_end) {
  char text[1024];
  ssize_t got = read(pipe_end, text, sizeof text - 1);
  text[got > 0 ? got : 0] = '\0';
  fputs(text, stderr);
  cli->status = CLI_WRONG_USAGE;
  return CLI_STOP;
}

static int try_command(cli_run *cli, const json_t *command) {
  int ends[2];
  size_t count = json_array_size(command);
  char **words = calloc(count + 1, sizeof *words);
  if (!words || pipe2(ends, O_CLOEXEC) != 0) {
    free(words);
    return cli_usage(cli, "cannot try the options: %s", strerror(errno));
  }
  for (size_t w = 0; w < count; w++)
    words[w] = (char *)(uintptr_t)json_string_value(json_array_get(command, w));
  int status = batch_run_command(words, ends[1], 60);
  close(ends[1]);
  int result = status == CLI_WRONG_USAGE ? tell_usage(cli, ends[0]) : CLI_END;
  close(ends[0]);
  free(words);
  return result;
}

int batch_try_options(cli_run *cli, const batch_maker *maker) {
  char name[] = "no-such-mesh", path[] = "/nonexistent/no-such-mesh.off";
  batch_item item = {.id = name, .path = path, .output = name};
  batch_maker nowhere = {.given = maker->given, .output = "/nonexistent"};
  batch_error error;
  json_t *job = batch_make_job(&item, 0, &nowhere, &error), *command;
  size_t c;
  int result = job ? CLI_END : cli_usage(cli, "%s", error.text);
  json_array_foreach(json_object_get(job, "commands"), c, command) if (result == CLI_END) result =
      try_command(cli, command);
  json_decref(job);
  return result;
}

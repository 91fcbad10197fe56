/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend batch export: the journals as a table, the grids as tars or arrays. */
#include "batch/export_sqlite.h"
#include "cli/batch.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/** Where the package, or what it needs, is missing, one line says so in place of a traceback. */
static const char program[] =
    "import sys\n"
    "try:\n"
    "    from voxmend.batch import main\n"
    "except ImportError as problem:\n"
    "    sys.exit('voxmend: %s lacks the Python package voxmend, or what it needs (%s); the variable PYTHON "
    "'\n"
    "             'names a Python that has it' % (sys.executable or 'Python', problem))\n"
    "sys.exit(main(sys.argv[1:]))\n";

/** Starts it with its standard output in *report, to be closed; an errno, 0 = it runs. */
static int start(pid_t *id, FILE **report, char *const *words) {
  posix_spawn_file_actions_t files;
  int channel[2];
  if (pipe2(channel, O_CLOEXEC) != 0)
    return errno;
  *report = fdopen(channel[0], "r");
  int failure = *report ? posix_spawn_file_actions_init(&files) : errno;
  if (failure == 0) {
    failure = posix_spawn_file_actions_adddup2(&files, channel[1], STDOUT_FILENO);
    if (failure == 0)
      failure = posix_spawnp(id, words[0], &files, NULL, words, environ);
    posix_spawn_file_actions_destroy(&files);
  }
  close(channel[1]);
  if (failure != 0)
    *report ? fclose(*report) : close(channel[0]);
  return failure;
}

/** Its report, to be released, NULL where that cannot be read; whether it came to a good end. */
static bool end(pid_t id, FILE *channel, json_t **report) {
  int ended = 0;
  *report = json_loadf(channel, 0, NULL);
  fclose(channel);
  while (waitpid(id, &ended, 0) < 0 && errno == EINTR)
    ;
  return WIFEXITED(ended) && WEXITSTATUS(ended) == 0;
}

/** Tars and arrays, and tables of Parquet, are made by the Python package, with the libraries that are at
 * home there. */
static int export_by_python(cli_run *cli, const char *folder, const batch_request *given, json_t **report) {
  const char *python = getenv("PYTHON");
  if (!python || !*python)
    python = "python3";
  batch_words words = {NULL, 0, 0};
  bool good = batch_words_add(&words, "%s", python) && batch_words_add(&words, "-c") &&
              batch_words_add(&words, "%s", program) && batch_words_add(&words, "export") &&
              batch_words_add(&words, "--to=%s", given->to) &&
              batch_words_add(&words, "--output=%s", given->output);
  for (int w = 0; good && w < given->export_options.count; w++)
    good = batch_words_add(&words, "%s", given->export_options.words[w]);
  good = good && batch_words_add(&words, "--") && batch_words_add(&words, "%s", folder);
  FILE *channel = NULL;
  pid_t id = 0;
  int failure = good ? start(&id, &channel, words.words) : ENOMEM;
  batch_words_free(&words);
  if (failure != 0)
    return cli_fail_text(cli, "%s: cannot start it for --to %s: %s", python, given->to, strerror(failure));
  if (!end(id, channel, report))
    return CLI_FAILED; /* it has said why */
  return *report ? CLI_DONE
                 : cli_fail_text(cli, "%s: its package voxmend told nothing of %s", python, given->output);
}

static int export_sqlite(cli_run *cli, const char *folder, const char *path, json_t **report) {
  batch_error error;
  int64_t rows = 0;
  if (!batch_export_sqlite(folder, path, &rows, &error))
    return cli_fail_text(cli, "%s", error.text);
  *report = json_pack("{s:s, s:s, s:I}", "output", path, "format", "sqlite", "meshes", (json_int_t)rows);
  return CLI_DONE;
}

enum { SQLITE, PARQUET, WEBDATASET, ZARR };

static const char *const kinds[] = {"sqlite", "parquet", "webdataset", "zarr", NULL};

/** CLI_STOP after a line if an option is for another kind of export. */
static int check_options(cli_run *cli, const batch_words *options, int kind) {
  static const struct {
    const char *name;
    int kind;
  } known[] = {{"--max-bytes", WEBDATASET}, {"--content", WEBDATASET}, {"--shuffle", WEBDATASET},
               {"--split", ZARR},           {"--chunk-bytes", ZARR},   {"--zarr-format", ZARR}};
  for (int w = 0; w < options->count; w++)
    for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
      size_t length = strlen(known[k].name);
      bool is_it = strncmp(options->words[w], known[k].name, length) == 0 && options->words[w][length] == '=';
      if (is_it && known[k].kind != kind)
        return cli_usage(cli, "%s is for --to %s, not %s", known[k].name, kinds[known[k].kind], kinds[kind]);
    }
  return CLI_END;
}

int batch_export_command(cli_run *cli, const char *folder, const batch_request *given) {
  json_t *report = NULL;
  int kind = SQLITE;
  if (!given->to || !given->output)
    return cli_usage(cli, "an export needs --to sqlite|parquet|webdataset|zarr and -o PATH"), cli->status;
  if (cli_choose(cli, &kind, "to", given->to, kinds) == CLI_STOP ||
      check_options(cli, &given->export_options, kind) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  int status = kind == SQLITE ? export_sqlite(cli, folder, given->output, &report)
                              : export_by_python(cli, folder, given, &report);
  if (status != CLI_DONE) {
    json_decref(report);
    return status;
  }
  if (cli_summary(cli))
    cli_row(cli, "output", "%s (%s): %" JSON_INTEGER_FORMAT " meshes", given->output, given->to,
            json_integer_value(json_object_get(report, "meshes")));
  return cli_finish(cli, report);
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** Messages on standard error, tables, and the report as JSON. */
#include "cli/cli.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* ---- Messages ---- */

/** Errors about memory end with a hint that is of use only where the resolution can be chosen. */
static void trim_hint(cli_run *cli) {
  static const char hint[] = " or lower the resolution (-r)";
  size_t length = strlen(cli->error.text), tail = sizeof hint - 1;
  for (const cli_option *option = cli->command->options; option->name; option++)
    if (option->key == 'r')
      return;
  if (length > tail && strcmp(cli->error.text + length - tail, hint) == 0)
    cli->error.text[length - tail] = '\0';
}

int cli_fail(cli_run *cli) {
  cli_progress_clear(cli);
  if (cli->error.code == VXM_ERROR_CANCELLED && cli_signal())
    fprintf(stderr, "voxmend: interrupted\n");
  else {
    trim_hint(cli);
    fprintf(stderr, "voxmend: %s\n", cli->error.text);
  }
  return CLI_FAILED;
}

int cli_fail_text(cli_run *cli, const char *format, ...) {
  cli_progress_clear(cli);
  fprintf(stderr, "voxmend: ");
  va_list arguments;
  va_start(arguments, format);
  vfprintf(stderr, format, arguments);
  va_end(arguments);
  fputc('\n', stderr);
  return CLI_FAILED;
}

void cli_warn(cli_run *cli, const char *format, ...) {
  char text[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  json_array_append_new(cli->warnings, cli_json_text(text));
  cli->warning_count++;
  if (cli->quiet)
    return;
  cli_progress_clear(cli);
  fprintf(stderr, "voxmend: warning: %s\n", text);
}

void cli_warn_mesh(cli_run *cli, const char *path, const vxm_mesh *mesh) {
  for (int64_t i = 0; i < vxm_mesh_warning_count(mesh); i++)
    cli_warn(cli, "%s: %s", cli_shown(path, "<stdin>"), vxm_mesh_warning(mesh, i));
}

void cli_warn_grid(cli_run *cli, const char *path, const vxm_grid *grid) {
  for (int64_t i = 0; i < vxm_grid_warning_count(grid); i++)
    cli_warn(cli, "%s: %s", cli_shown(path, "<stdin>"), vxm_grid_warning(grid, i));
}

bool cli_summary(const cli_run *cli) {
  return !cli->json && !cli->quiet;
}

void cli_row(const cli_run *cli, const char *label, const char *format, ...) {
  fprintf(cli->text, "%-10s ", label);
  va_list arguments;
  va_start(arguments, format);
  vfprintf(cli->text, format, arguments);
  va_end(arguments);
  fputc('\n', cli->text);
}

void cli_rows_space(const cli_run *cli, const vxm_space *space) {
  const double *o = space->origin, *s = space->voxel_size;
  cli_row(cli, "grid", "%" PRId64 " x %" PRId64 " x %" PRId64 " from (%.6g, %.6g, %.6g)", space->dims[0],
          space->dims[1], space->dims[2], o[0], o[1], o[2]);
  if (s[0] == s[1] && s[1] == s[2])
    cli_row(cli, "voxel size", "%.6g", s[0]);
  else
    cli_row(cli, "voxel size", "%.6g x %.6g x %.6g", s[0], s[1], s[2]);
}

const char *cli_shown(const char *path, const char *standard) {
  return strcmp(path, "-") == 0 ? standard : path;
}

double cli_clock(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

/* ---- JSON ---- */

json_t *cli_json_text(const char *text) {
  json_t *value = json_string(text);
  if (value)
    return value;
  char *copy = strdup(text);
  if (!copy)
    return NULL;
  for (char *c = copy; *c; c++)
    if ((unsigned char)*c >= 0x80)
      *c = '?';
  value = json_string(copy);
  free(copy);
  return value;
}

json_t *cli_json_number(double value) {
  return isfinite(value) ? json_real(value) : json_null();
}

json_t *cli_json_numbers(const double *values, int count) {
  json_t *array = json_array();
  for (int i = 0; i < count; i++)
    json_array_append_new(array, cli_json_number(values[i]));
  return array;
}

json_t *cli_json_space(const vxm_space *space) {
  json_t *dims = json_array();
  for (int axis = 0; axis < 3; axis++)
    json_array_append_new(dims, json_integer(space->dims[axis]));
  json_t *object = json_object();
  json_object_set_new(object, "dims", dims);
  json_object_set_new(object, "origin", cli_json_numbers(space->origin, 3));
  json_object_set_new(object, "voxel_size", cli_json_numbers(space->voxel_size, 3));
  return object;
}

json_t *cli_json_hash(uint64_t hash) {
  char text[17];
  snprintf(text, sizeof text, "%016" PRIx64, hash);
  return json_string(text);
}

enum { JSON_STYLE = JSON_INDENT(2) | JSON_REAL_PRECISION(17) };

static bool report_failed(cli_run *cli, int reason) {
  cli_fail_text(cli, "%s: cannot write the report: %s", cli->report, strerror(reason));
  return false;
}

bool cli_file_open(cli_file *file, const char *path) {
  *file = (cli_file){.path = path};
  struct stat info;
  bool replace = stat(path, &info) != 0 || S_ISREG(info.st_mode);
  if (replace) {
    size_t size = strlen(path) + 32;
    file->temporary = malloc(size);
    if (!file->temporary)
      return false;
    snprintf(file->temporary, size, "%s.%ld.tmp", path, (long)getpid());
  }
  file->stream = fopen(replace ? file->temporary : path, "we");
  if (file->stream)
    return true;
  int reason = errno;
  free(file->temporary);
  file->temporary = NULL;
  errno = reason;
  return false;
}

bool cli_file_commit(cli_file *file) {
  if (fflush(file->stream) != 0 || ferror(file->stream))
    return false;
  if (file->temporary && rename(file->temporary, file->path) != 0)
    return false;
  fclose(file->stream);
  free(file->temporary);
  *file = (cli_file){0};
  return true;
}

void cli_file_drop(cli_file *file) {
  if (file->stream) {
    fclose(file->stream);
    if (file->temporary)
      unlink(file->temporary);
  }
  free(file->temporary);
  *file = (cli_file){0};
}

/** The folder that a file is in, with all links followed; NULL if there is none. To be freed. */
static char *folder_of(const char *path) {
  const char *slash = strrchr(path, '/');
  char *folder = slash ? strndup(path, (size_t)(slash - path + 1)) : strdup(".");
  char *real = folder ? realpath(folder, NULL) : NULL;
  free(folder);
  return real;
}

bool cli_same_file(const char *a, const char *b) {
  struct stat first, second;
  if (strcmp(a, "-") == 0 || strcmp(b, "-") == 0)
    return false;
  bool a_is_there = stat(a, &first) == 0, b_is_there = stat(b, &second) == 0;
  if (a_is_there && b_is_there)
    return S_ISREG(first.st_mode) && first.st_dev == second.st_dev && first.st_ino == second.st_ino;
  if (a_is_there || b_is_there)
    return false;
  const char *a_name = strrchr(a, '/'), *b_name = strrchr(b, '/');
  if (strcmp(a_name ? a_name + 1 : a, b_name ? b_name + 1 : b) != 0)
    return false;
  char *a_folder = folder_of(a), *b_folder = folder_of(b);
  bool same = a_folder && b_folder && strcmp(a_folder, b_folder) == 0;
  free(b_folder);
  free(a_folder);
  return same;
}

int cli_check_report(cli_run *cli, const char *output) {
  for (int i = 0; i < cli->argument_count && cli->report; i++)
    if (cli_same_file(cli->report, cli->arguments[i]))
      return cli_usage(cli, "--report would overwrite %s, which is read", cli->arguments[i]);
  if (cli->report && output && cli_same_file(cli->report, output))
    return cli_usage(cli, "--report and -o name the same file");
  return CLI_END;
}

bool cli_report_open(cli_run *cli) {
  return !cli->report || cli_file_open(&cli->report_file, cli->report) || report_failed(cli, errno);
}

static bool write_report(cli_run *cli, const json_t *report) {
  FILE *stream = cli->report_file.stream;
  bool good = json_dumpf(report, stream, JSON_STYLE) == 0 && fputc('\n', stream) != EOF;
  return (good && cli_file_commit(&cli->report_file)) || report_failed(cli, errno);
}

int cli_finish(cli_run *cli, json_t *report) {
  cli_progress_clear(cli);
  bool good = true;
  if (cli->json && (json_dumpf(report, stdout, JSON_STYLE) != 0 || putchar('\n') == EOF))
    good = cli_fail_text(cli, "<stdout>: cannot write the report") == CLI_DONE;
  if (good && cli->report)
    good = write_report(cli, report);
  json_decref(report);
  if (!good)
    return CLI_FAILED;
  return cli->strict && cli->warning_count > 0 ? CLI_WARNED : CLI_DONE;
}

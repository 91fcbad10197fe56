/* SPDX-License-Identifier: BSD-3-Clause */
/** Messages on standard error, tables, and the report as JSON. */
#include "batch/batch.h"
#include "cli/cli.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- Messages ---- */

typedef struct wording {
  const char *said, *meant;
} wording;

static bool has_resolution(const cli_option *options) {
  for (; options && options->name; options++)
    if (options->letter == 'r')
      return true;
  return false;
}

/** Advice of the library says "resolution (-r)". Replaces that by the option that has set the size of voxels,
 * or drops it where no option does. */
static void reword(const cli_run *cli, char *text, size_t size) {
  static const wording by_voxel_size[] = {{"lower the resolution (-r)", "take a larger --voxel-size"},
                                          {"a higher resolution (-r)", "a smaller --voxel-size"}},
                       by_like[] = {{"lower the resolution (-r)", "take a smaller grid for --like"},
                                    {"a higher resolution (-r)", "a finer grid for --like"}},
                       fixed[] = {{" or lower the resolution (-r)", ""},
                                  {"lower the resolution (-r), or ", ""}};
  if (cli->sized_by == CLI_SIZED_BY_RESOLUTION &&
      (has_resolution(cli->command->options) || has_resolution(cli->command->others)))
    return;
  const wording *words = cli->sized_by == CLI_SIZED_BY_VOXEL_SIZE ? by_voxel_size
                         : cli->sized_by == CLI_SIZED_BY_LIKE     ? by_like
                                                                  : fixed;
  for (int w = 0; w < 2; w++) {
    const char *at = strstr(text, words[w].said);
    char *line;
    if (!at ||
        asprintf(&line, "%.*s%s%s", (int)(at - text), text, words[w].meant, at + strlen(words[w].said)) < 0)
      continue;
    snprintf(text, size, "%s", line);
    free(line);
  }
}

int cli_fail(cli_run *cli) {
  cli_progress_clear(cli);
  if (cli->error.code == VXM_ERROR_CANCELLED && cli_signal())
    fprintf(stderr, "voxmend: interrupted\n");
  else {
    reword(cli, cli->error.text, sizeof cli->error.text);
    fprintf(stderr, "voxmend: %s\n", cli->error.text);
  }
  return CLI_FAILED;
}

/** Prints control codes as '?': names of files, and texts in them, must not steer the terminal. */
static void put_printable(FILE *to, const char *text) {
  for (; *text; text++)
    fputc((unsigned char)*text < 0x20 || *text == 0x7f ? '?' : *text, to);
}

void cli_put_text(const cli_run *cli, const char *text, int width) {
  int length = (int)strnlen(text, INT_MAX);
  put_printable(cli->text, text);
  if (length < width)
    fprintf(cli->text, "%*s", width - length, "");
}

void cli_put_line(FILE *to, const char *format, va_list arguments) {
  char *text;
  if (vasprintf(&text, format, arguments) < 0)
    return;
  put_printable(to, text);
  free(text);
}

int cli_fail_text(cli_run *cli, const char *format, ...) {
  cli_progress_clear(cli);
  fprintf(stderr, "voxmend: ");
  va_list arguments;
  va_start(arguments, format);
  cli_put_line(stderr, format, arguments);
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
  reword(cli, text, sizeof text);
  json_array_append_new(cli->warnings, cli_json_text(text));
  cli->warning_count++;
  if (cli->quiet)
    return;
  cli_progress_clear(cli);
  fputs("voxmend: warning: ", stderr);
  put_printable(stderr, text);
  fputc('\n', stderr);
}

void cli_warn_mesh(cli_run *cli, const char *path, const vxm_mesh *mesh, int64_t told) {
  for (int64_t i = told; i < vxm_mesh_warning_count(mesh); i++)
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
  cli_put_line(cli->text, format, arguments);
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
  return batch_clock_ms();
}

/* ---- JSON ---- */

json_t *cli_json_text(const char *text) {
  return batch_json_string(text);
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

/* ---- Files ---- */

bool cli_try_file(cli_run *cli, const char *path) {
  struct stat info;
  if (stat(path, &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode))
    return true; /* opening a pipe and closing it again is noticed at its other end */
  vxm_status status = vxm_file_write(cli->context, path, "", 0, &cli->error);
  vxm_context_drop_files(cli->context);
  if (status == VXM_OK)
    status = vxm_context_hold_files(cli->context, &cli->error);
  return status == VXM_OK || cli_fail(cli) == CLI_DONE;
}

int cli_publish(cli_run *cli) {
  return vxm_context_publish_files(cli->context, &cli->error) == VXM_OK ? CLI_DONE : cli_fail(cli);
}

/** Set where jansson found no memory: it leaves out what it cannot hold, and seldom says so. */
static atomic_bool json_starved;

static void *json_allocate(size_t size) {
  void *block = malloc(size);
  if (!block)
    json_starved = true;
  return block;
}

void cli_json_start(void) {
  json_set_alloc_funcs(json_allocate, free);
}

/** The report as text that ends with a line, to be freed; NULL after a failure that has been told. */
static char *report_text(cli_run *cli, const json_t *report) {
  char *text = json_dumps(report, JSON_STYLE);
  size_t length = text ? strlen(text) : 0;
  char *line = text ? realloc(text, length + 2) : NULL;
  if (line && !json_starved) {
    memcpy(line + length, "\n", 2);
    return line;
  }
  free(line ? line : text);
  cli_fail_text(cli, "out of memory for the report: free some");
  return NULL;
}

void cli_note_companions(cli_run *cli, const vxm_mesh *mesh) {
  json_t *names = cli->capture ? cli->capture->companions : NULL;
  for (int64_t c = 0; names && c < vxm_mesh_companion_count(mesh); c++)
    json_array_append_new(names, cli_json_text(vxm_mesh_companion(mesh, c)));
}

static int write_report(cli_run *cli, const char *text) {
  vxm_status status = vxm_file_write(cli->context, cli->report, text, strlen(text), &cli->error);
  return status == VXM_OK ? CLI_DONE : cli_fail(cli);
}

/** What was printed may still be lost when it is flushed, on a full disk for one. */
static int flush_output(cli_run *cli) {
  return fflush(stdout) == 0 && !ferror(stdout)
             ? CLI_DONE
             : cli_fail_text(cli, "<stdout>: cannot write: %s", strerror(errno));
}

int cli_finish(cli_run *cli, json_t *report) {
  cli_progress_clear(cli);
  if (cli->capture)
    cli->capture->report = json_incref(report);
  bool is_wanted = cli->json || cli->report;
  char *text = is_wanted ? report_text(cli, report) : NULL;
  json_decref(report);
  if (is_wanted && !text)
    return CLI_FAILED;
  int status = CLI_DONE;
  if (cli->json && fputs(text, stdout) == EOF)
    status = cli_fail_text(cli, "<stdout>: cannot write: %s", strerror(errno));
  if (status == CLI_DONE)
    status = flush_output(cli);
  if (status == CLI_DONE && cli->report)
    status = write_report(cli, text);
  free(text);
  if (status == CLI_DONE)
    status = cli_publish(cli);
  if (status != CLI_DONE)
    return status;
  return cli->strict && cli->warning_count > 0 ? CLI_WARNED : CLI_DONE;
}

const char *cli_bytes_text(char text[24], uint64_t bytes) {
  static const char *const units[] = {"bytes", "KiB", "MiB", "GiB", "TiB"};
  double value = (double)bytes;
  int unit = 0;
  for (; unit < 4 && value >= (unit == 0 ? 1024 : 1023.95); unit++) /* 1024.0 of one is 1.0 of the next */
    value /= 1024;
  snprintf(text, 24, unit == 0 ? "%.0f %s" : "%.1f %s", value, units[unit]);
  return text;
}

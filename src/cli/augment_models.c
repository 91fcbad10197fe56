/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend augment of several meshes: a folder of variants for each, or one stream of all. */
#include "batch/inputs.h"
#include "cli/augment.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bool augment_has_several(const cli_run *cli) {
  return cli->argument_count > 1 || (cli->argument_count == 1 && strcmp(cli->arguments[0], "-") != 0 &&
                                     batch_is_several(cli->arguments[0]));
}

typedef struct several {
  batch_manifest manifest;
  json_t *models, *failures; /**< the report of each */
  vxm_sampler *sampler;
  augment_stream *stream; /**< NULL = folders */
  bool is_new;            /**< the folder of all was made here */
  int64_t made, variants;
  uint64_t bytes;
} several;

static int fail(cli_run *cli, const batch_error *error) {
  return cli_fail_text(cli, "%s", error->text);
}

/** Whether there is nothing of a former run in the folder of a mesh; else after a line. */
static bool check_former(cli_run *cli, const augment_request *given, const batch_item *item) {
  augment_request own = *given;
  char *folder = NULL;
  if (augment_is_stream(given))
    return true;
  if (asprintf(&folder, "%s/%s", given->output, item->output) < 0)
    return cli_fail_text(cli, "out of memory") == CLI_DONE;
  own.output = folder;
  bool good = augment_check_former(cli, &own) != CLI_STOP;
  free(folder);
  return good;
}

/** Says before any work what is not taken. */
static int check(cli_run *cli, const augment_request *given, const batch_manifest *manifest) {
  for (int64_t i = 0; i < manifest->count; i++) {
    const batch_item *item = &manifest->items[i];
    if (item->member)
      return cli_fail_text(cli, "%s: it is an archive; unpack it, or use 'voxmend batch --augment'",
                           item->path);
    if (item->options)
      return cli_fail_text(cli, "%s: its row has options, which 'voxmend batch --augment' takes", item->id);
    if (!check_former(cli, given, item))
      return cli->status;
  }
  if ((uint64_t)given->variant.model + (uint64_t)manifest->count - 1 > UINT32_MAX)
    return cli_fail_text(cli, "--model and %" PRId64 " meshes go beyond model 4294967295", manifest->count);
  return CLI_DONE;
}

/** Makes the folders above "OUT/a/b"; the last is made with the files in it. */
static int make_folders(cli_run *cli, const char *root, const char *path) {
  char *copy = strdup(path);
  int status = copy ? CLI_DONE : cli_fail_text(cli, "out of memory");
  for (char *slash = copy ? copy + strlen(root) : NULL; slash && status == CLI_DONE;
       slash = strchr(slash + 1, '/')) {
    *slash = '\0';
    if (mkdir(copy, 0777) != 0 && errno != EEXIST)
      status = cli_fail_text(cli, "%s: cannot make the folder: %s", copy, strerror(errno));
    *slash = '/';
  }
  free(copy);
  return status;
}

/** A mesh that failed leaves no folder behind. */
static void remove_folders(const char *root, const char *path) {
  char *copy = strdup(path);
  for (char *slash = copy ? strrchr(copy, '/') : NULL; slash && slash >= copy + strlen(root);
       slash = strrchr(copy, '/')) {
    *slash = '\0';
    if (rmdir(copy) != 0)
      break;
  }
  free(copy);
}

/** The request for one of them; CLI_FAILED after a line. Its output is to be freed. */
static int request_of(cli_run *cli, augment_request *out, const augment_request *given,
                      const batch_manifest *manifest, int64_t i) {
  const batch_item *item = &manifest->items[i];
  char *folder = NULL;
  *out = *given;
  out->input = item->path;
  out->variant.model = given->variant.model + (uint32_t)i;
  out->model_at = i;
  out->model_of = manifest->count;
  if (augment_is_stream(given))
    return CLI_DONE;
  if (asprintf(&folder, "%s/%s", given->output, item->output) < 0)
    return cli_fail_text(cli, "out of memory");
  out->output = folder;
  int status = make_folders(cli, given->output, folder);
  if (status == CLI_DONE && augment_check_folder(cli, out) == CLI_STOP)
    status = CLI_FAILED;
  if (status == CLI_DONE)
    return CLI_DONE;
  free(folder);
  out->output = given->output;
  return status;
}

static int make(cli_run *cli, several *s, const augment_request *given, int64_t i) {
  augment_request own;
  augment_outcome made = AUGMENT_OUTCOME_INIT;
  json_array_clear(cli->warnings);
  int status = request_of(cli, &own, given, &s->manifest, i);
  if (status == CLI_DONE)
    status = augment_model(cli, &made, &own, s->sampler, s->stream);
  if (status == CLI_DONE) {
    const batch_item *item = &s->manifest.items[i];
    json_t *report = augment_outcome_json(&own, &made);
    if (item->kind)
      json_object_set_new(report, "class", cli_json_text(item->kind));
    if (item->split)
      json_object_set_new(report, "split", cli_json_text(item->split));
    json_object_set_new(report, "warnings", json_copy(cli->warnings));
    json_array_append_new(s->models, report);
    s->made++;
    s->variants += made.made;
    s->bytes += made.folder.bytes;
  }
  if (status != CLI_DONE)
    json_array_append_new(s->failures,
                          json_pack("{s:o, s:I}", "file", cli_json_text(s->manifest.items[i].path), "model",
                                    (json_int_t)given->variant.model + i));
  if (own.output != given->output) {
    if (status != CLI_DONE && s->is_new)
      remove_folders(given->output, own.output);
    free((char *)(uintptr_t)own.output);
  }
  augment_outcome_free(&made);
  return status;
}

/* ---- models.tsv ---- */

/** With tabs, ends of lines and quotes in it a cell stands in quotes, each of its own twice, as in tables
 * that are read: its name still leads to the file. */
static void put_cell(FILE *file, const char *text, char end) {
  bool is_quoted = text && strpbrk(text, "\t\n\r\"");
  if (is_quoted)
    fputc('"', file);
  for (; text && *text; text++) {
    if (*text == '"')
      fputc('"', file);
    fputc(*text, file);
  }
  if (is_quoted)
    fputc('"', file);
  fputc(end, file);
}

/** Those that were made, a row each: what a training program reads beside the variants. */
static int write_list(cli_run *cli, const several *s, const augment_request *given) {
  char *text = NULL, *path = NULL;
  size_t size = 0, m;
  json_t *model;
  FILE *file = open_memstream(&text, &size);
  if (!file)
    return cli_fail_text(cli, "out of memory");
  fputs("model\tfolder\tclass\tsplit\tvariants\tmesh\n", file);
  json_array_foreach(s->models, m, model) {
    const batch_item *item =
        &s->manifest.items[json_integer_value(json_object_get(model, "model")) - given->variant.model];
    fprintf(file, "%" JSON_INTEGER_FORMAT "\t", json_integer_value(json_object_get(model, "model")));
    put_cell(file, item->output, '\t');
    put_cell(file, item->kind, '\t');
    put_cell(file, item->split, '\t');
    fprintf(file, "%" JSON_INTEGER_FORMAT "\t", json_integer_value(json_object_get(model, "variants")));
    put_cell(file, item->path, '\n');
  }
  bool good = fclose(file) == 0 && asprintf(&path, "%s/models.tsv", given->output) >= 0;
  int status = !good ? cli_fail_text(cli, "out of memory")
               : vxm_file_write(NULL, path, text, size, &cli->error) == VXM_OK ? CLI_DONE
                                                                               : cli_fail(cli);
  free(path);
  free(text);
  return status;
}

/* ---- All ---- */

static json_t *report(const cli_run *cli, const several *s, const augment_request *given, double total_ms) {
  json_t *object = json_object();
  json_object_set(object, "models", s->models);
  json_object_set(object, "failures", s->failures);
  json_object_set_new(object, "passed_over", json_integer(s->manifest.passed_over));
  json_object_set_new(object, "output", cli_json_text(given->output));
  json_object_set_new(object, "variants", json_integer(s->variants));
  json_object_set_new(object, "file_bytes", json_integer((json_int_t)s->bytes));
  augment_request_json(object, given);
  json_object_set_new(object, "time_ms", json_pack("{s:o}", "total", cli_json_number(total_ms)));
  json_object_set_new(object, "peak_bytes", json_integer((json_int_t)vxm_context_peak_bytes(cli->context)));
  return object;
}

static void summarize(const cli_run *cli, const several *s, const augment_request *given, double total_ms) {
  int64_t n = given->sampler.resolution;
  cli_row(cli, "models", "%" PRId64 " of %" PRId64, s->made, s->manifest.count);
  if (s->manifest.passed_over > 0)
    cli_row(cli, "passed over", "%" PRId64 " files that are no meshes:%s", s->manifest.passed_over,
            s->manifest.note);
  cli_row(cli, "variants",
          "%" PRId64 " of %" PRId64 " x %" PRId64 " x %" PRId64 " voxels, of each from %" PRId64
          " of epoch %" PRIu32 " on, seed %" PRIu64,
          s->variants, n, n, n, given->first, given->variant.epoch, given->sampler.seed);
  cli_engine_summarize(cli, &given->engine);
  if (augment_is_stream(given))
    cli_row(cli, "output", "<stdout> (%s)", given->format);
  else
    cli_row(cli, "output", "%s (%s), %" PRIu64 " bytes; models.tsv tells which is which", given->output,
            given->format, s->bytes);
  cli_row(cli, "time", "%.1f ms", total_ms);
}

/** One after another. A stream ends where one fails: its reader counts on each. */
static int make_each(cli_run *cli, several *s, const augment_request *given) {
  int status = augment_is_stream(given) ? augment_stream_open(cli, &s->stream, given, s->sampler) : CLI_DONE;
  for (int64_t i = 0; status == CLI_DONE && i < s->manifest.count; i++)
    if (make(cli, s, given, i) != CLI_DONE && (s->stream || cli_signal()))
      status = CLI_FAILED;
  status = augment_stream_close(cli, s->stream, status);
  return status == CLI_DONE && !augment_is_stream(given) && s->made > 0 ? write_list(cli, s, given) : status;
}

static int make_all(cli_run *cli, several *s, augment_request *given) {
  struct stat info;
  double start = cli_clock();
  given->model_of = s->manifest.count;
  s->is_new = !augment_is_stream(given) && stat(given->output, &info) != 0;
  int status = augment_open_sampler(cli, &s->sampler, given);
  if (status == CLI_DONE)
    status = make_each(cli, s, given);
  json_array_clear(cli->warnings); /* they are in the reports of the models */
  cli_progress_clear(cli);
  if (status != CLI_DONE)
    return status;
  cli_engine_warn(cli, &given->engine);
  double total_ms = cli_clock() - start;
  if (cli_summary(cli) && s->made > 0)
    summarize(cli, s, given, total_ms);
  status = cli_finish(cli, report(cli, s, given, total_ms));
  return json_array_size(s->failures) > 0 ? CLI_FAILED : status;
}

int augment_several(cli_run *cli, augment_request *given) {
  batch_error error;
  several s = {.models = json_array(), .failures = json_array()};
  const char **extensions = cli_mesh_extensions();
  batch_inputs inputs = {cli->arguments, cli->argument_count, extensions,
                         augment_is_stream(given) ? NULL : given->output};
  int status = !extensions || !s.models || !s.failures ? cli_fail_text(cli, "out of memory") : CLI_DONE;
  if (status == CLI_DONE && !batch_inputs_read(&s.manifest, &inputs, &error))
    status = fail(cli, &error);
  if (status == CLI_DONE && *s.manifest.warning)
    cli_warn(cli, "%s", s.manifest.warning);
  if (status == CLI_DONE)
    status = check(cli, given, &s.manifest);
  if (status == CLI_DONE)
    status = make_all(cli, &s, given);
  vxm_sampler_destroy(s.sampler);
  json_decref(s.models);
  json_decref(s.failures);
  batch_manifest_free(&s.manifest);
  cli_mesh_extensions_free(extensions);
  return status;
}

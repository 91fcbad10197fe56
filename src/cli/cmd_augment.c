/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend augment: variants of models, into folders or a stream. */
#include "cli/augment.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* ---- A list of rotations ---- */

static bool add_number(double **numbers, size_t *count, size_t *room, double value) {
  if (*count == *room) {
    size_t wanted = *room ? 2 * *room : 90;
    double *grown = realloc(*numbers, wanted * sizeof *grown);
    if (!grown)
      return false;
    *numbers = grown;
    *room = wanted;
  }
  (*numbers)[(*count)++] = value;
  return true;
}

/** Passes over a byte order mark, which spreadsheets write before UTF-8. @return 0 for a file that begins
 * like one but has another byte in it, else 1 */
static int pass_mark(FILE *file) {
  int c = getc(file);
  if (c == 0xef)
    return getc(file) == 0xbb && getc(file) == 0xbf;
  ungetc(c, file);
  return 1;
}

/** Numbers separated by blanks, commas or lines; nine make a matrix. */
static int read_rotations(cli_run *cli, augment_request *given, double **numbers) {
  const char *path = given->rotations;
  FILE *file = fopen(path, "re");
  if (!file)
    return cli_fail_text(cli, "%s: cannot read the rotations: %s", path, strerror(errno));
  size_t count = 0, room = 0;
  bool good = true;
  int got = pass_mark(file);
  double value;
  while (good && got == 1 && (got = fscanf(file, "%lf%*[ ,\t\r\n]", &value)) == 1)
    good = add_number(numbers, &count, &room, value);
  bool bad = got == 0 || ferror(file);
  fclose(file);
  if (!good)
    return cli_fail_text(cli, "%s: out of memory", path);
  if (bad || count == 0 || count % 9 != 0)
    return cli_fail_text(
        cli, "%s: a list of rotations has nine numbers for each, row after row; number %zu is the last", path,
        count);
  given->sampler.rotations = *numbers;
  given->sampler.rotation_count = (int64_t)(count / 9);
  return CLI_DONE;
}

/* ---- One model ---- */

static json_t *report(const cli_run *cli, const augment_request *given, const augment_outcome *made,
                      double total_ms) {
  json_t *object = augment_outcome_json(given, made), *time = json_object_get(object, "time_ms");
  augment_request_json(object, given);
  json_object_set_new(time, "total", cli_json_number(total_ms));
  json_object_set_new(object, "peak_bytes", json_integer((json_int_t)vxm_context_peak_bytes(cli->context)));
  json_object_set(object, "warnings", cli->warnings);
  return object;
}

static void summarize(const cli_run *cli, const augment_request *given, const augment_outcome *made,
                      double total_ms) {
  const cli_input *input = &made->input;
  int64_t n = given->sampler.resolution;
  cli_row(cli, "mesh", "%s (%s): %" PRId64 " vertices, %" PRId64 " faces; repaired %" PRId64 " triangles, %s",
          cli_shown(given->input, "<stdin>"), input->format, input->vertices, input->faces,
          made->census.triangles, made->census.closed ? "closed" : "open");
  cli_row(cli, "variants",
          "%" PRId64 " of %" PRId64 " x %" PRId64 " x %" PRId64 " voxels, from %" PRId64 " of epoch %" PRIu32
          " on, seed %" PRIu64,
          made->made, n, n, n, given->first, given->variant.epoch, given->sampler.seed);
  cli_engine_summarize(cli, &given->engine);
  if (augment_is_stream(given))
    cli_row(cli, "output", "<stdout> (%s)", given->format);
  else
    cli_row(cli, "output", "%s (%s), %" PRIu64 " bytes", given->output, given->format, made->folder.bytes);
  cli_row(cli, "time", "%.1f ms: read %.1f, repair %.1f, prepare %.1f, make %.1f", total_ms, input->read_ms,
          input->repair_ms, made->prepare_ms, made->make_ms);
}

static int make_one(cli_run *cli, augment_request *given) {
  double start = cli_clock();
  augment_outcome made = AUGMENT_OUTCOME_INIT;
  vxm_sampler *sampler = NULL;
  augment_stream *stream = NULL;
  int status = augment_open_sampler(cli, &sampler, given);
  if (status == CLI_DONE && augment_is_stream(given))
    status = augment_stream_open(cli, &stream, given, sampler);
  if (status == CLI_DONE)
    status = augment_model(cli, &made, given, sampler, stream);
  status = augment_stream_close(cli, stream, status);
  double total_ms = cli_clock() - start;
  vxm_sampler_destroy(sampler);
  if (status == CLI_DONE) {
    cli_progress_clear(cli);
    cli_engine_warn(cli, &given->engine);
    if (cli_summary(cli))
      summarize(cli, given, &made, total_ms);
    status = cli_finish(cli, report(cli, given, &made, total_ms));
    if (status == CLI_FAILED)
      augment_remove_files(&made.folder, given);
  }
  augment_outcome_free(&made);
  return status;
}

static int run(cli_run *cli) {
  augment_request given = {.count = 16,
                           .model_of = 1,
                           .repair = VXM_REPAIR_OPTIONS_INIT,
                           .sampler = VXM_SAMPLER_OPTIONS_INIT,
                           .voxelize = VXM_VOXELIZE_OPTIONS_INIT,
                           .engine = {.options = VXM_ENGINE_OPTIONS_INIT}};
  given.sampler.resolution = 64;
  if (augment_read_arguments(cli, &given) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  double *rotations = NULL;
  int status = given.rotations ? read_rotations(cli, &given, &rotations) : CLI_DONE;
  if (status == CLI_DONE)
    status = given.is_several ? augment_several(cli, &given) : make_one(cli, &given);
  free(rotations);
  vxm_engine_destroy(given.engine.engine);
  return status;
}

const cli_command cli_command_augment = {
    .name = "augment",
    .arguments = "MESH|FOLDER|LIST... -o DIR|- [OPTION]...",
    .summary = "make variants of models for training",
    .notes =
        "The mesh is repaired first, as by 'voxmend repair'. Each variant is scaled, mirrored and rotated,\n"
        "fitted into the grid so that nothing lies outside of it, displaced and moved. Variant I of a\n"
        "model, epoch and seed is always the same, on any machine and with any number of threads.\n\n"
        "Of several meshes, a folder, a pattern in quotes, a list (.txt) or a table (.csv, .tsv with a\n"
        "column path, and class and split), whose paths begin in its folder, each gets a folder DIR/NAME,\n"
        "and DIR/models.tsv tells which is which: their model numbers count from --model on, in the order\n"
        "of their names; cells with tabs, ends of lines or quotes are in quotes. A mesh that fails is\n"
        "named, the others are made, and the exit status is 1. On a stream one comes after another, and\n"
        "one that fails ends it. 'voxmend batch --augment' gives the same variants, with a process for each\n"
        "mesh, and goes on after an interruption; of files with the same bytes it makes those of one alone,\n"
        "and the others get links to them.\n\n"
        "Examples:\n"
        "  voxmend augment chair.off -o chairs -n 100 --rotate any --scale 0.5 --displace 0.01\n"
        "  voxmend augment chair.off -o turned -n 12 -r 32 --rotate z --mirror x --format npy\n"
        "  voxmend augment chair.off -o - -n 0 -r 32 --rotate any --format float32 | train\n"
        "  voxmend augment ModelNet10 -o variants -n 12 -r 32 --rotate z --format npy",
    .options = augment_options,
    .many = true,
    .folders = true,
    .run = run,
};

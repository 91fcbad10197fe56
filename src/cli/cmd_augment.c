/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend augment: variants of one model, into a folder or a stream. */
#include "cli/augment.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

typedef struct augment_outcome {
  cli_input input;
  vxm_census census;
  augment_folder folder;
  int64_t made;
  double prepare_ms, make_ms, total_ms;
} augment_outcome;

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

/** Numbers separated by blanks, commas or lines; nine make a matrix. */
static int read_rotations(cli_run *cli, augment_request *given, double **numbers) {
  const char *path = given->rotations;
  FILE *file = fopen(path, "re");
  if (!file)
    return cli_fail_text(cli, "%s: cannot read the rotations: %s", path, strerror(errno));
  size_t count = 0, room = 0;
  bool good = true;
  int got = 0;
  double value;
  while (good && (got = fscanf(file, "%lf%*[ ,\t\r\n]", &value)) == 1)
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

/* ---- Work ---- */

static int make_variants(cli_run *cli, augment_request *given, augment_outcome *results) {
  vxm_sampler *sampler = NULL;
  double start = cli_clock();
  vxm_status status = vxm_mesh_census(&results->census, results->input.mesh, &cli->error);
  if (status == VXM_OK)
    status = cli_engine_open(cli, &given->engine);
  given->voxelize.engine = given->engine.engine;
  given->sampler.voxelize = &given->voxelize;
  if (status == VXM_OK)
    status = vxm_sampler_create(&sampler, cli->context, &given->sampler, &cli->error);
  if (status == VXM_OK)
    status = vxm_sampler_put(sampler, given->variant.model, results->input.mesh, &cli->error);
  double made = cli_clock();
  results->prepare_ms = made - start;
  int result = status != VXM_OK           ? cli_fail(cli)
               : augment_is_stream(given) ? augment_stream(cli, given, sampler, &results->made)
                                          : augment_write_folder(cli, &results->folder, given, sampler);
  if (!augment_is_stream(given))
    results->made = results->folder.made;
  results->make_ms = cli_clock() - made;
  vxm_sampler_destroy(sampler);
  return result;
}

static json_t *report(const cli_run *cli, const augment_request *given, const augment_outcome *results) {
  json_t *object = json_object(), *input = json_object(), *time = json_object();
  json_object_set_new(input, "file", cli_json_text(cli_shown(given->input, "<stdin>")));
  json_object_set_new(input, "format", cli_json_text(results->input.format));
  json_object_set_new(input, "vertices", json_integer(results->input.vertices));
  json_object_set_new(input, "faces", json_integer(results->input.faces));
  json_object_set_new(object, "input", input);
  json_object_set_new(object, "repair", cli_passes_json(&results->input.repair));
  json_object_set_new(object, "triangles", json_integer(results->census.triangles));
  json_object_set_new(object, "closed", json_boolean(results->census.closed));
  json_object_set_new(object, "output", cli_json_text(given->output));
  json_object_set_new(object, "format", json_string(given->format));
  json_object_set_new(object, "resolution", json_integer(given->sampler.resolution));
  json_object_set_new(object, "seed", json_integer((json_int_t)given->sampler.seed));
  json_object_set_new(object, "model", json_integer(given->variant.model));
  json_object_set_new(object, "epoch", json_integer(given->variant.epoch));
  json_object_set_new(object, "first", json_integer(given->first));
  json_object_set_new(object, "variants", json_integer(results->made));
  json_object_set_new(object, "file_bytes", json_integer((json_int_t)results->folder.bytes));
  if (given->engine.engine)
    json_object_set_new(object, "engine", cli_engine_json(&given->engine));
  json_object_set_new(time, "read", cli_json_number(results->input.read_ms));
  json_object_set_new(time, "repair", cli_json_number(results->input.repair_ms));
  json_object_set_new(time, "prepare", cli_json_number(results->prepare_ms));
  json_object_set_new(time, "make", cli_json_number(results->make_ms));
  json_object_set_new(time, "total", cli_json_number(results->total_ms));
  json_object_set_new(object, "time_ms", time);
  json_object_set_new(object, "peak_bytes", json_integer((json_int_t)vxm_context_peak_bytes(cli->context)));
  json_object_set(object, "warnings", cli->warnings);
  return object;
}

static void summarize(const cli_run *cli, const augment_request *given, const augment_outcome *results) {
  const cli_input *input = &results->input;
  int64_t n = given->sampler.resolution;
  cli_row(cli, "mesh", "%s (%s): %" PRId64 " vertices, %" PRId64 " faces; repaired %" PRId64 " triangles, %s",
          cli_shown(given->input, "<stdin>"), input->format, input->vertices, input->faces,
          results->census.triangles, results->census.closed ? "closed" : "open");
  cli_row(cli, "variants",
          "%" PRId64 " of %" PRId64 " x %" PRId64 " x %" PRId64 " voxels, from %" PRId64 " of epoch %" PRIu32
          " on, seed %" PRIu64,
          results->made, n, n, n, given->first, given->variant.epoch, given->sampler.seed);
  cli_engine_summarize(cli, &given->engine);
  if (augment_is_stream(given))
    cli_row(cli, "output", "<stdout> (%s)", given->format);
  else
    cli_row(cli, "output", "%s (%s), %" PRIu64 " bytes", given->output, given->format, results->folder.bytes);
  cli_row(cli, "time", "%.1f ms: read %.1f, repair %.1f, prepare %.1f, make %.1f", results->total_ms,
          input->read_ms, input->repair_ms, results->prepare_ms, results->make_ms);
}

static int run(cli_run *cli) {
  augment_request given = {.count = 16,
                           .repair = VXM_REPAIR_OPTIONS_INIT,
                           .sampler = VXM_SAMPLER_OPTIONS_INIT,
                           .voxelize = VXM_VOXELIZE_OPTIONS_INIT,
                           .engine = {.options = VXM_ENGINE_OPTIONS_INIT}};
  given.sampler.resolution = 64;
  if (augment_read_arguments(cli, &given) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  double start = cli_clock(), *rotations = NULL;
  augment_outcome results = {.census = VXM_CENSUS_INIT};
  int status = given.rotations ? read_rotations(cli, &given, &rotations) : CLI_DONE;
  if (status == CLI_DONE)
    status = cli_read_repaired(cli, &results.input, given.input, given.no_repair ? NULL : &given.repair);
  if (status == CLI_DONE)
    status = make_variants(cli, &given, &results);
  free(rotations);
  vxm_mesh_destroy(results.input.mesh);
  if (status == CLI_DONE) {
    results.total_ms = cli_clock() - start;
    cli_progress_clear(cli);
    cli_engine_warn(cli, &given.engine);
    if (cli_summary(cli))
      summarize(cli, &given, &results);
    status = cli_finish(cli, report(cli, &given, &results));
  }
  if (status == CLI_FAILED)
    augment_remove_files(&results.folder, &given);
  free(results.folder.was_there);
  vxm_engine_destroy(given.engine.engine);
  return status;
}

const cli_command cli_command_augment = {
    .name = "augment",
    .arguments = "MESH -o DIR|- [OPTION]...",
    .summary = "make variants of one model for training",
    .notes =
        "The mesh is repaired first, as by 'voxmend repair'. Each variant is scaled, mirrored and rotated,\n"
        "fitted into the grid so that nothing lies outside of it, displaced and moved. Variant I of a\n"
        "model, epoch and seed is always the same, on any machine and with any number of threads.\n\n"
        "Examples:\n"
        "  voxmend augment chair.off -o chairs -n 100 --rotate any --scale 0.5 --displace 0.01\n"
        "  voxmend augment chair.off -o chairs -n 12 -r 32 --rotate z --mirror x --format npy\n"
        "  voxmend augment chair.off -o - -n 0 -r 32 --rotate any --format float32 | train",
    .options = augment_options,
    .run = run,
};

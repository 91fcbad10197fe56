/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend augment: a mesh is read and repaired, and its variants are made. */
#include "cli/augment.h"

#include <stdlib.h>

int augment_open_sampler(cli_run *cli, vxm_sampler **out, augment_request *given) {
  *out = NULL;
  vxm_status status = cli_engine_open(cli, &given->engine);
  given->voxelize.engine = given->engine.engine;
  given->sampler.voxelize = &given->voxelize;
  if (status == VXM_OK)
    status = vxm_sampler_create(out, cli->context, &given->sampler, &cli->error);
  return status == VXM_OK ? CLI_DONE : cli_fail(cli);
}

/** What the grid of the mesh as it stands would be told of: that it is open, so that the winding number
 * decides, that parts are lost and the like. Variants are too many to be told of each. */
static void warn_of_model(cli_run *cli, const augment_request *given, const vxm_mesh *mesh) {
  vxm_grid *grid = NULL;
  vxm_space_options space = VXM_SPACE_OPTIONS_INIT;
  vxm_voxelize_options options = given->voxelize;
  vxm_error ignored = VXM_ERROR_INIT; /* the variants are made all the same, or say why not */
  space.resolution[0] = given->sampler.resolution;
  options.engine = NULL; /* what there is to say of it is said once */
  if (vxm_voxelize(&grid, NULL, mesh, &space, &options, &ignored) == VXM_OK)
    cli_warn_grid(cli, given->input, grid);
  vxm_grid_destroy(grid);
}

static int make_variants(cli_run *cli, augment_outcome *out, const augment_request *given,
                         vxm_sampler *sampler, augment_stream *stream) {
  double start = cli_clock();
  warn_of_model(cli, given, out->input.mesh);
  if (vxm_mesh_census(&out->census, out->input.mesh, &cli->error) != VXM_OK ||
      vxm_sampler_put(sampler, given->variant.model, out->input.mesh, &cli->error) != VXM_OK)
    return cli_fail(cli);
  double prepared = cli_clock();
  out->prepare_ms = prepared - start;
  int status = stream ? augment_stream_write(cli, stream, given, &out->made)
                      : augment_write_folder(cli, &out->folder, given, sampler);
  if (!stream)
    out->made = out->folder.made;
  out->make_ms = cli_clock() - prepared;
  vxm_sampler_put(sampler, given->variant.model, NULL, NULL); /* the mesh goes */
  if (status == CLI_FAILED)
    augment_remove_files(&out->folder, given);
  return status;
}

int augment_model(cli_run *cli, augment_outcome *out, const augment_request *given, vxm_sampler *sampler,
                  augment_stream *stream) {
  int status = cli_read_repaired(cli, &out->input, given->input, given->no_repair ? NULL : &given->repair);
  if (status == CLI_DONE)
    status = make_variants(cli, out, given, sampler, stream);
  vxm_mesh_destroy(out->input.mesh);
  out->input.mesh = NULL;
  return status;
}

void augment_outcome_free(augment_outcome *outcome) {
  free(outcome->folder.was_there);
  outcome->folder.was_there = NULL;
}

json_t *augment_outcome_json(const augment_request *given, const augment_outcome *outcome) {
  const cli_input *from = &outcome->input;
  json_t *object = json_object(), *input = json_object(), *time = json_object();
  json_object_set_new(input, "file", cli_json_text(cli_shown(given->input, "<stdin>")));
  json_object_set_new(input, "format", cli_json_text(from->format));
  json_object_set_new(input, "vertices", json_integer(from->vertices));
  json_object_set_new(input, "faces", json_integer(from->faces));
  json_object_set_new(object, "input", input);
  json_object_set_new(object, "repair", cli_passes_json(&from->repair));
  json_object_set_new(object, "triangles", json_integer(outcome->census.triangles));
  json_object_set_new(object, "closed", json_boolean(outcome->census.closed));
  json_object_set_new(object, "output", cli_json_text(given->output));
  json_object_set_new(object, "model", json_integer(given->variant.model));
  json_object_set_new(object, "variants", json_integer(outcome->made));
  json_object_set_new(object, "file_bytes", json_integer((json_int_t)outcome->folder.bytes));
  json_object_set_new(time, "read", cli_json_number(from->read_ms));
  json_object_set_new(time, "repair", cli_json_number(from->repair_ms));
  json_object_set_new(time, "prepare", cli_json_number(outcome->prepare_ms));
  json_object_set_new(time, "make", cli_json_number(outcome->make_ms));
  json_object_set_new(object, "time_ms", time);
  return object;
}

void augment_request_json(json_t *report, const augment_request *given) {
  json_object_set_new(report, "format", json_string(given->format));
  json_object_set_new(report, "resolution", json_integer(given->sampler.resolution));
  if (given->sampler.coverage > 0)
    json_object_set_new(report, "coverage", json_integer(given->sampler.coverage));
  json_object_set_new(report, "seed", json_integer((json_int_t)given->sampler.seed));
  json_object_set_new(report, "epoch", json_integer(given->variant.epoch));
  json_object_set_new(report, "first", json_integer(given->first));
  if (given->engine.engine)
    json_object_set_new(report, "engine", cli_engine_json(&given->engine));
}

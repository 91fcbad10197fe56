/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend remesh: a closed surface of a mesh's solid, at the resolution of a grid. */
#include "cli/repair_common.h"
#include "cli/voxelize_common.h"

#include <inttypes.h>
#include <string.h>

typedef struct request {
  const char *input, *output;
  vxm_space_options space;
  vxm_voxelize_options voxelize;
  vxm_mesh_write_options write;
} request;

typedef struct outcome {
  cli_input input;
  vxm_mesh *mesh;
  vxm_voxelize_report solid;
  vxm_verification verification;
  double remesh_ms, write_ms;
} outcome;

static int take_resolution(cli_run *cli, const cli_option *option, const char *value, void *member) {
  if (cli_read_integer(member, value, option->to.min, option->to.max))
    return CLI_END;
  return cli_usage(cli, "-r '%s' is not a number of voxels from 1 to 1048576", value);
}

static const cli_option known_options[] = {
    {'o', "output", "MESH", "file to write; '-' is standard output (needs --format)",
     CLI_TEXT(request, output)},
    {'r', "resolution", "N", "voxels along the longest side of the model [128]",
     CLI_VALUE(take_resolution, request, space.resolution[0], .min = 1, .max = 1 << 20)},
    {0, "voxel-size", "S|SX,SY,SZ", "sides of a voxel in model units, instead of -r",
     CLI_VALUE(cli_take_voxel_size, request, space)},
    {0, "thin", "keep|drop|26",
     "parts thinner than a voxel: those that are kept come out whole, plates and\n"
     "walls two thirds of a voxel thick or more; keep and 26 are the same here\n"
     "[keep]",
     CLI_CHOICE_FROM(VXM_THIN_KEEP, request, voxelize.thin, cli_thin_parts)},
    {0, "ascii", NULL, "write .stl and .ply as text rather than binary; .off and .obj are text anyway",
     CLI_FLAG(request, write.ascii)},
    {0, "format", "F", "off, obj, stl or ply [by the name of the output]", CLI_TEXT(request, write.format)},
    CLI_OPTION_FORCE,
    CLI_OPTIONS_READ,
    CLI_OPTIONS_END};

static int read_arguments(cli_run *cli, request *out) {
  if (cli_read_options(cli, out) == CLI_STOP)
    return CLI_STOP;
  if (cli->argument_count != 1)
    return cli_usage(cli, "one mesh is expected, not %d", cli->argument_count);
  out->input = cli->arguments[0];
  bool is_sized = out->space.voxel_size > 0 || out->space.voxel_sizes[0] > 0;
  if (out->space.resolution[0] > 0 && is_sized)
    return cli_usage(cli, "-r and --voxel-size exclude each other");
  cli->sized_by = is_sized ? CLI_SIZED_BY_VOXEL_SIZE : CLI_SIZED_BY_RESOLUTION;
  out->space.fit = VXM_FIT_TIGHT;
  out->write.format = cli_output_format(cli, out->output, out->write.format, cli_mesh_formats);
  if (!out->write.format)
    return CLI_STOP;
  cli_writes(cli, "-o", out->output, false);
  return cli_check_names(cli) == CLI_STOP ? CLI_STOP
                                          : cli_check_surface_file(cli, out->output, out->write.format);
}

static json_t *make_report(const cli_run *cli, const request *given, const outcome *made) {
  json_t *report = json_object(), *times = json_object();
  json_object_set_new(report, "input", cli_json_text(given->input));
  json_object_set_new(report, "output", cli_json_text(given->output));
  json_object_set_new(report, "passes", cli_passes_json(&made->input.repair));
  json_object_set_new(report, "voxels", json_integer(made->solid.voxels));
  json_object_set_new(report, "vertices", json_integer(vxm_mesh_vertex_count(made->mesh)));
  json_object_set_new(report, "faces", json_integer(vxm_mesh_face_count(made->mesh)));
  json_object_set_new(times, "read", json_real(made->input.read_ms));
  json_object_set_new(times, "repair", json_real(made->input.repair_ms));
  json_object_set_new(times, "remesh", json_real(made->remesh_ms));
  json_object_set_new(times, "write", json_real(made->write_ms));
  json_object_set_new(report, "time_ms", times);
  json_object_set(report, "warnings", cli->warnings);
  return report;
}

static int remesh(cli_run *cli, const request *given, outcome *made) {
  double start = cli_clock();
  vxm_status status = vxm_mesh_remesh(&made->mesh, &made->solid, made->input.mesh, &given->space,
                                      &given->voxelize, &cli->error);
  if (status != VXM_OK)
    return cli_fail(cli);
  if (vxm_mesh_face_count(made->mesh) == 0)
    return cli_fail_text(cli, "%s: no voxel is inside; choose a higher -r, or --thin keep",
                         cli_shown(given->input, "<stdin>"));
  double remeshed = cli_clock();
  vxm_repair_options closed = VXM_REPAIR_OPTIONS_INIT;
  closed.level = VXM_LEVEL_CLOSED;
  closed.weld = VXM_WELD_OFF;
  status = vxm_mesh_write_verified(&made->verification, made->mesh, given->output, &given->write, &closed,
                                   false, &cli->error);
  made->remesh_ms = remeshed - start;
  made->write_ms = cli_clock() - remeshed;
  if (status == VXM_ERROR_UNREACHED)
    cli_advise(
        cli,
        strcmp(given->write.format, "stl") == 0
            ? "write another format than stl, whose 32-bit floats are too coarse here, move the model to "
              "the origin, or choose a lower -r"
            : "move the model to the origin, or choose a lower -r");
  return status == VXM_OK ? CLI_DONE : cli_fail(cli);
}

static int work(cli_run *cli, const request *given, outcome *made) {
  vxm_repair_options repair = VXM_REPAIR_OPTIONS_INIT;
  if (cli_read_repaired(cli, &made->input, given->input, &repair) != CLI_DONE ||
      remesh(cli, given, made) != CLI_DONE)
    return CLI_FAILED;
  cli_progress_clear(cli);
  if (cli_summary(cli)) {
    cli_row(cli, "input", "%s (%s): %" PRId64 " vertices, %" PRId64 " faces",
            cli_shown(given->input, "<stdin>"), made->input.format, made->input.vertices, made->input.faces);
    cli_row(cli, "voxels", "%" PRId64, made->solid.voxels);
    cli_row(cli, "surface", "%" PRId64 " vertices, %" PRId64 " faces, closed: verified in the file",
            vxm_mesh_vertex_count(made->mesh), vxm_mesh_face_count(made->mesh));
    cli_row(cli, "time", "%.1f ms: read %.1f, repair %.1f, remesh %.1f, write %.1f",
            made->input.read_ms + made->input.repair_ms + made->remesh_ms + made->write_ms,
            made->input.read_ms, made->input.repair_ms, made->remesh_ms, made->write_ms);
    cli_row(cli, "output", "%s (%s)", cli_shown(given->output, "<stdout>"), given->write.format);
  }
  return cli_finish(cli, cli->json || cli->report ? make_report(cli, given, made) : NULL);
}

static int run(cli_run *cli) {
  request given = {.space = VXM_SPACE_OPTIONS_INIT,
                   .voxelize = VXM_VOXELIZE_OPTIONS_INIT,
                   .write = VXM_MESH_WRITE_OPTIONS_INIT};
  if (read_arguments(cli, &given) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  outcome made = {.solid = VXM_VOXELIZE_REPORT_INIT, .verification = VXM_VERIFICATION_INIT};
  int status = work(cli, &given, &made);
  vxm_mesh_destroy(made.mesh);
  vxm_mesh_destroy(made.input.mesh);
  return status;
}

const cli_command cli_command_remesh = {
    .name = "remesh",
    .arguments = "MESH -o MESH [OPTION]...",
    .summary = "a closed surface around all of a mesh, at a resolution",
    .notes =
        "The mesh is repaired and voxelized as by 'voxmend voxelize', and the surface of the solid is made\n"
        "anew, where the faces meet the lines through voxel centres: closed, manifold and turned outward, "
        "smooth\n"
        "where the mesh is, with edges and corners cut by half a voxel at most. Groups and materials do not "
        "go\n"
        "along. 'voxmend repair --level closed' keeps the faces of the mesh instead.\n\n"
        "Examples:\n"
        "  voxmend remesh chair.off -o chair.ply\n"
        "  voxmend remesh scan.obj -o scan.stl -r 400\n"
        "  voxmend remesh part.stl -o part.ply --voxel-size 0.5",
    .options = known_options,
    .run = run,
};

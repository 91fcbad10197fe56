/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend carve: what a tool leaves of a grid along its path. */
#include "cli/repair_common.h"
#include "cli/toolpath.h"
#include "cli/values.h"

#include <inttypes.h>
#include <string.h>

typedef struct request {
  const char *tool, *path, *output;
  bool sparse;
  vxm_threshold_options threshold;
  vxm_grid_write_options write;
} request;

static const cli_option known_options[] = {
    {'t', "tool", "MESH", "the tool, in the model units of the grid, about its origin",
     CLI_TEXT(request, tool)},
    {'p', "path", "FILE.csv",
     "where the tool's origin goes, a position in each line: x,y,z; or x,y,z and a\n"
     "quaternion qw,qx,qy,qz; or the 12 numbers of a 3 x 4 matrix, row after row. An\n"
     "empty line lifts the tool: to the next position nothing is cut on the way;\n"
     "'-' is standard input, whose lines are cut as they come",
     CLI_TEXT(request, path)},
    {'o', "output", "FILE", CLI_GRID_FILES "; '-' is standard output", CLI_TEXT(request, output)},
    {0, "format", "F", CLI_GRID_FORMATS, CLI_TEXT(request, write.format)},
    {0, "sparse", NULL,
     "cut an octree, whose memory follows the surface and the path [where the output\n"
     "is .octree]",
     CLI_FLAG(request, sparse)},
    CLI_OPTION_FORCE,
    CLI_OPTIONS_SURFACE(request),
    CLI_OPTIONS_THRESHOLD(request),
    CLI_OPTIONS_READ,
    CLI_OPTIONS_END};

typedef struct outcome {
  cli_input tool;
  vxm_grid *grid; /**< the stock, then what is left of it; or NULL */
  vxm_sparse *sparse;
  int64_t before, removed, steps;
  json_t *by_step; /**< voxels that each has removed; NULL = nobody asks */
  double carve_ms; /**< without the time for reading the path */
} outcome;

static int check(cli_run *cli, request *out) {
  if (cli->argument_count != 1)
    return cli_usage(cli, "one grid is expected, not %d", cli->argument_count);
  if (!out->tool || !out->path)
    return cli_usage(cli, "%s is missing", out->tool ? "-p PATH.csv" : "-t TOOL");
  cli_reads(cli, out->tool);
  cli_reads(cli, out->path);
  if (cli_check_grid_output(cli, out->output, &out->write, cli_formats_with(VXM_FORMAT_BITS), false) ==
      CLI_STOP)
    return CLI_STOP;
  out->sparse |= strcmp(out->write.format, "octree") == 0;
  return CLI_END;
}

/* ---- Reading ---- */

static int read_stock(cli_run *cli, outcome *made, const request *given) {
  static const char why[] = "only set and clear voxels can be cut";
  const char *path = cli->arguments[0];
  return given->sparse ? cli_sparse_read(cli, &made->sparse, &given->threshold, path, why)
                       : cli_bits_read(cli, &made->grid, &given->threshold, path, why);
}

/* ---- Cutting ---- */

static int step(cli_run *cli, outcome *made, vxm_carver *carver, const cli_toolpath *toolpath,
                const double pose[12], bool is_lifted) {
  vxm_carve_report report = VXM_CARVE_REPORT_INIT;
  double start = cli_clock();
  vxm_status status = is_lifted ? vxm_carver_place(&report, carver, pose, &cli->error)
                                : vxm_carver_move(&report, carver, pose, &cli->error);
  made->carve_ms += cli_clock() - start;
  if (status == VXM_ERROR_ARGUMENT || status == VXM_ERROR_RANGE)
    return cli_fail_text(cli, "%s:%" PRId64 ": %s", toolpath->name, toolpath->line, cli->error.text);
  if (status != VXM_OK)
    return cli_fail(cli);
  made->steps++;
  made->removed += report.removed;
  if (made->by_step)
    json_array_append_new(made->by_step, json_integer(report.removed));
  return CLI_DONE;
}

static int follow_path(cli_run *cli, outcome *made, vxm_carver *carver, cli_toolpath *toolpath) {
  for (;;) {
    double pose[12];
    bool is_lifted, is_end;
    int status = cli_toolpath_next(cli, toolpath, pose, &is_lifted, &is_end);
    if (status == CLI_DONE && cli_progress(cli, "carving", 0))
      return cli_fail_text(cli, "interrupted");
    if (status == CLI_DONE && !is_end)
      status = step(cli, made, carver, toolpath, pose, is_lifted);
    if (status != CLI_DONE || is_end)
      return status;
  }
}

/** Puts what is left in the place of the octree that was read. */
static int take_octree(cli_run *cli, outcome *made, const vxm_carver *carver) {
  vxm_sparse *left = NULL;
  if (vxm_carver_sparse(&left, carver, &cli->error) != VXM_OK)
    return cli_fail(cli);
  vxm_sparse_destroy(made->sparse);
  made->sparse = left;
  return CLI_DONE;
}

static int carve(cli_run *cli, outcome *made, const request *given) {
  vxm_carver *carver = NULL;
  cli_toolpath toolpath = {.file = NULL};
  vxm_status created = made->sparse
                           ? vxm_carver_create_sparse(&carver, made->sparse, made->tool.mesh, &cli->error)
                           : vxm_carver_create(&carver, made->grid, made->tool.mesh, &cli->error);
  int status = created == VXM_OK ? cli_toolpath_open(cli, &toolpath, given->path) : cli_fail(cli);
  made->before = made->sparse ? vxm_sparse_count(made->sparse) : vxm_grid_count(made->grid);
  if (status == CLI_DONE)
    status = follow_path(cli, made, carver, &toolpath);
  if (status == CLI_DONE && made->steps == 0)
    status = cli_fail_text(cli, "%s: there is no position in it", toolpath.name);
  if (status == CLI_DONE && made->sparse)
    status = take_octree(cli, made, carver);
  cli_toolpath_close(&toolpath);
  vxm_carver_destroy(carver);
  return status;
}

/* ---- Results ---- */

static const vxm_space *space_of(const outcome *made) {
  return made->sparse ? vxm_sparse_space(made->sparse) : vxm_grid_space(made->grid);
}

static double steps_per_second(const outcome *made) {
  return made->carve_ms > 0 ? 1e3 * (double)made->steps / made->carve_ms : 0;
}

static json_t *make_report(const cli_run *cli, const request *given, outcome *made, uint64_t hash) {
  const double *size = space_of(made)->voxel_size;
  double voxel = size[0] * size[1] * size[2];
  json_t *report = json_object();
  json_object_set_new(report, "input", cli_json_text(cli->arguments[0]));
  json_object_set_new(report, "tool", cli_json_text(given->tool));
  json_object_set_new(report, "path", cli_json_text(given->path));
  json_object_set_new(report, "output", cli_json_text(given->output));
  json_object_set_new(report, "grid", cli_json_space(space_of(made)));
  json_object_set_new(report, "steps", json_integer(made->steps));
  json_object_set_new(report, "voxels_before", json_integer(made->before));
  json_object_set_new(report, "voxels", json_integer(made->before - made->removed));
  json_object_set_new(report, "removed", json_integer(made->removed));
  json_object_set_new(report, "removed_volume", cli_json_number((double)made->removed * voxel));
  json_object_set_new(report, "voxel_volume", cli_json_number(voxel));
  json_object_set(report, "removed_by_step", made->by_step);
  json_object_set_new(report, "hash", cli_json_hash(hash));
  json_object_set_new(report, "carve_ms", cli_json_number(made->carve_ms));
  json_object_set_new(report, "steps_per_second", cli_json_number(steps_per_second(made)));
  json_object_set(report, "warnings", cli->warnings);
  return report;
}

static int write_result(cli_run *cli, const request *given, outcome *made) {
  vxm_status status = made->sparse ? vxm_sparse_write(made->sparse, given->output, &given->write, &cli->error)
                                   : vxm_grid_write(made->grid, given->output, &given->write, &cli->error);
  if (status != VXM_OK)
    return cli_fail(cli);
  uint64_t hash = made->sparse ? vxm_sparse_hash(made->sparse) : vxm_grid_hash(made->grid);
  cli_progress_clear(cli);
  cli_warn_lattice(cli, given->output, given->write.format, space_of(made));
  if (cli_summary(cli)) {
    cli_rows_space(cli, space_of(made));
    cli_row(cli, "steps", "%" PRId64 " in %.1f ms (%.0f a second)", made->steps, made->carve_ms,
            steps_per_second(made));
    cli_row(cli, "removed", "%" PRId64 " of %" PRId64 " voxels", made->removed, made->before);
    cli_row(cli, "voxels", "%" PRId64, made->before - made->removed);
    cli_row(cli, "hash", "%016" PRIx64, hash);
    cli_row(cli, "output", "%s (%s)", cli_shown(given->output, "<stdout>"), given->write.format);
  }
  return cli_finish(cli, make_report(cli, given, made, hash));
}

static int run(cli_run *cli) {
  request given = {.threshold = VXM_THRESHOLD_OPTIONS_INIT, .write = VXM_GRID_WRITE_OPTIONS_INIT};
  if (cli_read_options(cli, &given) == CLI_STOP || check(cli, &given) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  vxm_repair_options repair = VXM_REPAIR_OPTIONS_INIT;
  outcome made = {.by_step = cli->json || cli->report || cli->capture ? json_array() : NULL};
  int status = read_stock(cli, &made, &given);
  if (status == CLI_DONE)
    status = cli_read_repaired(cli, &made.tool, given.tool, &repair);
  if (status == CLI_DONE)
    status = carve(cli, &made, &given);
  if (status == CLI_DONE)
    status = write_result(cli, &given, &made);
  vxm_mesh_destroy(made.tool.mesh);
  vxm_grid_destroy(made.grid);
  vxm_sparse_destroy(made.sparse);
  json_decref(made.by_step);
  return status;
}

const cli_command cli_command_carve = {
    .name = "carve",
    .arguments = "GRID -t TOOL -p PATH.csv -o FILE [OPTION]...",
    .summary = "remove what a moving tool cuts: milling, drilling",
    .notes =
        "Every voxel is removed whose centre comes to lie within the tool, anywhere along its path. A\n"
        "straight step is covered exactly, however long it is and whatever the shape of the tool; through\n"
        "turns no point moves by more than half a voxel at a time, without gaps. The tool is repaired as\n"
        "'voxmend voxelize' does. In the path, lines that begin with # and a heading such as x,y,z are "
        "passed\n"
        "over. The report (--json) has the voxels that each step has removed.\n\n"
        "Examples:\n"
        "  voxmend carve block.npy -t ball.stl -p path.csv -o part.npy\n"
        "  voxmend carve block.octree -t drill.stl -p holes.csv -o part.octree --json\n"
        "  controller | voxmend carve block.npy -t ball.stl -p - -o part.stl",
    .options = known_options,
    .run = run,
};

/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend convert: a grid in another format, or as a mesh. */
#include "cli/cli.h"

#include <inttypes.h>

enum { KEY_FORMAT = CLI_KEY_COMMAND, KEY_FORCE };

static const cli_option known_options[] = {
    {'o', "output", "FILE",
     "file to write: .binvox, .rle, .nrrd, .vdb, .npy or .raw (the last two with a\n"
     ".json beside them), or the grid as a mesh: .obj, .ply, .stl, .off; '-' is\n"
     "standard output"},
    {KEY_FORMAT, "format", "F",
     "binvox, npy, raw, rle, nrrd, vdb, obj, ply, stl or off [by the name of the\n"
     "output]"},
    CLI_OPTION_FORCE(KEY_FORCE),
    {0, NULL, NULL, NULL}};

typedef struct request {
  const char *input, *output, *format;
  bool force;
} request;

static int read_arguments(cli_run *cli, request *out) {
  const char *value;
  int key;
  while ((key = cli_next_option(cli, &value)) != CLI_END)
    if (key == 'o')
      out->output = value;
    else if (key == KEY_FORMAT)
      out->format = value;
    else if (key == KEY_FORCE)
      out->force = true;
    else
      return CLI_STOP;
  if (cli->argument_count != 1)
    return cli_usage(cli, "one grid is expected, not %d", cli->argument_count);
  out->input = cli->arguments[0];
  out->format = cli_output_format(cli, out->output, out->format, cli_grid_formats);
  if (!out->format)
    return CLI_STOP;
  cli_writes(cli, "-o", out->output, cli_has_json(out->format));
  if (cli_check_names(cli) == CLI_STOP)
    return CLI_STOP;
  return cli_check_surface_file(cli, out->output, out->format, out->force);
}

static json_t *make_report(const cli_run *cli, const request *given, const vxm_grid *grid) {
  json_t *report = json_object();
  json_object_set_new(report, "input", cli_json_text(given->input));
  json_object_set_new(report, "output", cli_json_text(given->output));
  json_object_set_new(report, "grid", cli_json_space(vxm_grid_space(grid)));
  json_object_set_new(report, "voxels", json_integer(vxm_grid_count(grid)));
  json_object_set_new(report, "hash", cli_json_hash(vxm_grid_hash(grid)));
  json_object_set(report, "warnings", cli->warnings);
  return report;
}

static int convert(cli_run *cli, const request *given, const vxm_grid *grid) {
  vxm_grid_write_options write = VXM_GRID_WRITE_OPTIONS_INIT;
  write.format = given->format;
  if (vxm_grid_write(grid, given->output, &write, &cli->error) != VXM_OK)
    return cli_fail(cli);
  cli_progress_clear(cli);
  if (cli_summary(cli)) {
    cli_row(cli, "input", "%s", cli_shown(given->input, "<stdin>"));
    cli_rows_space(cli, vxm_grid_space(grid));
    cli_row(cli, "voxels", "%" PRId64, vxm_grid_count(grid));
    cli_row(cli, "output", "%s (%s)", cli_shown(given->output, "<stdout>"), given->format);
  }
  return cli_finish(cli, make_report(cli, given, grid));
}

static int run(cli_run *cli) {
  request given = {0};
  if (read_arguments(cli, &given) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  vxm_grid *grid = NULL;
  if (vxm_grid_read(&grid, cli->context, given.input, &cli->error) != VXM_OK)
    return cli_fail(cli);
  cli_warn_grid(cli, given.input, grid);
  int status = convert(cli, &given, grid);
  vxm_grid_destroy(grid);
  return status;
}

const cli_command cli_command_convert = {
    .name = "convert",
    .arguments = "GRID -o FILE [OPTION]...",
    .summary = "write a grid in another format, or as a mesh",
    .notes =
        "As a mesh, the faces between set and empty voxels are merged into rectangles, in model units.\n\n"
        "Examples:\n"
        "  voxmend convert chair.binvox -o chair.npy\n"
        "  voxmend convert chair.npy -o blocks.obj",
    .options = known_options,
    .run = run,
};

/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend view: a picture of a grid, or of a mesh as voxels. */
#include "cli/cli.h"

#include <inttypes.h>
#include <string.h>

enum { KEY_SIZE = CLI_KEY_COMMAND, KEY_AZIMUTH, KEY_ELEVATION, KEY_UP };

static const cli_option known_options[] = {
    {'o', "output", "FILE.png", "picture to write"},
    {KEY_SIZE, "size", "WxH", "pixels, each from 1 to 16384 [800x600]"},
    {KEY_AZIMUTH, "azimuth", "DEGREES", "direction to look from, about the up axis [30]"},
    {KEY_ELEVATION, "elevation", "DEGREES", "height to look from, -90 to 90 above the horizon [25]"},
    {KEY_UP, "up", "x|y|z", "axis that points up [z]"},
    CLI_OPTIONS_THRESHOLD,
    CLI_OPTIONS_READ,
    {0, NULL, NULL, NULL}};

typedef struct request {
  const char *input, *output;
  vxm_picture_options picture;
  vxm_threshold_options threshold;
} request;

/** "800x600" */
static bool read_size(vxm_picture_options *out, const char *text) {
  enum { MOST = 16384 };
  const char *x = strchr(text, 'x');
  char width[8];
  int64_t w, h;
  if (!x || (size_t)(x - text) >= sizeof width)
    return false;
  memcpy(width, text, (size_t)(x - text));
  width[x - text] = '\0';
  if (!cli_read_integer(&w, width, 1, MOST) || !cli_read_integer(&h, x + 1, 1, MOST))
    return false;
  out->width = (int)w;
  out->height = (int)h;
  return true;
}

static int read_option(cli_run *cli, request *out, int key, const char *value) {
  static const char *const axes[] = {"x", "y", "z", NULL};
  vxm_picture_options *picture = &out->picture;
  int choice = 0, result;
  switch (key) {
  case 'o':
    out->output = value;
    return CLI_END;
  case KEY_SIZE:
    if (!read_size(picture, value))
      return cli_usage(cli, "--size '%s' is not WxH, each from 1 to 16384", value);
    return CLI_END;
  case KEY_AZIMUTH:
    if (!cli_read_number(&picture->azimuth, value))
      return cli_usage(cli, "--azimuth '%s' is not a number of degrees", value);
    return CLI_END;
  case KEY_ELEVATION:
    if (!cli_read_number(&picture->elevation, value) || picture->elevation < -90 || picture->elevation > 90)
      return cli_usage(cli, "--elevation '%s' is not a number of degrees from -90 to 90", value);
    return CLI_END;
  case CLI_KEY_THRESHOLD:
  case CLI_KEY_BELOW:
    return cli_threshold_read(cli, &out->threshold, key, value);
  default:
    result = cli_choose(cli, &choice, "up", value, axes);
    picture->up = choice + 1;
    return result;
  }
}

static int read_arguments(cli_run *cli, request *out) {
  const char *value;
  int key;
  while ((key = cli_next_option(cli, &value)) != CLI_END)
    if (key == CLI_STOP || read_option(cli, out, key, value) == CLI_STOP)
      return CLI_STOP;
  if (cli->argument_count != 1)
    return cli_usage(cli, "one grid or mesh is expected, not %d", cli->argument_count);
  out->input = cli->arguments[0];
  if (!out->output)
    return cli_usage(cli, "-o FILE.png is missing");
  if (!cli_is_extension(out->output, "png"))
    return cli_usage(cli, "the picture is a PNG: '%s' must end in .png", out->output);
  cli_writes(cli, "-o", out->output, false);
  return cli_check_names(cli);
}

static bool is_named(const char *path, const char *const *formats) {
  for (int i = 0; formats[i]; i++)
    if (cli_is_extension(path, formats[i]))
      return true;
  return false;
}

static int voxelize(cli_run *cli, vxm_grid **grid, const char *path) {
  enum { RESOLUTION = 128 };
  cli_input input;
  vxm_repair_options repair = VXM_REPAIR_OPTIONS_INIT;
  if (cli_read_repaired(cli, &input, path, &repair) != CLI_DONE)
    return CLI_FAILED;
  vxm_space_options space = VXM_SPACE_OPTIONS_INIT;
  space.resolution[0] = RESOLUTION;
  vxm_status status = vxm_voxelize(grid, NULL, input.mesh, &space, NULL, &cli->error);
  vxm_mesh_destroy(input.mesh);
  return status == VXM_OK ? CLI_DONE : cli_fail(cli);
}

/** A grid or a mesh: the name tells; where it does not, it is a mesh if it is not a grid. */
static int read_input(cli_run *cli, cli_values *values, const char *path) {
  if (is_named(path, cli_mesh_formats))
    return voxelize(cli, &values->grid, path);
  vxm_status status = cli_values_read(cli, values, path);
  if (status == VXM_OK)
    return CLI_DONE;
  bool maybe_mesh = status == VXM_ERROR_FORMAT && strcmp(path, "-") != 0;
  if (maybe_mesh && !(vxm_grid_format_traits(vxm_grid_format_of(path)) & VXM_FORMAT_READ))
    return voxelize(cli, &values->grid, path);
  return cli_fail(cli);
}

static json_t *make_report(const cli_run *cli, const request *given, const cli_values *values) {
  json_t *report = json_object();
  json_object_set_new(report, "input", cli_json_text(given->input));
  json_object_set_new(report, "output", cli_json_text(given->output));
  json_object_set_new(report, "grid", cli_json_space(cli_values_space(values)));
  cli_values_json(report, values, false);
  json_object_set(report, "warnings", cli->warnings);
  return report;
}

/** Bits as they are, or numbers by the threshold, or else by what they are. */
static vxm_status draw(cli_run *cli, const request *given, const cli_values *values) {
  bool is_given = cli_threshold_given(&given->threshold);
  if (values->grid)
    return vxm_grid_picture(values->grid, given->output, &given->picture, &cli->error);
  return vxm_field_picture(values->field, given->output, &given->picture, is_given ? &given->threshold : NULL,
                           &cli->error);
}

static int make_picture(cli_run *cli, const request *given, const cli_values *values) {
  if (draw(cli, given, values) != VXM_OK)
    return cli_fail(cli);
  cli_progress_clear(cli);
  if (cli_summary(cli)) {
    cli_row(cli, "input", "%s", cli_shown(given->input, "<stdin>"));
    cli_rows_space(cli, cli_values_space(values));
    cli_values_row(cli, values);
    cli_row(cli, "output", "%s", given->output);
  }
  return cli_finish(cli, make_report(cli, given, values));
}

static int run(cli_run *cli) {
  request given = {.picture = VXM_PICTURE_OPTIONS_INIT, .threshold = VXM_THRESHOLD_OPTIONS_INIT};
  if (read_arguments(cli, &given) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  cli_values values = {NULL, NULL};
  if (read_input(cli, &values, given.input) != CLI_DONE)
    return CLI_FAILED;
  int status = make_picture(cli, &given, &values);
  cli_values_free(&values);
  return status;
}

const cli_command cli_command_view = {
    .name = "view",
    .arguments = "GRID|MESH -o FILE.png [OPTION]...",
    .summary = "draw a picture of a grid, or of a mesh",
    .notes =
        "A mesh is repaired and voxelized at 128 voxels along its longest side first. Standard input is "
        "read\n"
        "as a grid.\n\n"
        "A file of values is drawn by what they are: signed distances below 0, unsigned ones below half a\n"
        "voxel's diagonal; coverage from one half on; confidence below 255, where the solid was not proven;\n"
        "labels and colours in their colours. If the file does not tell, non-negative integers are labels,\n"
        "values on both sides of 0 are distances, values from 0 to 1 coverage. --threshold and --below\n"
        "choose others.\n\n"
        "Examples:\n"
        "  voxmend view chair.binvox -o chair.png\n"
        "  voxmend view bunny.obj -o bunny.png --up y --azimuth 120 --size 1200x900\n"
        "  voxmend view distance.nrrd -o inside.png --below -0.1",
    .options = known_options,
    .run = run,
};

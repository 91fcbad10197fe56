/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend convert: a grid in another format, or as a mesh. */
#include "cli/values.h"

#include <inttypes.h>
#include <string.h>

typedef struct request {
  const char *input, *output;
  int coverage; /**< 0 = not wanted */
  bool has_window;
  int64_t begin[3], end[3];
  vxm_threshold_options threshold;
  vxm_grid_write_options write;
} request;

/** "0:64,10:20,0:1" */
static int take_window(cli_run *cli, const cli_option *option, const char *value, void *member) {
  request *out = member;
  char text[128], *rest = text;
  bool is_read = strlen(value) < sizeof text;
  if (is_read)
    strcpy(text, value);
  for (int a = 0; a < 3 && is_read; a++) {
    char *axis = strsep(&rest, ","), *end = axis ? strchr(axis, ':') : NULL;
    if (end)
      *end++ = '\0';
    is_read = end && cli_read_integer(&out->begin[a], axis, 0, 1 << 20) &&
              cli_read_integer(&out->end[a], end, 1, 1 << 20) && out->begin[a] < out->end[a];
  }
  if (!is_read || rest)
    return cli_usage(cli, "--%s '%s' is not X:X,Y:Y,Z:Z, such as 0:64,0:64,10:20", option->name, value);
  out->has_window = true;
  return CLI_END;
}

static int take_coverage(cli_run *cli, const cli_option *option, const char *value, void *member) {
  int64_t side;
  if (!cli_read_integer(&side, value, 1, 1 << 20) || (side & (side - 1)) != 0)
    return cli_usage(cli, "--%s '%s' is none of 1, 2, 4, 8, ... 1048576", option->name, value);
  *(int *)member = (int)side;
  return CLI_END;
}

static const cli_option known_options[] = {
    {'o', "output", "FILE", CLI_GRID_FILES "; '-' is standard output", CLI_TEXT(request, output)},
    {0, "format", "F", CLI_GRID_FORMATS, CLI_TEXT(request, write.format)},
    {0, "window", "X:X,Y:Y,Z:Z",
     "only these voxels: along each axis from the first number, 0 or more, to before\n"
     "the second; of .octree nothing else is read",
     CLI_VALUES(take_window)},
    {0, "coverage", "N",
     "write how much is set of each cube of N voxels along a side instead, 0 to 1; N a\n"
     "power of two; --window counts cubes then; of .octree a layer is read at a time",
     CLI_VALUE(take_coverage, request, coverage)},
    CLI_OPTION_FORCE,
    CLI_OPTIONS_SURFACE(request),
    CLI_OPTIONS_STYLE(request),
    CLI_OPTIONS_THRESHOLD(request),
    CLI_OPTIONS_END};

static int read_arguments(cli_run *cli, request *out) {
  if (cli_read_options(cli, out) == CLI_STOP)
    return CLI_STOP;
  if (cli->argument_count != 1)
    return cli_usage(cli, "one grid is expected, not %d", cli->argument_count);
  out->input = cli->arguments[0];
  unsigned any = VXM_FORMAT_BITS | VXM_FORMAT_NUMBERS | VXM_FORMAT_LABELS | VXM_FORMAT_COLORS;
  cli_formats formats = cli_formats_with(out->coverage ? VXM_FORMAT_NUMBERS : any);
  return cli_check_grid_output(cli, out->output, &out->write, formats, true);
}

static json_t *make_report(const cli_run *cli, const request *given, const cli_values *values) {
  json_t *report = json_object();
  json_object_set_new(report, "input", cli_json_text(given->input));
  json_object_set_new(report, "output", cli_json_text(given->output));
  json_object_set_new(report, "grid", cli_json_space(cli_values_space(values)));
  cli_values_json(report, values, true);
  json_object_set(report, "warnings", cli->warnings);
  return report;
}

/** Whether a field is of labels: it says so, or its numbers are whole and more than 0 and 1. */
static bool are_labels(const vxm_field *field) {
  vxm_scalar scalar = vxm_field_scalar(field);
  vxm_field_kind kind = vxm_field_kind_of(field);
  bool is_float = scalar == VXM_FLOAT64 || scalar == VXM_FLOAT32 || scalar == VXM_FLOAT16;
  return kind == VXM_FIELD_LABELS || (kind == VXM_FIELD_NUMBERS && !is_float && !vxm_field_is_mask(field));
}

/** Whether the output's format can hold the values of a field. */
static bool keeps_numbers(const request *given, const vxm_field *field) {
  unsigned traits = vxm_grid_format_traits(given->write.format);
  if (vxm_field_kind_of(field) == VXM_FIELD_COLORS)
    return (traits & (VXM_FORMAT_COLORS | VXM_FORMAT_NUMBERS)) != 0;
  return (traits & VXM_FORMAT_NUMBERS) || ((traits & VXM_FORMAT_LABELS) && are_labels(field));
}

/** Cuts the values down to --window. */
static vxm_status cut(cli_run *cli, const request *given, cli_values *values) {
  cli_values part = {NULL, NULL};
  vxm_status status =
      values->grid ? vxm_grid_window(&part.grid, values->grid, given->begin, given->end, &cli->error)
                   : vxm_field_window(&part.field, values->field, given->begin, given->end, &cli->error);
  cli_values_free(values);
  *values = part;
  return status;
}

static vxm_status read_part(cli_run *cli, const request *given, cli_values *out) {
  vxm_sparse_file *file;
  vxm_status status = vxm_sparse_file_open(&file, cli->context, given->input, &cli->error);
  if (status == VXM_OK && vxm_sparse_file_has_values(file))
    status = vxm_sparse_file_field(&out->field, file, given->begin, given->end, &cli->error);
  else if (status == VXM_OK)
    status = vxm_sparse_file_window(&out->grid, file, given->begin, given->end, &cli->error);
  vxm_sparse_file_close(file);
  return status;
}

/** Coverage of an octree file, of which a part at a time is in memory. */
static vxm_status count_file(cli_run *cli, const request *given, const vxm_coverage_options *options,
                             vxm_field **out) {
  vxm_sparse_file *file;
  vxm_status status = vxm_sparse_file_open(&file, cli->context, given->input, &cli->error);
  if (status == VXM_OK)
    status = vxm_sparse_file_coverage(out, file, options, given->has_window ? given->begin : NULL,
                                      given->has_window ? given->end : NULL, &cli->error);
  vxm_sparse_file_close(file);
  return status;
}

static int read_counts(cli_run *cli, const request *given, vxm_field **out) {
  vxm_coverage_options options = VXM_COVERAGE_OPTIONS_INIT;
  options.subdivision = given->coverage;
  if (cli_is_extension(given->input, "octree") && !cli_threshold_given(&given->threshold))
    return count_file(cli, given, &options, out) == VXM_OK ? CLI_DONE : cli_fail(cli);
  vxm_sparse *sparse = NULL;
  int result =
      cli_sparse_read(cli, &sparse, &given->threshold, given->input, "coverage counts set and clear voxels");
  if (result == CLI_DONE &&
      vxm_sparse_coverage(out, sparse, &options, given->has_window ? given->begin : NULL,
                          given->has_window ? given->end : NULL, &cli->error) != VXM_OK)
    result = cli_fail(cli);
  vxm_sparse_destroy(sparse);
  return result;
}

static int read_values(cli_run *cli, const request *given, cli_values *values) {
  if (given->coverage)
    return read_counts(cli, given, &values->field);
  if (given->has_window && cli_is_extension(given->input, "octree"))
    return read_part(cli, given, values) == VXM_OK ? CLI_DONE : cli_fail(cli);
  vxm_status status = cli_values_read(cli, values, given->input);
  if (status == VXM_OK && given->has_window)
    status = cut(cli, given, values);
  return status == VXM_OK ? CLI_DONE : cli_fail(cli);
}

/** Numbers stay numbers where the output holds them; else they become bits, or are refused. */
static int choose_bits_or_numbers(cli_run *cli, const request *given, cli_values *values) {
  char why[64];
  if (values->grid && cli_threshold_given(&given->threshold))
    cli_warn(cli, "%s holds set and clear voxels already: --threshold and --below are not applied",
             cli_shown(given->input, "<stdin>"));
  if (given->coverage) /* the threshold has been applied before the coverage was counted */
    return CLI_DONE;
  if (values->grid || (!cli_threshold_given(&given->threshold) && keeps_numbers(given, values->field)))
    return CLI_DONE;
  snprintf(why, sizeof why, ".%s holds only set and clear voxels", given->write.format);
  return cli_values_to_bits(cli, values, &given->threshold, given->input, why);
}

static int convert(cli_run *cli, const request *given, const cli_values *values) {
  vxm_status status = values->grid
                          ? vxm_grid_write(values->grid, given->output, &given->write, &cli->error)
                          : vxm_field_write(values->field, given->output, &given->write, &cli->error);
  if (status != VXM_OK)
    return cli_fail(cli);
  cli_progress_clear(cli);
  cli_warn_lattice(cli, given->output, given->write.format, cli_values_space(values));
  if (cli_summary(cli)) {
    cli_row(cli, "input", "%s", cli_shown(given->input, "<stdin>"));
    cli_rows_space(cli, cli_values_space(values));
    cli_values_row(cli, values);
    cli_row(cli, "output", "%s (%s)", cli_shown(given->output, "<stdout>"), given->write.format);
  }
  return cli_finish(cli, make_report(cli, given, values));
}

static int run(cli_run *cli) {
  request given = {.threshold = VXM_THRESHOLD_OPTIONS_INIT, .write = VXM_GRID_WRITE_OPTIONS_INIT};
  if (read_arguments(cli, &given) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  cli_values values = {NULL, NULL};
  if (read_values(cli, &given, &values) != CLI_DONE)
    return CLI_FAILED;
  int status = choose_bits_or_numbers(cli, &given, &values);
  if (status == CLI_DONE)
    status = convert(cli, &given, &values);
  cli_values_free(&values);
  return status;
}

const cli_command cli_command_convert = {
    .name = "convert",
    .arguments = "GRID -o FILE [OPTION]...",
    .summary = "write a grid in another format, or as a mesh",
    .notes =
        "As a mesh, the faces between set and empty voxels are merged into rectangles, in model units, and\n"
        "split into triangles. Every edge has two faces, and programs that merge vertices leave it so.\n\n"
        "Values (distances, coverage, labels, confidence, colours) are preserved in .npy, .nrrd, .nii,\n"
        ".vti, .vtk, .tif, .octree, .h5, .zarr and, but for colours, .vdb; labels up to 255 also in .binvox\n"
        "and .vox, all as blocks in .schem and .litematic and as objects in .glb, which take colours too,\n"
        "as .ply and .vox do. They become set and clear voxels only with --threshold or --below, or where\n"
        "nothing is lost: all are 0 or 1, or unsigned bytes 0 and 255. .glb is written but not read.\n\n"
        "Examples:\n"
        "  voxmend convert chair.binvox -o chair.npy\n"
        "  voxmend convert chair.npy -o blocks.obj\n"
        "  voxmend convert distance.nrrd -o distance.vdb\n"
        "  voxmend convert distance.nrrd --below 0 -o centres.binvox\n"
        "  voxmend convert city.octree --window 0:512,0:512,0:64 -o corner.npy\n"
        "  voxmend convert city.octree --coverage 64 -o overview.nrrd",
    .options = known_options,
    .run = run,
};

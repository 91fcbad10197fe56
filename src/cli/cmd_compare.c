/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend compare: in which voxels two grids differ. */
#include "cli/values.h"

#include <inttypes.h>
#include <math.h>

typedef struct request {
  vxm_threshold_options threshold;
} request;

static const cli_option known_options[] = {CLI_OPTIONS_THRESHOLD(request), CLI_OPTIONS_END};

/** Files hold origins and sizes to about nine digits; what is below a thousandth of a voxel is not a move. */
static void warn_of_places(cli_run *cli, const vxm_space *a, const vxm_space *b) {
  bool moved = false, scaled = false;
  for (int axis = 0; axis < 3; axis++) {
    double size = a->voxel_size[axis];
    moved |= !(fabs(a->origin[axis] - b->origin[axis]) <= 1e-3 * size);
    scaled |= !(fabs(size - b->voxel_size[axis]) * (double)a->dims[axis] <= 1e-3 * size);
  }
  if (moved)
    cli_warn(cli, "the grids have different origins; voxels are compared by index");
  if (scaled)
    cli_warn(cli, "the grids have different voxel sizes; voxels are compared by index");
}

static json_t *make_report(const cli_run *cli, const vxm_comparison *found) {
  json_t *report = json_object();
  json_object_set_new(report, "voxels_a", json_integer(found->voxels_a));
  json_object_set_new(report, "voxels_b", json_integer(found->voxels_b));
  json_object_set_new(report, "both", json_integer(found->both));
  json_object_set_new(report, "only_a", json_integer(found->only_a));
  json_object_set_new(report, "only_b", json_integer(found->only_b));
  json_object_set_new(report, "iou", cli_json_number(found->iou));
  json_object_set(report, "warnings", cli->warnings);
  return report;
}

static int compare(cli_run *cli, const vxm_grid *a, const vxm_grid *b) {
  vxm_comparison found = VXM_COMPARISON_INIT;
  if (vxm_grid_compare(&found, a, b, &cli->error) != VXM_OK)
    return cli_fail(cli);
  warn_of_places(cli, vxm_grid_space(a), vxm_grid_space(b));
  if (cli_summary(cli)) {
    cli_row(cli, "A", "%s: %" PRId64 " voxels", cli->arguments[0], found.voxels_a);
    cli_row(cli, "B", "%s: %" PRId64 " voxels", cli->arguments[1], found.voxels_b);
    cli_row(cli, "both", "%" PRId64, found.both);
    cli_row(cli, "only A", "%" PRId64, found.only_a);
    cli_row(cli, "only B", "%" PRId64, found.only_b);
    cli_row(cli, "IoU", "%.6f", found.iou);
  }
  return cli_finish(cli, make_report(cli, &found));
}

static int read_arguments(cli_run *cli, request *out) {
  if (cli_read_options(cli, out) == CLI_STOP)
    return CLI_STOP;
  if (cli->argument_count != 2)
    return cli_usage(cli, "two grids are expected, not %d", cli->argument_count);
  return cli_check_names(cli);
}

static int read_bits(cli_run *cli, cli_values *out, const vxm_threshold_options *threshold,
                     const char *path) {
  if (cli_values_read(cli, out, path) != VXM_OK)
    return cli_fail(cli);
  return cli_values_to_bits(cli, out, threshold, path, "only set and clear voxels can be compared");
}

static int run(cli_run *cli) {
  request given = {.threshold = VXM_THRESHOLD_OPTIONS_INIT};
  if (read_arguments(cli, &given) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  cli_values values[2] = {{NULL, NULL}, {NULL, NULL}};
  int status = CLI_DONE;
  for (int i = 0; i < 2 && status == CLI_DONE; i++)
    status = read_bits(cli, &values[i], &given.threshold, cli->arguments[i]);
  if (status == CLI_DONE)
    status = compare(cli, values[0].grid, values[1].grid);
  cli_values_free(&values[0]);
  cli_values_free(&values[1]);
  return status;
}

const cli_command cli_command_compare = {
    .name = "compare",
    .arguments = "GRID GRID [OPTION]...",
    .summary = "count the voxels in which two grids differ",
    .notes =
        "The grids must have equal dimensions. IoU is the number of voxels set in both over the number set\n"
        "in either. The exit status is 0 also when the grids differ. Numbers in a file become set and clear\n"
        "voxels by --threshold or --below; a file of set and clear voxels is taken as it is.\n\n"
        "Examples:\n"
        "  voxmend compare before.binvox after.npy --json\n"
        "  voxmend compare distance.nrrd solid.binvox --below 0",
    .options = known_options,
    .run = run,
};

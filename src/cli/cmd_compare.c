/* SPDX-License-Identifier: BSD-3-Clause */
/** voxmend compare: in which voxels two grids differ. */
#include "cli/cli.h"

#include <inttypes.h>
#include <math.h>

static const cli_option known_options[] = {{0, NULL, NULL, NULL}};

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
  vxm_comparison found;
  cli_warn_grid(cli, cli->arguments[0], a);
  cli_warn_grid(cli, cli->arguments[1], b);
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

static int run(cli_run *cli) {
  const char *value;
  if (cli_next_option(cli, &value) == CLI_STOP)
    return cli->status;
  if (cli->argument_count != 2) {
    cli_usage(cli, "two grids are expected, not %d", cli->argument_count);
    return cli->status;
  }
  if (cli_check_names(cli) == CLI_STOP)
    return cli->status;
  if (!cli_start(cli))
    return CLI_FAILED;
  vxm_grid *grids[2] = {NULL, NULL};
  int status = CLI_DONE;
  for (int i = 0; i < 2 && status == CLI_DONE; i++)
    if (vxm_grid_read(&grids[i], cli->context, cli->arguments[i], &cli->error) != VXM_OK)
      status = cli_fail(cli);
  if (status == CLI_DONE)
    status = compare(cli, grids[0], grids[1]);
  vxm_grid_destroy(grids[0]);
  vxm_grid_destroy(grids[1]);
  return status;
}

const cli_command cli_command_compare = {
    .name = "compare",
    .arguments = "GRID GRID [OPTION]...",
    .summary = "count the voxels in which two grids differ",
    .notes =
        "The grids must have equal dimensions. IoU is the number of voxels set in both over the number set\n"
        "in either. The exit status is 0 also when the grids differ.\n\n"
        "Example:\n"
        "  voxmend compare before.binvox after.npy --json",
    .options = known_options,
    .run = run,
};

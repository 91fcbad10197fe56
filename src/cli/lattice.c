/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/cli.h"

#include <math.h>
#include <string.h>

/** Voxels of OctoMap begin at multiples of their size; less than this is no move. */
static const double EVEN = 1e-6;

void cli_warn_lattice(cli_run *cli, const char *path, const char *format, const vxm_space *space) {
  double move[3];
  bool moves = false;
  if (strcmp(format, "bt") != 0)
    return;
  for (int a = 0; a < 3; a++) {
    double first = space->origin[a] / space->voxel_size[a], by = nearbyint(first) - first;
    move[a] = fabs(by) > EVEN ? by * space->voxel_size[a] : 0;
    moves = moves || move[a] != 0;
  }
  if (moves)
    cli_warn(cli,
             "%s: moved by %.4g %.4g %.4g onto OctoMap's lattice, whose voxels begin at multiples of their "
             "size; --bounds at such multiples with --voxel-size avoids it",
             cli_shown(path, "<stdout>"), move[0], move[1], move[2]);
}

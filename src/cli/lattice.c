/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/cli.h"

#include <math.h>
#include <string.h>

/** Voxels of OctoMap begin at multiples of their size; less than this is no move. */
static const double EVEN = 1e-6;

static void warn_of_move(cli_run *cli, const char *path, const vxm_space *space) {
  double move[3];
  bool moves = false;
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

/** For formats of cubes. voxmend reads the voxel size back from its metadata, other programs do not. */
static void warn_of_stretch(cli_run *cli, const char *path, const char *format, const vxm_space *space) {
  const double *size = space->voxel_size;
  if (fabs(size[1] - size[0]) > EVEN * size[0] || fabs(size[2] - size[0]) > EVEN * size[0])
    cli_warn(
        cli,
        "%s: .%s shows all voxels as cubes, and these are %.4g x %.4g x %.4g: the model looks stretched in "
        "other programs; one number as --voxel-size makes cubes",
        cli_shown(path, "<stdout>"), format, size[0], size[1], size[2]);
}

void cli_warn_lattice(cli_run *cli, const char *path, const char *format, const vxm_space *space) {
  static const char *const cubes[] = {"schem", "litematic", "vox"};
  if (strcmp(format, "bt") == 0)
    warn_of_move(cli, path, space);
  for (size_t c = 0; c < sizeof cubes / sizeof *cubes; c++)
    if (strcmp(format, cubes[c]) == 0)
      warn_of_stretch(cli, path, format, space);
}

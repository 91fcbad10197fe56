/* SPDX-License-Identifier: BSD-3-Clause */
/** The command line of binvox: what it asks for, and what is done with the voxels that voxelizing gives. */
#ifndef VXM_CLI_BINVOX_H
#define VXM_CLI_BINVOX_H

#include "cli/cli.h"

typedef enum binvox_type {
  BINVOX_BINVOX,
  BINVOX_NRRD,
  BINVOX_RAW,
  BINVOX_VTK,
  BINVOX_SCHEMATIC,
  BINVOX_MSH,
  BINVOX_TYPES
} binvox_type;

/** Names of the types, which are the extensions of files too; NULL ends them. */
extern const char *const binvox_types[BINVOX_TYPES + 1];

enum { BINVOX_TURNS_MAX = 64 };

typedef struct binvox_request {
  const char *model, *output; /**< output NULL = beside the model */
  binvox_type type;
  int64_t voxels;                       /**< -d */
  bool carving, voting, dilated, exact; /**< -c, -v, -dc, -e */
  bool wireframe, centred, internal_gone, fitted, materials;
  bool has_box;
  double box[6];                    /**< -bb */
  char turns[BINVOX_TURNS_MAX + 1]; /**< "xzz": quarter turns, in this order */
  int64_t halvings, least, block;   /**< how often -down, -dmin, -bi */
} binvox_request;

/** Reads the command line; CLI_STOP if it is at fault, or all has been said. */
int binvox_read_arguments(cli_run *cli, binvox_request *out);
void binvox_print_help(void);

/* What is done with the voxels. Each returns CLI_FAILED after a line. */
/** Sets what no straight line along an axis leads to from outside. */
int binvox_carve(cli_run *cli, vxm_grid *grid);
/** Sets the six neighbours of each voxel too. */
int binvox_dilate(cli_run *cli, vxm_grid *grid);
/** Clears voxels whose six neighbours are set. */
int binvox_remove_internal(cli_run *cli, vxm_grid *grid);
/** Makes one voxel of 2 x 2 x 2, set where `least` of them are. */
int binvox_halve(cli_run *cli, vxm_grid **grid, int64_t least);
/** Keeps the box of the voxels that are set alone; as it is where none is. */
int binvox_crop(cli_run *cli, vxm_grid **grid);

/** The block of each voxel before it is halved and cropped, x fastest; 0 = none of its own, and of several
 * that meet in a voxel the highest. */
typedef struct binvox_blocks {
  vxm_space space;
  unsigned char *ids; /**< NULL = all blocks are alike */
} binvox_blocks;

/** CLI_FAILED after a line; then there are none. */
int binvox_blocks_make(cli_run *cli, const binvox_request *given, binvox_blocks *out, const vxm_mesh *mesh,
                       const vxm_space *space);
void binvox_blocks_free(binvox_blocks *blocks);
/** The first block among those that a voxel of another space of the same place is made of; 0 if they have
 * none. */
unsigned char binvox_block_at(const binvox_blocks *blocks, const vxm_space *space, const int64_t at[3]);

/** Writes a file of any type; a failure is in cli->error. */
vxm_status binvox_write(cli_run *cli, const binvox_request *given, const vxm_grid *grid,
                        const binvox_blocks *blocks, const char *path);

#endif

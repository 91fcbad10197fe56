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

/** A grid in memory that is changed as a whole; rows are those of vxm_grid_words, with nothing set beyond
 * their ends. */
typedef struct binvox_bits {
  vxm_space space;
  int64_t row_words;
  uint64_t *words;
} binvox_bits;

/* Each replaces the content; false where memory is lacking. */
bool binvox_bits_read(binvox_bits *out, const vxm_grid *grid);
void binvox_bits_free(binvox_bits *bits);
bool binvox_bits_get(const binvox_bits *bits, int64_t i, int64_t j, int64_t k);
/** Sets what no straight line along an axis leads to from outside. */
bool binvox_carve(binvox_bits *bits);
/** Sets the six neighbours of each voxel too. */
bool binvox_dilate(binvox_bits *bits);
/** Clears voxels whose six neighbours are set. */
bool binvox_remove_internal(binvox_bits *bits);
/** Makes one voxel of 2 x 2 x 2, set where `least` of them are. */
bool binvox_halve(binvox_bits *bits, int64_t least);
/** First and last voxel that is set along each axis; false if none is. */
bool binvox_box(int64_t low[3], int64_t high[3], const binvox_bits *bits);
/** Keeps the box of the voxels that are set alone; as it is where none is. */
bool binvox_crop(binvox_bits *bits);
int64_t binvox_count(const binvox_bits *bits);

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
vxm_status binvox_write(cli_run *cli, const binvox_request *given, const binvox_bits *bits,
                        const binvox_blocks *blocks, const char *path);

#endif

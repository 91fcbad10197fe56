/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/formats/vdb/vdb_blocks.h"

#include <string.h>

enum { SIDE = VXM_VDB_SIDE };

static vxm_status put_block(const vxm_vdb_target *target, const int64_t at[3], const uint64_t bits[SIDE],
                            vxm_error *error) {
  for (int x = 0; x < SIDE; x++)
    if (bits[x] != ~UINT64_C(0))
      return target->functions->put_bits(target->vdb, at, bits, error);
  return target->functions->put_cube(target->vdb, at, SIDE, 1, error);
}

/* ---- Slices ---- */

/** The words of 8 x 8 rows, of which each byte is a row of a block. */
typedef struct bundle {
  uint64_t words[SIDE][SIDE]; /**< by y and z; 0 beyond the space */
  uint64_t any, all;
} bundle;

static bundle gather(const vxm_window *window, int64_t y, int64_t z, size_t word) {
  bundle b = {.any = 0, .all = ~UINT64_C(0)};
  for (int64_t dy = 0; dy < SIDE; dy++)
    for (int64_t dz = 0; dz < SIDE; dz++) {
      bool is_there = y + dy < window->middle_dim && z + dz < window->end;
      uint64_t row = is_there ? vxm_window_row(window, y + dy, z + dz)[word] : 0;
      b.words[dy][dz] = row;
      b.any |= row;
      b.all &= row;
    }
  return b;
}

static vxm_status put_byte(const vxm_vdb_target *target, const bundle *b, unsigned byte, const int64_t at[3],
                           vxm_error *error) {
  if ((b->all >> 8 * byte & 0xff) == 0xff)
    return target->functions->put_cube(target->vdb, at, SIDE, 1, error);
  uint64_t bits[SIDE] = {0};
  for (unsigned y = 0; y < SIDE; y++) {
    uint64_t plane = 0;
    for (unsigned z = 0; z < SIDE; z++)
      plane |= (b->words[y][z] >> 8 * byte & 0xff) << 8 * z;
    plane = vxm_transpose8(plane);
    for (unsigned x = 0; x < SIDE; x++)
      bits[x] |= (plane >> 8 * x & 0xff) << 8 * y;
  }
  return target->functions->put_bits(target->vdb, at, bits, error);
}

vxm_status vxm_vdb_put_slab(const vxm_vdb_target *target, const vxm_window *window, int64_t begin,
                            vxm_error *error) {
  vxm_status status = VXM_OK;
  for (int64_t y = 0; y < window->middle_dim; y += SIDE)
    for (size_t word = 0; word < window->row_words; word++) {
      bundle b = gather(window, y, begin, word);
      for (unsigned byte = 0; byte < 8 && b.any >> 8 * byte && status == VXM_OK; byte++)
        if (b.any >> 8 * byte & 0xff) {
          const int64_t at[3] = {(int64_t)(64 * word + 8 * byte), y, begin};
          status = put_byte(target, &b, byte, at, error);
        }
      if (status != VXM_OK)
        return status;
    }
  return VXM_OK;
}

/* ---- Octrees ---- */

/** The block at hand: in Morton order its 8 bricks follow each other. */
typedef struct gathering {
  const vxm_vdb_target *target;
  const vxm_sparse *sparse;
  int64_t at[3];
  uint64_t bits[SIDE];
  bool is_open;
  size_t bricks; /**< seen */
  vxm_status status;
  vxm_error *error;
} gathering;

static void flush(gathering *g) {
  if (g->is_open && g->status == VXM_OK)
    g->status = put_block(g->target, g->at, g->bits, g->error);
  g->is_open = false;
}

static bool is_in_block(const gathering *g, const vxm_sparse_piece *piece) {
  for (int a = 0; a < 3; a++)
    if (piece->position[a] / SIDE * SIDE != g->at[a])
      return false;
  return g->is_open;
}

/** Voxel (x,y,z) of a brick is bit 16 z + 4 y + x of its word; in a block z comes first. */
static void add_brick(gathering *g, const vxm_sparse_piece *piece) {
  unsigned x0 = (unsigned)piece->position[0] % SIDE, y0 = (unsigned)piece->position[1] % SIDE,
           z0 = (unsigned)piece->position[2] % SIDE;
  for (unsigned x = 0; x < 4; x++)
    for (unsigned y = 0; y < 4; y++) {
      uint64_t column = piece->bits >> (4 * y + x) & UINT64_C(0x0001000100010001);
      /* Bit 16 z of the column goes to bit z: each term brings one of them to bit 48 + z, and no two meet. */
      uint64_t nibble = column * UINT64_C(0x0001000200040008) >> 48 & 15;
      g->bits[x0 + x] |= nibble << (8 * (y0 + y) + z0);
    }
}

/** Of the bricks that are held, the mixed ones. */
static void report(gathering *g) {
  enum { BRICKS_PER_REPORT = 1 << 16 };
  if (++g->bricks % BRICKS_PER_REPORT == 0 && g->status == VXM_OK)
    g->status = vxm_progress(g->sparse->context, "writing",
                             (double)g->bricks / (double)g->sparse->brick_count, g->error);
}

static void put_piece(const vxm_sparse_piece *piece, void *payload) {
  gathering *g = payload;
  if (g->status != VXM_OK)
    return;
  if (!is_in_block(g, piece))
    flush(g);
  if (piece->side >= SIDE) {
    if (g->status == VXM_OK)
      g->status = g->target->functions->put_cube(g->target->vdb, piece->position, piece->side, 1, g->error);
  } else {
    if (!g->is_open) {
      for (int a = 0; a < 3; a++)
        g->at[a] = piece->position[a] / SIDE * SIDE;
      memset(g->bits, 0, sizeof g->bits);
      g->is_open = true;
    }
    add_brick(g, piece);
  }
  if (piece->bits != ~UINT64_C(0))
    report(g);
}

vxm_status vxm_vdb_put_octree(const vxm_vdb_target *target, const vxm_sparse *sparse, vxm_error *error) {
  gathering g = {.target = target, .sparse = sparse, .error = error};
  vxm_octree_walk_layers(sparse, 2, 0, sparse->space.dims[2], put_piece, &g);
  flush(&g);
  return g.status;
}

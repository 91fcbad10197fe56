/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/picture/occupancy_mips.h"
#include "base/threads.h"

#include <math.h>
#include <string.h>

/* ---- Level 0 from bits ---- */

typedef struct filling {
  vxm_occupancy_mips *mips;
  const vxm_grid *grid;
  int level;
} filling;

/** Takes the voxels of four rows, the first of which is j, into the blocks that they belong to. */
static void gather(uint64_t *blocks, const vxm_grid *grid, int64_t j, int64_t k, int64_t count) {
  for (int64_t y = j; y < vxm_min(j + 4, grid->space.dims[1]); y++) {
    const uint64_t *row = vxm_grid_row(grid, y, k);
    int shift = (int)(16 * (k & 3) + 4 * (y & 3));
    for (int64_t b = 0; b < count; b++)
      blocks[b] |= (row[b / 16] >> 4 * (b % 16) & 15) << shift;
  }
}

/** One layer of blocks: each of up to 64 set voxels becomes 0 to 255. */
static void fill_first(size_t task, int worker, void *payload) {
  (void)worker;
  const filling *f = payload;
  const int64_t *dims = f->mips->level[0].dims, bk = (int64_t)task;
  for (int64_t bj = 0; bj < dims[1]; bj++) {
    int64_t first = (bk * dims[1] + bj) * dims[0];
    uint64_t *blocks = f->mips->blocks + first;
    uint8_t *cells = f->mips->level[0].cells + first;
    memset(blocks, 0, (size_t)dims[0] * sizeof *blocks);
    for (int64_t k = 4 * bk; k < vxm_min(4 * bk + 4, f->grid->space.dims[2]); k++)
      gather(blocks, f->grid, 4 * bj, k, dims[0]);
    for (int64_t b = 0; b < dims[0]; b++)
      cells[b] = (uint8_t)((__builtin_popcountll(blocks[b]) * 255 + 63) / 64);
  }
}

/* ---- Each further level from the one before ---- */

static void fill_next(size_t task, int worker, void *payload) {
  (void)worker;
  const filling *f = payload;
  const int64_t *fine = f->mips->level[f->level - 1].dims, *dims = f->mips->level[f->level].dims;
  const uint8_t *from = f->mips->level[f->level - 1].cells;
  int64_t k = (int64_t)task;
  for (int64_t j = 0; j < dims[1]; j++)
    for (int64_t i = 0; i < dims[0]; i++) {
      unsigned sum = 0;
      for (int64_t z = 2 * k; z < vxm_min(2 * k + 2, fine[2]); z++)
        for (int64_t y = 2 * j; y < vxm_min(2 * j + 2, fine[1]); y++)
          for (int64_t x = 2 * i; x < vxm_min(2 * i + 2, fine[0]); x++)
            sum += from[(z * fine[1] + y) * fine[0] + x];
      /* Rounded up, so that 0 stays the mark of an empty cell. */
      f->mips->level[f->level].cells[(k * dims[1] + j) * dims[0] + i] = (uint8_t)((sum + 7) / 8);
    }
}

/* ---- Gaps ---- */

/** One layer of blocks. */
static void measure_gaps(size_t task, int worker, void *payload) {
  (void)worker;
  const filling *f = payload;
  const vxm_occupancy_mips *p = f->mips;
  const int64_t *dims = p->level[0].dims, k = 4 * (int64_t)task;
  for (int64_t j = 0; j < dims[1]; j++)
    for (int64_t i = 0; i < dims[0]; i++) {
      const int64_t voxel[3] = {4 * i, 4 * j, k};
      int levels = 0;
      while (levels < p->levels && vxm_occupancy_mips_cell(p, levels, voxel) == 0)
        levels++;
      p->gaps[vxm_occupancy_mips_index(p, voxel)] = (uint8_t)levels;
    }
}

/** Room for a level; level 0 has the blocks and gaps beside. */
static vxm_status make_level(vxm_occupancy_mips *p, int l, vxm_error *error) {
  int64_t side = INT64_C(4) << l, *dims = p->level[l].dims;
  for (int a = 0; a < 3; a++)
    dims[a] = (p->dims[a] + side - 1) / side;
  size_t count = (size_t)(dims[0] * dims[1] * dims[2]);
  vxm_error local = VXM_ERROR_INIT;
  if (l == 0)
    p->blocks = vxm_alloc(p->context, count, sizeof *p->blocks, &local);
  if (l == 0 && p->blocks)
    p->gaps = vxm_alloc(p->context, count, 1, &local);
  p->level[l].cells = p->gaps ? vxm_alloc(p->context, count, 1, &local) : NULL;
  p->levels = l + 1;
  if (!p->level[l].cells)
    vxm_error_pass(error, &local);
  return p->level[l].cells ? VXM_OK : local.code;
}

vxm_status vxm_occupancy_mips_create(vxm_occupancy_mips *out, const vxm_grid *grid, vxm_error *error) {
  *out = (vxm_occupancy_mips){.context = grid->context};
  memcpy(out->dims, grid->space.dims, sizeof out->dims);
  for (int l = 0; l < VXM_OCCUPANCY_LEVELS; l++) {
    vxm_status status = make_level(out, l, error);
    if (status != VXM_OK) {
      vxm_occupancy_mips_destroy(out);
      return status;
    }
    const int64_t *dims = out->level[l].dims;
    filling f = {out, grid, l};
    vxm_parallel(out->context, (size_t)dims[2], l == 0 ? fill_first : fill_next, &f);
    if (dims[0] == 1 && dims[1] == 1 && dims[2] == 1)
      break;
  }
  filling f = {out, grid, 0};
  vxm_parallel(out->context, (size_t)out->level[0].dims[2], measure_gaps, &f);
  return VXM_OK;
}

void vxm_occupancy_mips_destroy(vxm_occupancy_mips *mips) {
  for (int l = 0; l < mips->levels; l++)
    vxm_free(mips->context, mips->level[l].cells);
  vxm_free(mips->context, mips->blocks);
  vxm_free(mips->context, mips->gaps);
  mips->blocks = NULL;
  mips->gaps = NULL;
  mips->levels = 0;
}

double vxm_occupancy_mips_sample(const vxm_occupancy_mips *mips, int level, const double point[3]) {
  const int64_t *dims = mips->level[level].dims;
  double side = (double)(INT64_C(4) << level), part[3];
  int64_t base[3];
  for (int a = 0; a < 3; a++) {
    double at = point[a] / side - 0.5;
    if (!(at > -1 && at < (double)dims[a]))
      return 0;
    base[a] = (int64_t)floor(at);
    part[a] = at - (double)base[a];
  }
  double along[2] = {0, 0}, weight[2][2];
  for (int n = 0; n < 4; n++)
    weight[n >> 1][n & 1] = (n & 1 ? part[1] : 1 - part[1]) * (n >> 1 ? part[2] : 1 - part[2]);
  for (int n = 0; n < 4; n++) {
    int64_t j = base[1] + (n & 1), k = base[2] + (n >> 1);
    if (j < 0 || k < 0 || j >= dims[1] || k >= dims[2])
      continue;
    const uint8_t *row = mips->level[level].cells + (k * dims[1] + j) * dims[0];
    along[0] += base[0] >= 0 ? weight[n >> 1][n & 1] * row[base[0]] : 0;
    along[1] += base[0] + 1 < dims[0] ? weight[n >> 1][n & 1] * row[base[0] + 1] : 0;
  }
  return ((1 - part[0]) * along[0] + part[0] * along[1]) / 255;
}

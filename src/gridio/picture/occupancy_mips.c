/* SPDX-License-Identifier: BSD-3-Clause */
#include "gridio/picture/occupancy_mips.h"
#include "base/threads.h"

#include <math.h>

/* ---- Level 0 from bits ---- */

/** Counts, in each byte half, of the set bits of each group of 4: 16 counts of 0 to 4. */
static uint64_t count_nibbles(uint64_t word) {
  word -= word >> 1 & UINT64_C(0x5555555555555555);
  return (word & UINT64_C(0x3333333333333333)) + (word >> 2 & UINT64_C(0x3333333333333333));
}

typedef struct filling {
  vxm_occupancy_mips *pyramid;
  const vxm_grid *grid;
  int level;
} filling;

static int64_t smaller(int64_t a, int64_t b) {
  return a < b ? a : b;
}

/** One layer of blocks: each of up to 64 set voxels becomes 0 to 255. */
static void fill_first(size_t task, int worker, void *payload) {
  (void)worker;
  const filling *f = payload;
  const vxm_grid *grid = f->grid;
  const int64_t *dims = f->pyramid->level[0].dims, bk = (int64_t)task;
  for (int64_t bj = 0; bj < dims[1]; bj++) {
    uint8_t *cells = f->pyramid->level[0].cells + (bk * dims[1] + bj) * dims[0];
    for (size_t w = 0; w < grid->row_words; w++) {
      uint64_t low = 0, high = 0; /* counts of even and odd groups, a byte each */
      for (int64_t k = 4 * bk; k < smaller(4 * bk + 4, grid->space.dims[2]); k++)
        for (int64_t j = 4 * bj; j < smaller(4 * bj + 4, grid->space.dims[1]); j++) {
          uint64_t counts = count_nibbles(vxm_grid_row(grid, j, k)[w]);
          low += counts & UINT64_C(0x0f0f0f0f0f0f0f0f);
          high += counts >> 4 & UINT64_C(0x0f0f0f0f0f0f0f0f);
        }
      for (int64_t b = 0; b < smaller(16, dims[0] - 16 * (int64_t)w); b++) {
        uint64_t count = (b % 2 ? high : low) >> (8 * (b / 2)) & 0xff;
        cells[16 * (int64_t)w + b] = (uint8_t)((count * 255 + 63) / 64);
      }
    }
  }
}

/* ---- Each further level from the one before ---- */

static void fill_next(size_t task, int worker, void *payload) {
  (void)worker;
  const filling *f = payload;
  const int64_t *fine = f->pyramid->level[f->level - 1].dims, *dims = f->pyramid->level[f->level].dims;
  const uint8_t *from = f->pyramid->level[f->level - 1].cells;
  int64_t k = (int64_t)task;
  for (int64_t j = 0; j < dims[1]; j++)
    for (int64_t i = 0; i < dims[0]; i++) {
      unsigned sum = 0;
      for (int64_t z = 2 * k; z < smaller(2 * k + 2, fine[2]); z++)
        for (int64_t y = 2 * j; y < smaller(2 * j + 2, fine[1]); y++)
          for (int64_t x = 2 * i; x < smaller(2 * i + 2, fine[0]); x++)
            sum += from[(z * fine[1] + y) * fine[0] + x];
      /* Rounded up, so that 0 stays the mark of an empty cell. */
      f->pyramid->level[f->level].cells[(k * dims[1] + j) * dims[0] + i] = (uint8_t)((sum + 7) / 8);
    }
}

vxm_status vxm_occupancy_mips_create(vxm_occupancy_mips *out, const vxm_grid *grid, vxm_error *error) {
  *out = (vxm_occupancy_mips){.context = grid->context};
  int64_t side = 4;
  for (int l = 0; l < VXM_OCCUPANCY_LEVELS; l++, side *= 2) {
    int64_t *dims = out->level[l].dims, largest = 0;
    for (int a = 0; a < 3; a++) {
      dims[a] = (grid->space.dims[a] + side - 1) / side;
      largest = dims[a] > largest ? dims[a] : largest;
    }
    vxm_error local = VXM_ERROR_INIT;
    out->level[l].cells = vxm_alloc(out->context, (size_t)(dims[0] * dims[1] * dims[2]), 1, &local);
    if (!out->level[l].cells) {
      vxm_occupancy_mips_destroy(out);
      vxm_error_pass(error, &local);
      return local.code;
    }
    out->levels = l + 1;
    filling f = {out, grid, l};
    vxm_parallel(out->context, (size_t)dims[2], l == 0 ? fill_first : fill_next, &f);
    if (largest == 1)
      break;
  }
  return VXM_OK;
}

void vxm_occupancy_mips_destroy(vxm_occupancy_mips *pyramid) {
  for (int l = 0; l < pyramid->levels; l++)
    vxm_free(pyramid->context, pyramid->level[l].cells);
  pyramid->levels = 0;
}

double vxm_occupancy_mips_sample(const vxm_occupancy_mips *pyramid, int level, const double point[3]) {
  const int64_t *dims = pyramid->level[level].dims;
  double side = (double)(INT64_C(4) << level), part[3];
  int64_t base[3];
  for (int a = 0; a < 3; a++) {
    double at = point[a] / side - 0.5;
    if (!(at > -1 && at < (double)dims[a]))
      return 0;
    base[a] = (int64_t)floor(at);
    part[a] = at - (double)base[a];
  }
  double sum = 0;
  for (int corner = 0; corner < 8; corner++) {
    int64_t c[3];
    double weight = 1;
    bool outside = false;
    for (int a = 0; a < 3; a++) {
      int upper = corner >> a & 1;
      c[a] = base[a] + upper;
      weight *= upper ? part[a] : 1 - part[a];
      outside |= c[a] < 0 || c[a] >= dims[a];
    }
    if (!outside)
      sum += weight * pyramid->level[level].cells[(c[2] * dims[1] + c[1]) * dims[0] + c[0]];
  }
  return sum / 255;
}

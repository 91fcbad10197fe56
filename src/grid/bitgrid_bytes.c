/* SPDX-License-Identifier: BSD-3-Clause */
/** The bits of a grid as bytes [x][y][z], of a range of x, and back; and whole words. */
#include "base/task_progress.h"
#include "base/threads.h"
#include "grid/bitgrid.h"

#include <inttypes.h>
#include <string.h>

/** Columns begin to end - 1 along x; their bytes begin with the first of them. */
typedef struct transfer {
  const vxm_grid *grid; /**< its words may be written to where bytes are packed */
  size_t begin, end;
  uint8_t *to;         /**< where they are unpacked */
  const uint8_t *from; /**< where they are packed */
  bool is_asked;       /**< may be cancelled */
  vxm_task_progress progress;
} transfer;

static bool is_stopped(transfer *t, int worker) {
  return t->is_asked && vxm_task_progress_stopped(&t->progress, worker);
}

/** The columns of the range that lie in word w: first and number. */
static size_t columns_of(const transfer *t, size_t w, size_t *first) {
  *first = t->begin > w * 64 ? t->begin - w * 64 : 0;
  size_t end = t->end < w * 64 + 64 ? t->end - w * 64 : 64;
  return end - *first;
}

/** All voxels of one j: 64 x 64 bits at a time are turned from running along x to running along z. */
static void unpack_layer(size_t j, int worker, void *payload) {
  transfer *t = payload;
  const vxm_grid *grid = t->grid;
  size_t ny = (size_t)grid->space.dims[1], nz = (size_t)grid->space.dims[2];
  for (size_t w = t->begin / 64; w * 64 < t->end && !is_stopped(t, worker); w++)
    for (size_t k0 = 0; k0 < nz; k0 += 64) {
      uint64_t block[64] = {0};
      size_t first, count = vxm_min_size(nz - k0, 64), columns = columns_of(t, w, &first);
      for (size_t k = 0; k < count; k++)
        block[k] = vxm_grid_row(grid, (int64_t)j, (int64_t)(k0 + k))[w];
      vxm_transpose64(block);
      for (size_t c = first; c < first + columns; c++) {
        uint8_t *to = t->to + ((w * 64 + c - t->begin) * ny + j) * nz + k0;
        for (size_t k = 0; k < count; k++)
          to[k] = (uint8_t)(block[c] >> k & 1);
      }
    }
  if (t->is_asked)
    vxm_task_progress_step(&t->progress);
}

/** The same the other way; other columns of a word stay. */
static void pack_layer(size_t j, int worker, void *payload) {
  transfer *t = payload;
  const vxm_grid *grid = t->grid;
  size_t ny = (size_t)grid->space.dims[1], nz = (size_t)grid->space.dims[2];
  for (size_t w = t->begin / 64; w * 64 < t->end && !is_stopped(t, worker); w++)
    for (size_t k0 = 0; k0 < nz; k0 += 64) {
      uint64_t block[64] = {0};
      size_t first, count = vxm_min_size(nz - k0, 64), columns = columns_of(t, w, &first);
      for (size_t c = first; c < first + columns; c++) {
        const uint8_t *from = t->from + ((w * 64 + c - t->begin) * ny + j) * nz + k0;
        for (size_t k = 0; k < count; k++)
          block[c] |= (uint64_t)(from[k] != 0) << k;
      }
      vxm_transpose64(block);
      uint64_t mask = (columns == 64 ? ~UINT64_C(0) : vxm_low_bits((unsigned)columns)) << first;
      for (size_t k = 0; k < count; k++) {
        uint64_t *word = &vxm_grid_row(grid, (int64_t)j, (int64_t)(k0 + k))[w];
        *word = (*word & ~mask) | block[k];
      }
    }
  if (t->is_asked)
    vxm_task_progress_step(&t->progress);
}

static vxm_status run(transfer *t, const char *phase, vxm_task_fn layer, vxm_error *error) {
  size_t layers = (size_t)t->grid->space.dims[1];
  t->is_asked = true;
  vxm_task_progress_start(&t->progress, t->grid->context, phase, layers, error);
  vxm_parallel(t->grid->context, layers, layer, t);
  return vxm_task_progress_end(&t->progress);
}

static vxm_status check(const vxm_grid *grid, int64_t begin, int64_t end, const void *bytes,
                        vxm_error *error) {
  if (!grid || !bytes)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "grid: an argument is NULL");
  if (begin < 0 || begin > end || end > grid->space.dims[0])
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "grid: columns %" PRId64 " to %" PRId64 " are not within the %" PRId64 " that there are",
                    begin, end, grid->space.dims[0]);
  return VXM_OK;
}

vxm_status vxm_grid_unpack_range(const vxm_grid *grid, int64_t begin, int64_t end, uint8_t *bytes,
                                 vxm_error *error) {
  vxm_status status = check(grid, begin, end, bytes, error);
  if (status != VXM_OK || begin == end)
    return status;
  transfer t = {.grid = grid, .begin = (size_t)begin, .end = (size_t)end, .to = bytes};
  return run(&t, "unpacking voxels", unpack_layer, error);
}

vxm_status vxm_grid_pack_range(vxm_grid *grid, int64_t begin, int64_t end, const uint8_t *bytes,
                               vxm_error *error) {
  vxm_status status = check(grid, begin, end, bytes, error);
  if (status != VXM_OK || begin == end)
    return status;
  transfer t = {.grid = grid, .begin = (size_t)begin, .end = (size_t)end, .from = bytes};
  return run(&t, "packing voxels", pack_layer, error);
}

void vxm_grid_unpack(const vxm_grid *grid, uint8_t *bytes) {
  if (!grid || !bytes)
    return;
  transfer t = {.grid = grid, .end = (size_t)grid->space.dims[0], .to = bytes};
  vxm_parallel(grid->context, (size_t)grid->space.dims[1], unpack_layer, &t);
}

void vxm_grid_pack(vxm_grid *grid, const uint8_t *bytes) {
  if (!grid || !bytes)
    return;
  transfer t = {.grid = grid, .end = (size_t)grid->space.dims[0], .from = bytes};
  vxm_parallel(grid->context, (size_t)grid->space.dims[1], pack_layer, &t);
}

vxm_status vxm_grid_set_words(vxm_grid *grid, const uint64_t *words, size_t count, vxm_error *error) {
  if (!grid || !words)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "grid: an argument is NULL");
  if (count != grid->word_count)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "grid: %zu words; the grid has %zu", count, grid->word_count);
  uint64_t mask = vxm_grid_tail_mask(grid);
  for (size_t at = 0; at < count; at += grid->row_words) {
    memcpy(grid->words + at, words + at, grid->row_words * sizeof *words);
    grid->words[at + grid->row_words - 1] &= mask;
  }
  return VXM_OK;
}

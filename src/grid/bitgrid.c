/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/bitgrid.h"
#include "base/sized.h"
#include "base/threads.h"
#include "grid/count_hash.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

vxm_status vxm_space_check(const vxm_space *space, vxm_error *error) {
  static const char axis_name[3] = {'x', 'y', 'z'};
  for (int a = 0; a < 3; a++) {
    if (space->dims[a] < 1)
      return vxm_fail(error, VXM_ERROR_ARGUMENT, "%" PRId64 " voxels along %c; there must be at least 1",
                      space->dims[a], axis_name[a]);
    if (space->dims[a] > VXM_DIM_MAX)
      return vxm_fail(error, VXM_ERROR_RANGE,
                      "more than %" PRId64 " voxels along %c; choose larger voxels or a lower resolution",
                      VXM_DIM_MAX, axis_name[a]);
    if (!isfinite(space->origin[a]) || !isfinite(space->voxel_size[a]) || space->voxel_size[a] <= 0)
      return vxm_fail(error, VXM_ERROR_ARGUMENT,
                      "voxel size %g and origin %g along %c; both must be finite and the "
                      "size positive",
                      space->voxel_size[a], space->origin[a], axis_name[a]);
  }
  for (int a = 0; a < 3; a++)
    if (!isfinite(space->origin[a] + (double)space->dims[a] * space->voxel_size[a]))
      return vxm_fail(error, VXM_ERROR_RANGE,
                      "the grid would reach beyond the largest number along %c; scale it down", axis_name[a]);
  /* At most 2^14 words x 2^20 x 2^20 rows: the bytes fit 64 bits. */
  return VXM_OK;
}

vxm_status vxm_space_check_sizes(const vxm_space *space, vxm_error *error) {
  const double *s = space->voxel_size, least = fmin(s[0], fmin(s[1], s[2]));
  if (least >= VXM_VOXEL_SIZE_MIN)
    return VXM_OK;
  return vxm_fail(
      error, VXM_ERROR_RANGE,
      "voxels of size %g are too small to be computed with; choose larger ones, or scale the model "
      "up",
      least);
}

uint64_t vxm_space_bytes(const vxm_space *space) {
  return ((uint64_t)space->dims[0] + 63) / 64 * (uint64_t)space->dims[1] * (uint64_t)space->dims[2] * 8;
}

vxm_status vxm_grid_create(vxm_grid **out, vxm_context *context, const vxm_space *space, vxm_error *error) {
  if (out)
    *out = NULL;
  if (!out || !space)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "grid: an argument is NULL");
  vxm_status status = vxm_space_check(space, error);
  if (status != VXM_OK)
    return status;
  vxm_context *owner;
  status = vxm_context_acquire(&owner, context, error);
  if (status != VXM_OK)
    return status;
  vxm_grid *grid = vxm_try_calloc(owner, 1, sizeof *grid, &status, error);
  if (grid) {
    grid->context = owner;
    grid->space = *space;
    grid->row_words = ((size_t)space->dims[0] + 63) / 64;
    grid->slice_words = grid->row_words * (size_t)space->dims[1];
    grid->word_count = grid->slice_words * (size_t)space->dims[2];
    grid->words = vxm_try_calloc(owner, grid->word_count, sizeof *grid->words, &status, error);
  }
  if (!grid || !grid->words) {
    vxm_free(owner, grid);
    vxm_context_release(owner);
    return status;
  }
  *out = grid;
  return VXM_OK;
}

void vxm_grid_destroy(vxm_grid *grid) {
  if (!grid)
    return;
  vxm_context *context = grid->context;
  vxm_free(context, grid->confidence);
  vxm_free(context, grid->words);
  vxm_free(context, grid);
  vxm_context_release(context);
}

vxm_status vxm_grid_add_confidence(vxm_grid *grid, vxm_error *error) {
  vxm_status status = VXM_OK;
  const int64_t *dims = grid->space.dims;
  if (!grid->confidence)
    grid->confidence =
        vxm_try_calloc(grid->context, (size_t)dims[0] * (size_t)dims[1], (size_t)dims[2], &status, error);
  return status;
}

static bool inside(const vxm_grid *grid, int64_t i, int64_t j, int64_t k) {
  const int64_t *dims = grid->space.dims;
  return i >= 0 && j >= 0 && k >= 0 && i < dims[0] && j < dims[1] && k < dims[2];
}

bool vxm_grid_get(const vxm_grid *grid, int64_t i, int64_t j, int64_t k) {
  return grid && inside(grid, i, j, k) && (vxm_grid_row(grid, j, k)[i / 64] >> (i % 64) & 1);
}

void vxm_grid_set(vxm_grid *grid, int64_t i, int64_t j, int64_t k, bool value) {
  if (!grid || !inside(grid, i, j, k))
    return;
  uint64_t *word = vxm_grid_row(grid, j, k) + i / 64, bit = UINT64_C(1) << (i % 64);
  *word = value ? *word | bit : *word & ~bit;
}

const vxm_space *vxm_grid_space(const vxm_grid *grid) {
  return grid ? &grid->space : NULL;
}

int64_t vxm_grid_row_words(const vxm_grid *grid) {
  return grid ? (int64_t)grid->row_words : 0;
}

const uint64_t *vxm_grid_words(const vxm_grid *grid) {
  return grid ? grid->words : NULL;
}

void vxm_grid_count_hash(const vxm_grid *grid, int64_t *count, uint64_t *hash) {
  vxm_window window = vxm_window_of_grid(grid);
  vxm_count_hash sum = vxm_count_hash_start(&grid->space);
  vxm_count_hash_add(&sum, grid->context, &window, NULL);
  *count = sum.count;
  *hash = sum.hash;
}

int64_t vxm_grid_count(const vxm_grid *grid) {
  int64_t count = 0;
  uint64_t hash = 0;
  if (grid)
    vxm_grid_count_hash(grid, &count, &hash);
  return count;
}

uint64_t vxm_grid_hash(const vxm_grid *grid) {
  int64_t count = 0;
  uint64_t hash = 0;
  if (grid)
    vxm_grid_count_hash(grid, &count, &hash);
  return hash;
}

const uint8_t *vxm_grid_confidence(const vxm_grid *grid) {
  return grid ? grid->confidence : NULL;
}

int64_t vxm_grid_warning_count(const vxm_grid *grid) {
  return grid ? grid->warnings.count : 0;
}

const char *vxm_grid_warning(const vxm_grid *grid, int64_t index) {
  return grid && index >= 0 && index < grid->warnings.count ? grid->warnings.text[index] : "";
}

bool vxm_grid_box(int64_t begin[3], int64_t end[3], const vxm_grid *grid) {
  for (int a = 0; a < 3; a++) {
    if (begin)
      begin[a] = 0;
    if (end)
      end[a] = 0;
  }
  if (!begin || !end || !grid)
    return false;
  for (int64_t k = 0; k < grid->space.dims[2]; k++)
    for (int64_t j = 0; j < grid->space.dims[1]; j++) {
      const uint64_t *row = vxm_grid_row(grid, j, k);
      size_t first = 0, last = grid->row_words;
      while (first < last && row[first] == 0)
        first++;
      if (first == last)
        continue;
      while (row[last - 1] == 0)
        last--;
      const int64_t low[3] = {64 * (int64_t)first + __builtin_ctzll(row[first]), j, k};
      const int64_t high[3] = {64 * (int64_t)last - __builtin_clzll(row[last - 1]), j + 1, k + 1};
      for (int a = 0; a < 3; a++) {
        begin[a] = end[a] > 0 ? vxm_min(begin[a], low[a]) : low[a];
        end[a] = vxm_max(end[a], high[a]);
      }
    }
  return end[0] > 0;
}

static uint64_t combine_words(uint64_t a, uint64_t b, vxm_set_operation operation) {
  switch (operation) {
  case VXM_SET_UNION:
    return a | b;
  case VXM_SET_INTERSECTION:
    return a & b;
  case VXM_SET_DIFFERENCE:
    return a & ~b;
  default:
    return a ^ b;
  }
}

vxm_status vxm_bitgrid_combine(vxm_grid **out, const vxm_grid *a, const vxm_grid *b,
                               vxm_set_operation operation, vxm_error *error) {
  vxm_status status = vxm_grid_create(out, a->context, &a->space, error);
  if (status != VXM_OK)
    return status;
  uint64_t *words = (*out)->words;
  if (operation != VXM_SET_COMPLEMENT) {
    for (size_t w = 0; w < a->word_count; w++)
      words[w] = combine_words(a->words[w], b->words[w], operation);
    return VXM_OK;
  }
  for (size_t w = 0; w < a->word_count; w++)
    words[w] = ~a->words[w];
  for (size_t w = a->row_words - 1; w < a->word_count; w += a->row_words)
    words[w] &= vxm_grid_tail_mask(a);
  return VXM_OK;
}

vxm_status vxm_grid_compare(vxm_comparison *out, const vxm_grid *a, const vxm_grid *b, vxm_error *error) {
  VXM_RESULT_CLEAR(out);
  if (!out || !a || !b)
    return vxm_fail(error, VXM_ERROR_ARGUMENT, "compare: an argument is NULL");
  const int64_t *p = a->space.dims, *q = b->space.dims;
  if (memcmp(p, q, sizeof a->space.dims) != 0)
    return vxm_fail(error, VXM_ERROR_ARGUMENT,
                    "compare: the grids have different dimensions, %" PRId64 "x%" PRId64 "x%" PRId64
                    " and %" PRId64 "x%" PRId64 "x%" PRId64 "; make both in one space (--like)",
                    p[0], p[1], p[2], q[0], q[1], q[2]);
  vxm_comparison found = {.iou = 1};
  for (size_t w = 0; w < a->word_count; w++) {
    found.both += vxm_popcount(a->words[w] & b->words[w]);
    found.only_a += vxm_popcount(a->words[w] & ~b->words[w]);
    found.only_b += vxm_popcount(~a->words[w] & b->words[w]);
  }
  found.voxels_a = found.both + found.only_a;
  found.voxels_b = found.both + found.only_b;
  int64_t any = found.both + found.only_a + found.only_b;
  if (any > 0)
    found.iou = (double)found.both / (double)any;
  VXM_RESULT_WRITE(out, &found);
  return VXM_OK;
}

/* SPDX-License-Identifier: BSD-3-Clause */
/** What binvox does with voxels once they are made: 64 of a row at a time. */
#include "cli/binvox.h"

#include <stdlib.h>

static int64_t rows_of(const vxm_grid *grid) {
  const int64_t *dims = vxm_grid_space(grid)->dims;
  return dims[1] * dims[2];
}

static size_t words_of(const vxm_grid *grid) {
  return (size_t)(vxm_grid_row_words(grid) * rows_of(grid));
}

/** Row (j,k), or one without voxels where there is none. */
static const uint64_t *row_at(const vxm_grid *grid, const uint64_t *none, int64_t j, int64_t k) {
  const int64_t *dims = vxm_grid_space(grid)->dims;
  if (j < 0 || k < 0 || j >= dims[1] || k >= dims[2])
    return none;
  return vxm_grid_words(grid) + (k * dims[1] + j) * vxm_grid_row_words(grid);
}

static int lack(cli_run *cli) {
  return cli_fail_text(cli, "out of memory for the voxels: free some, or lower -d");
}

/** Replaces all voxels, and frees the words. */
static int replace(cli_run *cli, vxm_grid *grid, uint64_t *words) {
  vxm_status status = vxm_grid_set_words(grid, words, words_of(grid), &cli->error);
  free(words);
  return status == VXM_OK ? CLI_DONE : cli_fail(cli);
}

/* ---- Carving ---- */

/** Marks what is seen along x: all before the first voxel of a row that is set, and behind the last. */
static void see_along_x(uint64_t *seen, const vxm_grid *grid) {
  const int64_t words = vxm_grid_row_words(grid);
  for (int64_t row = 0; row < rows_of(grid); row++) {
    const uint64_t *in = vxm_grid_words(grid) + row * words;
    uint64_t *out = seen + row * words;
    int64_t first = 0, last = words - 1;
    for (; first < words && in[first] == 0; first++)
      out[first] = UINT64_MAX;
    for (; last > first && in[last] == 0; last--)
      out[last] = UINT64_MAX;
    if (first == words)
      continue;
    out[first] |= (in[first] & -in[first]) - 1;
    int top = 63 - __builtin_clzll(in[last]);
    out[last] |= top == 63 ? 0 : UINT64_MAX << (top + 1);
  }
}

/** Marks what is seen from both ends of a column of rows, `step` words apart. */
static void see_column(uint64_t *seen, const uint64_t *words, int64_t count, int64_t step) {
  uint64_t open = UINT64_MAX;
  for (int64_t n = 0; n < count && open; n++) {
    open &= ~words[n * step];
    seen[n * step] |= open;
  }
  open = UINT64_MAX;
  for (int64_t n = count - 1; n >= 0 && open; n--) {
    open &= ~words[n * step];
    seen[n * step] |= open;
  }
}

int binvox_carve(cli_run *cli, vxm_grid *grid) {
  const int64_t *dims = vxm_grid_space(grid)->dims;
  const uint64_t *words = vxm_grid_words(grid);
  int64_t row = vxm_grid_row_words(grid), slice = row * dims[1];
  uint64_t *seen = calloc(words_of(grid), sizeof *seen);
  if (!seen)
    return lack(cli);
  see_along_x(seen, grid);
  for (int64_t k = 0; k < dims[2]; k++)
    for (int64_t w = 0; w < row; w++)
      see_column(seen + k * slice + w, words + k * slice + w, dims[1], row);
  for (int64_t w = 0; w < slice; w++)
    see_column(seen + w, words + w, dims[2], slice);
  for (size_t w = 0; w < words_of(grid); w++)
    seen[w] = ~seen[w];
  return replace(cli, grid, seen);
}

/* ---- Neighbours ---- */

/** Dilation sets the voxels of which one of the six neighbours, or the voxel itself, is set; else the voxels
 * are kept that have an empty neighbour. */
static int combine_neighbours(cli_run *cli, vxm_grid *grid, bool is_dilation) {
  const int64_t *dims = vxm_grid_space(grid)->dims, words = vxm_grid_row_words(grid);
  uint64_t *made = calloc(words_of(grid), sizeof *made), *none = calloc((size_t)words, sizeof *none);
  if (!made || !none) {
    free(none);
    free(made);
    return lack(cli);
  }
  for (int64_t k = 0; k < dims[2]; k++)
    for (int64_t j = 0; j < dims[1]; j++) {
      const uint64_t *row = row_at(grid, none, j, k);
      const uint64_t *a = row_at(grid, none, j - 1, k), *b = row_at(grid, none, j + 1, k);
      const uint64_t *c = row_at(grid, none, j, k - 1), *d = row_at(grid, none, j, k + 1);
      uint64_t *out = made + (k * dims[1] + j) * words;
      for (int64_t w = 0; w < words; w++) {
        uint64_t left = row[w] << 1 | (w > 0 ? row[w - 1] >> 63 : 0);
        uint64_t right = row[w] >> 1 | (w + 1 < words ? row[w + 1] << 63 : 0);
        out[w] = is_dilation ? row[w] | left | right | a[w] | b[w] | c[w] | d[w]
                             : row[w] & ~(left & right & a[w] & b[w] & c[w] & d[w]);
      }
    }
  free(none);
  return replace(cli, grid, made);
}

int binvox_dilate(cli_run *cli, vxm_grid *grid) {
  return combine_neighbours(cli, grid, true);
}

int binvox_remove_internal(cli_run *cli, vxm_grid *grid) {
  return combine_neighbours(cli, grid, false);
}

/* ---- Other sizes ---- */

static int count_eight(const vxm_grid *grid, int64_t i, int64_t j, int64_t k) {
  int count = 0;
  for (int n = 0; n < 8; n++)
    count += vxm_grid_get(grid, 2 * i + (n & 1), 2 * j + (n >> 1 & 1), 2 * k + (n >> 2));
  return count;
}

int binvox_halve(cli_run *cli, vxm_grid **grid, int64_t least) {
  vxm_space space = *vxm_grid_space(*grid);
  for (int axis = 0; axis < 3; axis++) {
    space.dims[axis] = (space.dims[axis] + 1) / 2;
    space.voxel_size[axis] *= 2;
  }
  vxm_grid *made;
  if (vxm_grid_create(&made, cli->context, &space, &cli->error) != VXM_OK)
    return cli_fail(cli);
  for (int64_t k = 0; k < space.dims[2]; k++)
    for (int64_t j = 0; j < space.dims[1]; j++)
      for (int64_t i = 0; i < space.dims[0]; i++)
        if (count_eight(*grid, i, j, k) >= least)
          vxm_grid_set(made, i, j, k, true);
  vxm_grid_destroy(*grid);
  *grid = made;
  return CLI_DONE;
}

int binvox_crop(cli_run *cli, vxm_grid **grid) {
  int64_t begin[3], end[3];
  vxm_grid *made;
  if (!vxm_grid_box(begin, end, *grid))
    return CLI_DONE;
  if (vxm_grid_window(&made, *grid, begin, end, &cli->error) != VXM_OK)
    return cli_fail(cli);
  vxm_grid_destroy(*grid);
  *grid = made;
  return CLI_DONE;
}

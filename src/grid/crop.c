/* SPDX-License-Identifier: BSD-3-Clause */
#include "grid/crop.h"
#include "base/bits.h"

#include <inttypes.h>

vxm_status vxm_space_check_box(const vxm_space *space, const int64_t begin[3], const int64_t end[3],
                               vxm_error *error) {
  for (int a = 0; a < 3; a++)
    if (begin[a] < 0 || begin[a] >= end[a] || end[a] > space->dims[a])
      return vxm_fail(error, VXM_ERROR_ARGUMENT,
                      "the window %" PRId64 ":%" PRId64 " along %c is empty, or not within the %" PRId64
                      " voxels of the grid",
                      begin[a], end[a], "xyz"[a], space -> dims[a]);
  return VXM_OK;
}

vxm_space vxm_space_of_box(const vxm_space *space, const int64_t begin[3], const int64_t end[3]) {
  vxm_space box = *space;
  for (int a = 0; a < 3; a++) {
    box.dims[a] = end[a] - begin[a];
    box.origin[a] += (double)begin[a] * space->voxel_size[a];
  }
  return box;
}

/** `count` bits of a row from bit `from` on. */
static void cut_row(uint64_t *out, const uint64_t *row, size_t row_words, int64_t from, int64_t count) {
  size_t first = (size_t)from / 64, words = ((size_t)count + 63) / 64;
  unsigned shift = (unsigned)(from % 64), rest = (unsigned)(count % 64);
  for (size_t w = 0; w < words; w++) {
    uint64_t high = shift && first + w + 1 < row_words ? row[first + w + 1] << (64 - shift) : 0;
    out[w] = row[first + w] >> shift | high;
  }
  if (rest)
    out[words - 1] &= vxm_low_bits(rest);
}

vxm_status vxm_grid_crop(vxm_grid **out, const vxm_grid *grid, const int64_t begin[3], const int64_t end[3],
                         vxm_error *error) {
  vxm_space space = vxm_space_of_box(&grid->space, begin, end);
  vxm_status status = vxm_grid_create(out, grid->context, &space, error);
  if (status != VXM_OK)
    return status;
  for (int64_t k = 0; k < space.dims[2]; k++)
    for (int64_t j = 0; j < space.dims[1]; j++)
      cut_row(vxm_grid_row(*out, j, k), vxm_grid_row(grid, begin[1] + j, begin[2] + k), grid->row_words,
              begin[0], space.dims[0]);
  return VXM_OK;
}
